"""The traces of a hazard that sensors notice beyond its level: warm surfaces, flames, and what dims the view.

A hazard names a class of these in `Hazard.signals`; one that names none is not noticed.
"""

from __future__ import annotations

from typing import Any, NamedTuple

from torch import Tensor

from hazard_ms.hazards.base import Hazard
from hazard_ms.simulation.world import World
from hazard_ms.spec.registry import load


class Flames(NamedTuple):
    """M upright cylinders of burning gas in each environment, all of one `temperature` [C]."""

    place: Tensor  # middle of the base [m], world frame, [E, M, 3]
    width: Tensor  # diameter [m], [E, M]; 0 for none
    height: Tensor  # [m], [E, M]
    temperature: float


class Murk(NamedTuple):
    """Smoke, rain or water between a camera and P points."""

    sight: Tensor  # optical depth in visible light [-], [E, P]
    near: Tensor  # optical depth for the light of a depth camera [-], [E, P]
    far: Tensor  # optical depth in thermal infrared [-], [E, P]
    temperature: Tensor  # of what emits there, weighted by optical depth [C], [E, P]
    colour: tuple[float, float, float]  # of the light that it scatters, linear red, green, blue; 1 is white


class Signals:
    """The signals of one hazard; each method returns None where there is nothing to notice, as all do here."""

    def __init__(self, hazard: Any) -> None:
        """`hazard`: whose parameters count."""
        self.hazard: Any = hazard

    def warmth(self, state: Any, world: World, labels: Tensor, points: Tensor) -> Tensor | None:
        """Temperature of the surfaces [C], [E, P], at `points` [m], [E, P, 3], world frame.

        `labels`, [E, P], as in `hazard_ms.sensing.camera`: indices along B, or STRUCTURE, AGENT, NOTHING.
        """
        return None

    def flames(self, state: Any, world: World) -> Flames | None:
        """The flames of every environment."""
        return None

    def murk(self, state: Any, world: World, eye: Tensor, points: Tensor) -> Murk | None:
        """Smoke, rain or water between the `eye` [m], [E, 3], and `points` [m], [E, P, 3], world frame."""
        return None


def signals_of(hazards: tuple[Hazard, ...]) -> dict[str, Signals]:
    """The signals of those of `hazards` that have any, by the hazards' names.

    Raises ValueError for a class that cannot be imported or is none of signals.
    """
    made = {}
    for hazard in hazards:
        if hazard.signals:
            kind = load(hazard.signals)
            if not (isinstance(kind, type) and issubclass(kind, Signals)):
                raise ValueError(f"signals must name a subclass of {__name__}.Signals, got {hazard.signals!r}")
            made[hazard.name] = kind(hazard)
    return made
