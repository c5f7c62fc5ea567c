"""250 actions that cannot be done: each gives a ValueError or a documented failure; none hangs or does harm."""

from __future__ import annotations

import string
from collections.abc import Iterator
from typing import Any

import gymnasium as gym
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import hazard_ms  # noqa: F401
from hazard_ms.skills.decision import (
    DROP,
    EXPLORE,
    NEED_TARGET,
    PICK_UP,
    STOP,
    VERBS,
    WALK_ONE_STEP,
    WALK_TO,
    Action,
    Result,
)
from hazard_ms.skills.executor import SkillEnv
from hazard_ms.skills.failures import FAILURES

pytestmark = pytest.mark.render
QUIET = dict(deadline=None, suppress_health_check=list(HealthCheck), database=None)
BUDGET = 5  # frames that an action which cannot be done may take
ENOUGH = 40  # decisions until something is in the hand

words = st.text(string.ascii_letters + string.digits + "/_-. \0é", max_size=20)
lists = st.lists(st.integers(), max_size=2)
junk = st.one_of(st.booleans(), st.integers(), st.floats(), st.binary(max_size=3), lists, st.just(object()))


class Played:
    """A skill environment that remembers whether the simulation went on."""

    def __init__(self) -> None:
        camera = {"width": 64, "height": 64}
        made = gym.make("HazardFire-v1", obs_mode="none", control_mode="pd_joint_pos", sensor_configs=camera)
        self.env = SkillEnv(made)
        self.decision, _ = self.env.reset(seed=0)

    def do(self, action: Action) -> Result:
        self.decision, _, terminated, truncated, info = self.env.step(action)
        assert not (terminated or truncated), info["result"]
        return info["result"]

    def state(self) -> tuple[Any, ...]:
        return (self.env.frame, self.env.stage.held, self.decision.targets)

    def refuses(self, call: Any) -> str:
        """`call` raises a ValueError and changes nothing. Returns what it says."""
        before = self.state()
        with pytest.raises(ValueError) as error:
            call()
        assert self.state() == before
        return str(error.value)

    def fails(self, action: Action, reason: str) -> None:
        """`action` fails at once, for a documented reason, and changes nothing but the frame."""
        assert reason in FAILURES
        frame, *rest = self.state()
        result = self.do(action)
        assert result == Result(False, reason, result.frames) and result.frames <= BUDGET
        assert self.env.frame == frame + result.frames
        assert list(self.state()[1:]) == rest

    def names(self, **wanted: bool) -> list[str]:
        """Things that are targets or not, and were seen or not."""
        world = self.env.base.world
        rows = [
            {
                "target": bool(world.target[0, i]),
                "movable": bool(world.movable[0, i]),
                "seen": i in self.decision.map.objects,
            }
            for i in range(len(world.names[0]))
        ]
        return [n for n, row in zip(world.names[0], rows, strict=True) if all(row[k] == v for k, v in wanted.items())]

    def still_works(self) -> None:
        """A normal look around: 12 turns of 30 degrees at 6 degrees a frame."""
        held = self.env.stage.held
        result = self.do(Action(EXPLORE))
        assert result.ok and result.frames == pytest.approx(60, abs=8) and self.env.stage.held == held


@pytest.fixture(scope="module")
def played() -> Iterator[Played]:
    made = Played()
    yield made
    made.env.env.close()


@pytest.fixture(scope="module")
def holding(played: Played) -> Played:
    """With a target in the hand, taken by the skills themselves."""
    played.do(Action(EXPLORE))
    for _ in range(ENOUGH):
        if played.env.stage.held >= 0:
            return played
        known = sorted(played.decision.map.objects)
        x, y = played.decision.agent_position
        targets = [i for i in known if played.decision.names[i] in played.names(target=True)]
        place = {i: played.decision.map.objects[i].position for i in targets}
        nearest = min(targets, key=lambda i: (place[i][0] - x) ** 2 + (place[i][1] - y) ** 2)
        name = played.decision.names[nearest]
        if played.do(Action(WALK_TO, name)).ok:
            played.do(Action(PICK_UP, name))
    raise AssertionError("nothing could be picked up")


@given(data=st.data())
@settings(max_examples=75, **QUIET)
def test_what_is_no_action_is_refused(data: st.DataObject) -> None:
    """An unknown verb, a verb or a target that is not text, or no target where one is needed."""
    kind = data.draw(st.sampled_from(["verb", "target", "missing"]))
    if kind == "verb":
        verb = data.draw(st.one_of(words.filter(lambda w: w not in VERBS), junk, st.none()))
        value: Any = verb
        arguments: tuple[Any, ...] = (verb, data.draw(st.one_of(words, st.none())))
    elif kind == "target":
        value = data.draw(junk)
        arguments = (data.draw(st.sampled_from(VERBS)), value)
    else:
        value = data.draw(st.sampled_from(NEED_TARGET))
        arguments = (value, None)
    with pytest.raises(ValueError) as error:
        Action(*arguments)
    said = str(error.value)
    assert (repr(value) in said or str(value) in said) and "must be" in said


@given(data=st.data())
@settings(max_examples=95, **QUIET)
def test_unknown_names_and_things_that_are_no_actions_are_refused(played: Played, data: st.DataObject) -> None:
    """The error names the value and what there is; nothing has happened."""
    kind = data.draw(st.sampled_from(["name", "needless", "type"]))
    if kind == "name":
        name = data.draw(words.filter(lambda w: w not in played.decision.names))
        verb = data.draw(st.sampled_from([WALK_TO, WALK_ONE_STEP, PICK_UP, DROP]))
        said = played.refuses(lambda: played.env.step(Action(verb, name)))
        assert repr(name) in said and ("must be" in said if verb == DROP else played.decision.names[0] in said)
    elif kind == "needless":  # no container is there, and looking around and stopping are done to nothing
        name, verb = (
            data.draw(st.sampled_from(played.decision.names)),
            data.draw(st.sampled_from([DROP, EXPLORE, STOP])),
        )
        said = played.refuses(lambda: played.env.step(Action(verb, name)))
        assert repr(name) in said and ("must be None" in said or "must be one of None" in said)
    else:
        value = data.draw(st.one_of(junk, words, st.none(), st.tuples(st.sampled_from(VERBS), words)))
        assert "Action(verb, target)" in played.refuses(lambda: played.env.step(value))


@given(data=st.data())
@settings(max_examples=40, **QUIET)
def test_with_an_empty_hand(played: Played, data: st.DataObject) -> None:
    """Dropping nothing; walking to what was never seen; picking up furniture, or a thing that is not a target."""
    kind = data.draw(st.sampled_from(["drop", "walk", "pick"]))
    if kind == "drop":
        played.fails(Action(DROP), "not_holding")
    elif kind == "walk":
        name = data.draw(st.sampled_from(played.names(seen=False)))
        played.fails(Action(data.draw(st.sampled_from([WALK_TO, WALK_ONE_STEP])), name), "target_unknown")
    else:
        played.fails(Action(PICK_UP, data.draw(st.sampled_from(played.names(target=False)))), "not_a_target")


@pytest.mark.parametrize("verb", [WALK_TO, WALK_ONE_STEP, PICK_UP])
def test_a_target_that_was_never_seen(played: Played, verb: str) -> None:
    """Nothing tells the agent where it is, whether it is within reach or not."""
    unseen = played.names(target=True, seen=False)
    played.fails(Action(verb, unseen[0]), "target_unknown")


def test_then_a_look_around_works(played: Played) -> None:
    played.still_works()


@given(data=st.data())
@settings(max_examples=40, **QUIET)
def test_with_a_full_hand(holding: Played, data: st.DataObject) -> None:
    """Picking up anything; walking to what is in the hand; dropping it into what is not a container."""
    kind = data.draw(st.sampled_from(["pick", "pick", "walk", "drop"]))
    if kind == "pick":
        holding.fails(Action(PICK_UP, data.draw(st.sampled_from(holding.decision.names))), "already_holding")
    elif kind == "walk":
        holding.fails(Action(WALK_TO, holding.decision.held), "target_unknown")
    else:
        name = data.draw(st.sampled_from(holding.decision.names))
        assert repr(name) in holding.refuses(lambda: holding.env.step(Action(DROP, name)))


def test_then_the_thing_can_still_be_brought_to_safety(holding: Played) -> None:
    holding.still_works()
    name = holding.decision.held
    assert holding.do(Action(DROP)).ok
    assert [t.rescued for t in holding.decision.targets if t.name == name] == [True]
    holding.fails(Action(PICK_UP, name), "already_rescued")


def test_an_episode_that_is_over_is_refused(played: Played) -> None:
    played.env.step(Action(STOP))
    said = played.refuses(lambda: played.env.step(Action(EXPLORE)))
    assert "reset" in said
    played.decision, _ = played.env.reset(seed=0)
    played.still_works()
