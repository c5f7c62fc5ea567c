"""Things that wind or water carries: the hand meets them where they will be, or gives them up soon."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
import sapien

from hazard_ms.skills import failures
from hazard_ms.skills.motor.drift import Drift
from hazard_ms.skills.motor.grasping import pick_up
from hazard_ms.spec.registry import ROBOTS
from tests.worlds.arena import Arena, Box

SPEED = 0.02  # a little faster than a robot drives [m per frame]: a hand that goes where it was comes too late
SLOW = 0.006  # a third of what a robot drives: it leaves the arm's reach, and a base that drives on catches it up
FAST = 0.03  # twice as fast as a robot [m per frame]
FAILED_FRAMES = 30  # most that giving it up may cost
START = np.array([0.62, -0.35, 0.04])  # middle of the thing at first [m]


def carried(arena: Arena, name: str, start: np.ndarray, step: np.ndarray) -> Callable[[object], None]:
    """A step of the arena in which the thing moves on by `step` [m], [3], until it is held."""
    body, once, at = arena.base.actors[name], type(arena).step, start.copy()

    def move(action: object) -> None:
        once(arena, action)  # type: ignore[arg-type]
        if arena.stage.held < 0:
            at[:] += step
            body.set_pose(sapien.Pose(at.tolist()))
            body.set_linear_velocity([0, 0, 0])
            arena.world.position[0, arena.index(name)] = arena.world.position.new_tensor(at)

    return move


def try_to_pick(
    arena: Arena, step: tuple[float, float, float], base: tuple[float, float] = (0.0, 0.0), ahead: float = 0.0
) -> tuple[bool, str, int]:
    """Pick the bowl up, which moves on by `step` [m] in each frame, with the base at `base` [m] at first.

    The bowl begins `ahead` [m] of START.
    """
    arena.restart(*base)
    start = START + [ahead, 0.0, 0.0]
    index = arena.index("bowl")
    arena.base.actors["bowl"].set_pose(sapien.Pose(start.tolist()))
    arena.world.position[0, index] = arena.world.position.new_tensor(start)
    arena.look()
    arena.step = carried(arena, "bowl", start, np.array(step))  # type: ignore[method-assign]
    try:
        result = arena.run(pick_up(arena.stage, index))
    finally:
        del arena.step
    return result.ok, result.reason, result.frames


def test_a_thing_that_moves_is_met_where_it_will_be(arena: Arena) -> None:
    assert try_to_pick(arena, (0.0, SPEED, 0.0))[0]


@pytest.mark.parametrize("robot", ROBOTS)
def test_a_thing_that_drifts_out_of_reach_behind_an_obstacle_is_followed(robot: str) -> None:
    """The arm reaches over the obstacle at first; then the base has to go round it."""
    obstacle = Box("obstacle", (0.62, -0.35, 0.12), (0.08, 0.5, 0.24), target=False)
    arena = Arena((obstacle, Box("bowl", tuple(START.tolist()), (0.16, 0.16, 0.08), 0.4)), robot=robot)
    reach = arena.agent.build.span(float(START[2]))[1]
    start = (float(START[0]) + 0.2 - reach, float(START[1]))
    ok, _, frames = try_to_pick(arena, (SLOW, 0.0, 0.0), start, 0.2)
    arena.close()
    assert ok and frames < 250


def test_a_thing_that_is_faster_than_the_robot_is_given_up_soon(arena: Arena) -> None:
    ok, reason, frames = try_to_pick(arena, (FAST, 0.0, 0.0))
    assert not ok and reason == failures.UNREACHABLE and frames <= FAILED_FRAMES


def test_nobody_drives_to_where_a_thing_was_that_is_faster(arena: Arena) -> None:
    """It lies a metre beyond reach: to drive there takes 62 frames, to see it move away 14."""
    ok, reason, frames = try_to_pick(arena, (0.0, FAST, 0.0), (-1.3, -0.35))
    assert not ok and reason == failures.UNREACHABLE and frames <= 45


def test_movement_is_measured_over_the_floor_and_rest_is_none(arena: Arena) -> None:
    arena.restart()
    index = arena.index("bowl")
    drift = Drift(arena.stage, index)
    assert not drift.ahead(10.0).any()  # nothing is known of it yet
    for _ in range(3):
        arena.world.position[0, index] += arena.world.position.new_tensor([0.01, -0.02, 0.03])
        drift.note()
    assert drift.ahead(10.0) == pytest.approx([0.1, -0.2, 0.0], abs=1e-5)
    arena.world.position[0, index] += arena.world.position.new_tensor([0.5, 0.0, 0.0])
    drift.note(50)  # the mean of all frames, of those that were not looked at, too
    assert drift.ahead(10.0) == pytest.approx([10.0 * 0.53 / 53, -10.0 * 0.06 / 53, 0.0], abs=1e-5)
    for _ in range(8):
        drift.note()
    assert not drift.ahead(10.0).any()
