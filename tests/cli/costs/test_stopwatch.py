"""The stopwatch of `hazard-ms bench`: phases add up, and what runs inside of another counts once."""

from __future__ import annotations

import time
from typing import Any

import pytest

from hazard_ms.cli.costs import frames


class Robot:
    """Moves, and looks while it does."""

    def move(self) -> int:
        time.sleep(0.02)
        self.look()
        return 7

    def look(self) -> None:
        time.sleep(0.1)


def test_a_phase_inside_of_another_counts_for_itself_only() -> None:
    robot, watch = Robot(), frames.Stopwatch()
    watch.wrap(robot, "look", "seeing")
    watch.wrap(robot, "move", "moving")
    start = time.perf_counter()
    assert robot.move() == 7
    whole = time.perf_counter() - start
    assert watch.seconds["moving"] < watch.seconds["seeing"]
    assert watch.seconds["moving"] + watch.seconds["seeing"] == pytest.approx(whole, rel=0.1)


def test_phases_add_up_to_a_frame() -> None:
    found: dict[str, Any] = frames.phases("HazardFire-v1", 30, 0, obs_mode="state", render_backend="none")
    whole = 1e6 / found["frames_per_second"]
    assert sum(found["phases_us"].values()) == pytest.approx(whole)
    assert all(us >= 0.0 for us in found["phases_us"].values()), found["phases_us"]  # "rest" is what is left
    assert 0.0 < found["hooks"] < 1.0
