"""An episode played to a frame without drawing, and the views of it that can be photographed."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from contextlib import contextmanager, nullcontext
from functools import cached_property
from typing import Any

import numpy as np
import sapien
from mani_skill.utils.sapien_utils import look_at

from hazard_ms.effects.cutaway import Cutaway
from hazard_ms.effects.entities import FRAMES_PER_SECOND
from hazard_ms.effects.raytracing.still import Image, Photographer, Viewpoint
from hazard_ms.evaluation.runner import played_to
from hazard_ms.pictures.options import IDLE, RenderOptions
from hazard_ms.simulation.drawing.viewpoint import HOUSE_ANGLE, corner_view, house_view
from hazard_ms.skills.executor import SkillEnv

THIRD_ANGLE = 1.15  # vertical, of the third person's eye, as in the environment [rad]
ORBIT = 0.36  # of a turntable, as a share of the scene's shorter side; indoors it stays inside the walls [ours]
ORBIT_OUTDOORS, ORBIT_HEIGHT = 0.55, 0.85  # the latter as a share of the third person's height [ours]


class FrozenEpisode:
    """One episode that stands still at a frame. A context manager."""

    def __init__(self, options: RenderOptions) -> None:
        """Play the episode of `options` up to its frame.

        Raises ValueError where nothing can draw, and for options that are not valid.
        """
        options.check()
        episode = options.episode
        if episode.agent == IDLE:
            self._skills = SkillEnv.make(episode.env_id, render_mode="rgb_array", **episode.settings)
            self.env = self._skills.base
            self._skills.env.reset(seed=episode.seed, options=episode.reset_options)
            self.play(options.frame)
        else:
            self._skills = played_to(episode, options.frame, render_mode="rgb_array")
            self.env = self._skills.base

    @property
    def frame(self) -> int:
        """Frames since the start of the episode."""
        return int(self.env.world.frame[0])

    def play(self, frame: int) -> None:
        """Let the robot stand still until `frame`, which must not have passed."""
        still = self.env.agent.action(0.0, 0.0, self.env.agent.tucked, True)
        for _ in range(self.frame, frame):
            self.env.advance(still)

    def view(self, camera: str, width: int, height: int) -> Viewpoint:
        """The view from the corner (third), of an open home (home), or through the head camera (head), in pixels.

        Raises ValueError for `home` in a scene that has no rooms.
        """
        if camera == "head":
            eye = self.env.observer.camera.camera._render_cameras[0]
            return Viewpoint(eye.global_pose, float(eye.fovy), width, height, spectator=False)
        spec = self.env.specs[0]
        if camera != "home":
            return Viewpoint(corner_view(spec), THIRD_ANGLE, width, height)
        if not spec.room.areas:
            raise ValueError(f"camera home needs a scene with several rooms, got {spec.name}")
        return Viewpoint(house_view(spec, width / height), HOUSE_ANGLE, width, height, open_home=True)

    def around(self, share: float, width: int, height: int) -> Viewpoint:
        """The view from a circle around the middle of the scene; `share` of a turn, 0 to 1."""
        spec = self.env.specs[0]
        (x, y), turn = spec.room.size, 2 * math.pi * share
        radius = (ORBIT_OUTDOORS if spec.room.open_air else ORBIT) * min(x, y)
        eye = np.array(
            [x / 2 + radius * math.cos(turn), y / 2 + radius * math.sin(turn), ORBIT_HEIGHT * corner_view(spec).p[2]]
        )
        return Viewpoint(look_at(eye, [x / 2, y / 2, 0.3]).sp, THIRD_ANGLE, width, height)

    @contextmanager
    def ready(self, view: Viewpoint, shader: str) -> Iterator[Callable[[int], Image]]:
        """Compile what pictures from `view` through `shader` need.

        Yields what takes a picture, given the samples per pixel.
        """
        self.env.observer.show(view.spectator)
        with (
            self._cutaway if view.open_home else nullcontext(),
            self._photographer.ready(view, shader, self.frame / FRAMES_PER_SECOND) as take,
        ):
            yield take

    def picture(self, view: Viewpoint, shader: str, samples: int) -> Image:
        """The picture from `view`, [H, W, 3], RGB."""
        with self.ready(view, shader) as take:
            return take(samples)

    @cached_property
    def _photographer(self) -> Photographer:
        return Photographer(self._scene)

    @cached_property
    def _cutaway(self) -> Cutaway:
        return Cutaway(self._scene, self.env.specs[0])

    @property
    def _scene(self) -> sapien.Scene:
        scene: sapien.Scene = self.env.scene.sub_scenes[0]
        return scene

    def close(self) -> None:
        """Close the environment."""
        self._skills.close()

    def __enter__(self) -> FrozenEpisode:
        return self

    def __exit__(self, *_: Any) -> None:
        self.close()
