"""Inner walls of scenes and the doorways in them: what lies between two places (torch; Warp: hazard_ms.hazards.walls).

Everything that goes straight, as heat and flames do, asks here: a wall lets it pass where the straight line from one
place to the other goes through a doorway, or through what is open of a door (hazard_ms.simulation.openings). Places are
points [m], [..., 3], world frame; walls are planes in the middle of their thickness, and run from one side of a room to
the other.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import torch
from torch import Tensor

from hazard_ms.simulation.kernels.launch import Launches
from hazard_ms.spec import Opening, Partition, SceneSpec

NOWHERE = 1e6  # where a wall that does not exist is [m]: farther than any place


@dataclass(frozen=True)
class Walls:
    """The inner walls of E scenes: W walls and D doorways or doors in each, at least one of both; not all exist."""

    any: bool  # whether any scene has one
    wall: Tensor  # axis that it crosses (0 x, 1 y), where, and half of its thickness [m], [E, W, 3]
    # number of its wall (-1 for none), lower and upper end along it of what is open now, sill and top [m], [E, D, 5]
    doorway: Tensor
    # numbers of the doorways that each wall has in any scene, [W]; empty: it may have any. Others are not looked at
    ways: tuple[tuple[int, ...], ...] = ()
    launches: Launches = field(default_factory=Launches, compare=False, repr=False)  # of kernels that ask about them

    @classmethod
    @torch.inference_mode(False)
    def of(cls, specs: tuple[SceneSpec, ...], device: torch.device | str) -> Walls:
        """The inner walls of `specs`. Their tensors can be changed in place, in inference mode and out of it."""
        walls = [[_wall(p) for p in s.room.partitions] for s in specs]
        doorways = [_doorways(s) for s in specs]
        most = max(1, *(len(row) for row in walls))
        ways = tuple(
            tuple(sorted({d for row in doorways for d, way in enumerate(row) if way[0] == w})) for w in range(most)
        )
        wall, doorway = (0.0, NOWHERE, 0.0), (-1.0, *[0.0] * 4)
        return cls(any(walls), _padded(walls, wall, device), _padded(doorways, doorway, device), ways)

    @classmethod
    def none(cls, count: int, device: torch.device | str = "cpu") -> Walls:
        """`count` scenes without inner walls."""
        wall, doorway = (0.0, NOWHERE, 0.0), (-1.0, *[0.0] * 4)
        walls, doorways = (
            torch.tensor(row, device=device).expand(count, 1, len(row)).contiguous() for row in (wall, doorway)
        )
        return cls(False, walls, doorways)

    def part(self, rows: Tensor | slice) -> Walls:
        """The walls of the environments `rows`, indices [R] or a slice."""
        return Walls(self.any, self.wall[rows], self.doorway[rows], self.ways, self.launches)

    def doorways_of(self, wall: int) -> Sequence[int]:
        """Numbers of the doorways that may be in the wall of this number."""
        return self.ways[wall] if self.ways else range(self.doorway.shape[1])


def _wall(partition: Partition) -> tuple[float, ...]:
    return float(partition.axis == "x"), partition.at, partition.thickness / 2


def _doorways(spec: SceneSpec) -> list[tuple[float, ...]]:
    """Doorways and doors in inner walls, in the order of the room's openings, as open as at frame 0."""
    numbers = {p.name: float(k) for k, p in enumerate(spec.room.partitions)}
    found: list[tuple[float, ...]] = []
    for o in spec.room.openings:
        if o.wall in numbers:
            low, high = o.centre - o.width / 2, o.centre + o.width / 2
            low = low if o.share == 1.0 else high - o.share * o.width
            found.append((numbers[o.wall], low, high, o.sill, o.sill + o.height))
    return found


def leaves(spec: SceneSpec) -> list[Opening]:
    """The doors in the inner walls of a scene."""
    names = {p.name for p in spec.room.partitions}
    return [o for o in spec.room.openings if o.kind == "door" and o.wall in names]


def _padded(rows: list[list[tuple[float, ...]]], empty: tuple[float, ...], device: torch.device | str) -> Tensor:
    length = max(1, *(len(row) for row in rows))
    return torch.tensor([[*row, *[empty] * (length - len(row))] for row in rows], device=device)


def blocked(walls: Walls, here: Tensor, there: Tensor) -> Tensor:
    """Whether a wall lies between the places `here` [m], [E, M, 3], and `there` [m], [E, P, 3]: [E, M, P], bool."""
    here, there = here[:, :, None], there[:, None]
    found = torch.zeros(here.shape[0], here.shape[1], there.shape[2], dtype=torch.bool, device=here.device)
    for w in range(walls.wall.shape[1]):
        across = walls.wall[:, w, 0, None, None] > 0
        at = walls.wall[:, w, 1, None, None]
        (mine, along), (yours, end) = ((_across(across, p), _across(~across, p)) for p in (here, there))
        crosses = (mine < at) != (yours < at)
        if not crosses.is_cuda and not crosses.any():
            continue
        share = (at - mine) / torch.where(crosses, yours - mine, 1.0)
        through = torch.zeros_like(found)
        place = along + share * (end - along)
        height = here[..., 2] + share * (there[..., 2] - here[..., 2])
        for d in walls.doorways_of(w):
            number, low, high, sill, top = (v[:, None, None] for v in walls.doorway[:, d].unbind(-1))
            through |= (number == w) & (place > low) & (place < high) & (height >= sill) & (height < top)
        found |= crosses & ~through
    return found


def _across(across: Tensor, place: Tensor) -> Tensor:
    """The coordinate of `place` along y where `across` holds, else along x."""
    return torch.where(across, place[..., 1], place[..., 0])
