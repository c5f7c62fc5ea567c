"""The eye of the third person: it overlooks a room, follows the robots in the open, and looks into homes from above."""

from __future__ import annotations

import math
from collections.abc import Iterator
from contextlib import contextmanager

from hazard_ms.effects.cutaway import Cutaway
from hazard_ms.simulation.drawing.viewpoint import HOUSE_ANGLE, corner_view, following_view, house_view
from hazard_ms.skills.executor import SkillEnv
from hazard_ms.skills.team import TeamSkills


class Spectator:
    """The third person's camera of one environment, after its reset; whoever takes pictures does it in `looking`."""

    def __init__(self, env: SkillEnv | TeamSkills, near: bool = False) -> None:
        """`near`: whether it follows the robot in homes, too, rather than overlook all rooms at once."""
        self._robots, self._near = env.base.robots.values(), near
        self.camera = next(iter(env.base.scene.human_render_cameras.values()))
        self._spec, self._cutaway = env.base.specs[0], None
        if self._spec.room.areas:
            self._cutaway = Cutaway(env.base.scene.sub_scenes[0], self._spec)
            for eye in self.camera.camera._render_cameras:
                eye.set_fovy(HOUSE_ANGLE, compute_x=True)

    @contextmanager
    def looking(self) -> Iterator[None]:
        """Bring the camera to where it sees best now; a home stands open meanwhile."""
        places = [robot.base()[:2] for robot in self._robots]
        x, y = (sum(along) / len(places) for along in zip(*places, strict=True))  # of a team, the middle
        if self._cutaway is None:
            if self._spec.room.open_air:
                reach = max(math.dist(place, (x, y)) for place in places)
                self.camera.camera.set_local_pose(following_view(corner_view(self._spec), (x, y), reach))
            yield
            return
        aspect = self.camera.camera.width / self.camera.camera.height
        self.camera.camera.set_local_pose(house_view(self._spec, aspect, (x, y) if self._near else None))
        with self._cutaway:
            yield
