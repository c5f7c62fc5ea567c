"""Behaviour cloning: a small network learns `pick_up` from frames of demonstrations, and plays it in a new room.

    python examples/clone_pick_up.py                                  # 500 demonstrations, then three policies
    python examples/clone_pick_up.py --demonstrations 50 --scenes 3   # a quick look

The skill `pick_up` plans: it solves the arm's kinematics, and looks for a route past what the map shows. The policy has
no plan. Thirty times a second it reads 38 numbers and says how to move the arm's joints and the base, and whether to
shut the hand. What it does is nevertheless a skill like any other, a generator of actions that `SkillEnv.run` plays.

So that it knows what to do about its own small errors, the skill is disturbed while it demonstrates; the label of each
frame is what it would have done undisturbed (DART: Laskey et al., CoRL 2017).
"""

from __future__ import annotations

import argparse
import math
import platform
import time
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor, nn

import hazard_ms
from hazard_ms.skills.context import LowLevel, Skill, Stage
from hazard_ms.skills.decision import Result
from hazard_ms.skills.executor import SkillEnv
from hazard_ms.skills.failures import MAX_FRAMES
from hazard_ms.skills.motor.grasping import pick_up
from hazard_ms.skills.motor.motion import wrap
from hazard_ms.skills.motor.walking import ARRIVED, known, way_to

TASK, TRAIN, TEST = "HazardFire-v1", "train", "test"  # kitchen_a, living_room_a, craft_room_a; and kitchen_b
ARM, GRIPPER, BASE = slice(0, 7), 7, slice(11, 13)  # of Fetch's action: [rad]; shut below 0; shares of full speed
FRAMES = 120  # after which a policy has failed; 99 % of demonstrations have the thing in the hand after 81 [ours]
LOOKS, QUARTER = 4, math.tau / 4  # looks that show everything around, with a field of view of 120 degrees; [rad]
HEIGHTS, FAR = (0.15, 0.4, 0.6, 0.8), 1.3  # [m] things this high count in the room ahead, which is measured this far
NOISE, KEPT = 0.08, 0.75  # [rad] of the disturbance of each joint, and the share of it left after a frame [ours]
HIDDEN, EPOCHS, BATCH, RATE, DROPOUT = 256, 20, 256, 2e-3, 0.1  # [ours]

Floats = NDArray[np.float32]
Frame = tuple[Floats, Floats]  # what was seen, [38], and its label, [10]
Player = Callable[[Stage, int], Skill]  # plays the pick-up of a thing by its index


class PickUp:
    """A pick-up as the policy knows it: numbers in the frame of the robot's base, in and out."""

    def __init__(self, stage: Stage, index: int) -> None:
        self.stage, self.index, self.start = stage, index, stage.robot.base()
        self.targets = stage.robot.arm()  # last commanded joints [rad], [7]
        self.room = [stage.room_ahead(height, FAR) for height in HEIGHTS]
        self.half = stage.world.extent[0, index].numpy() / 2

    def seen(self) -> Floats:
        """What the policy reads, [38]: the arm, the hand, the thing, the room ahead, how far the base has moved."""
        stage = self.stage
        x, y, heading = stage.robot.base()
        to_base, arm = turned(-heading), stage.robot.arm()
        at, rotation, _ = stage.robot.kinematics(arm)
        hand, thing = (to_base @ (point - (x, y, 0.0)) for point in (at, stage.position(self.index)))
        moved = turned(-self.start[2]) @ (x - self.start[0], y - self.start[1], 0.0)
        touch = (stage.gap(self.index), stage.would_take() == self.index)
        where = (hand, thing, thing - hand, to_base @ rotation[:, 0], moved[:2], [wrap(heading - self.start[2])])
        return np.concatenate([arm, self.targets - arm, *where, touch, self.half, self.room]).astype(np.float32)

    def label(self, action: LowLevel) -> Floats:
        """The output, [10], that means the low-level `action`: steps of the joints, drive and turn, above 0 to shut."""
        steps = (action[ARM] - self.targets) / self.stage.robot.build.arm_step
        return np.concatenate([steps, action[BASE], [-action[GRIPPER]]]).astype(np.float32)

    def action(self, output: Floats) -> LowLevel:
        """The low-level action that the `output`, [10], means."""
        build = self.stage.robot.build
        self.targets = self.targets + np.clip(output[:7], -1.0, 1.0) * build.arm_step
        forward, turn = float(output[7]) * build.forward_step, float(output[8]) * build.turn_step
        return self.stage.robot.action(forward, turn, self.targets, open_hand=output[9] <= 0.0)


def turned(angle: float) -> NDArray[np.float64]:
    """The matrix, [3, 3], that turns by `angle` [rad] about the vertical."""
    c, s = math.cos(angle), math.sin(angle)
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


def starts(env: SkillEnv, scenes: Sequence[str]) -> Iterator[int]:
    """Stand where walks to targets end, in one scene after another, and yield the index of each target in turn.

    Targets that were not seen on the way are left out.
    """
    for scene in scenes:
        print(scene, end=" ", flush=True)
        env.reset(seed=0, options={"scene": scene})
        begin = env.base.get_state_dict()
        stand(env, *env.stage.robot.base(), looks=LOOKS)
        left = [env.base.world.index(0, body.name) for body in env.base.specs[0].targets]
        while able := [index for index in left if known(env.stage, index)]:
            left.remove(able[0])
            restore(env, begin)
            stage, (x, y, _) = env.stage, env.stage.position(able[0])
            edge = float(stage.world.extent[0, able[0], :2].norm()) / 2
            path = way_to(stage, (x, y), ARRIVED + edge, stage.robot.build.reach + edge)
            if path is not None:
                spot = path.points[-1] if len(path.points) else stage.robot.base()
                stand(env, spot[0], spot[1], math.atan2(y - spot[1], x - spot[0]), looks=2)
                yield able[0]


def stand(env: SkillEnv, x: float, y: float, heading: float, looks: int) -> None:
    """Put the robot at `x`, `y` [m] with its `heading` [rad] after `looks` looks around from there."""
    for look in reversed(range(looks)):
        env.base.agent.place(torch.tensor([0]), torch.tensor([[x, y]]), torch.tensor([heading + look * QUARTER]))
        env.base.world.read()
        env.base.episode.see(env.base.agent)
        env.look()


def restore(env: SkillEnv, state: dict[str, Any]) -> None:
    """Put everything back into `state`; only what the robot has seen by now stays."""
    env.base.set_state_dict(state)
    env.seen.frame = int(env.base.world.frame[0])  # a map refuses looks that are older than its last one
    env.stage.bumps.clear()
    env.stage._arm = env.stage.robot.arm()


def demonstrate(env: SkillEnv, count: int, chance: np.random.Generator) -> list[Frame]:
    """The frames of `count` pick-ups that worked, or of all that did if the scenes have fewer."""
    frames, made, tried, began = list[Frame](), 0, 0, time.perf_counter()
    for index in starts(env, chance.permutation(env.base.task.scenes(TRAIN)).tolist()):
        new: list[list[Frame]] = [[], []]
        result = env.run(disturbed(env.stage, index, chance, new, pick_up(env.stage, index)))
        frames, made, tried = frames + new[0] * result.ok, made + result.ok, tried + 1
        if made >= count:
            break
    print(f"\n{made} demonstrations from {tried} pick-ups in {TRAIN}: {(time.perf_counter() - began) / 60.0:.1f} min")
    return frames


def disturbed(stage: Stage, index: int, chance: np.random.Generator, frames: list[list[Frame]], doing: Skill) -> Skill:
    """What is `doing`, with noise on the arm's targets; of `frames` the last list gets those with the thing in hand."""
    now, noise, size, began = PickUp(stage, index), np.zeros(7), NOISE * chance.uniform(0.3, 1.7), stage.frame
    for action in doing:
        frames[stage.held == index].append((now.seen(), now.label(action)))
        noise = KEPT * noise + math.sqrt(1.0 - KEPT**2) * size * chance.normal(size=7)
        now.targets = action[ARM] + noise
        yield np.concatenate([now.targets, action[GRIPPER:]]).astype(np.float32)
    return Result(stage.held == index, frames=stage.frame - began)


class Policy(nn.Module):
    """Two hidden layers between what is seen, [N, 38], and the output, [N, 10]."""

    def __init__(self, seen: Tensor) -> None:
        super().__init__()
        self.mean, self.spread = seen.mean(0), seen.std(0) + 0.02
        layers: list[nn.Module] = []
        for width in (seen.shape[1], HIDDEN):
            layers += [nn.Linear(width, HIDDEN), nn.ReLU(), nn.Dropout(DROPOUT)]
        self.layers = nn.Sequential(*layers, nn.Linear(HIDDEN, 10))

    def forward(self, seen: Tensor) -> Tensor:
        return self.layers(((seen - self.mean) / self.spread).clamp(-5.0, 5.0))

    @torch.no_grad()
    def output(self, now: PickUp) -> Floats:
        return self(torch.from_numpy(now.seen())[None])[0].numpy()


def loss(output: Tensor, label: Tensor) -> Tensor:
    """The error: of steps and drive without squares, so that of two ways one is learnt, and not their middle."""
    off = (output - label).abs()
    shut = nn.functional.binary_cross_entropy_with_logits(output[:, 9], (label[:, 9] > 0.0).float())
    return off[:, :7].mean() + 0.5 * off[:, 7:9].mean() + shut


def train(frames: Sequence[Frame], seed: int) -> Policy:
    """A policy that has learnt from all `frames`."""
    torch.manual_seed(seed)
    seen, labels = (torch.from_numpy(np.stack(part)) for part in zip(*frames, strict=True))
    policy = Policy(seen)
    optimiser = torch.optim.AdamW(policy.parameters(), RATE)
    rates = torch.optim.lr_scheduler.OneCycleLR(optimiser, RATE, total_steps=EPOCHS * -(-len(seen) // BATCH))
    for _ in range(EPOCHS):
        for some in torch.randperm(len(seen)).split(BATCH):
            optimiser.zero_grad()
            loss(policy(seen[some]), labels[some]).backward()
            optimiser.step()
            rates.step()
    return policy.eval()


def played(output: Callable[[PickUp], Floats]) -> Player:
    """The skill that does what `output`, [10], says in each frame, until the thing is in the hand."""

    def play(stage: Stage, index: int) -> Skill:
        now = PickUp(stage, index)
        for frame in range(FRAMES):
            if stage.held == index:
                return Result(True, frames=frame)
            yield now.action(output(now))
        return Result(False, MAX_FRAMES, FRAMES)

    return play


def score(env: SkillEnv, players: dict[str, Player], scenes: Sequence[str]) -> None:
    """Let all `players` do every pick-up of `scenes` that the skill can do, and print how many each did."""
    done: Counter[str] = Counter()
    for index in starts(env, scenes):
        begin = env.base.get_state_dict()
        done["all"] += 1
        if env.run(pick_up(env.stage, index)).ok:
            done["skill"] += 1
            for name, player in players.items():
                restore(env, begin)
                done[name] += env.run(player(env.stage, index)).ok
    print(f"\nthe skill does {done['skill']} of {done['all']} pick-ups in {len(scenes)} scenes of {TEST}; of these")
    for name in players:
        print(f"  {name:16} {done[name]:4}  {done[name] / max(1, done['skill']):6.1%}")


def main(words: Sequence[str] | None = None) -> None:
    """Record, train, score, and print the numbers."""
    parser = argparse.ArgumentParser(description="Clone the skill pick_up from demonstrations, and score the policies.")
    parser.add_argument("--demonstrations", type=int, default=500, help="pick-ups to learn from")
    parser.add_argument("--scenes", type=int, default=25, help="scenes to score in, up to 25")
    parser.add_argument("--seeds", type=int, default=3, help="policies to train, each from its own first weights")
    asked = parser.parse_args(words)
    torch.set_num_threads(1)  # quicker for so small a network
    print(f"hazard_ms {hazard_ms.__version__}, torch {torch.__version__}, Python {platform.python_version()}")
    env = SkillEnv.make(TASK, effects="off")
    frames = demonstrate(env, asked.demonstrations, np.random.default_rng(0))
    players = {f"clone, seed {seed}": played(train(frames, seed).output) for seed in range(asked.seeds)}
    chance = np.random.default_rng(0)
    players["random"] = played(lambda now: chance.uniform(-1.0, 1.0, 10).astype(np.float32))
    score(env, players, env.base.task.scenes(TEST)[: asked.scenes])
    env.close()


if __name__ == "__main__":
    main()
