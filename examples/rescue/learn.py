"""Learn to walk, reach and stow from the benchmark's skills, for policies.py: see there.

Skills demonstrate in rooms of `train`, while noise leads the robot astray; the label of each frame is what the skill
does about it (DART: Laskey et al., CoRL 2017). Then the networks play themselves, and the label of some of their frames
is what a skill that begins there would do (DAgger: Ross et al., AISTATS 2011).
"""

from __future__ import annotations

import argparse
import copy
import math
import sys
from pathlib import Path

import numpy as np
import torch
from safetensors.torch import save_file
from torch import nn

from hazard_ms import Action
from hazard_ms.evaluation.options import EpisodeOptions
from hazard_ms.evaluation.runner import play
from hazard_ms.skills import actions
from hazard_ms.skills.context import LowLevel, Skill, Stage
from hazard_ms.skills.decision import Result
from hazard_ms.skills.motor.arm import follow
from hazard_ms.skills.motor.grasping import come_near
from hazard_ms.skills.motor.motion import ALIGNED, turn_by, turn_to
from hazard_ms.skills.motor.reaching import GRASP, arm_way
from hazard_ms.skills.motor.walking import known, walk_to

sys.path[:0] = [str(Path(__file__).parent), str(Path(__file__).parents[1])]
import clone_pick_up as reaching  # noqa: E402
from policies import ARM, LOOK, REACH, VERBS, Deciding, Hand, Policies, Walk, Walker, error  # noqa: E402

SWERVE, KEPT = 0.7, 0.9  # noise in how fast it turns, as a share of full speed; the share of it left after a frame
EPOCHS, BATCH, RATE = 12, 256, 1e-3
ASIDE, AWAY = 1.2, 0.3  # a reach whose base turns [rad] or drives [m] farther is left out: it goes to another place
CORRECTED = 4  # frames of a network of which one is labelled, for all of them
EVERY, ENDS = 2, 4  # frames of walks of which one is learned from: the next looks the same; times that an end counts
MIRRORED = torch.tensor([1.0, 1.0, 1.0, -1.0, -1.0, 1.0, 1.0, -1.0, -1.0, 1.0])  # a walk's numbers where left is right


class Notes:
    """Frames with labels."""

    def __init__(self) -> None:
        self.walks: list[tuple[np.ndarray, np.ndarray, np.ndarray]] = []  # maps, numbers, label
        self.frames: dict[str, list[reaching.Frame]] = {name: [] for name in ARM}

    def write(self, out: Path) -> None:
        """Write all that was noted so far."""
        made = {f"walk_{part}": np.stack(rows) for part, rows in enumerate(zip(*self.walks, strict=True))}
        for name, rows in self.frames.items():
            made.update({f"{name}_{part}": np.stack(own) for part, own in enumerate(zip(*rows, strict=True))})
        np.savez_compressed(out, **made)


class Teacher(Deciding):
    """Moves by the benchmark's skills while noise leads them astray, and notes what they do about it."""

    def __init__(self, seed: int = 0) -> None:
        super().__init__()
        self.chance, self.notes = np.random.default_rng(seed), Notes()

    def skill(self, stage: Stage, action: Action) -> Skill:
        """The benchmark's skill for `action`, disturbed."""
        doing, verb = actions.skill(stage, action), VERBS.get(action.verb)
        if verb == "walk" and action.target in stage.labeller.names:
            return self.swerving(stage, doing, stage.labeller.index(str(action.target)))
        if verb == "reach":
            return self.trembling(stage, doing, stage.labeller.index(str(action.target)), ("reach", "stow"))
        if verb == "stow" and action.target is None:
            return self.trembling(stage, doing, stage.held, ("stow", "stow"))
        return doing

    def swerving(self, stage: Stage, doing: Skill, index: int) -> Skill:
        """A walk that turns more or less than the skill wants."""
        walk, noise, size, results = Walk(stage, index), 0.0, SWERVE * self.chance.random(), list[Result]()
        for used, action in enumerate(noting(doing, results)):
            wanted = action[reaching.BASE].copy()
            if known(stage, index) and used % LOOK == 0:
                walk.plan()
            if known(stage, index) and used % EVERY == 0:
                self.notes.walks.append((walk.maps(), walk.numbers(), np.append(wanted, 0.0).astype(np.float32)))
            noise = KEPT * noise + math.sqrt(1.0 - KEPT**2) * size * self.chance.normal()
            action[reaching.BASE] = np.clip(wanted + (0.0, noise), -1.0, 1.0)
            yield action
        if results[0].ok and known(stage, index):
            self.notes.walks += [(walk.maps(), walk.numbers(), np.array([0.0, 0.0, 1.0], np.float32))] * ENDS
        return results[0]

    def trembling(self, stage: Stage, doing: Skill, index: int, names: tuple[str, str]) -> Skill:
        """A reach or a stow whose arm goes a little astray; `names`: what frames are of before and while it is held."""
        rows: list[list[reaching.Frame]] = [[], []]
        results = list[Result]()
        yield from reaching.disturbed(stage, index, self.chance, rows, noting(doing, results))
        moved = np.array([seen[26:29] for seen, _ in rows[0]]).reshape(-1, 3)
        if results[0].ok and (np.abs(moved) < (AWAY, AWAY, ASIDE)).all():
            for name, own in zip(names, rows, strict=True):
                self.notes.frames[name] += own
        return results[0]


def noting(doing: Skill, results: list[Result]) -> Skill:
    """The same as `doing`; `results` get what it returns."""
    results.append((yield from doing))
    return results[0]


class Pupil(Policies):
    """Moves by networks, and notes what the benchmark's skills would do where that leads."""

    def __init__(self, weights: str) -> None:
        super().__init__(weights)
        self.notes = Notes()

    def skill(self, stage: Stage, action: Action) -> Skill:
        """The network for `action`, watched."""
        doing, verb = super().skill(stage, action), VERBS.get(action.verb)
        if verb in ("walk", "reach") and action.target in stage.labeller.names:
            return self.watched(stage, doing, str(verb), stage.labeller.index(str(action.target)))
        return doing

    def watched(self, stage: Stage, doing: Skill, verb: str, index: int) -> Skill:
        """What is `doing`, with some of its frames labelled."""
        walk, now, results = Walk(stage, index), reaching.PickUp(stage, index), list[Result]()
        for frame, action in enumerate(noting(doing, results)):
            if verb == "walk" and frame % LOOK == 0:
                walk.plan()
            if frame % CORRECTED == 0:
                other = copy.copy(stage)  # whose arm may be moved in thought
                label = first(walk_to(other, index)) if verb == "walk" else grasp(other, index, now.targets)
                if verb == "reach" and label is not None:
                    self.notes.frames["reach"] += [(now.seen(), now.label(label))] * CORRECTED
                elif verb == "walk" and (label is not None or walk.way()[0] < REACH):
                    said = (0.0, 0.0, 1.0) if label is None else (*label[reaching.BASE], 0.0)
                    self.notes.walks += [(walk.maps(), walk.numbers(), np.array(said, np.float32))] * CORRECTED
            yield action
            now.targets = np.array(action[reaching.ARM], np.float64)
        return results[0]


def grasp(stage: Stage, index: int, targets: np.ndarray) -> LowLevel | None:
    """What leads a hand whose arm was sent to `targets` [rad] on to the thing `index`; None where nothing does."""
    stage._arm = np.array(targets, np.float64)
    if stage.would_take() == index and stage.gap(index) < GRASP:
        return stage.act(arm=stage._arm, shut=True)
    way = arm_way(stage, index, set(), stage.position(index))
    if way is None:
        near = first(come_near(stage, stage.position(index)))
        return first(turn_to(stage, stage.position(index))) if near is None else near
    return first(turn_by(stage, way.turn) if abs(way.turn) > ALIGNED else follow(stage, way.route))


def first(doing: Skill) -> LowLevel | None:
    """The first action of a skill; None if it ends without one."""
    action = next(doing, None)
    doing.close()
    return action


def record(player: Teacher | Pupil, out: Path, tasks: list[str], seeds: list[int]) -> None:
    """Let `player` play the seeds from `seeds[0]` to before `seeds[1]` of `tasks` in `train`, and write its notes."""
    notes = player.notes
    for number in range(*seeds):
        for task in tasks:
            result = play(EpisodeOptions(task, split="train", seed=number, effects="off"), player=player)
            told = {"walk": len(notes.walks), **{name: len(rows) for name, rows in notes.frames.items()}}
            print(f"{task} {number}: {100 * result.tally.value:.0f} % rescued; frames so far: {told}", flush=True)
        if number % 5 == 4 or number == seeds[-1] - 1:
            notes.write(out)


def demonstrate(out: Path, tasks: list[str], seeds: list[int], seed: int = 0) -> None:
    """Note what skills do that noise leads astray."""
    record(Teacher(seed), out, tasks, seeds)


def correct(out: Path, weights: Path, tasks: list[str], seeds: list[int]) -> None:
    """Note what skills would do where the networks in `weights` lead."""
    record(Pupil(str(weights)), out, tasks, seeds)


def train(demos: list[Path], out: Path, seed: int = 0) -> None:
    """Train the networks on the files `demos`, and write them into the folder `out`."""
    files = [np.load(path) for path in demos]
    data = {name: np.concatenate([file[name] for file in files if name in file]) for name in files[0].files}
    out.mkdir(parents=True, exist_ok=True)
    for name in ARM:
        policy = reaching.train(list(zip(data[f"{name}_0"], data[f"{name}_1"], strict=True)), seed, Hand, error)
        save_file(policy.state_dict(), out / f"{name}.safetensors")
        print(f"{name}: {len(data[f'{name}_0'])} frames", flush=True)
    torch.manual_seed(seed)
    maps, numbers, labels = (torch.from_numpy(data[f"walk_{part}"]) for part in range(3))
    model, steps = Walker(), EPOCHS * -(-len(maps) // BATCH)
    optimiser = torch.optim.AdamW(model.parameters(), RATE)
    rates = torch.optim.lr_scheduler.OneCycleLR(optimiser, RATE, total_steps=steps)
    for epoch in range(EPOCHS):
        losses = []
        for some in torch.randperm(len(maps)).split(BATCH):
            seen, known_, wanted = maps[some], numbers[some], labels[some]
            if torch.rand(()) < 0.5:  # a room in a mirror is as good: left is right there
                seen, known_, wanted = seen.flip(-1), known_ * MIRRORED, wanted * torch.tensor([1.0, -1.0, 1.0])
            ways, likely, over = model(seen, known_)
            off = (ways - wanted[:, None, :2]).square().mean(-1)
            near, which = off.min(1)
            loss = near.mean() + 0.1 * off.mean() + 0.2 * nn.functional.cross_entropy(likely, which)
            loss = loss + 0.2 * nn.functional.binary_cross_entropy_with_logits(over, wanted[:, 2])
            optimiser.zero_grad()
            loss.backward()
            optimiser.step()
            rates.step()
            losses.append(loss.item())
        print(f"walk: {len(maps)} frames, epoch {epoch + 1} of {EPOCHS}, loss {np.mean(losses):.4f}", flush=True)
    save_file(model.state_dict(), out / "walk.safetensors")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    commands = parser.add_subparsers(required=True)
    for do, told in ((demonstrate, "record skills"), (correct, "record networks"), (train, "train networks")):
        command = commands.add_parser(do.__name__, help=told)
        command.set_defaults(do=do)
        if do is train:
            command.add_argument("demos", type=Path, nargs="+")
            command.add_argument("--out", type=Path, required=True)
        else:
            command.add_argument("out", type=Path)
            command.add_argument("--tasks", nargs="+", default=["HazardFire-v1", "HazardFlood-v1"])
            command.add_argument("--seeds", type=int, nargs=2, default=[0, 75], help="first, and one after the last")
        if do is correct:
            command.add_argument("--weights", type=Path, required=True)
        else:
            command.add_argument("--seed", type=int, default=0)
    given = vars(parser.parse_args())
    given.pop("do")(**given)


if __name__ == "__main__":
    main()
