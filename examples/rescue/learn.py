"""Learn to walk, reach and stow from the benchmark's skills, for policies.py: see there.

Skills demonstrate in rooms of `train`, while noise leads the robot astray; the label of each frame is what the skill
does about it (DART: Laskey et al., CoRL 2017).
"""

from __future__ import annotations

import argparse
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
from hazard_ms.skills.context import Skill, Stage
from hazard_ms.skills.decision import Result
from hazard_ms.skills.motor.walking import known

sys.path[:0] = [str(Path(__file__).parent), str(Path(__file__).parents[1])]
import clone_pick_up as reaching  # noqa: E402
from policies import ARM, VERBS, Deciding, Walk, Walker  # noqa: E402

SWERVE, KEPT = 0.7, 0.9  # noise in how fast it turns, as a share of full speed; the share of it left after a frame
EPOCHS, BATCH, RATE = 12, 256, 1e-3
EVERY, ENDS = 2, 4  # frames of walks of which one is learned from: the next looks the same; times that an end counts
MIRRORED = torch.tensor([1.0, 1.0, 1.0, -1.0, -1.0, 1.0, -1.0, 1.0, -1.0])  # a walk's numbers where left is right


class Teacher(Deciding):
    """Moves by the benchmark's skills while noise leads them astray, and notes what they do about it."""

    def __init__(self, decides: str = "greedy", seed: int = 0) -> None:
        super().__init__(decides)
        self.chance = np.random.default_rng(seed)
        self.walks: list[tuple[np.ndarray, np.ndarray, np.ndarray]] = []  # maps, numbers, label
        self.frames: dict[str, list[reaching.Frame]] = {name: [] for name in ARM}

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
            if known(stage, index):
                numbers = walk.numbers()
                if used % EVERY == 0:
                    self.walks.append((walk.maps(), numbers, np.append(wanted, 0.0).astype(np.float32)))
            noise = KEPT * noise + math.sqrt(1.0 - KEPT**2) * size * self.chance.normal()
            walk.sent = np.clip(wanted + (0.0, noise), -1.0, 1.0).astype(np.float32)
            action[reaching.BASE] = walk.sent
            yield action
        if results[0].ok and known(stage, index):
            self.walks += [(walk.maps(), walk.numbers(), np.array([0.0, 0.0, 1.0], np.float32))] * ENDS
        return results[0]

    def trembling(self, stage: Stage, doing: Skill, index: int, names: tuple[str, str]) -> Skill:
        """A reach or a stow whose arm goes a little astray; `names`: what frames are of before and while it is held."""
        rows: list[list[reaching.Frame]] = [[], []]
        results = list[Result]()
        yield from reaching.disturbed(stage, index, self.chance, rows, noting(doing, results))
        if results[0].ok:
            for name, own in zip(names, rows, strict=True):
                self.frames[name] += own
        return results[0]


def noting(doing: Skill, results: list[Result]) -> Skill:
    """The same as `doing`; `results` get what it returns."""
    results.append((yield from doing))
    return results[0]


def demonstrate(out: Path, tasks: list[str], seeds: list[int], seed: int = 0) -> None:
    """Play the seeds from `seeds[0]` to before `seeds[1]` of `tasks` in `train`, and write what was noted."""
    teacher = Teacher(seed=seed)
    for number in range(*seeds):
        for task in tasks:
            result = play(EpisodeOptions(task, split="train", seed=number, effects="off"), player=teacher)
            told = {"walk": len(teacher.walks), **{name: len(rows) for name, rows in teacher.frames.items()}}
            print(f"{task} {number}: {100 * result.tally.value:.0f} % rescued; frames so far: {told}", flush=True)
        if number % 5 == 4 or number == seeds[-1] - 1:
            made = {f"walk_{part}": np.stack(rows) for part, rows in enumerate(zip(*teacher.walks, strict=True))}
            for name, rows in teacher.frames.items():
                made.update({f"{name}_{part}": np.stack(own) for part, own in enumerate(zip(*rows, strict=True))})
            np.savez_compressed(out, **made)


def train(demos: list[Path], out: Path, seed: int = 0) -> None:
    """Train the networks on the files `demos`, and write them into the folder `out`."""
    files = [np.load(path) for path in demos]
    data = {name: np.concatenate([file[name] for file in files]) for name in files[0].files}
    out.mkdir(parents=True, exist_ok=True)
    for name in ARM:
        policy = reaching.train(list(zip(data[f"{name}_0"], data[f"{name}_1"], strict=True)), seed)
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
            said = model(seen, known_)
            over = nn.functional.binary_cross_entropy_with_logits(said[:, 2], wanted[:, 2])
            loss = (said[:, :2] - wanted[:, :2]).abs().mean() + 0.2 * over
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
    (one := commands.add_parser("demonstrate")).set_defaults(do=demonstrate)
    one.add_argument("out", type=Path)
    one.add_argument("--tasks", nargs="+", default=["HazardFire-v1", "HazardFlood-v1"])
    one.add_argument("--seeds", type=int, nargs=2, default=[0, 75], help="the first, and the one after the last")
    (two := commands.add_parser("train")).set_defaults(do=train)
    two.add_argument("demos", type=Path, nargs="+")
    two.add_argument("--out", type=Path, required=True)
    for command in (one, two):
        command.add_argument("--seed", type=int, default=0)
    given = vars(parser.parse_args())
    given.pop("do")(**given)


if __name__ == "__main__":
    main()
