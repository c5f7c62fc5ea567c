"""At which commits files were made, and whether that was this code: a table names them, made.csv does for others."""

from __future__ import annotations

import csv
import re
import subprocess
from dataclasses import dataclass
from pathlib import Path

from results.makers import Maker

VERSION = "hazard_ms/spec/registry/version.py"
MADE = "results/made.csv"  # commits of what names none itself: where `./run results` made it, or last changed by hand
NAMED = re.compile(r"\bcommit ([0-9a-f]{7,40})(-dirty)?\b")
DIRTY = "-dirty"
SCRIPTS = re.compile(r"(?:results|examples)/[\w/]+\.py")
FOLDER = re.compile(r"-m results\.(\w+)$")  # of results/, which runs as a whole
RELEASE = (1, 0)  # from this version on, no number may be older than its release


@dataclass(frozen=True)
class Checkout:
    """A folder with this project under git. Raises ValueError if it is none."""

    root: Path

    def __post_init__(self) -> None:
        if self.git("rev-parse", "--git-dir") is None:
            raise ValueError(f"commits can be told in a checkout with git only, got {self.root}")

    def git(self, *words: str) -> str | None:
        """What git prints; None where it fails."""
        done = subprocess.run(["git", "-C", str(self.root), *words], capture_output=True, text=True, check=False)
        return done.stdout.strip() if done.returncode == 0 else None

    def head(self) -> str:
        """The commit of this checkout, seven letters or more."""
        return self.git("rev-parse", "--short=7", "HEAD") or ""

    def unsaved(self, maker: Maker) -> list[str]:
        """Files of the code of `maker` that differ from the commit."""
        return (self.git("status", "--porcelain", "--", *code(maker)) or "").splitlines()

    def files(self, maker: Maker) -> list[Path]:
        """The files of `maker` that there are."""
        return sorted(path for pattern in maker.files for path in self.root.glob(pattern) if path.is_file())

    def missing(self, maker: Maker) -> list[str]:
        """Those of its `files` that there are not."""
        return [pattern for pattern in maker.files if not any(self.root.glob(pattern))]

    def commits(self, maker: Maker) -> list[str]:
        """The commits at which its files were made, as they name them; DIRTY follows where code was not committed."""
        named = [
            "".join(found)
            for path in self.files(maker)
            if path.suffix == ".md"
            for found in NAMED.findall(path.read_text(encoding="utf-8"))
        ]
        rows = self.made()
        return list(dict.fromkeys(named or ([rows[maker.name]] if maker.name in rows else [])))

    def made(self) -> dict[str, str]:
        """Commits by name of maker, out of made.csv."""
        path = self.root / MADE
        if not path.exists():
            return {}
        with path.open(newline="", encoding="utf-8") as file:
            return {row["name"]: row["commit"] for row in csv.DictReader(file)}

    def note(self, name: str, commit: str) -> None:
        """Write to made.csv that `commit` has made what the maker called `name` makes."""
        rows = sorted({**self.made(), name: commit}.items())
        text = "name,commit\n" + "".join(f"{one},{at}\n" for one, at in rows)
        (self.root / MADE).write_text(text, encoding="utf-8")

    def same_code(self, maker: Maker, commit: str) -> bool:
        """Whether the code of `maker` is now what it was at `commit`."""
        return self.git("diff", "--quiet", commit, "HEAD", "--", *code(maker)) is not None

    def release(self) -> str:
        """The first commit with the version that this checkout has, up to its second number; "" before RELEASE."""
        now, first = version(self.git("show", f"HEAD:{VERSION}")), ""
        for commit in (self.git("log", "--format=%h", "--", VERSION) or "").splitlines():
            if now < RELEASE or version(self.git("show", f"{commit}:{VERSION}")) != now:
                break
            first = commit
        return first

    def old(self, makers: tuple[Maker, ...]) -> list[str]:
        """What is older than the release, a line each; nothing before RELEASE."""
        release = self.release()
        lines: list[str] = []
        for maker in makers if release else ():
            lines += [] if maker.kept else self.wrong(maker, release)
        return lines

    def wrong(self, maker: Maker, release: str) -> list[str]:
        """Why files of `maker` are not of `release` or later."""
        lines = [f"{maker.name}: {name} is missing" for name in self.missing(maker)]
        for commit in self.commits(maker) if maker.files else ():
            if commit.endswith(DIRTY):
                lines.append(f"{maker.name}: made at {commit}, of which nobody knows the code")
            elif self.git("merge-base", "--is-ancestor", release, commit) is None:
                lines.append(f"{maker.name}: made at {commit}, before the release {release}")
        return lines or ([] if self.commits(maker) else [f"{maker.name}: nobody knows the commit"])

    def state(self, maker: Maker) -> str:
        """What is to be told of `maker`: "made", "missing" or "stale", with commits or names."""
        missing, commits = self.missing(maker), self.commits(maker)
        if maker.kept:
            return f"kept: {maker.kept}"
        if missing:
            return f"missing: {', '.join(missing)}"
        if commits and all(not commit.endswith(DIRTY) and self.same_code(maker, commit) for commit in commits):
            return f"made at {', '.join(commits)}"
        return f"stale: of {', '.join(commits) or 'nobody knows what commit'}"


def code(maker: Maker) -> tuple[str, ...]:
    """What the files of `maker` depend on: the package, and the scripts that it runs."""
    scripts = {name for command in maker.commands for name in SCRIPTS.findall(command)}
    scripts |= {f"results/{name}" for command in maker.commands for name in FOLDER.findall(command)}
    return ("hazard_ms", *sorted(scripts))


def version(text: str | None) -> tuple[int, int]:
    """The first two numbers of the version that version.py sets."""
    found = re.search(r'__version__ = "(\d+)\.(\d+)', text or "")
    return (int(found[1]), int(found[2])) if found else (0, 0)
