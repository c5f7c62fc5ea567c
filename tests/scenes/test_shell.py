"""The shell of a room is closed, and keeps to its openings."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from hazard_ms.scenes.shell import shell
from hazard_ms.scenes.splits import scene
from hazard_ms.spec import Opening, Room


def test_the_shell_closes_the_room() -> None:
    """Rays from inside meet a colliding box in every direction, doors and windows included."""
    room = scene("kitchen_a/00").room
    solid = [b for b in shell(room) if b.collides]
    low = np.array([np.subtract(b.centre, np.divide(b.size, 2)) for b in solid])
    high = np.array([np.add(b.centre, np.divide(b.size, 2)) for b in solid])
    rng = np.random.default_rng(0)
    eye = np.array([*np.divide(room.size, 2), 1.2])
    assert not ((low < eye) & (eye < high)).all(-1).any()
    for _ in range(2000):
        ray = rng.normal(size=3)
        t = np.stack([(low - eye) / ray, (high - eye) / ray])
        near, far = t.min(0).max(-1), t.max(0).min(-1)
        assert ((near <= far) & (far > 0)).any(), f"a ray along {ray} leaves the room"


def test_the_shell_keeps_to_its_openings() -> None:
    room = Room((5.0, 4.0), openings=(Opening("window", "east", 2.0, 1.0, 1.2, 0.9),))
    walls = [b for b in shell(room) if b.kind == "wall" and "east" in b.name]
    area = sum(b.size[1] * b.size[2] for b in walls)
    assert area == pytest.approx(4.0 * 2.6 - 1.0 * 1.2)
    for bad, message in (
        (Opening("door", "south", 0.2, 0.9, 2.0), "must fit into the south wall"),
        (Opening("door", "south", 2, 1, 3), "must fit into"),
    ):
        with pytest.raises(ValueError, match=message):
            shell(dataclasses.replace(room, openings=(bad,)))
    with pytest.raises(ValueError, match="material must be one of [0-9]+ names such as .*, got 'lava'"):
        shell(dataclasses.replace(room, floor="lava"))
