"""The example of a rescue by policies: what they read, what they learn from, and that they play."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from hazard_ms.skills.decision import DROP, PICK_UP, WALK_TO, Action
from hazard_ms.skills.motor.grasping import pick_up
from tests.worlds.arena import Arena
from tests.worlds.registering import loaded
from tests.worlds.skill_room import BOXES

FOLDER = Path(__file__).parents[2] / "examples" / "rescue"
BY_THE_BOWL = (0.8, -0.5, -np.pi / 2)  # x, y [m] and heading [rad]


@pytest.fixture(scope="module")
def learn() -> Iterator[Any]:
    with loaded(FOLDER / "learn.py") as module:
        yield module
    for name in ("policies", "walks", "hands", "teach", "clone_pick_up"):
        del sys.modules[name]


@pytest.fixture(scope="module")
def teach(learn: Any) -> Any:
    return learn.teach


@pytest.fixture(scope="module")
def arena() -> Iterator[Arena]:
    made = Arena(BOXES)
    yield made
    made.close()


class Straight:
    """Turns to the next point of the path, or to the thing, and drives straight there."""

    def say(self, walk: Any) -> tuple[float, float, float]:
        _, bearing = walk.ahead()
        return float(abs(bearing) < 0.3), min(max(bearing / 0.1, -1.0), 1.0), -1.0


def test_a_walk_reads_a_map_that_turns_with_the_robot(arena: Arena, teach: Any) -> None:
    """The table stands 1.1 to 1.9 m ahead of the origin, 1.2 m wide: cells of 0.1 m, those ahead come first."""
    for heading, side in ((0.0, "ahead"), (np.pi / 2, "right"), (-np.pi / 2, "left")):
        arena.restart(0.0, 0.0, heading)
        height, explored, coarse, _ = teach.Walk(arena.stage, arena.index("mug")).maps()
        table = {"ahead": (slice(0, 4), slice(12, 20)), "left": (slice(12, 20), slice(0, 4))}
        table["right"] = (slice(12, 20), slice(28, 32))
        assert (height[table[side]] > 150).all(), side
        assert all((height[part] == 0).all() for other, part in table.items() if other != side)
        assert (explored == 255).all() and (height[14:18, 14:18] == 0).all()
        assert {"ahead": coarse[10:12, 15:17], "left": coarse[15:17, 10:12], "right": coarse[15:17, 20:22]}[
            side
        ].min() > 150


def test_its_numbers_say_where_the_thing_is(arena: Arena, learn: Any, teach: Any) -> None:
    arena.restart(0.8, -0.5, 0.0)
    walk = teach.Walk(arena.stage, arena.index("bowl"))  # 0.7 m to the right
    far, left, cos, sin, bearing, *way = walk.numbers()
    assert far == pytest.approx(0.7, abs=0.01) and bearing == pytest.approx(-np.pi / 2, abs=0.02)
    assert (cos, sin) == pytest.approx((0.0, -1.0), abs=0.02) and 0.0 < left < 0.2
    assert way == pytest.approx([0.7, 0.0, -1.0, -np.pi / 2, 1.0], abs=0.03)  # no path yet: straight to the thing
    mirrored = walk.numbers() * learn.MIRRORED.numpy()
    assert mirrored[[3, 4, 7, 8]].tolist() == (-walk.numbers()[[3, 4, 7, 8]]).tolist()
    assert mirrored[[0, 1, 2, 5, 6, 9]].tolist() == walk.numbers()[[0, 1, 2, 5, 6, 9]].tolist()


def test_a_path_leads_round_the_table_and_its_points_are_left_behind(arena: Arena, teach: Any) -> None:
    arena.restart(1.5, -1.2, np.pi / 2)
    walk = teach.Walk(arena.stage, arena.index("far"))  # beyond the table, at -3.5, 3.0
    walk.plan()
    first, before = walk.points[0], len(walk.points)
    assert before > 1 and walk.numbers()[9] == 0.0
    assert walk.ahead()[0] == pytest.approx(float(np.hypot(*(first - (1.5, -1.2)))), abs=0.02)
    arena.restart(float(first[0]), float(first[1]), 0.0)
    walk.stage = arena.stage
    walk.ahead()
    assert len(walk.points) < before and not any(point is first for point in walk.points)


@pytest.mark.parametrize("name, ok", [("bowl", True), ("walled", False)])
def test_a_walk_ends_where_it_should_or_after_its_frames(arena: Arena, teach: Any, name: str, ok: bool) -> None:
    arena.restart(*(BY_THE_BOWL if ok else (1.0, 1.0, 0.0)))
    result = arena.run(sys.modules["walks"].walked(arena.stage, arena.index(name), Straight()))
    assert result.ok == ok and (ok or result.frames == 100)
    assert not ok or teach.Walk(arena.stage, arena.index(name)).way()[2] < 0.0


def test_after_a_reach_that_failed_a_walk_leads_to_another_side(arena: Arena, teach: Any) -> None:
    walks, index = sys.modules["walks"], arena.index("pen")
    arena.restart(-0.45, 0.0, np.pi)
    result = arena.run(walks.walked(arena.stage, index, Straight(), [(-0.45, 0.0)]))
    x, y, _ = arena.agent.base()
    assert result.ok and result.frames > 10 and np.hypot(x + 0.45, y) > walks.APART - walks.PASSED
    assert 0.4 < np.hypot(x + 1.0, y) < walks.REACH
    arena.restart(-0.45, 0.0, np.pi)
    assert arena.run(walks.walked(arena.stage, index, Straight())).frames == 0  # who has not tried is there already


def test_a_reach_that_comes_no_nearer_is_given_up(arena: Arena, teach: Any) -> None:
    hands = sys.modules["hands"]
    arena.restart(*BY_THE_BOWL)
    policy = type("Idle", (), {"output": lambda self, now: np.array([*now.targets, 0.0, 0.0, -1.0])})()
    result = arena.run(hands.reached(arena.stage, arena.index("bowl"), policy))
    assert not result.ok and hands.PATIENCE <= result.frames <= hands.PATIENCE + 3


def test_hands_read_the_heights_before_the_base(arena: Arena, teach: Any) -> None:
    """The table begins 0.6 m ahead and is 0.74 m high."""
    hands = sys.modules["hands"]
    for heading, seen in ((0.0, True), (np.pi, False)):
        arena.restart(0.5, 0.0, heading)
        read = hands.felt(teach.reaching.PickUp(arena.stage, arena.index("mug")))
        heights = read[38:].reshape(len(hands.ALONG), len(hands.ACROSS))
        assert read.shape == (hands.SEEN,) and (heights[:3] == 0.0).all()
        assert (heights[hands.ALONG > 0.7].min() > 0.7) == seen and heights.max() < 0.9


def noted(teach: Any, arena: Arena, action: Action, swerve: float) -> tuple[Any, list[np.ndarray], Any]:
    """What a teacher notes, what was sent, and how it ended."""
    teacher, sent, step = teach.Teacher(), list[np.ndarray](), arena.step
    arena.step = lambda action: (sent.append(action.copy()), step(action))  # type: ignore[method-assign,assign]
    before, teach.SWERVE = teach.SWERVE, swerve
    try:
        result = arena.run(teacher.skill(arena.stage, action))
    finally:
        teach.SWERVE = before
        del arena.step
    return teacher, sent, result


@pytest.mark.parametrize("swerve", [0.0, 0.7])
def test_labels_of_walks_are_what_the_skill_wants_not_the_noise(arena: Arena, teach: Any, swerve: float) -> None:
    arena.restart(1.2, -2.6, 0.0)
    thing = arena.stage.labeller.names[arena.index("bowl")]
    teacher, sent, result = noted(teach, arena, Action(WALK_TO, thing), swerve)
    labels = np.array([label for _, _, label in teacher.notes.walks])
    went = np.array(sent)[:: teach.EVERY, 11:13]
    assert result.ok and labels[-teach.ENDS :].tolist() == [[0.0, 0.0, 1.0]] * teach.ENDS
    wanted = labels[: -teach.ENDS, :2]
    assert (labels[: -teach.ENDS, 2] == 0.0).all() and np.abs(wanted).max() <= 1.0
    np.testing.assert_array_equal(wanted[:, 0], went[:, 0])
    off = np.abs(wanted[:, 1] - went[:, 1]).mean()
    assert off == 0.0 if swerve == 0.0 else off > 0.05


def test_reaches_and_stows_are_told_apart_and_failures_are_left_out(arena: Arena, teach: Any) -> None:
    arena.restart(*BY_THE_BOWL)
    names = arena.stage.labeller.names
    teacher, sent, result = noted(teach, arena, Action(PICK_UP, names[arena.index("bowl")]), 0.0)
    reached, stowed = (len(teacher.notes.frames[name]) for name in teach.ARM)
    assert result.ok and reached > 20 and stowed > 5 and reached + stowed == len(sent)
    assert not teacher.skill(arena.stage, Action(PICK_UP, names[arena.index("bowl")])).close()
    held, sent, result = noted(teach, arena, Action(DROP), 0.0)
    assert result.ok and len(held.notes.frames["stow"]) == len(sent) and not held.notes.frames["reach"]
    teacher, sent, result = noted(teach, arena, Action(PICK_UP, names[arena.index("far")]), 0.0)
    assert not result.ok and not any(teacher.notes.frames.values())


class Led:
    """A pupil whose arm goes astray: its joints drift, its base stays."""

    def skill(self, stage: Any, action: Action) -> Any:
        arm = stage.robot.arm()
        while True:
            arm = arm + 0.03 * np.array([-1.0, 1.0, 0.5, -1.0, 0.5, -1.0, 0.5])
            yield stage.robot.action(0.0, 0.0, arm, True)


@pytest.mark.parametrize(("name", "start"), [("bowl", BY_THE_BOWL), ("mug", (0.5, 0.0, 0.3))])
def test_the_skill_goes_on_where_a_network_led_and_only_that_is_learned(
    arena: Arena, teach: Any, name: str, start: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(teach.reaching, "NOISE", 0.0)
    monkeypatch.setitem(teach.LED, "reach", 25)
    arena.restart(*start)
    teacher = teach.Teacher(2, Led())
    astray = int(np.random.default_rng(2).integers(25))
    action = Action(PICK_UP, arena.stage.labeller.names[arena.index(name)])
    began = arena.stage.frame
    assert astray > 10 and arena.run(teacher.skill(arena.stage, action)).ok and arena.stage.held == arena.index(name)
    noted = sum(map(len, teacher.notes.frames.values()))
    assert noted == arena.stage.frame - began - astray
    first, label = teacher.notes.frames["reach"][0]
    assert np.abs(first[:7] - arena.agent.tucked).max() > 0.3 and np.abs(label[:7] - first[:7]).max() > 0.3


def test_an_arm_goes_straight_to_where_it_is_told_to_and_no_faster_than_it_may(arena: Arena, teach: Any) -> None:
    hands, most = sys.modules["hands"], arena.agent.build.arm_step
    arena.restart(*BY_THE_BOWL)
    now = teach.reaching.PickUp(arena.stage, arena.index("bowl"))
    start, way = now.targets.copy(), np.array([0.25, -0.5, 0.0, 0.05, 0.0, 0.0, 0.1])
    sent = [hands.step(now, np.array([*(start + way), 2.0, -0.5, 1.0])) for _ in range(6)]
    for frame, action in enumerate(sent, start=1):
        np.testing.assert_allclose(action[:7], start + way * min(1.0, frame * most / 0.5), atol=1e-6)
    assert sent[0][11:13].tolist() == [1.0, -0.5] and sent[0][7] < 0.0  # full speed; shut


def test_who_does_what_the_labels_say_stows_the_thing(
    arena: Arena, teach: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(teach.reaching, "NOISE", 0.0)
    index = arena.index("bowl")
    arena.restart(*BY_THE_BOWL)
    assert arena.run(pick_up(arena.stage, index)).ok
    teacher, _, _ = noted(teach, arena, Action(DROP), 0.0)
    labels = iter([label for _, label in teacher.notes.frames["stow"]])
    arena.restart(*BY_THE_BOWL)
    assert arena.run(pick_up(arena.stage, index)).ok
    policy = type("Told", (), {"output": lambda self, now: next(labels)})()
    stowed = sys.modules["hands"].stowed
    assert arena.run(stowed(arena.stage, policy)).ok and bool(arena.world.safe[0, index])
    assert not arena.run(stowed(arena.stage, policy)).ok  # nothing is held


@pytest.mark.render
@pytest.mark.long
def test_networks_learn_from_an_episode_and_move_the_robot(
    learn: Any, teach: Any, tmp_path: Path, monkeypatch: Any
) -> None:
    monkeypatch.setattr(learn, "EPOCHS", dict.fromkeys(learn.EPOCHS, 2))
    learn.demonstrate(tmp_path / "demos.npz", ["HazardFire-v1"], [4, 5])
    learn.train([tmp_path / "demos.npz"], tmp_path / "made")
    assert {path.stem for path in (tmp_path / "made").iterdir()} == {"walk", "reach", "stow"}
    name = f"{FOLDER / 'policies.py'}:Policies:weights={tmp_path / 'made'}"
    played = teach.play(teach.EpisodeOptions("HazardFire-v1", seed=4, agent=name, effects="off"))
    assert played.agent == name and played.frames > 300
    walks = [one for one in played.decisions if one.verb == WALK_TO]
    assert walks and all(one.frames <= 100 for one in walks)
    learn.reach(tmp_path / "reaches.npz", ["HazardFire-v1"], [4, 5], tmp_path / "made", each=1)
    noted = np.load(tmp_path / "reaches.npz")
    assert len(noted["reach_0"]) == len(noted["reach_1"]) > 50 and "walk_0" not in noted


def test_it_refuses_agents_that_see_what_is_hidden(teach: Any) -> None:
    with pytest.raises(ValueError, match="decides must be an agent that sees what the robot sees, got 'oracle'"):
        teach.Deciding("oracle")
