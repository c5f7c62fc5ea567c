"""Whatever is handed to an environment: it is taken, or refused with a ValueError that leaves the episode unchanged."""

from __future__ import annotations

import copy
import hashlib
import warnings
from collections.abc import Callable
from typing import Any

import gymnasium as gym
import numpy as np
import pytest
import torch
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import hazard_ms  # noqa: F401
from tests.worlds.episodes import feed

USUAL, LONG = 150, 5004  # examples of each family
MODE = "pd_ee_target_delta_pose"  # a target that goes on from the last one: what is not finite would stay
NUMPY_DTYPES = [*"?bBhHiIlLqQefdgFDGSUVOmM", ">f4", ">f8", ">i4", "M8[s]", [("a", "f4")]]
TORCH_DTYPES = sorted({v for v in vars(torch).values() if isinstance(v, torch.dtype)}, key=str)
QUIET: dict[str, Any] = dict(deadline=None, suppress_health_check=list(HealthCheck), database=None)
numbers = st.one_of(
    st.sampled_from([0.0, 1.0, -1.0, 1e300, -1e300, 3e38, 1e30, 2.0**63, np.nan, np.inf, -np.inf]),
    st.floats(-2.0, 2.0),
    st.floats(),
)


@pytest.fixture(scope="module")
def env() -> Any:
    made = gym.make("HazardFire-v1", obs_mode="state", render_backend="none", control_mode=MODE)
    made.reset(seed=0)
    for _ in range(3):
        made.step(None)
    yield made
    made.close()


def digest(env: Any) -> str:
    """All that `get_state_dict` tells, and the control mode."""
    made = hashlib.sha256(env.unwrapped.agent.control_mode.encode())
    feed(made, env.unwrapped.get_state_dict())
    return made.hexdigest()


def taken(env: Any, call: Callable[[], Any]) -> bool:
    """Whether `call` was accepted; if not, it raised a ValueError of ours and changed nothing."""
    before = digest(env)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            call()
    except ValueError as error:
        assert " must " in str(error), error
        assert digest(env) == before, error
        return False
    return True


def steps_soundly(env: Any, action: Any) -> None:
    obs, reward, _, _, info = env.step(action)
    assert bool(info["sim_error"]) or (bool(torch.isfinite(obs).all()) and bool(torch.isfinite(reward).all()))


def odd_array(value: float, shape: tuple[int, ...], dtype: Any) -> Any:
    with np.errstate(all="ignore"), warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            return np.full(shape, value).astype(dtype)
        except (TypeError, ValueError, OverflowError):
            return np.zeros(shape, dtype)


def odd_tensor(value: float, shape: tuple[int, ...], dtype: torch.dtype) -> Any:
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            return torch.full(shape, value, dtype=torch.float64).to(dtype)
    except (RuntimeError, TypeError, NotImplementedError):
        return torch.empty(shape, device="meta")


def odd_layout(kind: str, made: np.ndarray) -> Any:
    tensor = torch.from_numpy(np.ascontiguousarray(made))
    return {
        "sparse": lambda: tensor.to_sparse(),
        "meta": lambda: tensor.to("meta"),
        "nested": lambda: torch.nested.nested_tensor([tensor]),
        "grad": lambda: tensor.requires_grad_(),
        "masked": lambda: np.ma.array(made, mask=True),
        "backwards": lambda: made[::-1],
        "fortran": lambda: np.asfortranarray(made),
        "list": lambda: made.tolist(),
        "ragged": lambda: [[1.0], [2.0, 3.0]],
        "matrix": lambda: np.asmatrix(made),
        "huge": lambda: np.full(made.shape, 10**400, object),
        "read-only": lambda: np.frombuffer(made.tobytes()),
    }[kind]()


LAYOUTS = ("sparse", "meta", "nested", "grad", "masked", "backwards", "fortran", "list", "ragged", "matrix", "huge")


def actions(size: int) -> st.SearchStrategy[Any]:
    shapes = st.one_of(st.just((size,)), st.just((1, size)), st.lists(st.integers(0, 14), max_size=3).map(tuple))
    arrays = st.builds(odd_array, numbers, shapes, st.sampled_from(NUMPY_DTYPES))
    tensors = st.builds(odd_tensor, numbers, shapes, st.sampled_from(TORCH_DTYPES))
    plain = st.lists(numbers, min_size=size, max_size=size).map(np.array)
    strange = st.builds(odd_layout, st.sampled_from((*LAYOUTS, "read-only")), plain)
    junk = st.one_of(st.none(), st.booleans(), st.integers(), st.text(max_size=3), st.just(object()))
    return st.one_of(arrays, tensors, plain, strange, junk)


def try_actions(env: Any, examples: int) -> None:
    agent = env.unwrapped.agent
    modes = agent.supported_control_modes
    sizes = sorted({agent.action_size(mode) for mode in modes})

    @given(action=st.sampled_from(sizes).flatmap(actions), mode=st.one_of(st.none(), st.sampled_from([*modes, "fly"])))
    @settings(max_examples=examples, **QUIET)
    def one(action: Any, mode: str | None) -> None:
        if bool(env.unwrapped.episode.sim_error) or int(env.unwrapped.elapsed_steps) > 500:
            env.reset(seed=0)
        given_action = action if mode is None else {"control_mode": mode, "action": action}
        if taken(env, lambda: steps_soundly(env, given_action)):
            steps_soundly(env, None)

    one()


def test_actions_of_all_types(env: Any) -> None:
    env.reset(seed=0)
    try_actions(env, USUAL)


@pytest.mark.long
@pytest.mark.timeout(3600)
@pytest.mark.parametrize("robot", ["fetch", "g1"])
@pytest.mark.parametrize("task", ["HazardFire-v1", "HazardFlood-v1", "HazardWind-v1"])
def test_thousands_of_actions(task: str, robot: str) -> None:
    made = gym.make(task, obs_mode="state", render_backend="none", robot_uids=robot, affects_agent=True)
    made.reset(seed=0)
    try_actions(made, LONG // 6)
    made.close()


def entries(state: Any, path: tuple[str, ...] = ()) -> list[tuple[str, ...]]:
    """Paths of all parts of a nested state, leaves and dicts."""
    found = [path] if path else []
    if isinstance(state, dict):
        for name, entry in state.items():
            found += entries(entry, (*path, name))
    return found


def changed(state: dict[str, Any], path: tuple[str, ...], change: Callable[[Any], Any]) -> dict[str, Any]:
    made = dict(state)
    inner = state[path[0]]
    made[path[0]] = change(copy.deepcopy(inner)) if len(path) == 1 else changed(inner, path[1:], change)
    return made


def one_number(value: float, where: int) -> Callable[[Any], Any]:
    def change(entry: Any) -> Any:
        if isinstance(entry, dict) or entry.numel() == 0:
            return value
        flat = entry.double().flatten()
        flat[where % flat.numel()] = value
        return flat.reshape(entry.shape)

    return change


def all_of(value: float, dtype: Any) -> Callable[[Any], Any]:
    def change(entry: Any) -> Any:
        shape = (1, 3) if isinstance(entry, dict) else tuple(entry.shape)
        return odd_array(value, shape, dtype) if isinstance(dtype, str) else odd_tensor(value, shape, dtype)

    return change


def try_states(env: Any, examples: int) -> None:
    base = env.unwrapped
    saved, flat = base.get_state_dict(), base.get_state()
    odd = st.one_of(numbers, st.integers(-3, 500), st.sampled_from([1e8, -1e9, 2.0**40]))
    parts = entries(saved)
    shown = [p for p in parts if p[0] != "actors"] + [p for p in parts if p[0] == "actors"][:4]
    dtypes = [d for d in NUMPY_DTYPES if isinstance(d, str)] + TORCH_DTYPES
    single = st.builds(one_number, odd, st.integers(0, 10**6))
    whole = st.builds(all_of, numbers, st.sampled_from(dtypes))
    other = st.sampled_from([lambda e: None, lambda e: {}, lambda e: "x", lambda e: [], lambda e: {"more": e}])
    nested = st.builds(
        lambda path, change: changed(saved, path, change), st.sampled_from(shown), single | whole | other
    )
    calls = st.one_of(
        nested.map(lambda state: lambda: base.set_state_dict(state)),
        nested.map(lambda state: lambda: env.reset(options={"reset_to_env_states": {"env_states": state}})),
        (single | whole | other).map(lambda change: lambda: base.set_state(change(flat))),
    )

    @given(call=calls)
    @settings(max_examples=examples, **QUIET)
    def one(call: Callable[[], Any]) -> None:
        base.set_state_dict(saved)
        if taken(env, call):
            steps_soundly(env, None)
            steps_soundly(env, None)

    one()


@pytest.fixture(scope="module", params=["HazardFire-v1", "HazardFlood-v1", "HazardWind-v1"])
def quick(request: pytest.FixtureRequest) -> Any:
    """An environment whose resets do not build the scene again."""
    physics = "realistic" if request.param == "HazardFire-v1" else "paper"
    made = gym.make(
        request.param, obs_mode="state", render_backend="none", control_mode=MODE, deterministic=False, physics=physics
    )
    made.reset(seed=0)
    for _ in range(5):
        made.step(None)
    yield made
    made.close()


def test_states_with_any_part_changed(quick: Any) -> None:
    try_states(quick, USUAL // 3)


@pytest.mark.long
@pytest.mark.timeout(3600)
def test_thousands_of_states(quick: Any) -> None:
    try_states(quick, LONG // 3)
