"""What is put on a table lies there, in real physics; what has no top within reach is refused."""

from __future__ import annotations

from typing import Any

import pytest

from hazard_ms.skills import failures
from hazard_ms.skills.decision import Action
from hazard_ms.skills.mitigations.shelving import tops
from hazard_ms.spec import Body, Fixture
from hazard_ms.spec.registry import ROBOTS
from tests.worlds.two_rooms import acted, spec, two_rooms

TABLE = Fixture("table_0", "table", "plain_box", (5.0, 2.6, 0.0), scale=(1.0, 0.8, 0.72))
HIGH = Fixture("cupboard_0", "cabinet", "plain_box", (0.4, 3.6, 1.4), scale=(0.4, 0.4, 0.4))
SMALL = Fixture("shelf_0", "shelf", "plain_box", (5.0, 0.4, 0.0), scale=(0.1, 0.1, 0.7))
MUG = Body("bottle_1", "bottle", "plain_box", (2.3, 1.8, 0.0), scale=(0.08, 0.08, 0.2), mass=0.4)


def scene() -> Any:
    return spec(door=None, bodies=(MUG,), fixtures=(TABLE, HIGH, SMALL))


@pytest.mark.parametrize("robot", ROBOTS)
def test_a_thing_is_put_on_a_table(robot: str) -> None:
    with two_rooms(scene(), ("flood",), robot=robot, verbs=("put_on",)) as rooms:
        assert tops(rooms.stage) == ()
        assert acted(rooms, Action("put_on", "table_0")).reason == failures.NOT_HOLDING
        acted(rooms, Action("walk_to", "bottle_1"))
        assert acted(rooms, Action("pick_up", "bottle_1")).ok
        assert tops(rooms.stage) == ("table_0", "shelf_0")
        assert acted(rooms, Action("put_on", "cupboard_0")).reason == failures.NO_TOP
        assert acted(rooms, Action("put_on", "shelf_0")).reason == failures.NO_ROOM
        result = acted(rooms, Action("put_on", "table_0"))
        assert result.ok, result
        x, y, z = rooms.world.position[0, rooms.index("bottle_1")].tolist()
        assert abs(x - 5.0) < 0.5 and abs(y - 2.6) < 0.4 and 0.72 < z < 0.72 + 0.15
        assert rooms.stage.held == -1 and not bool(rooms.world.safe.any())
