"""Scenes in which other things than targets lie elsewhere, or the robot starts elsewhere."""

from __future__ import annotations

import math

import numpy as np
import pytest

from hazard_ms.scenes.check import check
from hazard_ms.scenes.rearranged import MOVES, STEPS, TURNS, rearranged
from hazard_ms.scenes.splits import scene
from hazard_ms.spec import SceneSpec
from hazard_ms.spec.perturbation import LEAST_SHARE, Perturbation

NAMES = ("kitchen_a/00", "living_room_a/07", "kitchen_b/03", "flat_a/02", "house_test_1/05")
OBJECTS = [Perturbation(objects=level) for level in range(4)]
STARTS = [Perturbation(start=level) for level in range(4)]


def steps(before: SceneSpec, after: SceneSpec) -> np.ndarray:
    """How far each body is from where it was [m], [N]."""
    return np.array([math.dist(a.position, b.position) for a, b in zip(before.bodies, after.bodies, strict=True)])


@pytest.mark.parametrize("name", NAMES)
def test_things_that_are_no_targets_lie_elsewhere_and_nothing_else_is_changed(name: str) -> None:
    spec = scene(name)
    for level in (1, 2, 3):
        made = rearranged(spec, 5, OBJECTS[level])
        assert check(made) == []  # nothing is inside another, all targets can be reached
        assert made.targets == spec.targets
        far = steps(spec, made)
        moved = far[far > 0.0]
        assert len(moved) >= 5
        assert (moved >= LEAST_SHARE * MOVES[level] - 1e-3).all() and (moved <= MOVES[level] + 1e-3).all()
        for a, b in zip(spec.bodies, made.bodies, strict=True):
            assert (a.name, a.asset, a.scale, a.position[2], a.mass) == (
                b.name,
                b.asset,
                b.scale,
                b.position[2],
                b.mass,
            )
            assert a == b or a.position[2] > 0.1  # what is on the floor stays, so that ways stay free
        assert (made.fixtures, made.room, made.fires, made.agent_start) == (
            spec.fixtures,
            spec.room,
            spec.fires,
            spec.agent_start,
        )


@pytest.mark.parametrize("name", (*NAMES, "street/04", "parking_gale/11"))
def test_the_robot_starts_elsewhere_on_free_floor(name: str) -> None:
    spec = scene(name)
    found = 0
    for seed in range(6):
        for level in (1, 2, 3):
            made = rearranged(spec, seed, STARTS[level])
            assert check(made) == check(spec)  # it fits there, and gets to every target
            assert made.bodies == spec.bodies
            step = math.dist(made.agent_start.position, spec.agent_start.position)
            turn = abs(made.agent_start.heading - spec.agent_start.heading)
            assert step == 0.0 or LEAST_SHARE * STEPS[level] - 1e-3 <= step <= STEPS[level] + 1e-3
            assert LEAST_SHARE * TURNS[level] - 1e-3 <= turn <= TURNS[level] + 1e-3
            assert all(
                math.dist(made.agent_start.position, f) >= min(1.0, math.dist(spec.agent_start.position, f)) - 1e-6
                for f in spec.fires
            )
            found += step > 0.0
    assert found >= 12  # of 18


def test_the_seed_alone_decides() -> None:
    spec, both = scene("kitchen_a/03"), Perturbation(objects=2, start=2)
    assert rearranged(spec, 4, both) == rearranged(spec, 4, both)
    assert rearranged(spec, 4, both).bodies != rearranged(spec, 5, both).bodies
    assert rearranged(spec, 4, both).agent_start != rearranged(spec, 5, both).agent_start
    assert rearranged(spec, 4, both).bodies == rearranged(spec, 4, OBJECTS[2]).bodies  # kinds do not mix


def test_level_0_is_the_same_scene() -> None:
    spec = scene("kitchen_a/03")
    assert rearranged(spec, 4, Perturbation()) is spec
