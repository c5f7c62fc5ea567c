"""Paths of water from the wall that it comes from to any place in a room (torch; per place: reach.py, Warp).

Partitions run from one side of a room to the other, so its parts are rectangles in which water goes straight. Into
parts along the source wall it comes from the whole wall; into the others through doorways, and doors that are open at
all, each reached by the shortest path. The depth decreases along the path, so a part behind a partition fills from its
doorway, and the level is the same on both sides of it (but for the thickness of the partition, and at the outer edge of
a doorway that water passes on its path elsewhere). Nothing flows through closed walls and doors. Where water comes from
a second wall, too, a path begins at whichever wall makes it shorter; that wall is described as a doorway without depth,
in which the water already stands. Where water comes in at outer doors alone, so is each of them, and no part lies along
a source.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, NamedTuple

import torch
from torch import Tensor

from hazard_ms.hazards.base import none_set
from hazard_ms.hazards.flood import reach
from hazard_ms.hazards.flood.flood_state import FloodState
from hazard_ms.hazards.flood.reach import NEVER
from hazard_ms.scenes.inlets import inlets
from hazard_ms.scenes.walls import WALLS, on_wall
from hazard_ms.simulation.kernels.launch import Launches, of_environments
from hazard_ms.simulation.world import World
from hazard_ms.spec import Opening, Partition, Room, SceneSpec, Vec2

# Direction in which water flows in from each side of a room
SIDES: dict[str, Vec2] = {"south": (0.0, 1.0), "east": (-1.0, 0.0), "north": (0.0, -1.0), "west": (1.0, 0.0)}


@dataclass(frozen=True)
class Doorway:
    """The inside of a doorway, or a source: a rectangle on the floor, and the parts beside it."""

    low: Vec2  # [m]
    high: Vec2  # [m]
    part: int  # number of one of the parts beside it
    differing: int  # bits in which the others differ: of a doorway, that of its partition


class Source(NamedTuple):
    """A wall from which water comes."""

    flow: Vec2  # unit vector in which water leaves it
    origin_length: float  # path length at the origin of the room, were there no partitions [m]
    bits: int  # of the partitions that separate parts along it from others
    part: int  # those bits of the parts along it


class FlowPaths(NamedTuple):
    """The parts and doorways of E rooms with W partitions and D doorways, second source walls among them.

    The number of a part has one bit per partition: 1 on the side of larger x or y.
    """

    flow: Tensor  # unit vector in which water leaves the source wall, [E, 2]
    origin_length: Tensor  # path length at the origin of the room, were there no partitions [m], [E]
    partition: Tensor  # axis that each partition crosses (0 x, 1 y), and where [m], [E, W, 2]
    source_part: Tensor  # bits that the parts along the source wall share: which, and their values, [E, 2]
    doorway: Tensor  # low x, y and high x, y of doorways [m], [E, D, 4]
    doorway_distance: Tensor  # path length from the source wall to the doorway [m], [E, D]
    doorway_part: Tensor  # number of a part beside the doorway, and bits in which others beside it differ, [E, D, 2]


def sizes(specs: tuple[SceneSpec, ...], through_doors: bool = False) -> dict[str, int]:
    """The largest numbers of partitions, W, and of doorways, doors beside them and sources but the first wall, D."""
    return {
        "W": max(len(s.room.partitions) for s in specs),
        "D": max(
            len(_ways(s.room)) + (len(inlets(s)) if through_doors else s.second_flood_side is not None) for s in specs
        ),
    }


def paths_of(spec: SceneSpec, partitions: int, doorways: int, through_doors: bool = False) -> dict[str, Any]:
    """The entries of FlowPaths for one scene, padded to so many.

    `through_doors`: water comes in at outer doors (hazard_ms.scenes.inlets), not over the whole source walls. Raises
    ValueError for an unknown side.
    """
    sides = [spec.flood_side] if spec.second_flood_side is None else [spec.flood_side, spec.second_flood_side]
    for side in sides:
        if side not in SIDES:
            raise ValueError(f"flood_side of {spec.name} must be one of {', '.join(SIDES)}, got {side!r}")
    room = spec.room
    sources = [_source(room, side) for side in sides]
    ways = _ways(room)
    found = [_doorway(room, o.wall, o.centre, o.width) for o in ways]
    first = sources[0]
    is_open = [o.share > 0.0 for o in ways]
    if through_doors:
        others = [_inlet(room, o) for o in inlets(spec)]
        distances = _doorway_distances(found, [], others, is_open)
        first = first._replace(bits=1 << partitions, part=1 << partitions)  # of no part
    else:
        others = [_as_doorway(room, source) for source in sources[1:]]
        distances = _doorway_distances(found, sources, [], is_open)
    found, distances = [*found, *others], [*distances, *[0.0] * len(others)]
    spare = doorways - len(found)
    return {
        "flow": list(first.flow),
        "origin_length": first.origin_length,
        "partition": [[float(_across(p)), p.at] for p in room.partitions]
        + [[0.0, NEVER]] * (partitions - len(room.partitions)),
        "source_part": [first.bits, first.part],
        "doorway": [[*d.low, *d.high] for d in found] + [[0.0] * 4] * spare,
        "doorway_distance": distances + [NEVER] * spare,
        "doorway_part": [[d.part, d.differing] for d in found] + [[0, 0]] * spare,
    }


def _ways(room: Room) -> list[Opening]:
    """Doorways and doors in inner walls."""
    return [o for o in room.openings if o.wall not in WALLS]


def _across(partition: Partition) -> int:
    """The axis that a partition crosses: 0 for x, 1 for y."""
    return 1 if partition.axis == "x" else 0


def _source(room: Room, side: str) -> Source:
    flow = SIDES[side]
    bits = sum(1 << k for k, p in enumerate(room.partitions) if flow[_across(p)])
    # from the east and the north, water meets the sides of larger x and y first
    return Source(flow, max(-flow[0] * room.size[0], -flow[1] * room.size[1], 0.0), bits, bits if sum(flow) < 0 else 0)


def _as_doorway(room: Room, source: Source) -> Doorway:
    """The source wall as a doorway without depth, beside all parts along it."""
    low = (room.size[0] if source.flow[0] < 0 else 0.0, room.size[1] if source.flow[1] < 0 else 0.0)
    high = (0.0 if source.flow[0] > 0 else room.size[0], 0.0 if source.flow[1] > 0 else room.size[1])
    return Doorway(low, high, source.part, ((1 << len(room.partitions)) - 1) & ~source.bits)


def _inlet(room: Room, door: Opening) -> Doorway:
    """An opening in an outer wall as a doorway without depth."""
    low, high = (on_wall(room, door.wall, door.centre + d * door.width / 2, 0.0, 0.0)[:2] for d in (-1, 1))
    middle = ((low[0] + high[0]) / 2, (low[1] + high[1]) / 2)
    part = sum((middle[_across(p)] > p.at) << k for k, p in enumerate(room.partitions))
    return Doorway(low, high, part, 0)


def _doorway(room: Room, wall: str, centre: float, width: float) -> Doorway:
    number = next(k for k, p in enumerate(room.partitions) if p.name == wall)
    p = room.partitions[number]
    along, across = (centre - width / 2, centre + width / 2), (p.at - p.thickness / 2, p.at + p.thickness / 2)
    (x0, x1), (y0, y1) = (along, across) if p.axis == "x" else (across, along)
    middle = ((x0 + x1) / 2, (y0 + y1) / 2)
    part = sum(
        (not k == number and middle[0 if q.axis == "y" else 1] > q.at) << k for k, q in enumerate(room.partitions)
    )
    return Doorway((x0, y0), (x1, y1), part, 1 << number)


def _beside(doorway: Doorway) -> set[int]:
    return {doorway.part, doorway.part ^ doorway.differing}


def _straight(source: Source, doorway: Doorway) -> float:
    """Length of the straight path from a source wall to a doorway [m], NEVER where there is none."""
    if not any(part & source.bits == source.part for part in _beside(doorway)):
        return NEVER
    return source.origin_length + sum(
        f * (doorway.low[k] if f > 0 else doorway.high[k]) for k, f in enumerate(source.flow)
    )


def _doorway_distances(
    doorways: list[Doorway], sources: list[Source], inlets: list[Doorway], is_open: list[bool]
) -> list[float]:
    """Length of the shortest path from a source to each doorway [m]: straight, or from doorway to doorway."""
    pairs = zip(doorways, is_open, strict=True)
    lengths = [min((_straight(s, d) for s in sources), default=NEVER) if free else NEVER for d, free in pairs]
    ways, free, lengths = [*doorways, *inlets], [*is_open, *[True] * len(inlets)], [*lengths, *[0.0] * len(inlets)]
    for _ in doorways:  # each round finds at least one more shortest path
        for i, d in enumerate(doorways):
            for j, other in enumerate(ways):
                if i != j and free[i] and free[j] and _beside(d) & _beside(other):
                    gap = [max(d.low[k] - other.high[k], other.low[k] - d.high[k], 0.0) for k in range(2)]
                    lengths[i] = min(lengths[i], lengths[j] + (gap[0] ** 2 + gap[1] ** 2) ** 0.5)
    return lengths[: len(doorways)]


@torch.inference_mode()  # for one environment, autograd's part of every operation is a sixth of its time
def through_open(paths: FlowPaths | FloodState, there: Tensor, is_open: Tensor) -> Tensor:
    """Path length of the water to each doorway [m], [E, D], through those that are open.

    `there` and `is_open`, [E, C], are doorways and doors; sources, after them, keep theirs.
    """
    box, part, differing = paths.doorway, paths.doorway_part[..., 0], paths.doorway_part[..., 1]
    more = max(0, box.shape[1] - there.shape[1])
    there, is_open = (torch.nn.functional.pad(of, (0, more))[:, : box.shape[1]] for of in (there, is_open))
    second = ~there & (paths.doorway_distance < NEVER)
    flow = paths.flow[:, None]
    straight = paths.origin_length[:, None] + (flow * torch.where(flow > 0, box[..., :2], box[..., 2:])).sum(-1)
    bits, source = paths.source_part[:, :1], paths.source_part[:, 1:]
    along = ((part ^ source) & bits & ~differing) == 0  # a part beside it lies along the source wall
    length = torch.where(second, paths.doorway_distance, torch.where(along & is_open, straight, NEVER))
    free = second | is_open
    gap = (box[:, :, None, :2] - box[:, None, :, 2:]).clamp(min=0.0)
    gap = torch.maximum(gap, gap.transpose(1, 2)).norm(dim=-1)  # [E, D, D]
    both = ((part[:, :, None] ^ part[:, None]) & ~differing[:, :, None] & ~differing[:, None]) == 0
    step = torch.where(both & free[:, :, None] & free[:, None], gap, NEVER)
    for _ in range(box.shape[1]):  # each round finds at least one more shortest path
        length = torch.minimum(length, (length[:, None] + step).amin(-1))
    return length


def hold_back(state: FloodState, world: World, rise: Tensor) -> bool:
    """Let the water behind flood boards stay as high as it is while that at the sources rises by `rise` [m], [E].

    A source in which a board stands that is as high as the water outdoors moves away, along the path of the water, by
    as much as the surface falls as far as the level has risen. Returns whether any board stands.
    """
    if world.equipment is None or none_set(world.equipment.placed):
        return False
    plan = world.openings.plan
    top = plan.sill + world.equipment.boards(world.extent[..., 2], world.openings.count)
    held = plan.inlet & (top > plan.sill) & (top >= state.level[:, None])  # [E, O]
    first = world.openings.ways[0].sum(1, keepdim=True)  # sources come after the doorways, in the order of O
    number = torch.where(plan.inlet, first + plan.inlet.cumsum(1) - 1, 0)
    away = torch.where(held, (rise / state.surface_slope)[:, None], 0.0)
    state.doorway_distance.scatter_add_(1, number, away)
    return True


def path_lengths(
    paths: FlowPaths | FloodState, place: Tensor, launches: Launches | None = None
) -> tuple[Tensor, Tensor]:
    """Path length [m] of the water to `place` [m], [E, P, 3], and direction of its flow there: [E, P] and [E, P, 2].

    `paths` has the fields of FlowPaths. The length is NEVER where water cannot get.
    """
    place = of_environments(place, len(paths.flow))
    length, direction = place.new_empty(place.shape[:2]), place.new_empty(*place.shape[:2], 2)
    launches = launches or Launches()
    launches.run(
        reach.path_lengths, tuple(length.shape), launches.struct(reach.PathArrays, paths), place, length, direction
    )
    return length, direction
