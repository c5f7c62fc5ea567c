"""Properties of water, wherever it floods."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Water:
    """Properties of water."""

    density: float = 1000.0  # [kg/m^3]
    gravity: float = 9.81  # [m/s^2]
    # share of the critical damping of a body that heaves or rolls, zeta [-] [docs/physics.md L-10]
    damping: float = 0.1
    added_mass: float = 0.0  # share of the displaced mass that moves along, Ca [-]
