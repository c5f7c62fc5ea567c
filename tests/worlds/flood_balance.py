"""What the water of `realistic` has in whole scenes without a simulator: volume, energy, speed."""

from __future__ import annotations

from dataclasses import dataclass

import torch

from hazard_ms.hazards.flood.realistic.floor_plan import CELL, size_of
from hazard_ms.hazards.flood.realistic.inundation import Inundation
from hazard_ms.hazards.flood.realistic.inundation_state import InundationState
from hazard_ms.hazards.presets import flood
from hazard_ms.scenes.splits import SCENES, scene, scene_names, spare_scene
from hazard_ms.simulation.building import make_world
from hazard_ms.simulation.world import World
from hazard_ms.spec import SceneSpec
from tests.worlds.flood_worlds import begin

GRAVITY = 9.81  # [m/s^2]


def drawn(split: str, count: int) -> list[SceneSpec]:
    """So many scenes of a split: its own first, then spare ones of the same places."""
    names = scene_names(split)
    step = max(1, len(names) // min(count, len(names)))
    own = [scene(name) for name in names[::step][:count]]
    return own + [spare_scene(names, SCENES + k) for k in range(count - len(own))]


@dataclass
class Flooding:
    """One scene under water."""

    law: Inundation
    world: World
    state: InundationState

    @classmethod
    def of(cls, spec: SceneSpec, severity: str = "extreme") -> Flooding:
        law, world = flood("realistic", severity), make_world((spec,), torch.device("cpu"))
        assert isinstance(law, Inundation)
        return cls(law, world, begin(law, world))  # type: ignore[arg-type]

    def grid(self, name: str) -> torch.Tensor:
        """A quantity of all cells with the ring around them, [X + 2, Y + 2], double."""
        x, y = size_of([spec.room for spec in self.world.specs])
        held: torch.Tensor = getattr(self.state, name)[0].double().view(x + 2, y + 2)
        return held

    def step(self) -> None:
        self.world.chance.tick()
        self.law.advance(self.state, self.world, 1 / 30)

    @property
    def volume(self) -> float:
        """Water in the scene [m^3]."""
        return float((self.grid("depth") + self.grid("depth_rest")).sum()) * CELL**2

    @property
    def came(self) -> float:
        """Water that has come in, less what has left [m^3]."""
        return float(self.state.inflow.double() + self.state.inflow_rest.double())

    @property
    def speed(self) -> float:
        """Of the fastest water [m/s]."""
        return max(float(self.grid(f"velocity_{axis}").abs().max()) for axis in "xy")

    @property
    def energy(self) -> float:
        """Potential and kinetic energy of the water over its density [m^5/s^2]."""
        bed, depth = self.grid("bed"), self.grid("depth")
        found = GRAVITY * (depth * (bed + 0.5 * depth)).sum()
        for axis in (0, 1):
            ground = torch.maximum(bed, bed.roll(1, axis))
            over = 0.5 * sum(
                (b + d - ground).clamp(min=0) for b, d in ((bed, depth), (bed.roll(1, axis), depth.roll(1, axis)))
            )
            found = found + 0.5 * (over * self.grid(f"velocity_{'xy'[axis]}") ** 2).sum()
        return float(found) * CELL**2
