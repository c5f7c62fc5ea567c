"""All that a learner exchanges with a live environment, number by number: observation, action, reward and info."""

from __future__ import annotations

import inspect
from collections.abc import Iterator
from typing import Any

import numpy as np
from mani_skill.agents.controllers import (
    PDBaseForwardVelController,
    PDBaseVelController,
    PDEEPosController,
    PDJointPosController,
    PDJointPosVelController,
    PDJointVelController,
)

from hazard_ms.env.hazard_env import HazardEnv
from hazard_ms.robots.direct import DIRECT
from hazard_ms.sensing.observation_table import INF, Row, joint_units
from hazard_ms.tasks import task_of

REWARDS = {
    "normalized_dense": "the dense reward over the largest one of a frame",
    "dense": "hints on the way, and rescues",
    "sparse": "rescues alone",
    "none": "always 0",
}
INFO = {  # beside the entries of the task's goal and of its hazards
    "elapsed_steps": Row("elapsed_steps", (), "int32", "frame", "", 0.0, INF, "frames since the start of the episode"),
    "success": Row("success", (), "bool", "", "", 0.0, 1.0, "the goal is achieved; terminates the episode"),
    "fail": Row("fail", (), "bool", "", "", 0.0, 1.0, "it can no longer be achieved; terminates the episode"),
    "sim_error": Row("sim_error", (), "bool", "", "", 0.0, 1.0, "the simulation broke; truncates the episode"),
}
HAND = ("x", "y", "z", "turn about x", "turn about y", "turn about z")
RIGID = ("m", "m", "m", "rad", "rad", "rad")


def describe(env: HazardEnv) -> dict[str, list[Row]]:
    """Rows of observation, action, reward and info of an environment after a reset, by section."""
    state = env._get_obs_state_dict({})
    return {
        "observation": list(env.observation_table.rows(env._init_raw_obs, state)),
        "action": list(actions(env)),
        "reward": list(reward(env)),
        "info": list(info(env)),
    }


def ranges(task: str) -> list[tuple[float, float]]:
    """Ends of the scales of a task's hazards, in their units. Raises ValueError for an unknown task."""
    return [(hazard.level.low, hazard.level.high) for hazard in task_of(task, "paper").hazards]


def actions(env: HazardEnv) -> Iterator[Row]:
    """One row for each controller of the control mode, with the numbers that it takes."""
    controller, space = env.agent.controller, env.agent.single_action_space
    for name, (start, end) in controller.action_mapping.items():
        if end == start:
            continue
        part = controller.controllers[name]
        text, unit, entries = _controller(part, end - start)
        bounds = tuple(space.low[start:end].tolist()), tuple(space.high[start:end].tolist())
        if part.config.normalize_action:
            low, high = (np.broadcast_to(b, end - start) for b in (part.action_space_low, part.action_space_high))
            pairs = dict.fromkeys(f"{float(a):.4g} to {float(b):.4g}" for a, b in zip(low, high, strict=True))
            text += "; -1 to 1 stand for " + ", ".join(pairs)
        yield Row(f"[{start}:{end}] {name}", (end - start,), str(space.dtype), unit, "", *bounds, text, entries)


def _controller(part: Any, size: int) -> tuple[str, str, tuple[str, ...]]:
    """What a controller takes: in words, its unit, and the names of the numbers."""
    joints = tuple(joint.name for joint in part.joints)
    units = joint_units(part.joints)
    rates = units.replace("m", "m/s").replace("rad", "rad/s")
    if isinstance(part, PDBaseForwardVelController):
        return "velocity ahead and about the vertical axis", "m/s, rad/s", ("forward", "turn")
    if isinstance(part, PDBaseVelController):
        return "velocity in the base's own frame", "m/s, m/s, rad/s", ("forward", "left", "turn")
    if isinstance(part, PDEEPosController):
        change = "change of the hand's place" if part.config.use_delta else "place of the hand"
        return f"{change}, frame {part.config.frame}", ", ".join(RIGID[:size]), HAND[:size]
    if type(part).__module__.startswith("hazard_ms.") and type(part) not in DIRECT.values():
        return inspect.getdoc(type(part)).splitlines()[0].rstrip("."), "", ()  # type: ignore[union-attr]
    if isinstance(part, PDJointPosVelController):
        return "position, then velocity of each joint", f"{units}, {rates}", joints + joints
    if isinstance(part, PDJointVelController):
        return "velocity of each joint", rates, joints
    if isinstance(part, PDJointPosController):
        change = "change of each joint's position" if part.config.use_delta else "position of each joint"
        return change, units, joints[:size]
    return (inspect.getdoc(type(part)) or "").split("\n")[0], "", ()


def reward(env: HazardEnv) -> Iterator[Row]:
    """One row for each reward mode; `env` has one of them."""
    for mode, text in REWARDS.items():
        function = {"dense": env.task.goal.dense, "sparse": env.task.goal.sparse}.get(mode)
        first = (inspect.getdoc(function) or "").split("\n")[0].replace(", [E]", "") if callable(function) else ""
        more = f": {first}" if first else ""
        if mode == "normalized_dense":
            more = f", {env.task.goal.largest:g}"
        chosen = " (in use)" if mode == env.reward_mode else ""
        low = {"dense": env.task.goal.least, "normalized_dense": env.task.goal.least / env.task.goal.largest}
        high = 0.0 if mode == "none" else INF
        yield Row(f"{mode}{chosen}", (), "float32", "", "", low.get(mode, 0.0), high, text + more)


def info(env: HazardEnv) -> Iterator[Row]:
    """One row for each key of info, [E] each."""
    told = {f"{term.name}": term for term in env.task.goal.info}
    quantities = {key: what for hazard in env.task.hazards for key, what in hazard.tells.items()}
    for key, value in env.get_info().items():
        dtype = str(value.dtype).removeprefix("torch.")
        if key in INFO:
            yield INFO[key]
        elif key in told:
            term = told[key]
            yield Row(key, term.shape, dtype, term.unit, term.frame, term.low, term.high, term.meaning, term.entries)
        elif key in quantities:
            what = quantities[key]
            yield Row(key, (), dtype, what.unit, "", what.low, what.high, what.meaning)
        else:
            yield Row(key, tuple(value.shape[1:]), dtype, "", "", -INF, INF, "")
