"""The signals of floods and winds that sensors notice: water, which depth cameras hardly see through, and rain.

No rain is simulated: while a wind blows it rains RAIN, evenly.
"""

from __future__ import annotations

from typing import Any

import torch
from torch import Tensor

from hazard_ms.sensing.senses.signals import Murk, Signals
from hazard_ms.simulation.world import World

WATER_NEAR = 4.3  # absorption of water at 850 nm, where depth cameras see [1/m] [M: Kou, Labrie and Chylek 1993]
RAIN = 50.0  # in a storm [mm/h] [ours: where the Met Office's violent showers begin]
# specific attenuation of light by rain is 1.076 R^0.67 dB/km [ITU-R P.1814, Carbonneau and Wisely]
RAIN_EXTINCTION = 1.076 * RAIN**0.67 / (10.0 / 2.302585) / 1000.0  # [1/m]
RAIN_COLOUR = (0.55, 0.55, 0.53)  # light that it scatters, that of haze in pictures [ours]
AMBIENT = 20.0  # of rain and water [C] [docs/physics.md 4.4]
SMALL = 1e-6  # least height of a line [m]


class FloodSignals(Signals):
    """The signals of every flood."""

    def murk(self, state: Any, world: World, eye: Tensor, points: Tensor) -> Murk:
        """The part of each line below the level of the water at its end, for depth cameras, see `Signals.murk`.

        Pictures show water by themselves, and thermal cameras show its surface.
        """
        level = self.hazard.image(state, world, points)
        way = points - eye[:, None]
        bottom = torch.minimum(points[..., 2], eye[:, None, 2])
        tall = way[..., 2].abs()
        level_way = (bottom < level).float()  # of a level line: wholly under water, or not at all
        share = torch.where(tall > SMALL, (level - bottom) / tall.clamp(min=SMALL), level_way).clamp(0.0, 1.0)
        depth = WATER_NEAR * share * way.norm(dim=-1)
        none = torch.zeros_like(depth)
        return Murk(none, depth, none, none + AMBIENT, (0.0, 0.0, 0.0))


class WindSignals(Signals):
    """The signals of every wind."""

    def murk(self, state: Any, world: World, eye: Tensor, points: Tensor) -> Murk:
        """The rain, see `Signals.murk`: drops are larger than all wavelengths, so they dim all alike."""
        depth = RAIN_EXTINCTION * (points - eye[:, None]).norm(dim=-1)
        return Murk(depth, depth, depth, torch.full_like(depth, AMBIENT), RAIN_COLOUR)
