"""The commands `hazard-ms report` and `regret` on folders of results; they import what they need when called."""

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
    csv: Path | None = None,
) -> int:
    """Compare agents over folders of results: scores, differences, regret, and where frames and targets go.

    Prints the scores with 95 % intervals, and writes one page with tables, charts and links to each episode. Raises
    ValueError for folders without results, and for results that cannot be compared.

    Args:
        folders: Folders that `hazard-ms evaluate` wrote; folders in them are read, too.
        output: Page to write, NAME.html.
        json: Print everything as JSON instead, and write no page.
        pages: Write the page of each episode, into a folder NAME_episodes beside the page.
        csv: File for one row of numbers for each episode, NAME.csv.
    """
    from json import dumps

    from hazard_ms.evaluation.comparison.folders import groups
    from hazard_ms.evaluation.comparison.page import episode_pages, page
    from hazard_ms.evaluation.comparison.rows import table as table_of_rows
    from hazard_ms.evaluation.comparison.summary import summary, table
    from hazard_ms.machine.files import make_folder, write

    if not folders:
        raise ValueError("folders must be those that `hazard-ms evaluate -o FOLDER` wrote, got none")
    if output.suffix != ".html":
        raise ValueError(f"output must be a name that ends in .html, got {output.name!r}")
    found, left_out = groups(folders)
    summaries = [summary(group) for group in found]
    if csv is not None:
        make_folder(csv.parent)
        write(csv, table_of_rows(found))
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


def regret(
    folders: Annotated[tuple[Path, ...], tyro.conf.Positional],
    output: Annotated[Path | None, flag("-o")] = None,
    workers: int = 0,
    load: tuple[str, ...] = (),
) -> int:
    """Judge each decision of recorded episodes: how much value it gave away, and why.

    Simulates the episodes again, and writes NAME.regret.json beside each result NAME.json; files that are there and fit
    their result are kept. Prints what each agent lost, and by what. `hazard-ms report` shows it, too.

    Args:
        folders: Folders that `hazard-ms evaluate` wrote; folders in them are read, too.
        output: File for what each agent lost, NAME.json.
        workers: Processes; 0: one for each core.
        load: Modules, or files NAME.py, that register what the episodes need.
    """
    from json import dumps

    from hazard_ms.agents.base import user_path
    from hazard_ms.evaluation.regret.command import regret as run
    from hazard_ms.evaluation.regret.table import shares
    from hazard_ms.machine.files import write

    user_path()
    found = run(folders, workers, load)
    if output is not None:
        agents = dict.fromkeys(one.agent for one in found)
        made = {agent: shares([one for one in found if one.agent == agent]) for agent in agents}
        write(output, dumps(made, indent=1, allow_nan=False) + "\n")
    return 0
