"""`./run results [NAME...|all|--page|--check]`: what made every table and picture, and whether that was this code.

Without words it tells the state of each. Names, or `all`, are made anew unless they are of this code, one after
another; a run that was stopped resumes. `--page` writes docs/numbers.md, `--check` ends with 1 if a number is older
than the release, from version 1.0 on.
"""

from __future__ import annotations

import os
import shlex
import shutil
import subprocess
import sys
import time
from pathlib import Path

from hazard_ms.spec.checks import one_of
from results.commits import Checkout
from results.makers import MAKERS, Maker
from results.numbers_page import PAGE, page

ROOT = Path(__file__).parents[1]
MARK = "COMMIT"  # file in a folder of raw results: the commit at which it was begun
INTERRUPTED = 130  # as shells end after Ctrl-C


def tell(checkout: Checkout) -> None:
    """Print the state of each maker."""
    wide = max(len(maker.name) for maker in MAKERS)
    for maker in MAKERS:
        print(f"{maker.name:{wide}}  {maker.hours:5.1f} h  {checkout.state(maker)}{lacks(maker)}")


def lacks(maker: Maker) -> str:
    """What this machine has not and `maker` needs; "" if nothing."""
    there = os.environ.get(maker.needs[1:]) if maker.needs.startswith("$") else Path(maker.needs).exists()
    return "" if not maker.needs or there else f" (needs {maker.needs})"


def clear(checkout: Checkout, maker: Maker) -> None:
    """Move away what its commands would resume from, unless it was begun with this code."""
    home = checkout.root / "build"
    own = [home / name for name in maker.folders]
    marks = {folder: (folder / MARK).read_text().strip() if (folder / MARK).exists() else "" for folder in own}
    begun = {folder: bool(mark) and checkout.same_code(maker, mark) for folder, mark in marks.items()}
    older = home / "older" / f"{maker.name}-{time.strftime('%Y%m%d-%H%M%S')}"
    again = [folder for folder in own if not begun[folder]]
    rows = [checkout.root / name for name in maker.rows if again]
    for path in [path for path in (*again, *rows) if path.exists()]:
        older.mkdir(parents=True, exist_ok=True)
        shutil.move(path, older / path.name)
        print(f"moved {path.relative_to(checkout.root)} to {older.relative_to(checkout.root)}", flush=True)
    for folder in again:
        folder.mkdir(parents=True)
        (folder / MARK).write_text(f"{checkout.head()}\n", encoding="utf-8")


def words(command: str) -> list[str]:
    """The arguments of a process for a command of a maker, $VARIABLES filled in."""
    first, *others = shlex.split(os.path.expandvars(command))
    started = {"python": [sys.executable], "hazard-ms": [sys.executable, "-m", "hazard_ms.cli"]}
    return [*started.get(first, [first]), *others]


def run(command: list[str], folder: Path) -> None:
    """Run a command, which may end by itself after Ctrl-C. Raises CalledProcessError where it fails."""
    with subprocess.Popen(command, cwd=folder) as process:
        try:
            status = process.wait()
        except KeyboardInterrupt:
            process.wait()  # it was told, too
            raise
    if status:
        raise subprocess.CalledProcessError(status, command)


def make(checkout: Checkout, maker: Maker) -> None:
    """Run the commands of a maker. Raises ValueError if it cannot be made, CalledProcessError where one fails."""
    if unsaved := checkout.unsaved(maker):
        raise ValueError(f"the code of {maker.name} must be committed, which tables name; got {unsaved[0]}")
    if lacks(maker):
        raise ValueError(f"{maker.name} cannot be made here{lacks(maker)}")
    begun, at = time.monotonic(), checkout.head()
    clear(checkout, maker)
    for command in maker.commands:
        print(f"{maker.name}: ./run {command}", flush=True)
        run(words(command), checkout.root)
    checkout.note(maker.name, at)
    print(f"{maker.name}: made at {at} in {(time.monotonic() - begun) / 3600:.2f} h", flush=True)


def make_all(checkout: Checkout, makers: list[Maker], strict: bool) -> int:
    """Make those that are not of this code. Returns how many failed; `strict`: those that cannot be made here do."""
    failed = 0
    for maker in makers:
        if checkout.state(maker).startswith("made"):
            print(f"{maker.name}: {checkout.state(maker)}")
            continue
        if lacks(maker) and not strict:
            print(f"{maker.name}: left out{lacks(maker)}")
            continue
        try:
            make(checkout, maker)
        except (ValueError, subprocess.CalledProcessError) as error:
            print(f"{maker.name}: {error}", file=sys.stderr, flush=True)
            failed += 1
    return failed


def chosen(names: list[str]) -> list[Maker]:
    """The makers called `names`. Raises ValueError for unknown ones, and for those that are kept as they are."""
    known = {maker.name: maker for maker in MAKERS}
    found = [known[one_of(name, [*known, "all"], "a name of ./run results")] for name in names]
    for maker in found:
        if maker.kept:
            raise ValueError(f"a name must be of what is made anew, got {maker.name} ({maker.kept})")
    return found


def main(arguments: list[str]) -> int:
    """Do what the command says. Returns its exit status."""
    try:
        checkout = Checkout(ROOT)
        if not arguments:
            tell(checkout)
        elif arguments == ["--page"]:
            (ROOT / PAGE).write_text(page(ROOT), encoding="utf-8")
        elif arguments == ["--check"]:
            wrong = checkout.old(MAKERS)
            release = checkout.release()
            print(
                "\n".join(wrong) or (f"all is of {release} or later" if release else "no release yet: all may be old")
            )
            return bool(wrong)
        elif arguments == ["all"]:
            return bool(make_all(checkout, [maker for maker in MAKERS if not maker.kept], strict=False))
        else:
            return bool(make_all(checkout, chosen(arguments), strict=True))
    except ValueError as error:
        print(f"./run results: {error}", file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        print("\n./run results: stopped; the same command resumes", file=sys.stderr)
        return INTERRUPTED
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
