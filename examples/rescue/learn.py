"""Learn to walk, reach and stow from the benchmark's skills, for policies.py: see there; teach.py records them."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import torch
from safetensors.torch import save_file
from torch import Tensor, nn

sys.path.insert(0, str(Path(__file__).parent))
import teach  # noqa: E402
from hands import ARM, Hand, error  # noqa: E402
from walks import Walker  # noqa: E402

TASKS = ["HazardFire-v1", "HazardFlood-v1"]
EPOCHS, BATCH, RATE = {"walk": 12, "reach": 20, "stow": 12}, 256, 1e-3
TAKES = 30  # which of a hand's numbers says that it would take the thing if it shut now
MIRRORED = torch.tensor([1.0, 1.0, 1.0, -1.0, -1.0, 1.0, 1.0, -1.0, -1.0, 1.0])  # a walk's numbers where left is right


def strayed(model: Walker, maps: Tensor, numbers: Tensor, wanted: Tensor) -> Tensor:
    """The error of a walk's network."""
    if torch.rand(()) < 0.5:  # a room in a mirror is as good: left is right there
        maps, numbers, wanted = maps.flip(-1), numbers * MIRRORED, wanted * torch.tensor([1.0, -1.0, 1.0])
    ways, likely, over = model(maps, numbers)
    off = (ways - wanted[:, None, :2]).square().mean(-1)
    near, which = off.min(1)
    loss = near.mean() + 0.1 * off.mean() + 0.2 * nn.functional.cross_entropy(likely, which)
    return loss + 0.2 * nn.functional.binary_cross_entropy_with_logits(over, wanted[:, 2])


def missed(model: Hand, seen: Tensor, wanted: Tensor) -> Tensor:
    """The error of a hand's network."""
    return error(model(seen), wanted)


def fit(name: str, model: nn.Module, data: list[Tensor], off: Callable[..., Tensor], out: Path) -> None:
    """Train `model` by the error `off` on all rows of `data`; write it, and its curve, into the folder `out`."""
    epochs, rows, curve = EPOCHS[name], len(data[0]), ["epoch,loss"]
    optimiser = torch.optim.AdamW(model.parameters(), RATE)
    rates = torch.optim.lr_scheduler.OneCycleLR(optimiser, RATE, total_steps=epochs * -(-rows // BATCH))
    for epoch in range(epochs):
        losses = []
        for some in torch.randperm(rows).split(BATCH):
            loss = off(model, *(part[some] for part in data))
            optimiser.zero_grad()
            loss.backward()
            optimiser.step()
            rates.step()
            losses.append(loss.item())
        print(f"{name}: {rows} frames, epoch {epoch + 1} of {epochs}, loss {np.mean(losses):.4f}", flush=True)
        curve.append(f"{epoch + 1},{np.mean(losses):.4f}")
    save_file(model.state_dict(), out / f"{name}.safetensors")
    (out / f"{name}.csv").write_text("\n".join(curve) + "\n", encoding="utf-8")


def train(demos: list[Path], out: Path, seed: int = 0) -> None:
    """Train the networks on the files `demos`, and write them into the folder `out`."""
    files = [np.load(path) for path in demos]
    data: dict[str, list[Tensor]] = {}
    for name, parts in (("walk", 3), *((name, 2) for name in ARM)):
        own = [[file[f"{name}_{part}"] for file in files if f"{name}_{part}" in file] for part in range(parts)]
        data[name] = [torch.from_numpy(np.concatenate(part)) for part in own]
    out.mkdir(parents=True, exist_ok=True)
    torch.set_num_threads(1)  # quicker for networks as small as these
    for name in ARM:
        torch.manual_seed(seed)
        seen, wanted = data[name]
        if name == "reach":  # the hand may shut as soon as it would take the thing: skills come nearer first
            wanted[:, 9] = torch.maximum(wanted[:, 9], seen[:, TAKES])
        fit(name, Hand(seen), [seen, wanted], missed, out)
    torch.manual_seed(seed)
    fit("walk", Walker(), data["walk"], strayed, out)


def demonstrate(out: Path, tasks: list[str], seeds: list[int], weights: Path | None = None, seed: int = 0) -> None:
    """Record whole rescues."""
    teach.rescues(teach.teacher_of(seed, weights), out, tasks, seeds)


def reach(
    out: Path, tasks: list[str], seeds: list[int], weights: Path | None = None, each: int = 4, seed: int = 0
) -> None:
    """Record reaches and stows from places all around targets."""
    teach.reaches(teach.teacher_of(seed, weights), out, tasks, seeds, each)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    commands = parser.add_subparsers(required=True)
    for do in (demonstrate, reach, train):
        command = commands.add_parser(do.__name__, help=do.__doc__)
        command.set_defaults(do=do)
        command.add_argument("--seed", type=int, default=0, help="of chance")
        if do is train:
            command.add_argument("demos", type=Path, nargs="+")
            command.add_argument("--out", type=Path, required=True)
            continue
        command.add_argument("out", type=Path)
        tasks, seeds = (TASKS, [0, 75, 5]) if do is demonstrate else (TASKS[:1], [0, 75, 5])
        command.add_argument("--tasks", nargs="+", default=tasks)
        command.add_argument("--seeds", type=int, nargs="+", default=seeds, help="of rooms, as of Python's range")
        command.add_argument("--weights", type=Path, help="folder of networks that begin, before a skill takes over")
        if do is reach:
            command.add_argument("--each", type=int, default=4, help="places around each target")
    given = vars(parser.parse_args())
    given.pop("do")(**given)


if __name__ == "__main__":
    main()
