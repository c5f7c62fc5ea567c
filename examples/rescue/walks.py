"""The walk of policies.py: what it knows, the network that says how to go on, and the skill that does so."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
import torch
from torch import Tensor, nn

from hazard_ms.skills import failures
from hazard_ms.skills.context import Skill, Stage
from hazard_ms.skills.decision import Result
from hazard_ms.skills.motor.motion import Watch, wrap
from hazard_ms.skills.motor.navigation import Path, Ways
from hazard_ms.skills.motor.walking import ARRIVED, WALK_FRAMES, known, way_to

CELLS, SIZES = 32, (0.1, 0.3)  # of the pictures of the map: along a side; widths [m]
FAR, HIGH = 5.0, 1.0  # [m] from where on distances, and heights, count alike
LOOK, PASSED = 60, 0.12  # frames of a walk from look to look; distance at which a point of its path is behind it [m]
FACING, REACH = 0.15, 1.2  # bearing [rad] and distance [m] from a thing at which a walk may end
SIDES, APART = 12, 0.35  # directions from which another reach is tried; how far from the earlier ones [m]
HIDDEN, NUMBERS, WAYS = 256, 10, 4

Place = tuple[float, float]

_side = (np.arange(CELLS) - CELLS / 2 + 0.5)[::-1]
AHEAD, LEFT = (part.copy() for part in np.meshgrid(_side, _side, indexing="ij"))  # of cells from the robot, in cells


class Walk:
    """A walk to a thing as the policy knows it, in the frame of the robot's base.

    It is not told how fast it moves, or what it sent last: skills mostly go on as before, so a policy that is told
    learns that and nothing else, and stands still for ever where it once does.
    """

    def __init__(self, stage: Stage, index: int, tried: Sequence[Place] = ()) -> None:
        """`tried`: where a reach for the thing failed [m]; the walk leads elsewhere."""
        self.stage, self.index, self.tried = stage, index, tried
        self.points: list[np.ndarray] = []  # of the path, which are still ahead [m]

    def plan(self) -> None:
        """Search the map for a path to the thing."""
        place = self.stage.seen.objects[self.index].position
        far, _, left = self.way()
        path = self.elsewhere(place[:2], far - left) if self.tried else None
        path = path or way_to(self.stage, (float(place[0]), float(place[1])), far - left, REACH)
        self.points = [] if path is None else list(path.points)

    def elsewhere(self, place: np.ndarray, far: float) -> Path | None:
        """The shortest path to another side of the thing at `place` [m], [2], `far` [m] from it; None without any."""
        angles, seen = np.arange(SIDES) * math.tau / SIDES, self.stage.seen
        spots = place + far * np.stack([np.cos(angles), np.sin(angles)], -1)
        goals = [(float(x), float(y)) for x, y in spots if all(math.dist((x, y), old) > APART for old in self.tried)]
        if not goals:
            return None
        where, radius = self.stage.robot.base()[:2], self.stage.robot.build.radius
        ways = Ways(self.stage.obstacles(), seen.explored, seen.cell, seen.origin, where, goals, radius)
        paths = (ways.path(goal, 0.0, seen.cell) for goal in goals)
        able = [path for path in paths if path is not None and path.short <= seen.cell and len(path.points)]
        return min(able, key=lambda path: path.length, default=None)

    def over(self, said: float) -> bool:
        """Whether the walk ends here, if the network says what is above 0 where it does."""
        far, bearing, left = self.way()
        there = left < 0.0 or (said > 0.0 and far < REACH)
        return abs(bearing) < FACING and there and not (self.tried and self.points)

    def ahead(self) -> tuple[float, float]:
        """Distance [m] and bearing [rad] of the next point of the path; of the thing where none is left."""
        x, y, heading = self.stage.robot.base()
        while self.points and math.dist(self.points[0], (x, y)) < PASSED:
            self.points.pop(0)
        off = (self.points[0] if self.points else self.stage.seen.objects[self.index].position[:2]) - (x, y)
        return float(np.hypot(*off)), wrap(math.atan2(off[1], off[0]) - heading)

    def way(self) -> tuple[float, float, float]:
        """Distance to the thing [m], its bearing [rad], and what is left of the distance to where a walk ends [m]."""
        x, y, heading = self.stage.robot.base()
        thing = self.stage.seen.objects[self.index]
        off = thing.position[:2] - (x, y)
        far = float(np.hypot(*off))
        edge = min(thing.radius, self.stage.labeller.half_width(self.index))
        return far, wrap(math.atan2(off[1], off[0]) - heading), far - ARRIVED - edge

    def numbers(self) -> np.ndarray:
        """What it knows beside the map: where the thing is, and the next point of the path, [NUMBERS]."""
        far, bearing, left = self.way()
        point, aside = self.ahead()
        seen = (min(far, FAR), min(max(left, -1.0), 1.0), math.cos(bearing), math.sin(bearing), bearing)
        return np.array([*seen, min(point, 1.0), math.cos(aside), math.sin(aside), aside, not self.points], np.float32)

    def maps(self) -> np.ndarray:
        """Heights, and what was seen, around the robot in cells of SIZES, ahead upwards, uint8 [4, CELLS, CELLS]."""
        seen, (x, y, heading) = self.stage.seen, self.stage.robot.base()
        height, made = self.stage.obstacles(), []
        c, s = math.cos(heading), math.sin(heading)
        for size in SIZES:
            at = np.stack([x + size * (c * AHEAD - s * LEFT), y + size * (s * AHEAD + c * LEFT)], -1)
            cell = np.floor((at - seen.origin) / seen.cell).astype(int)[..., ::-1]
            inside = ((cell >= 0) & (cell < height.shape)).all(-1)
            row, column = np.where(inside[..., None], cell, 0).transpose(2, 0, 1)
            made += [np.where(inside, np.clip(height[row, column] / HIGH, 0.0, 1.0), 0.0)]
            made += [inside & seen.explored[row, column]]
        return (255.0 * np.stack(made)).astype(np.uint8)


class Walker(nn.Module):
    """From maps, [N, 4, CELLS, CELLS], and NUMBERS, [N, 10], to WAYS to go on, of which one is chosen.

    They are drive and turn, [N, WAYS, 2], from -1 to 1; how likely each is, [N, WAYS]; above 0 if it has arrived, [N].
    """

    def __init__(self) -> None:
        super().__init__()
        layers: list[nn.Module] = []
        for planes, width in ((4, 24), (24, 48), (48, 48)):
            layers += [nn.Conv2d(planes, width, 3, 2, 1), nn.ReLU()]
        self.eye = nn.Sequential(*layers, nn.Flatten(), nn.Linear(48 * (CELLS // 8) ** 2, HIDDEN), nn.ReLU())
        self.out = nn.Sequential(
            *(nn.Linear(HIDDEN + NUMBERS, HIDDEN), nn.ReLU(), nn.Dropout(0.1), nn.Linear(HIDDEN, HIDDEN), nn.ReLU()),
            nn.Linear(HIDDEN, 3 * WAYS + 1),
        )

    def forward(self, maps: Tensor, numbers: Tensor) -> tuple[Tensor, Tensor, Tensor]:
        said = self.out(torch.cat([self.eye(maps.float() / 255.0), numbers], 1))
        ways = said[:, 1:].unflatten(1, (WAYS, 3))
        return ways[..., :2], ways[..., 2], said[:, 0]

    @torch.no_grad()
    def say(self, walk: Walk) -> tuple[float, float, float]:
        """Drive and turn of the likeliest way, and above 0 if the walk is over."""
        ways, likely, over = self(torch.from_numpy(walk.maps())[None], torch.from_numpy(walk.numbers())[None])
        drive, turn = ways[0, int(likely.argmax())].clamp(-1.0, 1.0).tolist()
        return drive, turn, float(over)


def walked(stage: Stage, index: int, walker: Walker, tried: Sequence[Place] = ()) -> Skill:
    """A walk to the thing `index` as the `walker` says, to elsewhere than where reaches were `tried` [m]."""
    walk, watch, build = Walk(stage, index, tried), Watch(), stage.robot.build
    for frame in range(WALK_FRAMES):
        if not known(stage, index):
            return Result(False, failures.UNKNOWN, frame)
        if frame % LOOK == 0:
            walk.plan()
        drive, turn, over = walker.say(walk)
        if walk.over(over):
            stage.look()
            return Result(True, frames=frame)
        x, y, _ = stage.robot.base()
        if watch.stuck(x, y, drive * build.forward_step):
            stage.bump()
        yield stage.act(drive * build.forward_step, turn * build.turn_step)
        if frame % LOOK == LOOK - 1:
            stage.look()
    return Result(False, failures.MAX_FRAMES, WALK_FRAMES)
