"""Tree search: the original's sums by hand, and good choices in a small world."""

from __future__ import annotations

import math
import time
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pytest

from hazard_ms.sketch.planning.tree import Choice, Node, backed_up, chosen, exploration, exploration_rate, search

Where = tuple[int, int]  # place, and bits of what was fetched


@dataclass(frozen=True)
class Errands:
    """Targets to fetch at 0.5 per metre; what is left in the end costs its distance, beyond 5, once more."""

    costs: list[list[float]]  # from place to target; the start is the last row

    def options(self, state: Where) -> Sequence[int]:
        return [target for target in range(len(self.costs[0])) if not state[1] >> target & 1]

    def step(self, state: Where, option: int) -> tuple[Where, float, bool]:
        fetched = state[1] | 1 << option
        return (option, fetched), self.costs[state[0]][option], fetched == (1 << len(self.costs[0])) - 1

    def rest(self, state: Where) -> float:
        return sum(max(2 * self.costs[state[0]][target] - 5, 0.0) for target in self.options(state))

    def start(self) -> Where:
        return len(self.costs) - 1, 0


def errands(places: np.ndarray) -> Errands:
    """Targets at places [m], [M, 2], and a start at the origin."""
    everything = np.concatenate([places, np.zeros((1, 2))])
    return Errands((0.5 * np.linalg.norm(everything[:, None] - places, axis=-1)).tolist())


def test_the_exploration_rate_is_the_original_s() -> None:
    """ln((1 + n + 1e6) / 1e6) + 0.1, and c(100) * 10 / 10."""
    assert exploration_rate(0) == pytest.approx(0.100001, abs=5e-7)
    assert exploration_rate(2000) == pytest.approx(0.101999, abs=5e-7)
    assert exploration(100, 9) == pytest.approx(0.100101, abs=5e-7)


def node(visits: int, mean: float, cost: float) -> Node[int, int]:
    made = Node[int, int](0, cost, False)
    made.visits, made.total = visits, visits * mean
    return made


def test_in_the_tree_value_cost_and_few_visits_decide() -> None:
    """After 100 visits 9 of them are worth 0.1001 more, and 49 of them 0.0200."""
    parent = node(100, 0, 0)
    rare, usual, dear = node(9, -1.0, 0.0), node(49, -0.93, 0.0), node(9, -0.5, 0.6)
    parent.children = [usual, rare, dear]
    assert chosen(parent) is rare  # -0.8999 against -0.9100 and -0.9999
    usual.total += 49 * 0.02
    assert chosen(parent) is usual  # -0.8900
    parent.children += [node(0, 0, 3), cheap := node(0, 0, 2), node(0, 0, 2)]
    assert chosen(parent) is cheap


def test_values_are_discounted_and_costs_subtracted_on_the_way_back() -> None:
    """-3; 0.95 * -3 - 2 = -4.85; 0.95 * -4.85 - 1 = -5.6075."""
    assert backed_up(-3.0, [1.0, 2.0]) == pytest.approx([-3, -4.85, -5.6075])


def test_a_single_option_is_scored_by_the_roll_out_behind_it() -> None:
    """Targets at 1, 3 and 6 m on a line, one after the other: costs 0.5, 1, 1.5, and nothing is left."""

    @dataclass(frozen=True)
    class Corridor(Errands):
        def options(self, state: Where) -> Sequence[int]:
            return list(super().options(state))[:1]

    model = Corridor(errands(np.array([[1.0, 0], [3, 0], [6, 0]])).costs)
    found = search(model, model.start(), simulations=1)
    assert found.visits == (1,) and found.scores == pytest.approx([-(1 + 0.95 * 1.5) - 0.5])
    found = search(model, model.start(), simulations=1, depth=1)  # 3 m are left, cost 1.5: less than 2.5 is free
    assert found.scores == pytest.approx([-1 - 0.5])
    far = Corridor(errands(np.array([[1.0, 0], [3, 0], [11, 0]])).costs)  # 8 m are cost 4: 2 * 4 - 5 = 3
    assert search(far, far.start(), simulations=1, depth=1).scores == pytest.approx([-(1 + 0.95 * 3) - 0.5])


@dataclass(frozen=True)
class Doors:
    """Two doors, each of its own price, and two more behind each: a state is the row of `behind` that is next."""

    here: tuple[float, float]
    behind: tuple[tuple[float, float], tuple[float, float]]

    def options(self, state: int) -> Sequence[int]:
        return 0, 1

    def step(self, state: int, option: int) -> tuple[int, float, bool]:
        return (option, self.here[option], False) if state < 0 else (state, self.behind[state][option], True)

    def rest(self, state: int) -> float:
        return 0.0


def test_it_finds_the_option_that_is_cheaper_in_the_end() -> None:
    found = search(Doors((0.5, 1.0), ((5, 5), (0, 0))), -1, simulations=500)
    assert found.option == 1
    assert found.visits[1] > found.visits[0] > 0 and sum(found.visits) == 500
    assert found.scores == pytest.approx((-5.5, -1.0))


def test_it_finds_what_random_choices_later_on_would_miss() -> None:
    """Behind the first door one costs 0, the other 1, and half on average; behind the second both cost 0.3."""
    found = search(Doors((1, 1), ((1, 0), (0.3, 0.3))), -1, simulations=2000)
    assert found.option == 0
    assert -1.1 < found.scores[0] < -1


def test_chance_comes_from_the_seed_alone() -> None:
    model = errands(np.random.default_rng(2).uniform(-5, 5, (8, 2)))

    def found(seed: int) -> Choice[int]:
        return search(model, model.start(), simulations=300, seed=seed)

    assert found(1) == found(1)
    assert found(1) != found(2)


def test_options_that_were_not_tried_are_not_chosen() -> None:
    """The first simulation goes to the cheapest option, which then is the only one with a value."""
    model = errands(np.array([[9.0, 0], [1, 0], [5, 0]]))
    found = search(model, model.start(), simulations=1)
    assert found.visits == (0, 1, 0) and found.option == 1
    assert found.scores[0] == found.scores[2] == -math.inf


def test_a_decision_among_fifteen_targets_takes_few_steps(capsys: pytest.CaptureFixture[str]) -> None:
    """2,000 simulations: each steps once for each option of a new node, and through one roll-out at most."""
    model = errands(np.random.default_rng(0).uniform(-5, 5, (15, 2)))
    steps = 0

    class Counting(Errands):
        def step(self, state: Where, option: int) -> tuple[Where, float, bool]:
            nonlocal steps
            steps += 1
            return super().step(state, option)

    found = search(Counting(model.costs), model.start(), simulations=2000)
    assert sum(found.visits) == 2000
    assert steps <= 15 + 2000 * (15 + 15)
    start = time.process_time()
    search(model, model.start(), simulations=2000)
    with capsys.disabled():
        print(f" [2,000 simulations with 15 targets: {time.process_time() - start:.2f} s of processor time]", end="")


def test_bad_searches_are_refused() -> None:
    model = errands(np.array([[1.0, 0]]))
    with pytest.raises(ValueError, match="simulations must be at least 1 and depth at least 0, got 0 and 20"):
        search(model, model.start(), simulations=0)
    with pytest.raises(ValueError, match="got 5 and -1"):
        search(model, model.start(), simulations=5, depth=-1)
    with pytest.raises(ValueError, match=r"state must have at least one option, got \(0, 1\)"):
        search(model, (0, 1))
