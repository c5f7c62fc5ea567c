"""Heat exchange of the HAZARD challenge: all things approach the mean of their surroundings at each update (torch).

    T' = T + decay (T_env - T)
    T_env = (W T_room + sum_j w_j T_j) / (W + sum_j w_j),   w_j = (reach / max(distance_j, nearest))^2

All new temperatures come from all old ones (Jacobi); sources keep theirs. T_env is a mean with positive weights and 0 <
decay < 1, so no temperature ever leaves the range of those present and the room's: stable at any distance. Limits of
the model: no heat capacity, no conduction, no shading but by walls; `decay` counts updates, so it is tied to the length
of a frame.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import torch
from torch import Tensor

from hazard_ms.hazards.walls import cut_off
from hazard_ms.simulation.walls import Walls

_TINY = 1e-30  # least sum of weights [1/m^2], so that 0 / 0 cannot occur
# Most weights worked on at a time on a CPU: 1 MB stays in its cache, four times faster than 1,024 environments at once
_BLOCK = 2**18


class Sources(NamedTuple):
    """The M sources of heat of each of E environments."""

    place: Tensor  # [m], [E, M, 3], world frame
    temperature: Tensor  # [C], [E, M]
    active: Tensor  # [E, M], bool; the others have no weight


@dataclass(frozen=True)
class Mean:
    """A mean of the temperatures around a point, weighted by distance."""

    room_temperature: float  # [C]
    room_weight: float  # weight of the room, in units of a source at `reach`
    reach: float  # distance at which a source has the weight 1 [m]
    nearest: float  # nearer sources weigh no more than at this distance [m]

    def at(self, points: Tensor, sources: Sources, walls: Walls) -> Tensor:
        """Mean temperature [C] at `points` [m], [E, P, 3]: [E, P]. Point p is source p, and no source to itself.

        Sources behind `walls` count nothing.
        """
        environments = len(points)
        block = environments if points.is_cuda else max(1, _BLOCK // (points.shape[1] * sources.place.shape[1]))
        if block >= environments:
            return self._block(points, sources, walls)
        parts = (slice(start, start + block) for start in range(0, environments, block))
        return torch.cat([self._block(points[p], Sources(*(s[p] for s in sources)), walls.part(p)) for p in parts])

    def _block(self, points: Tensor, sources: Sources, walls: Walls) -> Tensor:
        place, temperature, active = sources
        x = torch.where(active, place[..., 0], torch.inf)  # infinitely far: of weight 0
        ahead, across, above = points.transpose(1, 2).contiguous()[:, :, None].unbind(1)  # side by side: twice as fast
        weight = (x[..., None] - ahead).square_()  # squared distance so far, [E, M, P]
        for axis, there in ((1, across), (2, above)):
            offset = place[..., axis, None] - there
            weight.addcmul_(offset, offset)
        weight.clamp_(min=self.nearest**2).reciprocal_()
        weight[:, : points.shape[1]].diagonal(dim1=1, dim2=2).zero_()
        if walls.any:
            weight.masked_fill_(~cut_off(weight > 0.0, walls, place, points), 0.0)
        total = weight.sum(1).add_(self.room_weight / self.reach**2).clamp_(min=_TINY)
        # the excess over the room: a scene at the room's temperature stays there exactly; sums, not products of
        # matrices, whose rounding depends on how many environments there are
        excess = weight.mul_((temperature - self.room_temperature)[..., None]).sum(1)
        return self.room_temperature + excess / total


def exchange(temperature: Tensor, around: Tensor, passive: Tensor, decay: float) -> Tensor:
    """Temperatures [C], [...], after one update.

    Those of `passive` things, [...], bool, move towards `around` [C], [...]; the others stay.
    """
    return torch.where(passive, torch.lerp(temperature, around, decay), temperature)
