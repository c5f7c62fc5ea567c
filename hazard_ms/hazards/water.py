"""What water is like, wherever it floods."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Water:
    """What water is like."""

    density: float = 1000.0  # [kg/m^3]
    gravity: float = 9.81  # [m/s^2]
    damping: float = 0.1  # zeta, share of the critical damping of a body that heaves or rolls [-] [physics.md L-10]
    added_mass: float = 0.0  # Ca, of the displaced mass [-]

    @property
    def numbers(self) -> tuple[float, float, float, float]:
        """As kernels take them."""
        return self.density, self.gravity, self.damping, self.added_mass
