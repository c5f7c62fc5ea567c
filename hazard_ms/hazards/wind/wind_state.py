"""State of an episode with wind."""

from __future__ import annotations

from dataclasses import dataclass

from torch import Tensor

from hazard_ms.hazards.base import State, quantity


@dataclass
class WindState(State):
    """State of the wind with C carts, A robots and a shelter map of Y x X cells."""

    heading: Tensor = quantity("E 2", "", "where the wind blows to, a unit vector")
    speed: Tensor = quantity("E", "m/s", "mean wind, at 10 m where there is a profile")
    gust: Tensor = quantity("E", "", "excess over the mean wind in standard deviations")
    felt: Tensor = quantity("E B", "", "share of the wind that a thing feels")
    strength: Tensor = quantity("E B", "", "force over density, area and speed squared")
    sway: Tensor = quantity("E B 3", "", "sideways force over the force along the wind, the vector r")
    twist: Tensor = quantity("E B 3", "m", "torque over the force along the wind")
    carts: Tensor = quantity("E C", "", "index of a cart, -1 for none", dtype="int", fill=-1, low=-1, high="B")
    settled: Tensor = quantity("E B", "", "lies in a cart: the wind does not touch it any more", dtype="bool")
    corner: Tensor = quantity("E 2", "m", "south-west corner of the shelter map")
    lies: Tensor = quantity("E A", "", "a robot lies on the ground", dtype="bool")
    lain: Tensor = quantity("E A", "s", "time since a robot fell, 0 where it stands", low=0.0)
    before: Tensor = quantity("E B 3", "m/s", "velocity of each thing a frame ago")
    struck: Tensor = quantity("E B", "J", "energy of the blow that a thing took in the last frame", low=0.0)
    endurance: Tensor = quantity("E B", "J", "largest energy of a blow that a thing bears", low=0.0)
    loss: Tensor = quantity("E Y X", "", "share of the wind that is lost near the ground")
    cause: Tensor = quantity("E Y X", "m", "height of what shelters the cell")
