"""The rule of thumb in a room without physics."""

from __future__ import annotations

from collections import Counter

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hazard_ms.agents.rule import Rule
from hazard_ms.skills.decision import DROP, EXPLORE, PICK_UP, STOP, WALK_TO, Action, Result
from tests.worlds.playground import Playground, brief, play

NEAR = {"a": (1.0, 0.0), "b": (0.0, 2.0), "c": (-1.5, 1.0)}
VALUES = {"a": 1.0, "b": 5.0, "c": 1.0}


def test_it_rescues_everything_near_one_after_the_other_and_stops() -> None:
    ground = Playground(dict(NEAR), VALUES)
    taken = play(Rule(), ground)
    assert ground.rescued == {"a", "b", "c"}
    assert [action.verb for action in taken] == [
        EXPLORE,
        *[WALK_TO, PICK_UP, DROP] * 2,
        WALK_TO,
        WALK_TO,
        PICK_UP,
        DROP,
        STOP,
    ]


def test_it_draws_its_targets_evenly() -> None:
    """Whatever they are worth and however far they are: of 900 agents 300 begin with each (four sigma)."""
    ground = Playground(dict(NEAR), VALUES)
    ground.do(Action(EXPLORE))
    counts: Counter[str | None] = Counter()
    for seed in range(900):
        player = Rule()
        player.reset(brief(seed=seed))
        counts[player.act(ground.decision()).target] += 1
    assert set(counts) == set(NEAR)
    assert all(abs(count - 300) < 4 * np.sqrt(900 / 3 * 2 / 3) for count in counts.values())


def test_it_stays_with_what_it_has_drawn() -> None:
    """A walk of 100 frames ends on the way; whatever it sees then, it goes on."""
    ground = Playground({"far": (6.0, 0.0), "near": (3.0, 0.5)}, {"far": 1.0, "near": 5.0}, sight=9.0)
    taken = play(Rule(), ground)
    walks = [action.target for action in taken if action.verb == WALK_TO]
    assert ground.rescued == {"far", "near"} and len(walks) > 4
    assert sum(a != b for a, b in zip(walks, walks[1:], strict=False)) == 1


@pytest.mark.parametrize(("fault", "most"), [("broken", 2), ("slippery", 4)])
def test_it_gives_up_what_fails_twice(fault: str, most: int) -> None:
    """Two walks without a path, or two pick-ups with a walk before each."""
    for seed in range(5):
        ground = Playground(
            {"bad": (1.0, 0.0), "good": (0.0, 2.5)},
            {"bad": 5.0, "good": 1.0},
            **{fault: frozenset({"bad"})},  # type: ignore[arg-type]
        )
        taken = play(Rule(), ground, seed)
        first_searched = next(i for i, action in enumerate(taken) if ground.rescued and action == Action(DROP))
        assert ground.rescued == {"good"}
        assert sum(action.target == "bad" for action in taken[:first_searched]) in (0, most)


def test_a_walk_that_ran_out_of_frames_is_no_failure_until_the_eighth() -> None:
    ground = Playground({"a": (2.0, 0.0), "b": (0.0, 2.0)}, {"a": 1.0, "b": 1.0})
    ground.do(Action(EXPLORE))
    player = Rule()
    player.reset(brief())
    first = player.act(ground.decision())
    for _ in range(7):
        ground.last = (first, Result(False, "max_frames", 100))
        assert player.act(ground.decision()) == first
    assert player.act(ground.decision()) != first


def test_it_brings_things_to_carts_that_it_can_reach() -> None:
    places = {**NEAR, "cart": (-2.0, 0.0), "stuck": (0.5, -0.5)}
    for seed in range(5):
        ground = Playground(dict(places), VALUES, carts=("cart", "stuck"), broken=frozenset({"stuck"}))
        taken = play(Rule(), ground, seed)
        assert ground.rescued == {"a", "b", "c"} and Action(DROP, "cart") in taken


def test_it_searches_from_things_that_it_has_seen() -> None:
    ground = Playground({"table": (2.8, 0.0), "far": (5.0, 0.0)}, {"far": 5.0})
    taken = play(Rule(), ground)
    assert taken[:3] == [Action(EXPLORE), Action(WALK_TO, "table"), Action(WALK_TO, "table")]
    assert ground.rescued == {"far"}


def test_it_searches_from_one_thing_after_the_other() -> None:
    things = {"table": (2.0, 0.0), "sofa": (0.0, 2.0), "lamp": (-2.0, 0.0)}
    ground = Playground({**things, "hidden": (40.0, 0.0)}, {"hidden": 5.0}, sight=5.0)
    assert {action.target for action in play(Rule(), ground) if action.verb == WALK_TO} == set(things)


def test_where_it_can_go_nowhere_it_looks_around() -> None:
    ground = Playground({"table": (2.8, 0.0), "far": (9.0, 0.0)}, {"far": 5.0}, broken=frozenset({"table"}))
    taken = play(Rule(), ground)
    assert taken[1:3] == [Action(WALK_TO, "table")] * 2 and set(taken[3:]) == {Action(EXPLORE)}


@given(st.integers(0, 2**32 - 1))
@settings(max_examples=30, deadline=None)
def test_what_can_be_saved_nearby_is_saved_whatever_fails(seed: int) -> None:
    draw = np.random.default_rng(seed)
    names = [f"t{i}" for i in range(int(draw.integers(1, 5)))]
    places = {
        n: (float(x), float(y)) for n, (x, y) in zip(names, draw.uniform(-1.2, 1.2, (len(names), 2)), strict=True)
    }
    bad = [frozenset(n for n in names if draw.random() < 0.3) for _ in range(2)]
    ground = Playground(places, {n: float(draw.choice([1, 5])) for n in names}, broken=bad[0], slippery=bad[1])
    play(Rule(), ground, seed % 1000, most=1000)
    assert ground.rescued == set(names) - bad[0] - bad[1]


def test_it_is_a_function_of_its_seed() -> None:
    def episode(seed: int) -> list[Action]:
        return play(Rule(), Playground(dict(NEAR), VALUES), seed)

    assert episode(3) == episode(3)
    assert len({tuple(episode(seed)) for seed in range(8)}) > 2


def test_it_must_try_at_least_once() -> None:
    with pytest.raises(ValueError, match="give_up must be at least 1, got 0"):
        Rule(give_up=0)
