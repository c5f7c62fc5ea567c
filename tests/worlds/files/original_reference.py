"""Where a log of the original benchmark puts its objects, computed for tests in another way than the package does.

4 x 4 matrices.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np


def rotation(x: float, y: float, z: float) -> np.ndarray:
    """Unity's rotation by Euler angles [degrees], as a 4 x 4 matrix on columns of the left-handed frame."""
    (cx, sx), (cy, sy), (cz, sz) = ((np.cos(a), np.sin(a)) for a in np.radians([x, y, z]))
    about_x = np.array([[1, 0, 0], [0, cx, -sx], [0, sx, cx]])
    about_y = np.array([[cy, 0, sy], [0, 1, 0], [-sy, 0, cy]])
    about_z = np.array([[cz, -sz, 0], [sz, cz, 0], [0, 0, 1]])
    made = np.eye(4)
    made[:3, :3] = about_y @ about_x @ about_z
    return made


def commands(log: Path) -> list[dict[str, Any]]:
    """All commands of a log with one list on each line."""
    return [c for line in log.read_text().splitlines() if line.strip() for c in json.loads(line)]


def poses(log: Path) -> dict[int, np.ndarray]:
    """World matrices of all objects at the end of a log, left-handed, y up."""
    world: dict[int, np.ndarray] = {}
    parent: dict[int, int] = {}

    def move(i: int, to: np.ndarray) -> None:
        by = to @ np.linalg.inv(world[i])
        world[i] = to
        for child in [c for c, p in parent.items() if p == i]:
            move(child, by @ world[child])

    def turned(i: int, turn: np.ndarray) -> np.ndarray:
        made = turn.copy()
        made[:3, 3] = world[i][:3, 3]
        return made

    for c in commands(log):
        kind, i = c["$type"], c.get("id")
        if kind == "add_object":
            angles = c.get("rotation", {"x": 0, "y": 0, "z": 0})
            world[i] = rotation(**angles)
            world[i][:3, 3] = [c["position"][k] for k in "xyz"]
        elif kind == "rotate_object_to_euler_angles":
            move(i, turned(i, rotation(**c["euler_angles"])))
        elif kind == "object_look_at_position":
            x, _, z = np.array([c["position"][k] for k in "xyz"]) - world[i][:3, 3]  # level in all files
            move(i, turned(i, rotation(0.0, np.degrees(np.arctan2(x, z)), 0.0)))
        elif kind == "rotate_object_by":
            assert c["axis"] == "yaw"
            about = rotation(0.0, c["angle"], 0.0)
            about[:3, 3] = world[i][:3, 3] - about[:3, :3] @ world[i][:3, 3]
            move(i, about @ world[i])
        elif kind == "parent_object_to_object":
            parent[i] = c["parent_id"]
        elif kind == "unparent_object":
            parent.pop(i, None)
    return world
