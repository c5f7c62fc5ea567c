"""Fixtures of the tests of skills: a room of `tests.worlds.skill_room` for each robot."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from hazard_ms.spec.registry import ROBOTS
from tests.worlds.arena import Arena
from tests.worlds.skill_room import BOXES


@pytest.fixture(scope="module", params=ROBOTS)
def arena(request: pytest.FixtureRequest) -> Iterator[Arena]:
    made = Arena(BOXES, robot=request.param)
    yield made
    made.close()


@pytest.fixture
def fresh(arena: Arena) -> Arena:
    arena.restart()
    return arena
