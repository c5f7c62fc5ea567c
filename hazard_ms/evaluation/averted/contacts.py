"""Counts a robot's collisions with furniture and walls, from the contacts that PhysX finds on the CPU.

A collision begins with a frame at whose end something that stands pushes a link of the robot with at least FORCE, and
did not in the GAP before. Contacts between two frames, of less than 33 ms, are not seen. What the robot carries or
could carry does not count, nor do the floor and other robots.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from hazard_ms.spec.names import plain_name

FORCE = 10.0  # from which a contact is a collision: more than brushing past, an impulse of 0.08 N s a step [N] [ours]
GAP = 0.5  # time without contact after which touching the same thing is a new collision [s] [ours]
UPRIGHT = 0.7  # share of a contact's normal along the vertical from which it is the floor's, or a thing's top [-]


class Collisions:
    """The collisions of one robot since it was made."""

    def __init__(self, env: Any, robot: Any) -> None:
        """Begin with none of this `robot` in the one scene of `env`, a HazardEnv on the CPU."""
        self.number = 0
        self._px: Any = env.scene.sub_scenes[0].physx_system
        self._seconds = 1.0 / float(env.sim_freq)  # in which an impulse was given [s]
        self._gap = round(GAP * float(env.control_freq))
        self._links = _links(robot)
        self._others = {link for other in env.robots.values() if other is not robot for link in _links(other)}
        self._loose = {body.name for body in env.specs[0].bodies}
        self._frame = 0
        self._last: dict[int, int] = {}  # frame of the last contact with each thing

    def count(self) -> None:
        """Look at the contacts at the end of a frame."""
        self._frame += 1
        for other, force in self._pushed().items():
            if force >= FORCE:
                if self._frame - self._last.get(other, -self._gap - 1) > self._gap:
                    self.number += 1
                self._last[other] = self._frame
            elif other in self._last and force > 0.0:
                self._last[other] = self._frame

    def _pushed(self) -> dict[int, float]:
        """Force [N] with which each thing that stands pushes the robot sideways, by the number of its entity."""
        found: dict[int, float] = {}
        for contact in self._px.get_contacts():
            first, second = (body.entity for body in contact.bodies)
            mine = [e.per_scene_id in self._links for e in (first, second)]
            if mine[0] == mine[1]:
                continue
            other = second if mine[0] else first
            if other.per_scene_id in self._others or plain_name(other.name) in self._loose:
                continue
            for point in contact.points:
                if abs(float(point.normal[2])) < UPRIGHT:
                    force = float(np.linalg.norm(point.impulse)) / self._seconds
                    found[other.per_scene_id] = found.get(other.per_scene_id, 0.0) + force
        return found


def _links(robot: Any) -> set[int]:
    """Numbers of the entities of a robot's links."""
    return {link._objs[0].entity.per_scene_id for link in robot.robot.links}
