"""An episode played to a frame without drawing, and the views of it that can be photographed."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import cached_property
from typing import Any

import gymnasium as gym
import numpy as np
import sapien
from mani_skill.utils.sapien_utils import look_at

import hazard_ms  # noqa: F401 registers the environments
from hazard_ms.agents.base import agent
from hazard_ms.building import corner_view
from hazard_ms.effects.entities import FRAMES_PER_SECOND
from hazard_ms.env import HazardEnv
from hazard_ms.pictures.camera import Image, Photographer, View
from hazard_ms.pictures.order import RenderOrder
from hazard_ms.play import Episode
from hazard_ms.rendering import backend
from hazard_ms.skills.executor import SkillEnv

THIRD_ANGLE = 1.15  # vertical, of the third person's eye, as in the environment [rad]
ORBIT = 0.36  # of a turntable, as a share of the scene's shorter side; indoors it stays inside the walls [ours]
ORBIT_OUTDOORS, ORBIT_HEIGHT = 0.55, 0.85  # the latter as a share of the third person's height [ours]


class FrameReached(Exception):  # noqa: N818 no error: it ends a decision in its midst
    """The frame that was asked for has come."""


class Stage:
    """One episode that stands still at a frame. A context manager."""

    def __init__(self, order: RenderOrder) -> None:
        """Play the episode of `order` up to its frame. Raises ValueError where nothing can draw, or for names that are unknown."""
        order.check()
        if backend() == "none":
            raise ValueError("nothing can draw on this machine: hazard-ms doctor says why")
        player = None if order.agent == "idle" else agent(order.agent)
        settings: dict[str, Any] = {"split": order.split, "physics": order.physics, "robot_uids": order.robot, "lighting": order.light}
        made = gym.make(order.env_id, obs_mode="none", render_mode="rgb_array", **settings)
        self.env: HazardEnv = made.unwrapped  # type: ignore[assignment]
        options = {} if order.scene is None else {"scene": order.scene}
        self._made = made
        self.frame = 0
        if player is None:
            made.reset(seed=order.seed, options=options)
            self.play(order.frame)
        else:
            _play_as(player, SkillEnv(made), order, options)
            self.frame = int(self.env.world.frame[0])

    def play(self, frame: int) -> None:
        """Let the robot stand still until `frame`, which must not have passed."""
        still = self.env.agent.action(0.0, 0.0, self.env.agent.tucked, True)
        while self.frame < frame:
            self.env.advance(still)
            self.frame += 1

    def view(self, camera: str, width: int, height: int) -> View:
        """From the corner (third), or through the robot's head camera (head)."""
        if camera == "head":
            eye = self.env._sensors[self.env.agent.head_camera].camera._render_cameras[0]
            return View(eye.global_pose, float(eye.fovy), width, height)
        return View(corner_view(self.env.specs[0]), THIRD_ANGLE, width, height)

    def around(self, share: float, width: int, height: int) -> View:
        """From a circle around the middle of the scene, `share` 0..1 of a turn."""
        spec = self.env.specs[0]
        (x, y), turn = spec.room.size, 2 * math.pi * share
        radius = (ORBIT_OUTDOORS if spec.room.open_air else ORBIT) * min(x, y)
        eye = np.array([x / 2 + radius * math.cos(turn), y / 2 + radius * math.sin(turn), ORBIT_HEIGHT * corner_view(spec).p[2]])
        return View(look_at(eye, [x / 2, y / 2, 0.3]).sp, THIRD_ANGLE, width, height)

    @contextmanager
    def ready(self, view: View, shader: str) -> Iterator[Callable[[int], Image]]:
        """Compile what pictures from `view` through `shader` need; yields what takes one, given the samples per pixel."""
        self.env.observer.show()
        with self._photographer.ready(view, shader, self.frame / FRAMES_PER_SECOND) as take:
            yield take

    def picture(self, view: View, shader: str, samples: int) -> Image:
        """What is seen from `view`, [H, W, 3], RGB."""
        with self.ready(view, shader) as take:
            return take(samples)

    @cached_property
    def _photographer(self) -> Photographer:
        return Photographer(self._scene)

    @property
    def _scene(self) -> sapien.Scene:
        scene: sapien.Scene = self.env.scene.sub_scenes[0]
        return scene

    def close(self) -> None:
        """Close the environment."""
        self._made.close()

    def __enter__(self) -> Stage:
        return self

    def __exit__(self, *_: Any) -> None:
        self.close()


def _play_as(player: Any, env: SkillEnv, order: RenderOrder, options: dict[str, Any]) -> None:
    """Let an agent play until the frame of `order`, or the end of its episode."""
    decision, _ = env.reset(seed=order.seed, options=options)
    player.reset(env.base.task, order.seed)

    def watch(_: Any) -> None:
        if env.frame >= order.frame:
            raise FrameReached

    env.watch = watch
    if order.frame == 0:
        return
    try:
        Episode(env, player).run(decision)
    except FrameReached:
        return
