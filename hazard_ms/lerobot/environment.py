"""`HazardRobot-v1`: one of our tasks as policies that drive robots know environments, with LeRobot's names.

A step is one frame, or `every` frames with the same action. Observations are not batched, and made of numpy arrays:

| key | |
|---|---|
| `pixels` | `head`: the picture of the head camera, [H, W, 3], uint8, as recordings have it, and those of `cameras` |
| `agent_pos` | [S], world frame: joints [rad, m], their velocities, base x, y [m], heading [rad], hand x, y, z [m], |
| | and 1 if it holds something, else 0: `observation.state` of exported demonstrations |

Actions are those of the robot's control mode, [A], `action` of exported demonstrations.
"""

from __future__ import annotations

from typing import Any

import gymnasium as gym
import numpy as np
from numpy.typing import NDArray

from hazard_ms.env.hazard_env import HazardEnv
from hazard_ms.spec.checks import one_of, whole
from hazard_ms.spec.registry.robots import skill_control_mode

HEAD = "head"
RENDER_MODES = ("rgb_array",)
LEAST_SIDE, MOST_SIDE = 16, 1024  # of pictures [pixels] [ours]
MOST_EVERY = 30  # frames of a step: one second [ours]
OURS = ("obs_mode", "num_envs", "sensor_configs")  # keywords that are decided here
Observation = dict[str, Any]
Info = dict[str, Any]


class RobotEnv(gym.Env[Observation, NDArray[np.float32]]):
    """A task in which a policy drives the robot."""

    metadata = {"render_modes": list(RENDER_MODES), "render_fps": 30}  # noqa: RUF012 gymnasium's name and type

    def __init__(
        self,
        *,
        task: str = "HazardFire-v1",
        side: int = 256,
        every: int = 1,
        render_mode: str | None = "rgb_array",
        robot_uids: str = "fetch",
        control_mode: str | None = None,
        max_frames: int | None = None,
        **settings: Any,
    ) -> None:
        """Make the environment of a task.

        Args:
            task: Name of the task, as gym.make has it: those of practice are hazard_ms.tasks.practice:HazardPickUp-v1.
            side: Width and height of pictures [pixels].
            every: Frames that a step lasts.
            render_mode: "rgb_array", with which `render` takes a picture in third person, or None.
            robot_uids: The robot.
            control_mode: What an action means; None: as in demonstrations.
            max_frames: Greatest length of an episode [frames]; None takes that of the task. (With gymnasium's own
                max_episode_steps a wrapper would hide the task's sentence from LeRobot.)
            **settings: Other keywords of the task's environment (split, scenes, physics, cameras, perturb, ...).

        Raises:
            ValueError: For unknown names, numbers out of range, and where nothing renders.
        """
        if render_mode is not None:
            one_of(render_mode, RENDER_MODES, "render_mode")
        for name in OURS:
            if name in settings:
                raise ValueError(f"{name} must not be given, because {__name__} decides it, got {settings[name]!r}")
        if max_frames is not None:
            settings["max_episode_steps"] = whole(max_frames, 1, 2**31, "max_frames")
        whole(side, LEAST_SIDE, MOST_SIDE, "side")
        self.render_mode, self._every = render_mode, whole(every, 1, MOST_EVERY, "every")
        self.env = gym.make(
            task if ":" in task else f"hazard_ms:{task}",
            obs_mode="none",
            render_mode=render_mode,
            robot_uids=robot_uids,
            control_mode=control_mode or skill_control_mode(robot_uids),
            sensor_configs={"width": side, "height": side},
            **settings,
        )
        base = self.env.unwrapped
        if not isinstance(base, HazardEnv):
            self.env.close()
            raise ValueError(f"task must be a task of hazard_ms, got {task!r}")
        if not base.observer.renders:
            self.env.close()
            raise ValueError(
                "render_backend must be a renderer, got none: policies need pictures (see `hazard-ms doctor`)"
            )
        self._base = base
        self.metadata = {**self.metadata, "render_fps": round(base.control_freq / self._every)}
        self.action_space = self.env.get_wrapper_attr("single_action_space")
        state = gym.spaces.Box(-np.inf, np.inf, self._state().shape, np.float32)
        picture = gym.spaces.Box(0, 255, (side, side, 3), np.uint8)
        pixels = gym.spaces.Dict(dict.fromkeys((HEAD, *base.cameras), picture))
        self.observation_space = gym.spaces.Dict({"pixels": pixels, "agent_pos": state})

    @property
    def task_description(self) -> str:
        """The sentence that demonstrations have as their task."""
        return self._base.task_description

    @property
    def task(self) -> str:
        """The same sentence by LeRobot's other name."""
        return self.task_description

    @property
    def _max_episode_steps(self) -> int:
        """Steps of an episode at most."""
        limit = self.env.get_wrapper_attr("_max_episode_steps")
        return -(-int(limit or self._base.task.max_frames) // self._every)

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Observation, dict[str, Any]]:
        """Start the episode of `seed`; without one, the next of the series that the last seed began.

        `options` are those of the task's own environment ({"scene": name}); LeRobot's own are left alone.

        Raises ValueError for seeds and options that are not allowed.
        """
        super().reset(seed=seed)
        self.env.reset(seed=seed, options=options)
        return self._observation(), self._info(self._base.get_info())

    def step(self, action: Any) -> tuple[Observation, float, bool, bool, Info]:
        """Let the frames of a step pass with `action`, [A]; its reward is the sum over them.

        `info` has `is_success`, whether the task's goal is reached, in rescues `value`, the share of the value that was
        rescued so far, and `frames`, the number of frames of the step.

        Raises ValueError for an action of another shape, and for NaN.
        """
        total, terminated, truncated, frames = 0.0, False, False, 0
        told: Info = {}
        sent = np.asarray(action, np.float32)
        while frames < self._every and not terminated and not truncated:
            _, reward, ended, over, told = self.env.step(sent)
            total, frames = total + float(reward), frames + 1
            terminated, truncated = bool(ended), bool(over)
        return self._observation(), total, terminated, truncated, {**self._info(told), "frames": frames}

    def render(self) -> Any:
        """A picture of the scene in third person, [H, W, 3], uint8; None without a render mode."""
        return None if self.render_mode is None else _array(self.env.render())

    def close(self) -> None:
        """Close the task's environment."""
        self.env.close()

    def _observation(self) -> Observation:
        rgb, _ = self._base.observer.look()
        seen = {HEAD: rgb, **{name: self._base.observer.picture(name) for name in self._base.cameras}}
        pixels = {name: picture.cpu().numpy().copy() for name, picture in seen.items()}
        return {"pixels": pixels, "agent_pos": self._state()}

    def _state(self) -> NDArray[np.float32]:
        """What the robot feels of itself, [S], as the module says."""
        robot = self._base.agent
        body = [robot.robot.get_qpos()[0], robot.robot.get_qvel()[0]]
        parts = [*(part.cpu().numpy() for part in body), np.array(robot.base()), robot.hand()]
        return np.concatenate([*parts, [float(self._base.hand.held[0] >= 0)]]).astype(np.float32)

    def _info(self, told: dict[str, Any]) -> Info:
        made: Info = {"is_success": bool(told["success"][0])}
        return {**made, "value": float(told["value"][0])} if "value" in told else made


def _array(picture: Any) -> NDArray[np.uint8]:
    """A picture of one environment, [H, W, 3], from a batch of them."""
    found = picture.cpu().numpy() if hasattr(picture, "cpu") else np.asarray(picture)
    return np.ascontiguousarray(found[0] if found.ndim == 4 else found)
