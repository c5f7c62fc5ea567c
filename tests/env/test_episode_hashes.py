"""Episodes are bit for bit what they were when `episode_hashes.json` was recorded: no change goes unnoticed."""

from __future__ import annotations

import json

import gymnasium as gym
import pytest

from tests.env.episode_hashes import PRESETS, RECORD, SEEDS, STEPS, TASKS, episode_hash, hashes, key, machine, recorded

record = json.loads(RECORD.read_text())


@pytest.mark.skipif(
    record["machine"] != machine(), reason="recorded with other packages, or on a processor without AVX2"
)
@pytest.mark.parametrize("physics", PRESETS)
@pytest.mark.parametrize("env_id", TASKS)
def test_episodes_are_what_they_were(env_id: str, physics: str, pytestconfig: pytest.Config) -> None:
    seeds = SEEDS if pytestconfig.getoption("--long") else SEEDS[:1]
    expected = recorded(env_id, physics)
    assert hashes(env_id, physics, seeds) == {str(seed): expected[str(seed)] for seed in seeds}


def test_a_hash_notices_one_millimetre() -> None:
    env = gym.make(TASKS[0], obs_mode="none", render_backend="none", control_mode="pd_joint_pos")
    plain = episode_hash(env, 0, 2)
    assert plain == episode_hash(env, 0, 2)
    world = env.unwrapped.world
    env.reset(seed=0)
    read = type(world).read

    def moved(self) -> None:  # noqa: ANN001
        read(self)
        self.position[0, 0, 0] += 1e-3

    type(world).read = moved
    try:
        assert episode_hash(env, 0, 2) != plain
    finally:
        type(world).read = read
        env.close()


def test_the_record_holds_every_case() -> None:
    assert set(record["hashes"]) == {key(e, p) for e in TASKS for p in PRESETS}
    assert all(set(row) == {str(s) for s in SEEDS} for row in record["hashes"].values())
    assert STEPS == 300
