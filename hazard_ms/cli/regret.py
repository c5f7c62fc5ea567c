"""The command `hazard-ms regret`; it imports what it needs when it is called."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import tyro

from hazard_ms.evaluation.choices import flag


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
