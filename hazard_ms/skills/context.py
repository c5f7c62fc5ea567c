"""The context of a skill: the robot, the hand, the things, and the map of what was seen."""

from __future__ import annotations

from collections.abc import Callable, Generator
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from hazard_ms.sensing.detection.labeller import Labeller
from hazard_ms.sensing.door_memory import DoorMemory
from hazard_ms.sensing.semantic_map import SemanticMap
from hazard_ms.simulation.robot import Robot
from hazard_ms.simulation.world import World
from hazard_ms.skills.decision import Result
from hazard_ms.tasks.episode.episode import Episode
from hazard_ms.tasks.episode.grasp import Hand, distance_to_boxes, graspable

LowLevel = NDArray[np.float32]  # an action of the environment
Skill = Generator[LowLevel, None, Result]  # yields actions and returns the outcome
BUMP_RADIUS = 0.2  # radius of the obstacle that is assumed where the robot got stuck [m]
BUMP_MEMORY = 300  # frames for which such an obstacle is remembered
HALT = 0.2  # gap to another robot, in the direction of the drive, at which the base stops: it brakes within 0.06 m [m]
SIDE = np.cos(np.deg2rad(60.0))  # of the angle from the direction of the drive within which another robot stops it
GRAZE = 0.08  # gap at which another robot stops it in any direction that brings them closer [m] [ours]
HAND_RADIUS = 0.2  # of the disc on the floor that another robot's hand takes up [m] [ours]


class Rescuer(Protocol):
    """The part of an environment that skills need; `hazard_ms.env.HazardEnv` has it."""

    agent: Robot
    world: World
    hand: Hand
    episode: Episode

    @property
    def control_timestep(self) -> float:
        """Duration of a frame [s]."""


class Stage:
    """One episode of one environment as skills see it.

    The arm moves towards where it should be whenever an action is made.
    """

    def __init__(
        self, env: Rescuer, seen: SemanticMap, look: Callable[[], None], labeller: Labeller | None = None
    ) -> None:
        """Begin an episode in `env` with the map `seen`, which `look` updates.

        `labeller` knows the things by which actions and the map mean them; None: they are meant as along B.
        """
        self.env = env
        self.labeller = labeller or Labeller(env.world)
        self.doors = DoorMemory(env.world)  # openings that are known; none is until a look enters it
        self.maps = [seen]  # all maps that are to forget what moves
        self.seen = seen
        self.look = look
        self.bumps: list[tuple[float, float, int]] = []  # x, y [m], frame
        self.others: tuple[Robot, ...] = ()  # the other robots of its team, which tell it where they are
        self.on_ground = False  # whether a thing can be rescued by putting it on the ground, where nothing moves it
        self.last_move = (0.0, 0.0, self.robot.arm())  # forward [m], turn [rad], and where the arm is to get to [rad]
        self._arm = self.robot.arm()  # last commanded joints [rad]

    @property
    def robot(self) -> Robot:
        """The robot that acts."""
        return self.env.agent

    @property
    def world(self) -> World:
        """The true state of the robot's surroundings."""
        return self.env.world

    @property
    def frame(self) -> int:
        """Frames since the start of the episode."""
        return int(self.world.frame[0])

    @property
    def held(self) -> int:
        """Index along B of the thing in the hand, or -1."""
        return int(self.env.hand.held[0])

    def act(
        self, forward: float = 0.0, turn: float = 0.0, arm: NDArray[np.float64] | None = None, shut: bool | None = None
    ) -> LowLevel:
        """An action, [A]: drive `forward` [m], `turn` [rad], bring the arm one step towards `arm` [rad] (None: tucked).

        `shut` closes the hand or opens it; None keeps what it holds. It does not drive at another robot close by.
        """
        if self.others and forward and self.faces_another(forward):
            forward = 0.0
        actual = self.robot.arm()
        if np.abs(actual - self._arm).max() > 1.0:  # [rad]; something else moved the arm or is in its way
            self._arm = actual
        goal = self.robot.tucked if arm is None else arm
        self.last_move = (forward, turn, goal)
        left = goal - self._arm  # all joints arrive at the same time
        self._arm = self._arm + left * min(1.0, self.robot.build.arm_step / max(float(np.abs(left).max()), 1e-9))
        holding = self.held >= 0 if shut is None else shut
        return self.robot.action(forward, turn, self._arm, not holding)

    def still(self) -> LowLevel:
        """An action, [A], in which the robot stays as it is; what it was about to do it can do afterwards."""
        return self.robot.action(0.0, 0.0, self.robot.arm(), self.held < 0)

    def arm_gap(self, arm: NDArray[np.float64]) -> float:
        """Largest difference of a joint from `arm`, [..., J] [rad]."""
        return float(np.abs(self.robot.arm() - arm).max())

    def position(self, index: int) -> NDArray[np.float64]:
        """True middle of a thing's box [m], [3], world frame: for the hand, which feels what it touches."""
        return self.world.position[0, index].cpu().numpy().astype(np.float64)

    def would_take(self) -> int:
        """Index along B of the thing that the hand would take if it shut now, or -1."""
        return int(graspable(self.world, self.robot.gripper_pose()[0])[0])

    def gap(self, index: int) -> float:
        """Distance from the hand to the surface of a thing's box [m]."""
        return float(distance_to_boxes(self.world, self.robot.gripper_pose()[0])[0, index])

    def bump(self) -> None:
        """Remember that something stands right in front of the base."""
        x, y, heading = self.robot.base()
        ahead = self.robot.build.radius + BUMP_RADIUS / 2
        self.bumps.append((x + ahead * np.cos(heading), y + ahead * np.sin(heading), self.frame))

    def room_ahead(self, height: float, most: float, turn: float = 0.0) -> float:
        """Distance [m] from the base's middle to the next thing ahead higher than `height` [m], at most `most` [m].

        Ahead is where the base faces, or will face when it has turned by `turn` [rad], anticlockwise.
        """
        x, y, heading = self.robot.base()
        heading += turn
        radius = self.robot.build.radius
        along, across = np.meshgrid(np.arange(0.0, most, self.seen.cell / 4), np.linspace(-radius, radius, 9) * 0.8)
        points_x = x + along * np.cos(heading) - across * np.sin(heading)
        points_y = y + along * np.sin(heading) + across * np.cos(heading)
        cells = np.floor((np.stack([points_y, points_x], -1) - self.seen.origin[::-1]) / self.seen.cell).astype(int)
        inside = ((cells >= 0) & (cells < self.seen.height.shape)).all(-1)
        high = np.zeros(along.shape, bool)
        high[inside] = self.seen.height[tuple(cells[inside].T)] > height
        return float(along[high].min(initial=most))

    def discs(self) -> list[tuple[float, float, float]]:
        """Discs of floor that the other robots of its team take up: middles x, y and radii [m] of bases and hands."""
        bases = [(*robot.base()[:2], robot.build.radius) for robot in self.others]
        hands = [(float(x), float(y), HAND_RADIUS) for x, y, _ in (robot.hand() for robot in self.others)]
        return bases + hands

    def faces_another(self, forward: float) -> bool:
        """Whether driving `forward` [m], backwards if negative, leads at another robot of its team that is close.

        That is one within HALT ahead, or one within GRAZE to the side that the drive brings closer.
        """
        x, y, heading = self.robot.base()
        heading += np.pi if forward < 0.0 else 0.0
        for other_x, other_y, radius in self.discs():
            away = np.array([other_x - x, other_y - y])
            far = float(np.hypot(*away))
            gap = far - self.robot.build.radius - radius
            closer = float(away @ (np.cos(heading), np.sin(heading)))
            if (gap < HALT and closer > SIDE * far) or (gap < GRAZE and closer > 0.0):
                return True
        return False

    def obstacles(self) -> NDArray[np.float32]:
        """Heights of obstacles [m], [Y, X]: as seen, barred, where the robot got stuck lately, and other robots."""
        height = self.seen.obstacles
        stuck = [(x, y, BUMP_RADIUS) for x, y, frame in self.bumps if self.frame - frame < BUMP_MEMORY]
        for disc in stuck + self.discs():
            height[self.covered(disc, height.shape, self.seen.origin)] = 1.0
        return height

    def covered(
        self, disc: tuple[float, float, float], shape: tuple[int, ...], corner: NDArray[np.floating]
    ) -> NDArray[np.bool_]:
        """The cells of a piece of the map, [Y, X] as `shape` says, from `corner` [m], [2], on, that lie in a disc.

        `disc`: the middle's x and y, and the radius [m].
        """
        y, x = np.mgrid[0 : shape[0], 0 : shape[1]]
        middle_x, middle_y = corner[:, None, None] + (np.stack([x, y]) + 0.5) * self.seen.cell
        return np.asarray(np.hypot(middle_x - disc[0], middle_y - disc[1]) < disc[2])
