"""The time that a frame takes: for hazards one step, for the forces on bodies four; and when scenes are rebuilt."""

from __future__ import annotations

from typing import Any

import gymnasium as gym
import pytest

import hazard_ms  # noqa: F401 registers the environments
from hazard_ms.env import keywords

FRAME = 1 / 30  # [s] docs/benchmark.md 1


def test_hazards_advance_by_a_frame_and_push_in_each_of_its_four_steps() -> None:
    env = gym.make("HazardFlood-v1", obs_mode="none", render_backend="none")
    env.reset(seed=0)
    base: Any = env.unwrapped
    told: list[tuple[str, float]] = []
    advance, push = base.episode.advance, base.episode.push
    base.episode.advance = lambda dt: (told.append(("advance", dt)), advance(dt))
    base.episode.push = lambda dt: (told.append(("push", dt)), push(dt))
    base.step(None)
    env.close()
    assert [name for name, _ in told] == ["push"] * 4 + ["advance"]
    assert [dt for _, dt in told] == pytest.approx([FRAME / 4] * 4 + [FRAME])


@pytest.mark.parametrize(
    ("given", "deterministic", "every"),
    [({}, True, 1), ({}, False, 0), ({"reconfiguration_freq": 5}, True, 5), ({"reconfiguration_freq": 0}, True, 0)],
)
def test_a_scene_is_rebuilt_for_every_episode_unless_something_else_is_asked_for(
    given: dict[str, Any], deterministic: bool, every: int
) -> None:
    """Only what is rebuilt gives the same bits again (docs/reliability.md)."""
    made = keywords.for_maniskill({"render_backend": "none", **given}, "fetch", "off", deterministic)
    assert made["reconfiguration_freq"] == every
