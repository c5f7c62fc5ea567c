"""The contract of a simulator: reading, pushing and keeping the bodies of a World."""

from __future__ import annotations

from typing import Any, Protocol

from torch import Tensor


class Handles(Protocol):
    """The moving bodies of a simulator, M per scene; `hazard_ms.simulation.physx` has a class for CPU and for GPU."""

    def read(self, world: Any) -> None:
        """Write position, rotation, velocity and angular velocity of the moving bodies into `world`, a World."""

    def push(self, force: Tensor, torque: Tensor | None) -> None:
        """Apply force [N] and torque [N m], [E, B, 3], world frame, at the centres of mass, for one physics step."""

    def asleep(self) -> Tensor:
        """Whether the simulator has put each body to rest, bool [E, M]."""

    def put_to_sleep(self, asleep: Tensor) -> None:
        """Let the bodies of the mask `asleep` [E, M] rest exactly where they are."""

    def place(self, rows: Tensor, base: Tensor, rotation: Tensor) -> None:
        """Put all bodies of the environments `rows` at rest at `base` [m], [E, B, 3], and `rotation`, [E, B, 4]."""

    def freeze(self, frozen: Tensor, base: Tensor, rotation: Tensor) -> None:
        """Keep the bodies of the mask `frozen`, [E, B], at `base` [m], [E, B, 3], and `rotation`, [E, B, 4].

        They neither fall nor collide. All other bodies are free.
        """

    def loosen(self, loose: Tensor) -> None:
        """Let the furniture of the mask `loose`, [E, B], move; all other furniture stands where it is."""
