"""The measure of `hazard-ms bench --vector`: what it counts, with environments whose steps take a known time."""

from __future__ import annotations

import time
from typing import Any

import numpy as np
import pytest
from gymnasium.spaces import Box

from hazard_ms.cli.costs.vector import TURN, Turns, report


class Sleepers:
    """Three environments whose step takes 2 ms, of which half is work."""

    num_envs, pids, action_space = 3, (), Box(-1.0, 1.0, (3, 13))

    def reset(self, seed: int) -> None:
        self.steps = 0

    def step(self, action: np.ndarray) -> Any:
        assert action.shape == (3, 13) and not action[:, :-2].any() and action[:, -2:].all()
        self.steps += 1
        time.sleep(0.001)
        start = time.thread_time()
        while time.thread_time() - start < 0.001:
            pass


def test_frames_of_all_environments_count_and_processor_time_leaves_waiting_out() -> None:
    envs = Sleepers()
    turns = Turns(envs, 1, 0)
    for _ in range(5):
        turns.play()
    assert envs.steps == 6 * TURN and len(turns.spans) == 5
    assert turns.rate <= 3 / 0.002
    assert 0.001 / 3 <= turns.cost < 0.002 / 3


def test_unknown_names_and_too_few_frames_are_refused() -> None:
    with pytest.raises(ValueError, match="HazardFire-v1"):
        report("HazardFir-v1", 100, 0)
    with pytest.raises(ValueError, match="frames must be"):
        report("HazardFire-v1", TURN - 1, 0)
