"""Environments that are timed in turn: the order of turns, their medians, and the tables that are made of them."""

from __future__ import annotations

import time
from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from hazard_ms.cli.costs import stock
from hazard_ms.cli.costs.frames import Stopwatch
from hazard_ms.cli.costs.scaling import OURS, STOCK, pictures_table, things_table
from hazard_ms.cli.costs.tables import table
from hazard_ms.cli.costs.turns import Case, Turn, actions_of, frames_in_turn, phases_in_turn


def busy(seconds: float) -> None:
    """Take this much processor time [s]."""
    end = time.process_time() + seconds
    while time.process_time() < end:
        pass


class Busy:
    """An environment of which each step takes a given processor time, in physics for the most part."""

    def __init__(self, name: str, physics: float, rest: float, steps: list[tuple[str, bool]]) -> None:
        low, high = np.array([-1.0, 0.0], np.float32), np.array([1.0, 0.5], np.float32)
        self.unwrapped = SimpleNamespace(single_action_space=SimpleNamespace(low=low, high=high, shape=(2,)))
        self._name, self._times, self._steps = name, (physics, rest), steps
        self.physics: Callable[[float], None] = busy

    def step(self, action: Any) -> None:
        self._steps.append((self._name, bool(action.any())))
        self.physics(self._times[0])
        busy(self._times[1])


def test_each_has_its_turn_in_every_round_with_each_kind_of_action() -> None:
    steps: list[tuple[str, bool]] = []
    envs: Any = {name: Busy(name, 0.0, cost, steps) for name, cost in (("slow", 0.004), ("quick", 0.002))}
    found = frames_in_turn(envs, 3, 2, 0)
    once = [(name, drawn) for name in ("slow", "quick") for drawn in (False, True) for _ in range(3)]
    assert steps == once * 2
    for kind in ("zeros", "random"):
        assert found["slow"].cpu[kind] == pytest.approx(0.004, rel=0.4)
        assert found["quick"].cpu[kind] == pytest.approx(0.002, rel=0.4)
        assert found["slow"].wall[kind] >= 0.0039


def test_what_disturbs_one_round_of_three_does_not_count() -> None:
    env: Any = Busy("env", 0.0, 0.002, [])
    plain, calls = env.step, []

    def disturbed(action: Any) -> None:
        calls.append(action)
        busy(0.05 if len(calls) == 2 else 0.0)
        plain(action)

    env.step = disturbed
    assert frames_in_turn({"env": env}, 1, 3, 0)["env"].cpu["random"] == pytest.approx(0.002, rel=0.3)


def test_phases_are_those_of_one_frame() -> None:
    env: Any = Busy("env", 0.003, 0.001, [])
    watch = Stopwatch(time.process_time)
    watch.wrap(env, "physics", "physics")
    found = phases_in_turn({"env": env}, {"env": watch}, 4, 3, 0)["env"]
    assert found["physics"] == pytest.approx(0.003, rel=0.2)
    assert found["frame"] == pytest.approx(0.004, rel=0.2)


def test_random_actions_fill_the_space_and_follow_from_the_seed() -> None:
    env: Any = Busy("env", 0.0, 0.0, [])
    drawn = actions_of(env, "random", 500, 7)
    assert drawn.shape == (500, 2) and drawn.dtype == np.float32
    assert np.allclose(drawn.min(axis=0), [-1.0, 0.0], atol=0.02) and np.allclose(
        drawn.max(axis=0), [1.0, 0.5], atol=0.02
    )
    assert (drawn == actions_of(env, "random", 500, 7)).all() and (drawn != actions_of(env, "random", 500, 8)).any()


def turn(zeros: float, drawn: float) -> Turn:
    spans = {"zeros": zeros, "random": drawn}
    return Turn(spans, {kind: 2 * span for kind, span in spans.items()})


def cells(text: str) -> list[list[str]]:
    """The cells of a table's rows, without headings."""
    return [[cell.strip() for cell in line.split("|")[1:-1]] for line in text.splitlines()[2:]]


def test_the_table_of_frames_compares_with_stock_on_the_same_robot() -> None:
    turns = {stock.STOCK[0]: turn(0.004, 0.005), stock.USUAL[0]: turn(0.001, 0.002)}
    assert cells(stock.frames_table(turns, {stock.STOCK[0]: 1, stock.USUAL[0]: 60})) == [
        ["PickCube-v1", "fetch", "stock", "1", "250 (125)", "200 (100)", "1.00", "1.00"],
        ["HazardFire-v1", "fetch", "paper", "60", "1000 (500)", "500 (250)", "4.00", "2.50"],
    ]


def test_shares_are_of_the_same_task() -> None:
    turns = {case: turn(1.0, 0.002 if case.env_id == "HazardFire-v1" else 0.004) for case in stock.USUAL}
    turns |= {case: turn(1.0, 0.004 if case.robot == "g1" else 0.005) for case in stock.OTHERS}
    shares = {(row[0], row[1], row[2]): row[3] for row in cells(stock.shares_table(turns))}
    assert shares["HazardFire-v1", "fetch", "realistic"] == "40%"
    assert shares["HazardFlood-v1", "fetch", "realistic"] == "80%"
    assert shares["HazardFire-v1", "g1", "paper"] == "50%"
    assert len(shares) == 8


def test_the_table_of_phases_adds_up_and_divides_the_frame_by_physics() -> None:
    phases = {
        stock.STOCK[0]: {"physics": 0.4e-3, "robot": 0.6e-3, "observe": 0.2e-3, "frame": 2e-3},
        stock.USUAL[0]: {"physics": 0.5e-3, "robot": 0.2e-3, "observe": 0.1e-3, "push": 0.1e-3, "force": 0.05e-3}
        | {"frame": 1e-3},
    }
    assert cells(stock.phases_table(phases)) == [
        ["PickCube-v1", "fetch", "stock"]
        + ["400 (1.0)", "600 (1.0)", "200 (1.0)", "0", "800 (1.0)", "2000 (1.0)", "5.00"],
        ["HazardFire-v1", "fetch", "paper"]
        + ["500 (0.8)", "200 (3.0)", "100 (2.0)", "150", "50 (16.0)", "1000 (2.0)", "2.00"],
    ]


def test_tables_of_scaling_have_a_row_for_each_number() -> None:
    frame = {"frame": 2e-3, "physics": 5e-4, "force": 3e-4, "advance": 1e-4}
    found = {(task, number): frame for task in ("fire", "wind") for number in (20, 60)}
    assert cells(things_table(found)) == [
        ["20", "2000 (500; 20%)", "2000 (500; 20%)"],
        ["60", "2000 (500; 20%)", "2000 (500; 20%)"],
    ]
    spans = {(OURS, 64): (0.02, 0.01), (STOCK, 64): (0.01, 0.005)}
    assert cells(pictures_table(spans)) == [["64", "20.0 (10.0)", "10.0 (5.0)", "2.00"]]


def test_a_table_is_as_wide_as_its_longest_cells() -> None:
    assert table(["what", "n"], [["a", "100"], ["longer", "1"]]).splitlines() == [
        "| what   |   n |",
        "| ------ | --: |",
        "| a      | 100 |",
        "| longer |   1 |",
    ]
    assert table(["n"], [["1"]], 0).splitlines()[1] == "| -: |"


def test_a_case_is_made_with_its_robot_and_preset() -> None:
    env: Any = Case("HazardFire-v1", "g1", "realistic").make(obs_mode="none", render_backend="none")
    assert env.unwrapped.physics == "realistic" and env.unwrapped.agent.uid == "hazard_g1"
    env.close()
