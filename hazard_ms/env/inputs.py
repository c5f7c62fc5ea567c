"""Checks what users hand to a running environment, before anything changes in it."""

from __future__ import annotations

from typing import Any

import torch
from torch import Tensor

from hazard_ms.env import states
from hazard_ms.env.built import BuiltEnv
from hazard_ms.spec import checks
from hazard_ms.tasks.episode import snapshot

STATES = "reset_to_env_states"


def action(env: BuiltEnv, value: Any) -> Any:
    """The action `value` as the simulator takes it: see `checks.action`; of a team a dict of them by robot, or None.

    Raises ValueError for what it cannot take.
    """
    if len(env.robots) == 1:
        return _action(env, env.agent, value)
    if value is None:
        return None
    if not isinstance(value, dict) or set(value) != set(env.robots):
        got = sorted(map(str, value)) if isinstance(value, dict) else type(value).__name__
        raise ValueError(f"an action must be a dict with {', '.join(env.robots)}, got {got}")
    for name, one in value.items():
        if one is None or isinstance(one, dict):
            raise ValueError(f"the action of {name} must be an array of numbers, got {type(one).__name__}")
    return {name: _action(env, robot, value[name]) for name, robot in env.robots.items()}


def _action(env: BuiltEnv, robot: Any, value: Any) -> Any:
    return checks.action(value, env.num_envs, robot.control_mode, robot.action_size, robot.supported_control_modes)


def reset(env: BuiltEnv, seed: Any, options: Any) -> tuple[Any, dict[str, Any]]:
    """The `seed` and the `options` of a reset as the simulator takes them.

    Raises ValueError for what is not allowed.
    """
    seed = checks.seeds(seed, env.num_envs)
    options = checks.options(options, env.num_envs)
    rows = options.get("env_idx", torch.arange(env.num_envs)).to(env.device)
    if "env_idx" in options:
        options["env_idx"] = rows
    if "scene" in options:
        env.choice.names(options["scene"], [0] * env.num_envs)
    due = env.reconfiguration_freq != 0 and env._reconfig_counter == 0
    if len(rows) < env.num_envs and (due or options.get("reconfigure") or "scene" in options):
        raise ValueError(
            f"reset option 'env_idx' must name all {env.num_envs} environments when scenes are rebuilt, got {len(rows)}"
        )
    if STATES in options:
        options[STATES] = _to_reset_to(env, options, rows)
    return seed, options


def _to_reset_to(env: BuiltEnv, options: dict[str, Any], rows: Tensor) -> dict[str, Any]:
    """The option that resets the environments `rows`, [R], to saved states, checked."""
    given = options[STATES]
    if "scene" in options:
        raise ValueError(f"reset option 'scene' must not be given with {STATES!r}, which keeps the scene, got both")
    if not isinstance(given, dict) or "env_states" not in given or not {*given} <= {"env_states", "obs"}:
        got = sorted(map(str, given)) if isinstance(given, dict) else type(given).__name__
        raise ValueError(f"reset option {STATES!r} must be a dict with env_states, and obs if wanted, got {got}")
    made = {"env_states": state(env, given["env_states"], rows)}
    if given.get("obs") is not None:
        made["obs"] = states.alike(given["obs"], env._last_obs, len(rows), f"obs of reset option {STATES!r}")
    return made


def state(env: BuiltEnv, value: Any, rows: Tensor) -> dict[str, Any]:
    """The state `value`, nested or flat, for the environments `rows`, [R], as nested tensors, [R, N] each.

    Raises ValueError for a state of another environment or scene, and for numbers that no sound simulation has.
    """
    now = env.get_state_dict()
    if not isinstance(value, dict):
        value = snapshot.unflatten(checks.numbers(value, "the flat state", flags=True), now)
    return states.checked(value, now, env.episode, len(rows))
