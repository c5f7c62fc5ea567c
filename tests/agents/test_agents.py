"""Agents in a room without physics: what they choose, what they save, and that they always end."""

from __future__ import annotations

from collections import Counter
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hazard_ms.agents.base import Agent, agent
from hazard_ms.agents.greedy import Greedy
from hazard_ms.agents.random import Random
from hazard_ms.skills.decision import (
    DROP,
    EXPLORE,
    PICK_UP,
    STOP,
    VERBS,
    WALK_ONE_STEP,
    WALK_TO,
    Action,
)
from tests.worlds.playground import Playground, brief, play

RESCUERS = ("greedy", "planner")  # agents that fetch what is worth most, and search for more


@pytest.mark.parametrize("name", ["greedy", "planner", "mcts:simulations=200"])
def test_rescuers_bring_in_everything_near_and_stop(name: str) -> None:
    ground = Playground({"a": (1.0, 0.0), "b": (0.0, 2.0), "c": (-1.5, 1.0)}, {"a": 1.0, "b": 5.0, "c": 1.0})
    taken = play(agent(name), ground)
    assert ground.rescued == {"a", "b", "c"} and taken[-1] == Action(STOP)
    assert taken[0] == Action(EXPLORE)


def test_greedy_weighs_distance_against_value() -> None:
    """2 m further for five times the value is worth it: (1 + 1) / 1 > (3 + 1) / 5."""
    ground = Playground({"cheap": (1.0, 0.0), "dear": (0.0, 2.9)}, {"cheap": 1.0, "dear": 5.0})
    picked = [a.target for a in play(Greedy(), ground) if a.verb == PICK_UP]
    assert picked == ["dear", "cheap"]


def test_greedy_counts_what_will_be_damaged_at_half() -> None:
    """Equal value; the nearer one heats up by 50 C in 100 frames from 200 C and reaches 300 C before it gets there."""
    ground = Playground({"hot": (2.0, 0.0), "cool": (-2.4, 0.0)}, {"hot": 5.0, "cool": 5.0})
    player = Greedy()
    player.reset(brief())
    ground.do(player.act(ground.decision()))
    hot = ground.map.objects[0]
    ground.remember(0, replace(hot, levels=(250.0,), history=((0, (200.0,)), (100, (250.0,)))))
    assert player.act(replace(ground.decision(), frame=100)).target == "cool"
    ground.remember(0, replace(hot, levels=(200.0,), history=((0, (200.0,)), (100, (200.0,)))))
    assert player.act(replace(ground.decision(), frame=100)).target == "hot"


@pytest.mark.parametrize("name", RESCUERS)
def test_rescuers_go_where_they_have_not_been(name: str) -> None:
    """The target is out of sight; a landmark at the edge of sight leads to it, one amid explored floor does not."""
    ground = Playground({"table": (2.8, 0.0), "sofa": (0.4, 0.4), "far": (5.0, 0.0)}, {"far": 5.0})
    taken = play(agent(name), ground)
    assert [a.target for a in taken if a.verb == WALK_TO][0] == "table"
    assert ground.rescued == {"far"}


@pytest.mark.parametrize("name", RESCUERS)
@pytest.mark.parametrize("fault", ["broken", "slippery"])
def test_rescuers_give_up_what_fails_and_save_the_rest(fault: str, name: str) -> None:
    ground = Playground(
        {"bad": (1.0, 0.0), "good": (0.0, 2.5)},
        {"bad": 5.0, "good": 1.0},
        **{fault: frozenset({"bad"})},  # type: ignore[arg-type]
    )
    taken = play(agent(name), ground)
    assert ground.rescued == {"good"}
    assert sum(a.target == "bad" for a in taken) <= 20 and taken[-1].verb == STOP


@pytest.mark.parametrize("name", RESCUERS)
def test_rescuers_bring_things_to_carts_that_work(name: str) -> None:
    places = {"a": (1.0, 0.0), "b": (0.0, 2.0), "cart": (-2.0, 0.0), "stuck": (0.5, -0.5)}
    ground = Playground(places, {"a": 1.0, "b": 5.0}, carts=("cart", "stuck"), broken=frozenset({"stuck"}))
    play(agent(name), ground)
    assert ground.rescued == {"a", "b"}


@pytest.mark.parametrize("name", RESCUERS)
@given(st.integers(0, 2**32 - 1))
@settings(max_examples=20, deadline=None)
def test_rescuers_end_whatever_fails(name: str, seed: int) -> None:
    """Any room, any set of things that fail: never more than 300 decisions, and what can be saved nearby is saved."""
    draw = np.random.default_rng(seed)
    names = [f"t{i}" for i in range(int(draw.integers(1, 8)))]
    places = {n: (float(x), float(y)) for n, (x, y) in zip(names, draw.uniform(-4, 4, (len(names), 2)), strict=True)}
    some = [frozenset(n for n in names if draw.random() < 0.3) for _ in range(2)]
    ground = Playground(places, {n: float(draw.choice([1, 5])) for n in names[:5]}, broken=some[0], slippery=some[1])
    taken = play(agent(name), ground, most=1000)
    assert len(taken) < 300
    assert ground.frame >= 1500 or taken[-1].verb == STOP
    near = {n for n in ground.values if np.hypot(*places[n]) < 2.0} - some[0] - some[1]
    assert ground.frame >= 1500 or near <= ground.rescued


def test_random_draws_evenly_from_its_moves() -> None:
    """One known target in sight: drop, explore, one step, pick up, walk to it, each with chance 1/5 (four sigma)."""
    ground = Playground({"a": (1.0, 0.0)}, {"a": 1.0})
    ground.look()
    player = Random()
    player.reset(brief())
    counts = Counter(player.act(ground.decision()).verb for _ in range(2000))
    assert set(counts) == {DROP, EXPLORE, WALK_ONE_STEP, PICK_UP, WALK_TO}
    assert all(abs(n - 400) < 4 * np.sqrt(2000 * 0.2 * 0.8) for n in counts.values())


def test_random_knows_only_what_it_has_seen() -> None:
    player = Random()
    player.reset(brief(seed=1))
    ground = Playground({"a": (1.0, 0.0)}, {"a": 1.0})
    assert {player.act(ground.decision()) for _ in range(50)} == {Action(DROP), Action(EXPLORE)}


def test_random_is_a_function_of_its_seed() -> None:
    def episode(seed: int) -> list[Action]:
        return play(Random(), Playground({"a": (1.0, 0.0), "b": (0.0, 2.0)}, {"a": 1.0, "b": 5.0}), seed)

    assert episode(3) == episode(3)
    assert episode(3) != episode(4)


def test_greedy_does_better_than_random() -> None:
    def rescued(make: type[Agent]) -> int:
        total = 0
        for seed in range(10):
            places = np.random.default_rng(seed).uniform(-2.5, 2.5, (6, 2))
            ground = Playground(
                {f"t{i}": (float(x), float(y)) for i, (x, y) in enumerate(places)}, {f"t{i}": 1.0 for i in range(6)}
            )
            play(make(), ground, seed, most=2000)
            total += len(ground.rescued)
        return total

    assert rescued(Greedy) > 1.5 * rescued(Random)


@pytest.mark.parametrize(
    ("verb", "target"),
    [("fly", None), ("", None), (WALK_TO, None), (PICK_UP, None), (WALK_TO, 3), (None, None), ([], None)],
)
def test_what_is_not_an_action_is_refused(verb: str, target: str | None) -> None:
    with pytest.raises(ValueError, match="must be"):
        Action(verb, target)


def test_every_verb_has_a_form() -> None:
    assert {str(Action(v, "cup")) for v in VERBS} == {f"{v} cup" for v in VERBS}
    assert str(Action(DROP)) == "drop"
