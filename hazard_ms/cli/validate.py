"""The command `hazard-ms validate`; it loads nothing heavy before it is called."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from hazard_ms.evaluation.choices import flag, offer
from hazard_ms.spec import registry


def validate(
    hazard: Annotated[str, offer(registry.HAZARDS)] = "",
    output: Annotated[Path | None, flag("-o")] = None,
    quick: bool = False,
    load: tuple[str, ...] = (),
) -> int:
    """Check the physics against exact solutions, the original's tables and publications. Exits with 1 if a case fails.

    Args:
        hazard: Hazard whose cases are run; by default all.
        output: Folder for a page (validation.md) with curves.
        quick: Leave out the cases that take more than a second or two.
        load: Modules, or files NAME.py, that register hazards of your own.
    """
    from hazard_ms.spec.checks import one_of
    from hazard_ms.validation.report import validate as run

    for module in load:
        registry.load_plugin(module)
    return run(one_of(hazard, registry.HAZARDS, "hazard") if hazard else None, quick, output)
