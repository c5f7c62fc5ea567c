"""How far water has to go from the wall that it comes from to any place in a room, and which way it flows there.

A room is parted by walls from one side to the other, so its parts are rectangles in which water goes straight. Into parts that lie
along its source wall it comes from all of it; into the others through doorways, each reached by the shortest way. The depth falls
with the way gone, so a part behind a wall fills from its doorway, and the level is the same on both sides of it (but for the
thickness of the wall, and at the outer edge of a doorway that water passes on its way elsewhere). Nothing flows through closed walls.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, NamedTuple

from torch import Tensor

from hazard_ms.kernels import reach
from hazard_ms.kernels.reach import NEVER
from hazard_ms.launching import Launches, of_environments
from hazard_ms.spec import Room, SceneSpec, Vec2

SIDES: dict[str, Vec2] = {"south": (0.0, 1.0), "east": (-1.0, 0.0), "north": (0.0, -1.0), "west": (1.0, 0.0)}  # which way it flows in


@dataclass(frozen=True)
class Gate:
    """The inside of a doorway: a rectangle on the floor."""

    low: Vec2  # [m]
    high: Vec2  # [m]
    wall: int  # the partition it is in, by number
    part: int  # one of the two parts that it joins; the other differs in the bit of the wall


class Ways(NamedTuple):
    """The parts and doorways of E rooms, W partitions, G doorways."""

    flow: Tensor  # direction in which water leaves the source wall, [E, 2]
    start: Tensor  # the way at the origin of the room, were there no partitions [m], [E]
    wall: Tensor  # partitions: across which axis (0 x, 1 y), and where [m], [E, W, 2]
    near: Tensor  # the bits of a part that tell whether it is along the source wall: which, and their values, [E, 2]
    gate: Tensor  # low x, y and high x, y of doorways [m], [E, G, 4]
    gate_way: Tensor  # from the source wall to the doorway [m], [E, G]
    gate_part: Tensor  # the number of a part beside the doorway, and the bit in which the other differs, [E, G, 2]


def sizes(specs: tuple[SceneSpec, ...]) -> dict[str, int]:
    """The largest numbers of partitions, W, and of doorways, G."""
    return {
        "W": max(len(s.room.partitions) for s in specs),
        "G": max(sum(o.kind == "doorway" for o in s.room.openings) for s in specs),
    }


def ways_of(spec: SceneSpec, walls: int, gates: int) -> dict[str, Any]:
    """The entries of Ways for one scene, padded. Raises ValueError for a side that is none."""
    if spec.flood_side not in SIDES:
        raise ValueError(f"flood_side of {spec.name} is {spec.flood_side!r}; allowed: {', '.join(SIDES)}")
    room, flow = spec.room, SIDES[spec.flood_side]
    across = [1 if p.axis == "x" else 0 for p in room.partitions]
    start = max(-flow[0] * room.size[0], -flow[1] * room.size[1], 0.0)
    bits = sum(1 << k for k, axis in enumerate(across) if flow[axis])
    near = (bits, bits if sum(flow) < 0 else 0)  # from the east and the north, water meets the far sides of walls first
    found = [_gate(room, o.wall, o.centre, o.width) for o in room.openings if o.kind == "doorway"]
    ways = _gate_ways(found, flow, start, near)
    spare = gates - len(found)
    return {
        "flow": list(flow),
        "start": start,
        "wall": [[float(axis), p.at] for axis, p in zip(across, room.partitions, strict=True)] + [[0.0, NEVER]] * (walls - len(across)),
        "near": list(near),
        "gate": [[*g.low, *g.high] for g in found] + [[0.0] * 4] * spare,
        "gate_way": ways + [NEVER] * spare,
        "gate_part": [[g.part, 1 << g.wall] for g in found] + [[0, 0]] * spare,
    }


def _gate(room: Room, wall: str, centre: float, width: float) -> Gate:
    number = next(k for k, p in enumerate(room.partitions) if p.name == wall)
    p = room.partitions[number]
    along, across = (centre - width / 2, centre + width / 2), (p.at - p.thickness / 2, p.at + p.thickness / 2)
    (x0, x1), (y0, y1) = (along, across) if p.axis == "x" else (across, along)
    middle = ((x0 + x1) / 2, (y0 + y1) / 2)
    part = sum((not k == number and middle[0 if q.axis == "y" else 1] > q.at) << k for k, q in enumerate(room.partitions))
    return Gate((x0, y0), (x1, y1), number, part)


def _beside(gate: Gate) -> set[int]:
    return {gate.part, gate.part ^ (1 << gate.wall)}


def _gate_ways(gates: list[Gate], flow: Vec2, start: float, near: tuple[int, int]) -> list[float]:
    """The shortest way from the source wall to each doorway [m]: straight, or from doorway to doorway."""
    ways = []
    for g in gates:
        straight = start + sum(f * (g.low[k] if f > 0 else g.high[k]) for k, f in enumerate(flow))
        ways.append(straight if any(part & near[0] == near[1] for part in _beside(g)) else NEVER)
    for _ in gates:  # each round finds at least one more shortest way
        for i, g in enumerate(gates):
            for j, h in enumerate(gates):
                if i != j and _beside(g) & _beside(h):
                    gap = [max(g.low[k] - h.high[k], h.low[k] - g.high[k], 0.0) for k in range(2)]
                    ways[i] = min(ways[i], ways[j] + (gap[0] ** 2 + gap[1] ** 2) ** 0.5)
    return ways


def ways_to(ways: Ways, place: Tensor, launches: Launches | None = None) -> tuple[Tensor, Tensor]:
    """How far water has come at `place` [m], [E, P, 3]: [m], [E, P], NEVER where it cannot; and the flow's direction, [E, P, 2]."""
    place = of_environments(place, len(ways.flow))
    way, toward = place.new_empty(place.shape[:2]), place.new_empty(*place.shape[:2], 2)
    (launches or Launches()).run(reach.ways_to, tuple(way.shape), *ways, place, way, toward)
    return way, toward
