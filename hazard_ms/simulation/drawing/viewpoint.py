"""The third person: from where a camera overlooks a whole scene, or follows the robot where that is too large.

Homes are seen from high above their longer side, as a doll's house is, with the ceiling taken off
(`hazard_ms.effects.cutaway`).
"""

from __future__ import annotations

import itertools

import numpy as np
import sapien
from mani_skill.utils.sapien_utils import look_at

from hazard_ms.scenes.assets.index import asset
from hazard_ms.scenes.boxes import Box, box_of
from hazard_ms.spec import SceneSpec

# a box higher than TALL hides from a camera what lies behind it and up to BESIDE to its sides [m] [ours]
TALL, BESIDE = 1.3, 0.4
HIDING = 12.0  # one box in the view weighs as much as being this much nearer to the agent [m] [ours]
EYES_OUTDOORS = 6.0  # height of the camera that watches a scene in the open [m] [ours]
HOUSE_ANGLE, HOUSE_PITCH = 0.6, 1.1  # of the camera above a home: vertical angle, and downwards [rad] [ours]
HOUSE_HIGH, HOUSE_MARGIN = 2.1, 0.03  # height that it must see [m], and what stays free at each edge of it [-] [ours]
ROUND = (3.4, 2.4)  # half sizes of the part of a home around the robot that is followed, along x and y [m] [ours]
BEHIND, ABOVE = 4.5, 3.2  # of a camera that follows the robot: how far from it, and how high [m] [ours]
NEAR = 3.0  # distance from what it looks at up to which such a camera sees to all sides [m] [ours]


def following_view(whole: sapien.Pose, place: tuple[float, float], reach: float = 0.0) -> sapien.Pose:
    """Pose of a camera that looks at `place` [m] from the side from which the camera at `whole` overlooks the scene.

    It is so far away that it sees up to `reach` [m] around that place.
    """
    ahead, farther = whole.to_transformation_matrix()[:2, 0], max(1.0, reach / NEAR)
    eye = np.append(np.asarray(place) - farther * BEHIND * ahead / np.linalg.norm(ahead), farther * ABOVE)
    return look_at(eye, [*place, 0.6]).sp


def house_view(spec: SceneSpec, aspect: float, place: tuple[float, float] | None = None) -> sapien.Pose:
    """Pose of a camera above a home, with the vertical angle HOUSE_ANGLE, whose picture just holds all of it.

    `aspect`: width of the picture by its height [-]; with a `place` [m] it holds what is ROUND that.
    """
    middle, half = np.array(spec.room.size) / 2, np.array(spec.room.size) / 2
    if place is not None:
        half = np.minimum(half, ROUND if spec.room.size[0] >= spec.room.size[1] else ROUND[::-1])
        middle = np.clip(place, half, 2 * middle - half)
    deep, high, wide = np.array([0.0, 1.0, 0.0]), np.array([0.0, 0.0, 1.0]), np.array([1.0, 0.0, 0.0])
    if spec.room.size[1] > spec.room.size[0]:  # from the east
        deep, wide = np.array([-1.0, 0.0, 0.0]), np.array([0.0, 1.0, 0.0])
    ahead = np.cos(HOUSE_PITCH) * deep - np.sin(HOUSE_PITCH) * high
    up = np.sin(HOUSE_PITCH) * deep + np.cos(HOUSE_PITCH) * high
    signs = np.array(list(itertools.product((-1.0, 1.0), repeat=3)))
    corners = signs * [*half, HOUSE_HIGH / 2]
    tall = np.tan(HOUSE_ANGLE / 2) * (1.0 - 2 * HOUSE_MARGIN)
    # a corner is in the picture if its distance from the axis is at most `tall` of that along the axis; the eye is
    # as near, and as far up in its picture, as the uppermost and the lowest corner allow
    first, last = (corners @ ahead) * tall - corners @ up, (corners @ ahead) * tall + corners @ up
    shift = (first.min() - last.min()) / 2
    far = max(
        -(first.min() + last.min()) / (2 * tall), np.max(np.abs(corners @ wide) / (tall * aspect) - corners @ ahead)
    )
    eye = np.array([*middle, HOUSE_HIGH / 2]) - far * ahead - shift * up
    return look_at(eye, eye + ahead, up).sp


def corner_view(spec: SceneSpec) -> sapien.Pose:
    """Pose of the camera that watches a scene: in an upper corner of the room, or in the open over one of its sides.

    It is far from the agent's start and looks at the middle, past tall things.
    """
    (x, y), z = spec.room.size, EYES_OUTDOORS if spec.room.open_air else spec.room.height
    start = np.array(spec.agent_start.position)
    sides = [(0.15, size / 2, size - 0.15) if spec.room.open_air else (0.15, size - 0.15) for size in (x, y)]
    eyes = [np.array([a, b, z - 0.15]) for a in sides[0] for b in sides[1] if (a, b) != (x / 2, y / 2)]
    target = np.array([x / 2, y / 2, 0.1]) * 0.8 + np.array([*start, 0.1]) * 0.2
    tall = [box for f in spec.fixtures if (box := box_of(f, asset(f.asset).extent)).high > TALL]
    eye = max(eyes, key=lambda e: np.linalg.norm(e[:2] - start) - HIDING * _hidden(e, target, tall))
    return look_at(eye, target).sp


def _hidden(eye: np.ndarray, target: np.ndarray, boxes: list[Box]) -> float:
    """Number of `boxes` that hide the line from `eye` to `target`, each weighted: the nearer to the eye, the more."""
    share = np.linspace(0.0, 0.8, 30)[:, None]
    points = eye + share * (target - eye)
    inside = [(b.distance(points[:, 0], points[:, 1]) < BESIDE) & (points[:, 2] < b.high + BESIDE) for b in boxes]
    return float(sum((i * (1.0 - share[:, 0])).max(initial=0.0) for i in inside))
