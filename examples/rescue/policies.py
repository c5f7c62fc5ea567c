"""A whole rescue without a planned motion: three small networks walk, reach and stow, and an agent decides what for.

    python examples/rescue/learn.py demonstrate demos.npz --tasks HazardFire-v1 HazardFlood-v1
    python examples/rescue/learn.py train demos.npz --out learned/rescue
    hazard-ms evaluate -e HazardFire-v1 --split test \\
        --agents greedy examples/rescue/policies.py:Policies:weights=learned/rescue

Skills plan: walks follow a path point by point, a reach solves the arm's kinematics and looks for a way past furniture.
Here `greedy`, or any other agent, still decides what to fetch, but a network plays each of its actions: it reads
numbers and says, thirty times a second, how base, arm and hand move. A search over the map tells walks where the way
leads, once in two seconds, as in a navigation stack. Only `explore`, a turn once around, is as it was.

Reaches and stows are those of clone_pick_up.py; a walk reads the map around the robot as pictures that turn with it.
They are for Fetch, for tasks whose safe place is its bag, and for things that are told as they are (no detector).
"""

from __future__ import annotations

import math
import sys
from pathlib import Path
from typing import Any

import numpy as np
import torch
from safetensors.torch import load_file
from torch import Tensor, nn

from hazard_ms import Action, Agent
from hazard_ms.agents.base import agent
from hazard_ms.skills import actions, failures
from hazard_ms.skills.brief import Brief
from hazard_ms.skills.context import Skill, Stage
from hazard_ms.skills.decision import DROP, PICK_UP, WALK_ONE_STEP, WALK_TO, Decision, Result
from hazard_ms.skills.motor.motion import Watch, wrap
from hazard_ms.skills.motor.walking import ARRIVED, WALK_FRAMES, known, way_to

sys.path.insert(0, str(Path(__file__).parents[1]))
import clone_pick_up as reaching  # noqa: E402

VERBS = {WALK_TO: "walk", WALK_ONE_STEP: "walk", PICK_UP: "reach", DROP: "stow"}
CELLS, SIZES = 32, (0.1, 0.3)  # of the pictures of the map: along a side; widths [m]
FAR, HIGH = 5.0, 1.0  # [m] from where on distances, and heights, count alike
LOOK, PASSED = 60, 0.12  # frames of a walk from look to look; distance at which a point of its path is behind it [m]
STOW_FRAMES = 90  # of a stow at most, which takes half of them
FACING, REACH = 0.15, 1.2  # bearing [rad] and distance [m] from a thing at which a walk may end
HIDDEN, NUMBERS, WAYS = 256, 10, 4
ARM = ("reach", "stow")  # networks that move arm, hand and base, from 38 numbers

_side = (np.arange(CELLS) - CELLS / 2 + 0.5)[::-1]
AHEAD, LEFT = (part.copy() for part in np.meshgrid(_side, _side, indexing="ij"))  # of cells from the robot, in cells


class Walk:
    """A walk to a thing as the policy knows it, in the frame of the robot's base.

    It is not told how fast it moves, or what it sent last: skills mostly go on as before, so a policy that is told
    learns that and nothing else, and stands still for ever where it once does.
    """

    def __init__(self, stage: Stage, index: int) -> None:
        self.stage, self.index = stage, index
        self.points: list[np.ndarray] = []  # of the path, which are still ahead [m]

    def plan(self) -> None:
        """Search the map for a path to the thing."""
        place = self.stage.seen.objects[self.index].position
        far, _, left = self.way()
        path = way_to(self.stage, (float(place[0]), float(place[1])), far - left, REACH)
        self.points = [] if path is None else list(path.points)

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


class Hand(nn.Module):
    """Two hidden layers between what is seen, [N, 38], and WAYS outputs, [N, WAYS, 10], of which one is chosen."""

    def __init__(self, seen: Tensor) -> None:
        super().__init__()
        for name, numbers in (("mean", seen.mean(0)), ("spread", seen.std(0) + 0.02)):
            self.register_buffer(name, numbers)
        then, last = (nn.ReLU(), nn.Dropout(reaching.DROPOUT)), nn.Linear(HIDDEN, 11 * WAYS)
        self.layers = nn.Sequential(nn.Linear(38, HIDDEN), *then, nn.Linear(HIDDEN, HIDDEN), *then, last)

    def forward(self, seen: Tensor) -> tuple[Tensor, Tensor]:
        said = self.layers(((seen - self.mean) / self.spread).clamp(-5.0, 5.0)).unflatten(1, (WAYS, 11))
        return said[..., :10], said[..., 10]

    @torch.no_grad()
    def output(self, now: reaching.PickUp) -> np.ndarray:
        ways, likely = self(torch.from_numpy(now.seen())[None])
        return ways[0, int(likely.argmax())].numpy()


def error(said: tuple[Tensor, Tensor], label: Tensor) -> Tensor:
    """The error of the nearest way: one turns the base, another reaches at once, and their middle does neither."""
    ways, likely = said
    label = label[:, None].expand_as(ways)
    shut = nn.functional.binary_cross_entropy_with_logits(ways[..., 9], (label[..., 9] > 0.0).float(), reduction="none")
    off = (ways - label).square()  # without squares, where an arm mostly rests, it would rest for ever
    off = off[..., :7].mean(-1) + 0.5 * off[..., 7:9].mean(-1) + 0.3 * shut
    near, which = off.min(1)
    return near.mean() + 0.1 * off.mean() + 0.2 * nn.functional.cross_entropy(likely, which)


def walked(stage: Stage, index: int, walker: Walker) -> Skill:
    """A walk to the thing `index` as the `walker` says."""
    walk, watch, build = Walk(stage, index), Watch(), stage.robot.build
    for frame in range(WALK_FRAMES):
        if not known(stage, index):
            return Result(False, failures.UNKNOWN, frame)
        if frame % LOOK == 0:
            walk.plan()
        far, bearing, left = walk.way()
        drive, turn, over = walker.say(walk)
        if abs(bearing) < FACING and (left < 0.0 or (over > 0.0 and far < REACH)):
            stage.look()
            return Result(True, frames=frame)
        x, y, _ = stage.robot.base()
        if watch.stuck(x, y, drive * build.forward_step):
            stage.bump()
        yield stage.act(drive * build.forward_step, turn * build.turn_step)
        if frame % LOOK == LOOK - 1:
            stage.look()
    return Result(False, failures.MAX_FRAMES, WALK_FRAMES)


def stowed(stage: Stage, policy: Any) -> Skill:
    """What the hand holds is brought to the bag as the `policy` says, and let go of."""
    held = stage.held
    if held < 0:
        return Result(False, failures.NOT_HOLDING)
    now = reaching.PickUp(stage, held)
    for frame in range(STOW_FRAMES):
        if bool(stage.world.safe[0, held]):
            return Result(True, frames=frame)
        if stage.held != held:
            return Result(False, failures.NOT_RESCUED, frame)
        yield now.action(policy.output(now))
    return Result(False, failures.NOT_RESCUED, STOW_FRAMES)


class Deciding(Agent):
    """Decides as another agent does."""

    def __init__(self, decides: str = "greedy") -> None:
        """Raises ValueError for an agent that sees what is hidden."""
        self.inner = agent(decides)
        if self.inner.privileged:
            raise ValueError(f"decides must be an agent that sees what the robot sees, got {decides!r}")
        self.colours = self.inner.colours

    def reset(self, brief: Brief) -> None:
        """Begin an episode."""
        self.inner.reset(brief)

    def act(self, decision: Decision) -> Action:
        """What the other agent does."""
        action, self.note = self.inner.act(decision), self.inner.note
        return action


class Policies(Deciding):
    """Moves by the networks in the folder `weights`."""

    def __init__(self, weights: str, decides: str = "greedy") -> None:
        super().__init__(decides)
        torch.set_num_threads(1)  # quicker for networks as small as these
        self.models: dict[str, Any] = {"walk": Walker(), **{n: Hand(torch.zeros(2, 38)) for n in ARM}}
        for name, model in self.models.items():
            model.load_state_dict(load_file(Path(weights) / f"{name}.safetensors"))
            model.eval()

    def skill(self, stage: Stage, action: Action) -> Skill:
        """The network that does `action`, or the benchmark's skill where none has learned it."""
        verb = VERBS.get(action.verb)
        if verb == "stow" and action.target is None:
            return stowed(stage, self.models["stow"])
        if verb not in ("walk", "reach") or action.target not in stage.labeller.names:
            return actions.skill(stage, action)
        index = stage.labeller.index(action.target)
        if verb == "walk":
            return walked(stage, index, self.models["walk"])
        return reaching.played(self.models["reach"].output)(stage, index)
