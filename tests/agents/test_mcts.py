"""Tree search over rescues: it follows the clock of the problem, finds good plans, and repeats itself for a seed."""

from __future__ import annotations

import numpy as np
import pytest

from hazard_ms.agents.mcts import Mcts, Rescue
from hazard_ms.sketch.planning.orienteering import solve
from hazard_ms.sketch.planning.problem import Problem
from hazard_ms.sketch.planning.travel import StaticTravel
from hazard_ms.sketch.planning.tree import search
from hazard_ms.skills.decision import Action
from tests.worlds.playground import Playground, play


def on_a_line(
    places: tuple[float, ...], carts: tuple[float, ...] = (), frames_per_metre: float = 62.0, **more: object
) -> Problem:
    """A rescue along a line from 0, targets and carts at these places [m]; pick-ups and drops take no time."""
    x = np.array([*places, *carts, 0.0])
    travel = StaticTravel(frames_per_metre * np.abs(x[:, None] - x), len(carts))
    count = len(places)
    given = {"values": [1.0] * count, "damaged_at": [np.inf] * count, "pick": [0.0] * count}
    return Problem(travel, **{**given, "drop": [0.0] * (len(carts) or count), "limit": 500, **more})  # type: ignore[arg-type]


def test_a_simulation_follows_the_clock() -> None:
    """Targets at 1 m and -2 m with 10 frames to pick up and 5 to drop: safe at 77, then 186 + 15 later."""
    model = Rescue(on_a_line((1.0, -2.0), pick=[10.0, 10.0], drop=[5.0, 5.0], values=[1.0, 3.0]))
    near, far = model.options(model.start)
    state, cost, over = model.step(model.start, near)
    assert (state.frame, cost, over) == (77.0, -0.25, False)
    (last,) = model.options(state)
    assert model.step(state, last)[0].frame == 77.0 + 186.0 + 15.0
    assert model.step(state, last)[1:] == (-0.75, True)
    assert far.safe == 139.0


def test_what_cannot_be_safe_in_time_is_no_option() -> None:
    model = Rescue(on_a_line((1.0, -2.0), limit=100))
    assert [step.goal for step in model.options(model.start)] == [0]


def test_a_thing_in_the_hand_is_put_away_first() -> None:
    """Carts at -1 and 3 m, the other target at 4 m: both carts are options, and nothing else."""
    model = Rescue(on_a_line((0.0, 4.0), carts=(-1.0, 3.0), holding=0))
    assert [(step.goal, step.cart, step.safe) for step in model.options(model.start)] == [(0, 0, 62.0), (0, 1, 186.0)]
    state = model.step(model.start, model.options(model.start)[1])[0]
    (last,) = model.options(state)  # back at the other cart it would be frame 558: too late
    assert (last.goal, last.cart, last.safe) == (1, 1, 186.0 + 62.0 + 62.0)


@pytest.mark.parametrize("seed", range(5))
def test_what_it_begins_with_leads_to_nearly_the_best_plan(seed: int) -> None:
    """Six targets, of which time and damage allow some: at least 80 % of the value of the exact plan."""
    draw = np.random.default_rng(seed)
    x = np.vstack([draw.uniform(-4, 4, (6, 2)), np.zeros(2)])
    travel = StaticTravel(62 * np.hypot(*np.moveaxis(x[:, None] - x, -1, 0)))
    values, damaged = draw.choice([1.0, 5.0], 6), draw.uniform(200, 2000, 6)
    problem = Problem(travel, values.tolist(), damaged.tolist(), [80.0] * 6, [4.0] * 6, limit=1000)
    model = Rescue(problem)
    state, saved = model.start, 0.0
    while model.options(state):
        choice = search(model, state, 500, seed)
        saved += choice.option.worth
        state = model.step(state, choice.option)[0]
    best = solve(problem)
    assert 0.8 * best.value <= saved <= best.value + 1e-9


def test_it_is_a_function_of_its_seed_and_says_why() -> None:
    def episode(seed: int) -> tuple[list[Action], str | None]:
        places = {
            f"t{n}": (float(x), float(y)) for n, (x, y) in enumerate(np.random.default_rng(3).uniform(-2, 2, (5, 2)))
        }
        player = Mcts(simulations=30)
        return play(player, Playground(places, dict.fromkeys(places, 1.0)), seed, most=2), player.note

    assert episode(1) == episode(1)
    assert "of the value in" in (episode(1)[1] or "")
