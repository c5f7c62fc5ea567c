"""The page docs/numbers.md: which command makes which table and picture, and which pages quote it."""

from __future__ import annotations

import re
from pathlib import Path

from results.makers import MAKERS, Maker

PAGE = "docs/numbers.md"
HEAD = """# Which command made which number

Made by `./run results --page`; a test compares. Every table and picture has one maker. `./run results` shows the commit
at which each was made, and whether the code has changed since:

```bash
./run results                   # the state of each
./run results homes latency     # make these again, unless they are up to date
./run results all               # all that this machine can make, one after another
./run results --check           # from version 1.0 on: fail if a number is older
```

The same command resumes an interrupted run. Results of other code, and rows that would otherwise be reused, are
first moved to `build/older`. Commit the code first, since tables name the commit that made them; `results/made.csv`
has the commits of files that name none. Commit tables once they are made: that changes no code. Raw results of a
commit are in `build/`, each folder with a file `COMMIT`. Rescues of people ([benchmark](benchmark.md)) cannot be
played again: put them back from `build/older`.

From version 1.0 on, a release must not have older numbers: first commit the version, then run `./run results all`, then
tag. Only the results in the last table stay as they are, for the reason given there.

Hours are for one core, roughly. A page quotes a table if it names the table or its command, or shows its picture.

| name | makes | commands | hours | quoted in |
|---|---|---|---|---|
"""
KEPT = """
## What is kept

| name | files | made by | why it is kept | quoted in |
|---|---|---|---|---|
"""
NEEDS = """
## What it needs

| name | needs |
|---|---|
"""
WANTS = {
    "$HAZARD_MS_ORIGINAL": "the folder of the original's scenes (`indoor` and `outdoor`), which are not part of this "
    "project: `HAZARD_MS_ORIGINAL=FOLDER ./run results original`",
    "/dev/nvidiactl": "an NVIDIA GPU",
}


def pages(root: Path) -> list[Path]:
    """The pages that may quote numbers."""
    return [root / "README.md", *(path for path in sorted((root / "docs").rglob("*.md")) if path != root / PAGE)]


def quotes(text: str, maker: Maker) -> bool:
    """Whether a page names a file of `maker` or its own script, or shows its picture."""
    scripts = [word for command in maker.commands[-1:] for word in command.split() if word.startswith("results/")]
    for name in {*maker.files, *scripts}:
        pattern = re.escape(name).replace(r"\*", "[^)\\s]*")
        picture = re.escape(name.removeprefix("docs/")).replace(r"\*", "[^)\\s]*")
        if re.search(rf"(?<![\w/]){pattern}(?!\w)|\]\((?:docs/)?{picture}\)", text):
            return True
    return False


def quoted_in(root: Path, maker: Maker) -> str:
    """Links to the pages that quote `maker`."""
    own = {str(path.relative_to(root)) for name in maker.files for path in root.glob(name)}
    found = []
    for path in pages(root):
        name = str(path.relative_to(root))
        if name not in own and quotes(path.read_text(encoding="utf-8"), maker):
            target = name.removeprefix("docs/")
            found.append(f"[{target.removesuffix('.md')}]({target})" if target != name else f"`{name}`")
    return ", ".join(found) or "-"


def page(root: Path) -> str:
    """The page, Markdown."""
    made, kept = HEAD, KEPT
    for maker in MAKERS:
        files = ", ".join(f"`{name}`" for name in maker.files) or "-"
        commands = "<br>".join(f"`./run {command}`" for command in shown(maker)) or "-"
        quoted = quoted_in(root, maker)
        if maker.kept:
            kept += f"| `{maker.name}` | {files} | {commands} | {maker.kept} | {quoted} |\n"
        else:
            made += f"| `{maker.name}` | {files} | {commands} | {maker.hours:g} | {quoted} |\n"
    needs = "".join(f"| `{maker.name}` | {WANTS[maker.needs]} |\n" for maker in MAKERS if maker.needs)
    return made + NEEDS + needs + kept


def shown(maker: Maker) -> list[str]:
    """Its commands, without those that only copy."""
    return [command for command in maker.commands if not command.startswith("cp ")]
