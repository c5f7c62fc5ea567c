"""HazardGale-v1: its scenes, who it acts on, and what counts as rescued when time is up."""

from __future__ import annotations

import gymnasium as gym
import numpy as np
import pytest
import torch

import hazard_ms  # noqa: F401 registers the environments
from hazard_ms.evaluation.attempts import Recorded
from hazard_ms.evaluation.options import EpisodeOptions
from hazard_ms.evaluation.runner import play
from hazard_ms.scenes import splits
from hazard_ms.scenes.splits import scene
from hazard_ms.spec.registry import TASKS
from hazard_ms.tasks import task_of


def test_each_split_has_fifty_scenes_of_its_own() -> None:
    task = task_of("HazardGale-v1", "paper")
    names = {split: set(task.scenes(split)) for split in ("train", "test", "held_out")}
    assert tuple(names) == task.splits and [len(of) for of in names.values()] == [50, 50, 50]
    assert len(set.union(*names.values())) == 150 and TASKS["HazardGale-v1"].max_frames == 3000
    assert not set.union(*names.values()) & set(task_of("HazardWind-v1", "paper").all_scenes)
    assert TASKS["HazardGale-v1"].affects_agent and task.averted and task.mitigations == ("push",)


@pytest.mark.parametrize("place", ["street_gale", "park_gale", "market_gale", "yard_gale"])
def test_scenes_have_carts_targets_and_shelter(place: str) -> None:
    found = scene(f"{place}/07")
    kinds = [f.category for f in found.fixtures]
    assert kinds.count("cart") == 3 and len(found.targets) == 15
    assert {"house", "car", "hedge", "fence", "kiosk", "shed"} & set(kinds)


def test_wind_acts_on_the_robot_and_info_tells_what_is_kept() -> None:
    env = gym.make("HazardGale-v1", obs_mode="none", render_backend="none", control_mode="pd_joint_pos")
    env.reset(seed=3)
    base = env.unwrapped
    info = base.get_info()
    assert "agent_wind" in info and float(info["kept"][0]) == 1.0
    world, hazard = base.world, base.task.hazards[0]
    target = int(world.target[0].nonzero()[0])
    state = base.episode.states[hazard.name]
    state.place[0, target, 0] += 1.0  # as if it had been blown away from there
    total = float(torch.where(world.target, world.value, 0.0).sum())
    assert float(base.get_info()["kept"][0]) == pytest.approx(1.0 - float(world.value[0, target]) / total)
    env.close()


@pytest.mark.render
def test_what_lies_where_it_was_put_when_time_is_up_is_rescued() -> None:
    """Nobody acts, and the episode goes on after the agent has stopped: value is either rescued or lost."""
    options = EpisodeOptions("HazardGale-v1", agent="random", split="test", seed=25)
    result = play(options, player=Recorded((), "random"), max_episode_steps=200)
    assert result.frames == 0 and result.lost is not None and result.loads is not None
    assert result.lost.targets > 0.0
    assert result.tally.value_rescued + result.lost.targets == pytest.approx(result.tally.value_total)
    assert all(fate.frame == 0 for fate in result.targets if fate.rescued)


def test_carts_stand_in_a_bay() -> None:
    """Three in a row, 1.6 m from each other and 2 m from an edge (docs/benchmark.md 1.2)."""
    for name in splits.all_scene_names("gale")[::14]:
        places = np.array([cart.position[:2] for cart in splits.scene(name).containers])
        assert np.hypot(*np.diff(places, axis=0).T) == pytest.approx([1.6, 1.6], abs=1e-3), name
        edges = np.minimum(places, 16.0 - places)
        assert any(edges[:, axis] == pytest.approx(2.0, abs=1e-3) for axis in (0, 1)), name
