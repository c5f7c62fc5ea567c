"""The command `hazard-ms report`; it imports what it needs when it is called."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import tyro

from hazard_ms.evaluation.choices import flag


def report(
    folders: Annotated[tuple[Path, ...], tyro.conf.Positional],
    output: Annotated[Path, flag("-o")] = Path("report.html"),
    json: bool = False,
    pages: bool = True,
) -> int:
    """Compare agents over folders of results: scores, differences, regret, and where frames and targets go.

    Prints the scores with 95 % intervals, and writes one page with tables, charts and links to each episode. Raises
    ValueError for folders without results, and for results that cannot be compared.

    Args:
        folders: Folders that `hazard-ms evaluate` wrote; folders in them are read, too.
        output: Page to write, NAME.html.
        json: Print everything as JSON instead, and write no page.
        pages: Write the page of each episode that has none, into a folder NAME_episodes beside the page.
    """
    from json import dumps

    from hazard_ms.evaluation.comparison.folders import groups
    from hazard_ms.evaluation.comparison.page import episode_pages, page
    from hazard_ms.evaluation.comparison.summary import summary, table
    from hazard_ms.machine.files import make_folder, write

    if not folders:
        raise ValueError("folders must be those that `hazard-ms evaluate -o FOLDER` wrote, got none")
    if output.suffix != ".html":
        raise ValueError(f"output must be a name that ends in .html, got {output.name!r}")
    found, left_out = groups(folders)
    summaries = [summary(group) for group in found]
    if json:
        print(dumps({"groups": summaries, "left_out": left_out}, indent=1, allow_nan=False))
        return 0
    print("\n\n".join(map(table, summaries)))
    for line in left_out:
        print(f"left out: {line}")
    make_folder(output.parent)
    write(output, page(found, summaries, episode_pages(found, output) if pages else {}, output, left_out))
    print(f"page: {output.resolve()}")
    return 0
