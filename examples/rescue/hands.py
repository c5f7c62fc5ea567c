"""Reaches and stows of policies.py: what their networks read, the networks, and the skills that do what they say."""

from __future__ import annotations

import math
import sys
from pathlib import Path

import numpy as np
import torch
from torch import Tensor, nn

from hazard_ms.skills import failures
from hazard_ms.skills.context import LowLevel, Skill, Stage
from hazard_ms.skills.decision import Result

sys.path.insert(0, str(Path(__file__).parents[1]))
import clone_pick_up as reaching  # noqa: E402

ARM = ("reach", "stow")  # the networks
ALONG, ACROSS = np.arange(0.2, 1.3, 0.12), np.arange(-0.6, 0.61, 0.15)  # [m] before the base: heights that they read
TALL = 1.5  # [m] from where on heights count alike
SEEN = 38 + len(ALONG) * len(ACROSS)  # numbers that they read
WIDE, DROPPED, WAYS = 384, 0.05, 4  # of layers; share of what they say that is left out while they learn; ways to go on
NEARER, PATIENCE = 0.01, 45  # [m] that counts as coming nearer; frames without after which a reach is given up
OTHERS = 0.02  # weight of the errors of all ways, so that none is never learned: it draws ways to their middle
PRECISE = 4.0  # what errors of the arm [rad] count as much as those of the base [share of full speed]
STOW_FRAMES = 90  # of a stow at most, which takes half of them


def felt(now: reaching.PickUp) -> np.ndarray:
    """What a hand's network reads, [SEEN]: numbers of the pick-up, and the heights seen before the base [m]."""
    seen, (x, y, heading) = now.stage.seen, now.stage.robot.base()
    c, s = math.cos(heading), math.sin(heading)
    along, across = np.meshgrid(ALONG, ACROSS, indexing="ij")
    at = np.stack([y + s * along + c * across, x + c * along - s * across], -1)
    cell = np.floor((at - seen.origin[::-1]) / seen.cell).astype(int)
    row, column = np.clip(cell, 0, np.array(seen.height.shape) - 1).transpose(2, 0, 1)
    return np.concatenate([now.seen(), np.clip(seen.height[row, column], 0.0, TALL).ravel()]).astype(np.float32)


def wanted(now: reaching.PickUp, action: LowLevel) -> np.ndarray:
    """The label, [10], of the `action` that a skill has made just now.

    It is where the arm is to get to [rad], and not the step that leads there: all frames on the way have the same
    label, and who learns it a little wrong still gets there.
    """
    return np.array([*now.stage.last_move[2], *action[reaching.BASE], -action[reaching.GRIPPER]], np.float32)


def step(now: reaching.PickUp, output: np.ndarray) -> LowLevel:
    """The low-level action that the `output`, [10], means."""
    build, left = now.stage.robot.build, output[:7] - now.targets
    now.targets = now.targets + left * min(1.0, build.arm_step / max(float(np.abs(left).max()), 1e-9))
    drive, turn = np.clip(output[7:9], -1.0, 1.0) * (build.forward_step, build.turn_step)
    return now.stage.robot.action(float(drive), float(turn), now.targets, open_hand=output[9] <= 0.0)


class Hand(nn.Module):
    """Three hidden layers between what is read, [N, SEEN], and WAYS outputs, [N, WAYS, 10], of which one is chosen."""

    def __init__(self, seen: Tensor) -> None:
        super().__init__()
        for name, numbers in (("mean", seen.mean(0)), ("spread", seen.std(0) + 0.02)):
            self.register_buffer(name, numbers)
        layers: list[nn.Module] = []
        for width in (SEEN, WIDE, WIDE):
            layers += [nn.Linear(width, WIDE), nn.ReLU(), nn.Dropout(DROPPED)]
        self.layers = nn.Sequential(*layers, nn.Linear(WIDE, 11 * WAYS))

    def forward(self, seen: Tensor) -> tuple[Tensor, Tensor]:
        said = self.layers(((seen - self.mean) / self.spread).clamp(-5.0, 5.0)).unflatten(1, (WAYS, 11))
        return said[..., :10], said[..., 10]

    @torch.no_grad()
    def output(self, now: reaching.PickUp) -> np.ndarray:
        ways, likely = self(torch.from_numpy(felt(now))[None])
        return ways[0, int(likely.argmax())].numpy()


def error(said: tuple[Tensor, Tensor], label: Tensor) -> Tensor:
    """The error of the nearest way: one turns the base, another reaches at once, and their middle does neither."""
    ways, likely = said
    label = label[:, None].expand_as(ways)
    shut = nn.functional.binary_cross_entropy_with_logits(ways[..., 9], (label[..., 9] > 0.0).float(), reduction="none")
    off = (ways - label).square()  # without squares, where an arm mostly rests, it would rest for ever
    off = PRECISE * off[..., :7].mean(-1) + 0.5 * off[..., 7:9].mean(-1) + 0.3 * shut
    near, which = off.min(1)
    return near.mean() + OTHERS * off.mean() + 0.2 * nn.functional.cross_entropy(likely, which)


def reached(stage: Stage, index: int, policy: Hand) -> Skill:
    """A reach for the thing `index` as the `policy` says; it is given up where the hand comes no nearer for long."""
    now, nearest, since = reaching.PickUp(stage, index), math.inf, 0
    for frame in range(reaching.FRAMES):
        if stage.held == index:
            return Result(True, frames=frame)
        if stage.gap(index) < nearest - NEARER:
            nearest, since = stage.gap(index), frame
        if frame - since > PATIENCE:
            return Result(False, failures.MAX_FRAMES, frame)
        yield step(now, policy.output(now))
    return Result(False, failures.MAX_FRAMES, reaching.FRAMES)


def stowed(stage: Stage, policy: Hand) -> Skill:
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
        yield step(now, policy.output(now))
    return Result(False, failures.NOT_RESCUED, STOW_FRAMES)
