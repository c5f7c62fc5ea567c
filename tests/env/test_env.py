"""The environment as users meet it: gymnasium's checker, ManiSkill's wrappers, control modes, one frame's order."""

from __future__ import annotations

import warnings
from pathlib import Path
from typing import Any

import gymnasium as gym
import numpy as np
import pytest
import torch
from gymnasium.utils.env_checker import check_env

import hazard_ms  # noqa: F401
from hazard_ms import NumpyEnv
from tests.worlds.registering import registered_task

ALLOWED_WARNINGS = (  # each with its reason
    "A Box observation space minimum value is -infinity",  # joint velocities have no bound
    "A Box observation space maximum value is infinity",
    # absolute joint angles have their own limits
    "For Box action spaces, we recommend using a symmetric and normalized space",
    # NumpyEnv is a wrapper: the raw environment is batched, as ManiSkill's are
    "is different from the unwrapped version",
)


@pytest.fixture(scope="module")
def env() -> Any:
    made = gym.make("HazardFire-v1", obs_mode="state", render_backend="none")
    yield made
    made.close()


def test_gym_make_gives_batched_torch(env: Any) -> None:
    obs, info = env.reset(seed=0)
    assert isinstance(obs, torch.Tensor) and obs.shape == env.observation_space.shape == (1, obs.shape[1])
    obs, reward, terminated, truncated, info = env.step(env.action_space.sample())
    for value in (reward, terminated, truncated, info["success"], info["fail"], info["sim_error"]):
        assert isinstance(value, torch.Tensor) and value.shape == (1,)
    assert env.spec.max_episode_steps == 1500
    assert not bool(info["success"]) and not bool(terminated)


@pytest.mark.long  # test_learners.py asks the same checker and one more about states
@pytest.mark.parametrize("mode", ["state", pytest.param("rgb+depth+segmentation", marks=pytest.mark.render)])
def test_check_env_has_nothing_to_say(mode: str) -> None:
    made = NumpyEnv(gym.make("HazardFire-v1", obs_mode=mode, render_backend="none" if mode == "state" else "auto"))
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        check_env(made, skip_render_check=mode == "state")
    said = [str(w.message) for w in caught]
    unlisted = [
        s for s in said if "gymnasium" in s or "Box" in s or "WARN" in s if not any(a in s for a in ALLOWED_WARNINGS)
    ]
    assert unlisted == []
    made.close()


def test_each_target_of_the_table_has_an_id_in_pictures() -> None:
    """The renderer's own entity of that id stands where the table says the target is; absent targets have the id 0."""
    env = gym.make("HazardFire-v1", obs_mode="state_dict", render_backend="none")
    obs, _ = env.reset(seed=0)
    base: Any = env.unwrapped
    ids, places = base.target_ids(), obs["extra"]["target_position"].reshape(-1, 3)
    entities = {e.per_scene_id: e for e in base.scene.sub_scenes[0].entities}
    count = int((obs["extra"]["target_value"] > 0.0).sum())
    assert len(ids) == len(places) and 0 < count == len(set(ids[:count])) and set(ids[count:]) == {0}
    for number, place in zip(ids[:count], places, strict=False):
        entity, (name, category) = entities[number], base.label_table()[number]
        assert entity.name.endswith(name) and (name, category) in {(t.name, t.category) for t in base.specs[0].targets}
        assert np.linalg.norm(entity.pose.p[:2] - place[:2].numpy()) < 0.1
    env.close()


def test_observations_share_no_memory() -> None:
    made = NumpyEnv(gym.make("HazardFire-v1", obs_mode="state_dict", render_backend="none"))
    first, _ = made.reset(seed=0)
    before = first["extra"]["frame"].copy(), first["agent"]["qpos"].copy()
    made.step(made.action_space.sample())
    assert np.array_equal(first["extra"]["frame"], before[0]) and np.array_equal(first["agent"]["qpos"], before[1])
    made.close()


def test_time_limit_truncates_at_the_users_limit() -> None:
    made = gym.make("HazardFire-v1", obs_mode="state", render_backend="none", max_episode_steps=5)
    made.reset(seed=0)
    flags = [bool(made.step(None)[3]) for _ in range(5)]
    assert flags == [False, False, False, False, True]
    made.close()


@pytest.mark.parametrize(
    ("keywords", "frames"),
    [({}, 4), ({"split": "hard"}, 2), ({"split": "hard", "max_episode_steps": 3}, 3)],
    ids=["usual", "shorter", "asked for"],
)
def test_a_split_may_be_shorter_than_its_task(keywords: dict[str, Any], frames: int) -> None:
    with registered_task("HazardShort-v1", "hazard_ms.tasks.fire:hazard_fire", 4, {"hard": 2}) as name:
        made: Any = gym.make(name, obs_mode="state", render_backend="none", **keywords)
        assert made.spec.max_episode_steps == frames
        assert made.unwrapped.task.max_frames == (2 if keywords else 4)
        again: Any = gym.make(made.spec)
        for env in (made, again):
            env.reset(seed=0)
            assert [bool(env.step(None)[3]) for _ in range(frames)] == [*([False] * (frames - 1)), True]
            env.close()


def test_maniskill_wrappers(tmp_path: Path) -> None:
    from mani_skill.utils.wrappers.gymnasium import CPUGymWrapper
    from mani_skill.utils.wrappers.record import RecordEpisode
    from mani_skill.vector.wrappers.gymnasium import ManiSkillVectorEnv

    plain = CPUGymWrapper(gym.make("HazardFire-v1", obs_mode="state", render_backend="none"))
    obs, _ = plain.reset(seed=0)
    assert isinstance(obs, np.ndarray) and plain.observation_space.contains(obs)
    assert plain.observation_space.contains(plain.step(plain.action_space.sample())[0])
    plain.close()

    made = gym.make("HazardFire-v1", obs_mode="state", render_backend="none")
    recorded = RecordEpisode(made, str(tmp_path), save_video=False, trajectory_name="trajectory")
    recorded.reset(seed=4)
    for _ in range(3):
        recorded.step(recorded.action_space.sample())
    recorded.close()
    import h5py

    with h5py.File(tmp_path / "trajectory.h5") as file:
        assert file["traj_0/actions"].shape == (3, *made.unwrapped.single_action_space.shape)
        assert "hazard_ms" in file["traj_0/env_states"]

    vector = ManiSkillVectorEnv(gym.make("HazardFire-v1", obs_mode="state", render_backend="none", max_episode_steps=3))
    vector.reset(seed=0)
    outs = [vector.step(vector.action_space.sample()) for _ in range(4)]
    assert bool(outs[2][3]) and "final_info" in outs[2][4]
    vector.close()


def test_every_control_mode_that_is_offered_steps() -> None:
    from mani_skill.agents.robots.fetch import Fetch

    made = gym.make("HazardFire-v1", obs_mode="state", render_backend="none", deterministic=False)
    agent = made.unwrapped.agent
    stock = next(iter(Fetch._controller_configs.fget(agent)))
    assert agent.control_mode == stock == agent.supported_control_modes[0]  # starts as ManiSkill's own does
    assert {"pd_joint_pos", "pd_ee_delta_pose", "pd_joint_vel"} <= set(agent.supported_control_modes)
    for mode in agent.supported_control_modes:
        made.reset(seed=0)
        agent.set_control_mode(mode)
        agent.controller.reset()
        space = agent.single_action_space
        space.seed(0)
        for _ in range(3):
            obs, *_ = made.step({"control_mode": mode, "action": space.sample()[None]})
        assert torch.isfinite(obs).all(), mode
        with pytest.raises(ValueError, match=f"must have shape .* in control mode {mode!r}, got"):
            made.step({"control_mode": mode, "action": space.sample()[:-1]})
        assert len(agent.robot.get_qpos()[0]) == 15 and torch.isfinite(agent.robot.get_qvel()).all(), mode
    made.close()


def test_order_of_one_frame(env: Any) -> None:
    """As the docstring of HazardEnv publishes it."""
    env.reset(seed=1)
    base, calls = env.unwrapped, []

    def spy(owner: Any, method: str, label: str) -> None:
        plain = getattr(owner, method)

        def call(*args: Any, **kwargs: Any) -> Any:
            calls.append(label)
            return plain(*args, **kwargs)

        object.__setattr__(owner, method, call)

    hazard = base.task.hazards[0]
    for owner, method, label in (
        (base.agent, "set_action", "action"),
        (base.scene, "step", "physics"),
        (base.world, "read", "read"),
        (base.world.chance, "tick", "tick"),
        (hazard, "advance", "advance"),
        (base.episode.damage, "add", "damage"),
        (base.episode, "use_hand", "hand"),
        (base, "get_info", "info"),
        (base, "get_obs", "observe"),
        (base, "get_reward", "reward"),
    ):
        spy(owner, method, label)
    env.step(np.zeros(base.single_action_space.shape, np.float32))
    ends = ["read", "tick", "advance", "damage", "hand", "info", "observe", "reward"]
    assert calls == ["action", *["physics"] * 4, *ends]
    del hazard.__dict__["advance"]


def test_a_broken_simulation_ends_the_episode(env: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("HAZARD_MS_DUMPS", str(tmp_path))
    env.reset(seed=0)
    body = env.unwrapped.world.handles.bodies[0]
    body.linear_velocity = [0.0, 0.0, 900.0]
    _, reward, terminated, truncated, info = env.step(None)
    assert bool(info["sim_error"]) and bool(truncated) and not bool(terminated) and float(reward) == 0.0
    assert len(list(tmp_path.glob("*sim_error*.json"))) == 1
    _, info = env.reset(seed=0)
    assert not bool(info["sim_error"])


def test_nothing_of_the_last_episode_is_left(env: Any) -> None:
    """A violent episode, then a reset: the world is as it was after the first reset of this seed."""
    env.reset(seed=2)
    base = env.unwrapped
    first = {k: v.clone() for k, v in vars(base.world).items() if isinstance(v, torch.Tensor)}
    fire = base.episode.states["fire"].save()
    for _ in range(30):
        env.step(env.action_space.sample())
    base.episode.states["fire"].temperature[:] = 500.0
    env.reset(seed=2)
    for name, want in first.items():
        assert torch.equal(getattr(base.world, name), want), name
    for name, want in fire.items():
        assert torch.equal(getattr(base.episode.states["fire"], name), want), name
