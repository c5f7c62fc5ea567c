"""Paths in the original's narrow rooms: what a robot can get at, it finds a path to on its map of 0.1 m."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from hazard_ms.scenes.assets.index import asset
from hazard_ms.scenes.boxes import box_of
from hazard_ms.scenes.floor import OVERHEAD_HEIGHT, boxes_of
from hazard_ms.scenes.original.read import read
from hazard_ms.scenes.reach import reachable
from hazard_ms.sensing.semantic_map import MAP_CELL
from hazard_ms.skills.motor.navigation import AT_MOST, Ways
from hazard_ms.skills.motor.walking import ARRIVED
from hazard_ms.spec import Build, SceneSpec
from hazard_ms.spec.registry import ROBOTS, load
from hazard_ms.spec.robot import GRASP_REACH

ORIGINAL = Path(__file__).parents[3] / "shared" / "hazard_original" / "indoor"
EVERY = 8  # scenes of one that is looked at
BORDER = 10  # cells of wall around a room
PIECES = 3  # in each direction, at which a cell is looked for furniture

pytestmark = pytest.mark.skipif(not ORIGINAL.exists(), reason="the original benchmark's scenes are not here")


def seen(spec: SceneSpec, radius: float) -> tuple[np.ndarray, np.ndarray]:
    """The map of someone who has seen the whole room: heights [m], [Y, X], and the south-west corner [m]."""
    nx, ny = (int(np.ceil(size / MAP_CELL)) + 2 * BORDER for size in spec.room.size)
    x, y = (((np.arange(n * PIECES) + 0.5) / PIECES - BORDER) * MAP_CELL for n in (nx, ny))
    outside = ((x < 0) | (x > spec.room.size[0]))[None] | ((y < 0) | (y > spec.room.size[1]))[:, None]
    height = np.where(outside, 2.0, 0.0)
    for box in (b for boxes in boxes_of(spec) for b in boxes if b.low < OVERHEAD_HEIGHT):
        height = np.where(box.distance(x[None], y[:, None]) == 0.0, np.maximum(height, box.high), height)
    start = spec.agent_start.position
    height[np.hypot(x[None] - start[0], y[:, None] - start[1]) < radius] = 0.0
    return height.reshape(ny, PIECES, nx, PIECES).max((1, 3)), np.full(2, -BORDER * MAP_CELL)


def without_path(spec: SceneSpec, build: Build) -> tuple[int, int]:
    """The number of targets that the robot can get at, and of those among them to which it finds no path."""
    height, origin = seen(spec, build.radius)
    boxes = {t.name: box_of(t, asset(t.asset).extent) for t in spec.targets}
    goals = [(b.x, b.y) for b in boxes.values()]
    start = spec.agent_start.position
    ways = Ways(height, np.ones(height.shape, bool), MAP_CELL, origin, start, goals, build.radius)
    found = reachable(spec, build)
    missed = 0
    for box in (boxes[name] for name in found):
        edge = float(np.hypot(box.half_x, box.half_y))
        far = max(ARRIVED, build.span((box.low + box.high) / 2)[1]) + GRASP_REACH + edge
        path = ways.path((box.x, box.y), ARRIVED + edge, min(ARRIVED + edge + AT_MOST, far))
        missed += path is None or path.short > far
    return len(found), missed


@pytest.mark.parametrize("robot", ROBOTS)
def test_there_are_paths_to_the_targets_that_a_robot_can_get_at(robot: str) -> None:
    build: Build = load(ROBOTS[robot].robot).build
    specs = [read(folder).spec for folder in sorted(ORIGINAL.iterdir())[::EVERY]]
    found, missed = np.sum([without_path(spec, build) for spec in specs], axis=0)
    print(f"{robot}: no path to {missed} of {found} targets that it can get at, in {len(specs)} scenes")
    assert found > 50 and missed <= 0.05 * found
