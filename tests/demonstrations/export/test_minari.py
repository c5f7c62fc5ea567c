"""Exports for Minari: its own reader finds in them what was recorded, and makes the environment again."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import pytest

from hazard_ms.demonstrations.export import minari as exporter
from hazard_ms.demonstrations.export.source import Source
from tests.worlds.recorded import dataset, driven, frames_of

minari = pytest.importorskip("minari", reason="minari is not installed; the extra demos brings it")


def test_the_reader_of_minari_gives_what_was_recorded(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    name = exporter.write(Source(dataset(tmp_path / "recorded", obs="state")), tmp_path / "out")
    assert name == "hazard/fire/oracle-v0" and exporter.ROOT not in os.environ
    monkeypatch.setenv(exporter.ROOT, str(tmp_path / "out"))
    read = minari.load_dataset(name)
    assert (read.total_episodes, read.total_steps) == (2, 13)
    for number, episode in enumerate(read.iterate_episodes()):
        arrays = frames_of(number, (5, 8)[number], True)
        np.testing.assert_array_equal(episode.observations, arrays["obs"])
        for theirs, ours in (("actions", "action"), ("rewards", "reward"), ("terminations", "terminated")):
            np.testing.assert_array_equal(getattr(episode, theirs), arrays[ours])
        np.testing.assert_array_equal(episode.infos["success"], [False, *arrays["success"]])
    assert "targets" in read.storage.metadata["description"]


def test_observations_by_simulating_again_fit_the_environment(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    recorded = driven(tmp_path / "recorded")
    with pytest.raises(ValueError, match="obs must be state in the recording, got none; add --obs state"):
        exporter.write(Source(recorded), tmp_path / "out")
    name = exporter.write(Source(recorded, obs="state"), tmp_path / "out")
    monkeypatch.setenv(exporter.ROOT, str(tmp_path / "out"))
    read = minari.load_dataset(name)
    (episode,) = read.iterate_episodes()
    env = read.recover_environment(render_backend="none")
    try:
        obs, _ = env.reset(seed=4, options={"scene": episode_scene(recorded)})
        np.testing.assert_array_equal(episode.observations[0], obs)
        for frame, action in enumerate(episode.actions):
            np.testing.assert_array_equal(episode.observations[frame + 1], env.step(action)[0])
        assert env.observation_space == read.observation_space and env.action_space == read.action_space
    finally:
        env.close()


def episode_scene(recorded: Path) -> str:
    return next(iter(Source(recorded))).result.scene
