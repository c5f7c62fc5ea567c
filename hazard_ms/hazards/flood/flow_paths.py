"""Paths of water from the wall that it comes from to any place in a room (torch; per place: reach.py, Warp).

Partitions run from one side of a room to the other, so its parts are rectangles in which water goes straight. Into
parts along the source wall it comes from the whole wall; into the others through doorways, each reached by the shortest
path. The depth decreases along the path, so a part behind a partition fills from its doorway, and the level is the same
on both sides of it (but for the thickness of the partition, and at the outer edge of a doorway that water passes on its
path elsewhere). Nothing flows through closed walls.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, NamedTuple

from torch import Tensor

from hazard_ms.hazards.flood import reach
from hazard_ms.hazards.flood.flood_state import FloodState
from hazard_ms.hazards.flood.reach import NEVER
from hazard_ms.kernels.launch import Launches, of_environments
from hazard_ms.spec import Room, SceneSpec, Vec2

# Direction in which water flows in from each side of a room
SIDES: dict[str, Vec2] = {"south": (0.0, 1.0), "east": (-1.0, 0.0), "north": (0.0, -1.0), "west": (1.0, 0.0)}


@dataclass(frozen=True)
class Doorway:
    """The inside of a doorway: a rectangle on the floor."""

    low: Vec2  # [m]
    high: Vec2  # [m]
    partition: int  # number of the partition it is in
    part: int  # number of one of the two parts that it joins; the other differs in the bit of the partition


class FlowPaths(NamedTuple):
    """The parts and doorways of E rooms with W partitions and D doorways.

    The number of a part has one bit per partition: 1 on the side of larger x or y.
    """

    flow: Tensor  # unit vector in which water leaves the source wall, [E, 2]
    origin_length: Tensor  # path length at the origin of the room, were there no partitions [m], [E]
    partition: Tensor  # axis that each partition crosses (0 x, 1 y), and where [m], [E, W, 2]
    source_part: Tensor  # bits that the parts along the source wall share: which, and their values, [E, 2]
    doorway: Tensor  # low x, y and high x, y of doorways [m], [E, D, 4]
    doorway_distance: Tensor  # path length from the source wall to the doorway [m], [E, D]
    doorway_part: Tensor  # number of a part beside the doorway, and the bit in which the other differs, [E, D, 2]


def sizes(specs: tuple[SceneSpec, ...]) -> dict[str, int]:
    """The largest numbers of partitions, W, and of doorways, D."""
    return {
        "W": max(len(s.room.partitions) for s in specs),
        "D": max(sum(o.kind == "doorway" for o in s.room.openings) for s in specs),
    }


def paths_of(spec: SceneSpec, partitions: int, doorways: int) -> dict[str, Any]:
    """The entries of FlowPaths for one scene, padded to so many. Raises ValueError for an unknown side."""
    if spec.flood_side not in SIDES:
        raise ValueError(f"flood_side of {spec.name} must be one of {', '.join(SIDES)}, got {spec.flood_side!r}")
    room, flow = spec.room, SIDES[spec.flood_side]
    across = [1 if p.axis == "x" else 0 for p in room.partitions]
    origin_length = max(-flow[0] * room.size[0], -flow[1] * room.size[1], 0.0)
    bits = sum(1 << k for k, axis in enumerate(across) if flow[axis])
    # from the east and the north, water meets the sides of larger x and y first
    source_part = (bits, bits if sum(flow) < 0 else 0)
    found = [_doorway(room, o.wall, o.centre, o.width) for o in room.openings if o.kind == "doorway"]
    distances = _doorway_distances(found, flow, origin_length, source_part)
    spare = doorways - len(found)
    return {
        "flow": list(flow),
        "origin_length": origin_length,
        "partition": [[float(axis), p.at] for axis, p in zip(across, room.partitions, strict=True)]
        + [[0.0, NEVER]] * (partitions - len(across)),
        "source_part": list(source_part),
        "doorway": [[*d.low, *d.high] for d in found] + [[0.0] * 4] * spare,
        "doorway_distance": distances + [NEVER] * spare,
        "doorway_part": [[d.part, 1 << d.partition] for d in found] + [[0, 0]] * spare,
    }


def _doorway(room: Room, wall: str, centre: float, width: float) -> Doorway:
    number = next(k for k, p in enumerate(room.partitions) if p.name == wall)
    p = room.partitions[number]
    along, across = (centre - width / 2, centre + width / 2), (p.at - p.thickness / 2, p.at + p.thickness / 2)
    (x0, x1), (y0, y1) = (along, across) if p.axis == "x" else (across, along)
    middle = ((x0 + x1) / 2, (y0 + y1) / 2)
    part = sum(
        (not k == number and middle[0 if q.axis == "y" else 1] > q.at) << k for k, q in enumerate(room.partitions)
    )
    return Doorway((x0, y0), (x1, y1), number, part)


def _beside(doorway: Doorway) -> set[int]:
    return {doorway.part, doorway.part ^ (1 << doorway.partition)}


def _doorway_distances(
    doorways: list[Doorway], flow: Vec2, origin_length: float, source_part: tuple[int, int]
) -> list[float]:
    """Length of the shortest path from the source wall to each doorway [m]: straight, or from doorway to doorway."""
    lengths = []
    for d in doorways:
        straight = origin_length + sum(f * (d.low[k] if f > 0 else d.high[k]) for k, f in enumerate(flow))
        lengths.append(straight if any(part & source_part[0] == source_part[1] for part in _beside(d)) else NEVER)
    for _ in doorways:  # each round finds at least one more shortest path
        for i, d in enumerate(doorways):
            for j, other in enumerate(doorways):
                if i != j and _beside(d) & _beside(other):
                    gap = [max(d.low[k] - other.high[k], other.low[k] - d.high[k], 0.0) for k in range(2)]
                    lengths[i] = min(lengths[i], lengths[j] + (gap[0] ** 2 + gap[1] ** 2) ** 0.5)
    return lengths


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
