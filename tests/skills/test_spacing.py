"""Arms of a team keep off the other robots' bodies: planned round them, halted before them, given up after a while."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
import pytest
import torch

from hazard_ms.skills import spacing
from hazard_ms.skills.context import GRAZE, Skill, Stage
from hazard_ms.skills.decision import EXPLORE, PICK_UP, Action
from hazard_ms.skills.doing import Doing
from hazard_ms.skills.motor.arm import posture_for
from hazard_ms.skills.motor.motion import turn_to
from hazard_ms.skills.motor.surface import Leg, Place, Surface
from hazard_ms.skills.team import PATIENCE, TeamSkills

LOOK = Action(EXPLORE)


@pytest.fixture(scope="module")
def pair() -> Iterator[TeamSkills]:
    made = TeamSkills.make("HazardFire-v1", ("fetch", "fetch"), effects="off")
    yield made
    made.close()


def facing(pair: TeamSkills) -> Stage:
    """The stage of robot 0, which has turned to robot 1."""
    pair.reset(seed=1)
    stage, other = pair.knowledge["fetch-0"].stage, pair.base.robots["fetch-1"]
    for move in turn_to(stage, other.base()[:2]):
        pair.base.advance({"fetch-0": move, "fetch-1": pair.knowledge["fetch-1"].stage.act()})
    return stage


def through(stage: Stage, pair: TeamSkills) -> np.ndarray:
    """Joints [rad] with the hand inside of robot 1's base, which holds 0.29 m around its middle."""
    (x, y, _), (ox, oy, _) = stage.robot.base(), pair.base.robots["fetch-1"].base()
    share = 1.0 - 0.2 / math.hypot(ox - x, oy - y)
    return posture_for(stage, np.array([x + share * (ox - x), y + share * (oy - y), 0.45])).arm


def reach(stage: Stage, arm: np.ndarray) -> Skill:
    """Bring the arm to `arm` [rad] as fast as it goes, for ever."""
    while True:
        yield stage.act(arm=arm)


@pytest.mark.parametrize("looks_out", [True, False])
def test_an_arm_halts_before_another_robot_and_is_given_up(
    pair: TeamSkills, monkeypatch: pytest.MonkeyPatch, looks_out: bool
) -> None:
    """Who does not look out hits it: that shows that the arm would get there."""
    stage = facing(pair)
    if not looks_out:
        monkeypatch.setattr("hazard_ms.skills.team.would_touch", lambda stage: False)
    action = Action(PICK_UP, pair.decision("fetch-0").targets[0].name)
    pair._running["fetch-0"] = doing = Doing(action, reach(stage, through(stage, pair)), pair.frame)
    other = pair.base.robots["fetch-1"]
    least, began = math.inf, pair.frame
    for _ in range(12):  # robot 1 looks around on the spot meanwhile
        decisions, _, _, info = pair.step({"fetch-1": LOOK})
        least = min(least, spacing.gap(spacing.along(stage.robot.arm_places(stage.robot.arm())), other))
        if "fetch-0" in decisions or pair.collisions:
            break
    if looks_out:
        result = info["results"]["fetch-0"]
        assert pair.collisions == 0 and 0.06 < least
        assert (result.ok, result.reason) == (False, "blocked") and doing.waited == PATIENCE + 1
        assert PATIENCE < result.frames < pair.frame - began + PATIENCE
    else:
        assert pair.collisions > 0 or least < 0.06


def test_it_goes_on_as_it_was_when_the_other_has_gone(pair: TeamSkills) -> None:
    """Robot 1 drives away: the arm gets to where it was going."""
    stage = facing(pair)
    arm = through(stage, pair)
    pair._running["fetch-0"] = doing = Doing(LOOK, reach(stage, arm), pair.frame)
    away = pair.knowledge["fetch-1"].stage
    held = 0
    for frame in range(150):
        waits = pair._waits("fetch-0")
        move = pair._move("fetch-0", waits)
        back = away.act(-0.03 if frame > 30 else 0.0)
        pair.base.advance({"fetch-0": move, "fetch-1": back})
        pair._go_on(doing, waits)
        held += waits
    assert 0 < held < PATIENCE and pair.collisions == 0
    assert stage.arm_gap(arm) < 0.05


def test_routes_of_the_arm_count_the_other_robot_as_furniture(pair: TeamSkills) -> None:
    """The same straight route, with and without the other robot of the team."""
    stage = facing(pair)
    x, y, _ = stage.robot.base()
    legs = [Leg(stage.robot.arm(), 0.0), Leg(through(stage, pair), 0.0)]
    place = Place(np.array([x, y, 0.0]), 0.0, 0.0, 0.0)
    others, stage.others = stage.others, ()
    alone = Surface(stage, place).hits(legs)
    stage.others = others
    assert Surface(stage, place).hits(legs) > alone


def test_the_gap_is_that_to_the_base_or_to_the_arm(pair: TeamSkills) -> None:
    """By hand: 1 m beside the middle of a base of 0.29 m; 0.1 m above the hand; and high above the base alone."""
    pair.reset(seed=1)
    other = pair.base.robots["fetch-1"]
    x, y, _ = other.base()
    far = np.array([[x + 3.0, y, 0.2]])
    assert spacing.gap(far, other) == pytest.approx(3.0 - 0.29, abs=0.01)
    hand = other.arm_places(other.arm())[-1]
    assert spacing.gap(np.array([hand + (0.0, 0.0, 0.9)]), other) < 0.9 + 1e-6
    above = np.array([[x, y, 3.0]])
    highest = spacing.along(other.arm_places(other.arm()))
    assert spacing.gap(above, other) == pytest.approx(float(np.linalg.norm(highest - above, axis=1).min()))
    assert spacing.gap(np.array([[x, y, 0.2]]), other) == pytest.approx(-0.29, abs=0.01)


@pytest.mark.parametrize("graze", [GRAZE, -1.0])
def test_a_base_does_not_slide_along_another_robot(
    pair: TeamSkills, monkeypatch: pytest.MonkeyPatch, graze: float
) -> None:
    """Robot 1 starts 0.58 m beside robot 0 with its course 25 degrees towards it, and would slide along it."""
    monkeypatch.setattr("hazard_ms.skills.context.GRAZE", graze)
    pair.reset(seed=1)
    stage, other = pair.knowledge["fetch-1"].stage, pair.knowledge["fetch-0"].stage
    x, y, heading = other.robot.base()
    aside = np.array([-math.sin(heading), math.cos(heading)])
    start = torch.tensor(np.array([[x, y]]) + 0.58 * aside, dtype=torch.float32)
    stage.robot.place(torch.tensor([0]), start, torch.tensor([heading - math.radians(25.0)]))
    for _ in range(60):
        pair.base.advance({"fetch-0": other.act(), "fetch-1": stage.act(0.04)})
    moved = np.hypot(*(np.array(stage.robot.base()[:2]) - start[0].numpy()))
    assert (pair.collisions > 0) == (graze < 0.0)
    if graze > 0.0:
        assert moved < 0.2
        stage.act(-0.02)
        assert stage.last_move[0] == -0.02  # it may back away


def test_points_lie_on_the_links() -> None:
    joints = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 2.0, 0.0]])
    points = spacing.along(joints)
    links = points.reshape(-1, 2, 3)
    assert links[[0, -1]] == pytest.approx(np.stack([joints[:-1], joints[1:]]))
    assert links[2] == pytest.approx(np.array([[0.5, 0.0, 0.0], [1.0, 1.0, 0.0]]))
