"""`hazard-ms validate`: loads nothing heavy before it is called."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

import tyro


def validate(
    hazard: Literal["fire", "flood", "wind"] | None = None,
    output: Annotated[Path | None, tyro.conf.arg(aliases=["-o"])] = None,
    quick: bool = False,
) -> int:
    """Check the physics against exact solutions, the original's tables and publications. Ends with 1 if a case fails.

    Args:
        hazard: Only the cases of this one.
        output: Folder for a page (validation.md) with curves.
        quick: Leave out the cases that take more than a second or two.
    """
    from hazard_ms.validation.report import validate as run

    return run(hazard, quick, output)
