"""Checks the keywords that go on to ManiSkill, and adds to them what every hazard environment needs."""

from __future__ import annotations

import inspect
import os
from collections.abc import Callable, Iterable
from typing import Any

import torch
from mani_skill.envs.sapien_env import BaseEnv

from hazard_ms.machine.render_backend import backend
from hazard_ms.sensing.display import camera_settings
from hazard_ms.sensing.modes import check_obs_mode, check_renderer
from hazard_ms.spec import Task, checks
from hazard_ms.spec.registry.robots import robot_names, robot_uid

KNOWN = (*inspect.signature(BaseEnv.__init__).parameters,)[1:]
RENDER_MODES = ("human", "rgb_array", "sensors", "all")
REWARD_MODES = ("normalized_dense", "dense", "sparse", "none")
MOST_ENVS = 2**20  # environments of a batch: any larger number must be a mistake [-] [ours]
NEVER = 0  # reconfiguration_freq of a scene that stays


def check_names(given: Iterable[str], ours: Callable[..., None]) -> None:
    """Raise ValueError for keywords that neither `ours`, a constructor, nor ManiSkill's BaseEnv takes."""
    parameters = inspect.signature(ours).parameters.values()
    known = {*KNOWN, *(p.name for p in parameters if p.kind is p.KEYWORD_ONLY)} - {"task"}
    for name in given:
        checks.one_of(name, sorted(known), "a keyword of gym.make", shown=len(known))


def check_team(robot: Any, task: Task, given: dict[str, Any]) -> None:
    """Check that a team is asked for nothing in `task` that it cannot do yet, where `robot` names several.

    `given`: keywords for ManiSkill. Raises ValueError for the rest.
    """
    count = len(robot_names(robot))
    if count == 1:
        return
    if task.arrange is not None or task.doors_by_hand:
        raise ValueError(f"robot_uids must be one robot in {task.name}, which is practice for one robot, got {count}")
    if given.get("num_envs", 1) != 1 or given.get("sim_backend", "auto") not in ("auto", "cpu", "physx_cpu"):
        raise ValueError(f"num_envs must be 1 and sim_backend cpu for {count} robots, got {given}")


def modes_offered(draws: bool) -> list[str]:
    """The render modes that are possible here: none where nothing `draws`, and a window only on a display."""
    return [mode for mode in RENDER_MODES if draws and (mode != "human" or os.environ.get("DISPLAY"))]


def for_maniskill(given: dict[str, Any], robot: Any, effects: str, deterministic: bool) -> dict[str, Any]:
    """Keywords of ManiSkill's BaseEnv, from those that were `given`, complete and checked.

    Raises ValueError for names and numbers that are not allowed.
    """
    if torch.get_default_dtype() != torch.float32:
        raise ValueError(f"torch's default dtype must be torch.float32, got {torch.get_default_dtype()}")
    num_envs = checks.whole(given.get("num_envs", 1), 1, MOST_ENVS, "num_envs")
    sim, render = given.get("sim_backend", "auto"), given.get("render_backend", "auto")
    checks.backends(num_envs, sim, render)
    checks.one_of(given.get("reward_mode") or "none", REWARD_MODES, "reward_mode")
    checks.render_mode(given.get("render_mode"), RENDER_MODES, os.environ.get("DISPLAY"))
    checks.cameras(given.get("sensor_configs"))
    if given.get("obs_mode") is not None:
        check_obs_mode(given["obs_mode"])
    chosen = backend() if render == "auto" else render
    check_renderer(given.get("obs_mode"), chosen)
    cameras = camera_settings(given, effects if chosen not in ("none", None) else None, num_envs, sim)
    often = given.get("reconfiguration_freq")
    if often is None:  # only an environment that is rebuilt for every episode is bit-exact (measured)
        often = 1 if deterministic and num_envs == 1 else NEVER
    return {
        **given,
        **cameras,
        "num_envs": num_envs,
        "sim_backend": sim,
        "render_backend": chosen,
        "sim_config": given.get("sim_config") or {},
        "robot_uids": robot_uid(robot),
        "reconfiguration_freq": checks.whole(often, 0, 2**31, "reconfiguration_freq"),
        "enhanced_determinism": True,
    }
