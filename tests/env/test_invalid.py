"""Hundreds of invalid inputs: each gives an error that names the value and what is allowed; none harms the episode."""

from __future__ import annotations

import string
from typing import Any

import gymnasium as gym
import numpy as np
import pytest
import torch
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import hazard_ms  # noqa: F401
from tests.worlds.episodes import feed

EXAMPLES = 150  # of each of the three families below
SETTINGS = settings(max_examples=EXAMPLES, deadline=None, suppress_health_check=list(HealthCheck), database=None)
ALLOWED = ("allowed", "there are", "needs", "must")  # how our errors say what would have been right

words = st.text(string.ascii_letters + string.digits + "/_-. \0é", max_size=30)
junk = st.one_of(
    st.none(), st.booleans(), st.floats(), st.binary(max_size=4), st.lists(st.integers(), max_size=2), words
)


@pytest.fixture(scope="module")
def env() -> Any:
    made = gym.make("HazardFire-v1", obs_mode="state", render_backend="none")
    made.reset(seed=0)
    yield made
    made.close()


def bad_numbers(shape: tuple[int, ...]) -> st.SearchStrategy[np.ndarray]:
    return st.tuples(st.integers(0, shape[0] - 1), st.sampled_from([np.nan, np.inf, -np.inf])).map(
        lambda at: np.where(np.arange(shape[0]) == at[0], at[1], 0.0).astype(np.float32)
    )


def told(error: pytest.ExceptionInfo[ValueError]) -> None:
    assert any(word in str(error.value) for word in ALLOWED), str(error.value)


@given(data=st.data())
@SETTINGS
def test_actions(env: Any, data: st.DataObject) -> None:
    shape = env.unwrapped.single_action_space.shape
    wrong_size = (
        st.lists(st.integers(0, 20), min_size=0, max_size=3)
        .filter(lambda s: tuple(s) not in (shape, (1, *shape)))
        .map(np.zeros)
    )
    wrong_type = st.one_of(
        st.booleans(), st.integers(), st.floats(), words, st.lists(st.floats(), max_size=3), st.binary(max_size=3)
    )
    wrong_dtype = st.sampled_from(
        [np.zeros(shape, bool), np.zeros(shape, complex), torch.zeros(shape, dtype=torch.bool)]
    )
    bad = data.draw(st.one_of(bad_numbers(shape), wrong_size, wrong_type, wrong_dtype))
    before = env.unwrapped.world.frame.clone()
    with pytest.raises(ValueError) as error:
        env.step(bad)
    told(error)
    assert torch.equal(before, env.unwrapped.world.frame)


@given(data=st.data())
@SETTINGS
def test_resets(env: Any, data: st.DataObject) -> None:
    bad_seed = st.one_of(
        st.integers(max_value=-1),
        st.integers(min_value=2**32),
        st.floats(),
        st.booleans(),
        words,
        st.just([]),
        st.just([1, 2, 3]),
    )
    bad_option = st.one_of(
        st.dictionaries(
            words.filter(lambda w: w not in ("scene", "reconfigure", "env_idx", "reset_to_env_states")),
            junk,
            min_size=1,
        ),
        st.fixed_dictionaries({"scene": st.one_of(words, st.integers(), st.lists(words, max_size=2), st.none())}),
        st.fixed_dictionaries({"reconfigure": st.one_of(st.integers(), words, st.none())}),
        st.fixed_dictionaries({"env_idx": st.lists(st.integers().filter(lambda i: i != 0), min_size=1, max_size=3)}),
        words,
        st.integers(),
    )
    keywords = data.draw(st.one_of(bad_seed.map(lambda s: {"seed": s}), bad_option.map(lambda o: {"options": o})))
    with pytest.raises(ValueError) as error:
        env.unwrapped.reset(**keywords)
    told(error)


@given(data=st.data())
@SETTINGS
def test_keywords(data: st.DataObject) -> None:
    name = data.draw(
        st.sampled_from(
            [
                "physics",
                "split",
                "robot_uids",
                "effects",
                "sim_backend",
                "render_mode",
                "num_envs",
                "affects_agent",
                "deterministic",
                "obs_mode",
            ]
        )
    )
    if name == "num_envs":
        value = data.draw(st.one_of(st.integers(max_value=0), st.floats(), st.booleans(), words))
    elif name in ("affects_agent", "deterministic"):
        value = data.draw(
            st.one_of(st.integers(), words, st.floats(), *([st.none()] if name == "deterministic" else []))
        )
    else:
        value = data.draw(st.one_of(st.just(""), words.map(lambda w: w + "é")))  # no name of anything ends so
    with pytest.raises(ValueError) as error:
        gym.make("HazardFire-v1", render_backend="none", **{name: value})
    told(error)
    if isinstance(value, str) and value:
        assert repr(value) in str(error.value) or value.split("+")[0] in str(error.value)


def test_what_float32_cannot_hold_is_no_action(env: Any) -> None:
    for size in (1e300, -1e39, np.inf, np.nan):
        for kind in (np.float64, np.longdouble):
            with pytest.raises(ValueError, match="action must hold numbers that are finite in float32, got"):
                env.step(np.full(env.unwrapped.single_action_space.shape, size, kind))
    env.step(np.full(env.unwrapped.single_action_space.shape, 1e30))


def test_an_action_for_another_control_mode_that_is_refused_leaves_the_mode(env: Any) -> None:
    """The length of its actions is known before the mode is changed; afterwards it, and no other, is right."""
    env.reset(seed=1)
    agent = env.unwrapped.agent
    start, sizes = agent.control_mode, {"pd_joint_vel": 13, "pd_joint_pos_vel": 20, "pd_ee_delta_pos": 9}
    for mode, size in sizes.items():
        for wrong in (np.zeros((1, size + 1)), np.zeros((2, size)), np.full((1, size), np.nan), "forward", None):
            with pytest.raises(ValueError):
                env.step({"control_mode": mode, "action": wrong})
            assert agent.control_mode == start
        env.step({"control_mode": mode, "action": np.zeros((1, size))})
        assert agent.control_mode == mode
        env.step(np.zeros(size))
        with pytest.raises(ValueError, match=f"in control mode '{mode}', got"):
            env.step(np.zeros(size + 1))
        env.step({"control_mode": start, "action": np.zeros((1, agent.action_size(start)))})


def test_a_mode_that_was_left_and_taken_up_again_drives_as_before(env: Any) -> None:
    """Each mode has its own stiffness: ManiSkill sets it only once."""
    env.reset(seed=1)
    agent = env.unwrapped.agent

    def drive() -> list[float]:
        return [float(joint.stiffness[0]) for joint in agent.robot.active_joints[3:]]

    start, before = agent.control_mode, drive()
    env.step({"control_mode": "pd_joint_vel", "action": np.zeros((1, agent.action_size("pd_joint_vel")))})
    assert drive() != before
    env.step({"control_mode": start, "action": np.zeros((1, agent.action_size(start)))})
    assert drive() == before


def test_a_seed_in_an_array_without_axes_is_that_seed(env: Any) -> None:
    env.unwrapped.reset(seed=np.array(3))
    assert int(env.unwrapped.world.chance.seed[0]) == 3
    for bad in (np.array(3.0), np.array(-1), np.array("3"), np.array(True), torch.tensor(3)):
        with pytest.raises(ValueError, match="seed must be a whole number from 0"):
            env.unwrapped.reset(seed=bad)


def test_a_reset_to_a_state_keeps_the_scene_and_refuses_what_is_none(env: Any) -> None:
    env.reset(seed=4)
    base = env.unwrapped
    for _ in range(10):
        env.step(None)
    saved, scene = base.get_state_dict(), base.specs[0].name
    for _ in range(3):
        env.step(None)
    want = base.get_state_dict()["hazard_ms"]["fire"]
    for junk in (None, 3, {}, {"env_states": None}, {"env_states": {}}, {"env_states": saved, "more": 1}):
        with pytest.raises(ValueError):
            env.reset(options={"reset_to_env_states": junk})
    for more in ({"obs": 3}, {"obs": torch.zeros(1, 2)}):
        with pytest.raises(ValueError, match="obs of reset option 'reset_to_env_states' must"):
            env.reset(options={"reset_to_env_states": {"env_states": saved, **more}})
    with pytest.raises(ValueError, match="reset option 'scene' must not be given with"):
        env.reset(options={"reset_to_env_states": {"env_states": saved}, "scene": "kitchen_a/07"})
    assert base.specs[0].name == scene and int(base.elapsed_steps) == 13
    for state in (saved, base.get_state()):
        base.set_state_dict(saved)
        env.reset(options={"reset_to_env_states": {"env_states": state}})
        assert base.specs[0].name == scene
    env.reset(options={"reset_to_env_states": {"env_states": saved}})
    for _ in range(3):
        env.step(None)
    for name, value in base.get_state_dict()["hazard_ms"]["fire"].items():
        assert torch.allclose(value.double(), want[name].double(), atol=1e-3), name


def test_an_episode_goes_on_as_if_nothing_had_happened(env: Any) -> None:
    """The same frames with and without invalid calls in between give the same bits."""
    import hashlib

    def play(disturb: bool) -> str:
        digest = hashlib.sha256()
        env.reset(seed=8)
        for _ in range(10):
            if disturb:
                for bad in (np.full(env.unwrapped.single_action_space.shape, np.nan), np.zeros(3), "forward"):
                    with pytest.raises(ValueError):
                        env.step(bad)
                for keywords in ({"seed": -1}, {"options": {"scene": "nowhere"}}):
                    with pytest.raises(ValueError):
                        env.reset(**keywords)
            feed(digest, env.step(None)[0])
        return digest.hexdigest()

    assert play(False) == play(True)
