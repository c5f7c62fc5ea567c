"""The build of a robot, as plain frozen data."""

from __future__ import annotations

import math
from dataclasses import dataclass

# greatest distance from the middle of the hand to the surface of the box of a thing that it takes [m] [ours]; Fetch's
# fingers are 0.06 m long
GRASP_REACH = 0.15


@dataclass(frozen=True)
class Build:
    """The weight, size and limits of a robot.

    Raises ValueError for a mass, width, drag area, friction, stance, height of the drag or time to stand up that is not
    positive.
    """

    mass: float  # [kg]
    width: float  # edge of the upright square box that floats in water, and is dragged by it, as the robot does [m]
    drag_area: float  # drag coefficient times frontal area in air [m^2]
    friction: float  # of its wheels or soles on a floor [-]
    forward_step: float  # most that the base moves in a frame [m]
    turn_step: float  # most that the base turns in a frame [rad]
    arm_step: float  # most that an arm joint turns in a frame when a skill moves it [rad]
    radius: float  # of the circle around the base that holds the tucked robot [m]
    shoulder: tuple[float, float]  # where the arm begins: in front of the base's middle, above the floor [m]
    reach: float  # from the shoulder to the middle of the hand, arm stretched [m]
    # from the base's middle: how far ahead nothing higher than a seat may stand where the arm unfolds [m]
    elbow_room: float
    nearest: float  # horizontal distance from the base's middle below which the hand would meet its own base [m]
    stoops: tuple[tuple[float, float], ...] = ()  # other places where bending or crouching can bring the shoulder [m]
    stance: float = math.inf  # least width of the ground between its wheels or soles [m]; infinite: it never falls over
    drag_height: float = 0.5  # height above the floor at which drag in air acts on it [m]
    payload: float = math.inf  # that the stretched arm carries [kg]; infinite: it is not known
    rising: float = math.inf  # time in which it stands up again after a fall [s]; infinite: it stays down

    def __post_init__(self) -> None:
        for name in ("mass", "width", "drag_area", "friction"):
            if not 0.0 < getattr(self, name) < math.inf:
                raise ValueError(f"{name} must be a positive number, got {getattr(self, name)!r}")
        for name in ("stance", "drag_height", "payload", "rising"):
            if not getattr(self, name) > 0.0:
                raise ValueError(f"{name} must be positive, got {getattr(self, name)!r}")

    @property
    def pull(self) -> float:
        """Force with which the stretched arm pulls or pushes a handle [N]: the weight of its payload."""
        return 9.81 * self.payload

    def upright_moment(self, weight: float) -> float:
        """The largest moment [N m] about an edge of its stance that it withstands with `weight` [N] on the ground.

        It stands stiffly upright, its weight in the middle; leaning against the push is not counted.
        """
        return 0.5 * self.stance * weight

    def span(self, height: float) -> tuple[float, float]:
        """The least and largest horizontal distance from the base [m] at which the hand gets to `height` [m]."""
        far = 0.0
        for ahead, above in (self.shoulder, *self.stoops):
            left = self.reach**2 - (height - above) ** 2
            far = max(far, ahead + float(math.sqrt(left))) if left > 0.0 else far
        return self.nearest, far
