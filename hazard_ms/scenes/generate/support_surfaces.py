"""The surfaces of furniture on which things can stand."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from hazard_ms.scenes.assets.rows import Asset
from hazard_ms.scenes.boxes import Box
from hazard_ms.spec import Vec2, Vec3

BOARD_THICKNESS = 0.04  # thickness of a shelf's boards, at most [m] [ours]
MOST_HEADROOM = 1.0  # more headroom than this makes no difference [m]


@dataclass(frozen=True)
class Surface:
    """A rectangle at height z on the thing `owner`, along the axes of the thing's box."""

    owner: str
    box: Box
    middle: Vec2  # in the frame of the box [m]
    half: Vec2  # [m]
    z: float  # [m]
    headroom: float  # [m]

    def point(self, along: float, across: float) -> Vec2:
        """The point (along, across) from the rectangle's middle, in the world [m]."""
        return self.box.world(self.middle[0] + along, self.middle[1] + across)

    def holds(self, box: Box, margin: float) -> bool:
        """Whether the footprint of `box` keeps `margin` [m] from the rectangle's edges."""
        for x, y in box.corners(margin):
            u, v = _local(self.box, x, y)
            if abs(u - self.middle[0]) > self.half[0] or abs(v - self.middle[1]) > self.half[1]:
                return False
        return True


def surfaces_of(owner: str, model: Asset, scale: Vec3, box: Box) -> Iterator[Surface]:
    """The surfaces of the thing `owner`, which has the shape of `model` and occupies `box`."""
    for s in model.supports:
        low = [a * k for a, k in zip(s.min, scale, strict=False)]
        high = [a * k for a, k in zip(s.max, scale, strict=False)]
        above = [o.z for o in model.supports if o.z > s.z + BOARD_THICKNESS and _overlap(s.min, s.max, o.min, o.max)]
        headroom = min(
            [s.clearance * scale[2], MOST_HEADROOM] + [(z - s.z) * scale[2] - BOARD_THICKNESS for z in above]
        )
        middle = ((low[0] + high[0]) / 2, (low[1] + high[1]) / 2)
        half = ((high[0] - low[0]) / 2, (high[1] - low[1]) / 2)
        yield Surface(owner, box, middle, half, box.low + s.z * scale[2], headroom)


def _overlap(min_a: Vec2, max_a: Vec2, min_b: Vec2, max_b: Vec2) -> bool:
    return all(min_a[k] < max_b[k] and min_b[k] < max_a[k] for k in (0, 1))


def _local(box: Box, x: float, y: float) -> Vec2:
    u, v = box.local(x, y)  # type: ignore[arg-type]
    return float(u), float(v)
