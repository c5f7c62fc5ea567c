"""A robot's grip on a piece of furniture that can move, in PhysX on the CPU: springs of limited force and moment.

The springs keep the furniture where it stood before the robot's base. They push and turn it with at most `FORCE` and
`MOMENT`; where it is held fast, they give way, as a hand does.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import sapien

# Largest force [N]: 20 kg to start or stop a load, the guideline for men [HSE RR228, 2004]
FORCE = 196.0
MOMENT = 0.25 * FORCE  # largest moment [N m]: with hands 0.5 m apart [ours]
GIVE = 0.025  # how far a spring gives way at FORCE [m] [ours]
BEND = math.radians(5.0)  # how far it turns at MOMENT [rad] [ours]
HEIGHT = 0.3  # of the grip above the floor [m] [ours: low enough that no cart tips over]
# Damping over stiffness [s] [ours: 0.94 of what lets a cart of 22 kg on these springs come to rest without a swing]
DAMPING = 0.1
UPRIGHT = sapien.Pose(q=[math.sqrt(0.5), 0.0, -math.sqrt(0.5), 0.0])  # the x axis of the springs points up


class Hitch:
    """A grip of a base on furniture, from when it is made until `release`."""

    def __init__(self, base: Any, load: Any) -> None:
        """Grip a `load` with a `base`, both rigid bodies of SAPIEN, at the middle of the load and HEIGHT."""
        self._base, self._load = base, load
        place = sapien.Pose([*load.entity.pose.p[:2], HEIGHT]) * UPRIGHT
        self._at = base.entity.pose.inv() * place, load.entity.pose.inv() * place
        self._drive: Any = sapien.physx.PhysxDriveComponent(load)
        self._drive.parent = base
        self._drive.pose_in_parent, self._drive.pose_in_child = self._at
        for set_spring in (self._drive.set_drive_property_y, self._drive.set_drive_property_z):
            set_spring(FORCE / GIVE, DAMPING * FORCE / GIVE, FORCE)
        self._drive.set_drive_property_twist(MOMENT / BEND, DAMPING * MOMENT / BEND, MOMENT)
        load.entity.add_component(self._drive)

    def slip(self) -> float:
        """Distance of the load over the floor from where the grip would keep it [m]."""
        base, load = self._base.entity.pose * self._at[0], self._load.entity.pose * self._at[1]
        return float(np.hypot(*(base.p - load.p)[:2]))

    def release(self) -> None:
        """Let go of the load, which stays where it is."""
        self._load.entity.remove_component(self._drive)
