"""Action chunking with transformers, in one file: pictures and joints in, a second of actions out.

    hazard-ms demos record -e HazardPickUp-v1 --load hazard_ms.tasks.practice -a oracle \\
        --obs rgb --cameras head+wrist --perturb control:2 -n 600 -o demos
    python examples/act_from_pictures.py train demos/HazardPickUp-v1/oracle --minutes 30 --out learned/pick_up
    python examples/act_from_pictures.py play learned/pick_up --episodes 25 --hazards fire

Every tenth of a second the policy may look through the robot's cameras and feel its joints; it says what to send in
each of the coming tenths, of which a few are carried out before it looks again (Zhao et al., RSS 2023, without the
variational encoder: a program's demonstrations need none). A small network of convolutions tells where in a picture
some learnt features are (Levine et al., JMLR 2016). It is told neither where things nor where it is. While it is shown
how, noise leads arm and base astray, so that it learns to come back. For walks see fetch_from_pictures.py.
"""

from __future__ import annotations

import importlib
import json
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

import cv2
import gymnasium as gym
import numpy as np
import torch
import tyro
from safetensors.torch import load_file, save_file
from torch import Tensor, nn

from hazard_ms.demonstrations.reading import demonstrations

# what the network sees: the camera; top, left, height and width of the part of its picture, as shares; rows and columns
VIEWS = {
    "head": ("head", (3 / 8, 3 / 16, 5 / 8, 5 / 8), (96, 96)),
    "wrist": ("wrist", (0.0, 0.0, 1.0, 1.0), (96, 96)),
    "far": ("head", (3 / 8, 0.0, 1 / 4, 1.0), (64, 256)),  # a thing 4 m away is as wide as three of its pixels
    "near": ("head", (1 / 2, 0.0, 1 / 2, 1.0), (64, 128)),
}
POINTS = 64  # features whose places in a picture are told
CHUNK, CARRIED = 10, 4  # actions that it foresees; those that are carried out before it looks again
MODES, LOSERS, CHOOSING = 4, 0.1, 0.2  # ways to go on; what all count beside the nearest; what choosing among them does
WIDTH, HEADS, DEPTH, BATCH, RATE, WEIGHT_DECAY = 128, 4, 2, 64, 4e-4, 1e-4
LEAST = 0.1  # spread that numbers count as having at least: what hardly changes must not weigh most
SHIFT, JITTER = 4, 0.1  # most that pictures are shifted [pixels]; noise of joints, as a share of their spread
BASE = 3  # joints that are the robot's place in the world, which it is not told
Names = tuple[str, ...]


class Rows(NamedTuple):
    """What was seen, felt and done: N rows, [N, ...] each."""

    pictures: list[Tensor]  # of each view, [N, 3, H, W], uint8
    body: Tensor  # see `felt`
    chunks: Tensor  # the coming CHUNK actions, [N, CHUNK, A]


class Eye(nn.Module):
    """From a picture, [N, 3, H, W], to what is seen in it, [N, WIDTH]: the places of POINTS features."""

    def __init__(self) -> None:
        super().__init__()
        self.features = nn.Sequential(
            *(nn.Conv2d(3, 24, 5, 2, 2), nn.ReLU(), nn.Conv2d(24, 48, 3, 2, 1), nn.ReLU()),
            *(nn.Conv2d(48, POINTS, 3, 2, 1), nn.ReLU(), nn.Conv2d(POINTS, POINTS, 3, 1, 1)),
        )
        self.out = nn.Sequential(nn.Linear(2 * POINTS, WIDTH), nn.ReLU(), nn.Linear(WIDTH, WIDTH))

    def forward(self, picture: Tensor) -> Tensor:
        with torch.autocast("cpu", torch.bfloat16, self.training):  # faster where a CPU has it
            found = self.features(picture.contiguous(memory_format=torch.channels_last)).float()
        share = found.flatten(2).softmax(-1).reshape(found.shape)  # of each feature, over the picture
        down, along = (torch.linspace(-1.0, 1.0, size) for size in found.shape[2:])
        return self.out(torch.cat([(share.sum(2) * along).sum(-1), (share.sum(3) * down).sum(-1)], 1))


class Chunks(nn.Module):
    """From pictures, [N, 3, H, W] of each view, and the body, [N, J], to ways to go on, [N, MODES, CHUNK, A].

    Beside them, logarithms of how likely each is, [N, MODES]: to reach at once, or to drive first.
    """

    def __init__(self, views: int, joints: int, numbers: int) -> None:
        super().__init__()
        self.eyes = nn.ModuleList(Eye() for _ in range(views))
        self.body = nn.Sequential(nn.Linear(joints, WIDTH), nn.ReLU(), nn.Linear(WIDTH, WIDTH))
        self.places = nn.Parameter(0.02 * torch.randn(views + 1, WIDTH))
        self.queries = nn.Parameter(0.02 * torch.randn(CHUNK, WIDTH))
        shape = dict(d_model=WIDTH, nhead=HEADS, dim_feedforward=3 * WIDTH, dropout=0.1, batch_first=True)
        self.encoder = nn.TransformerEncoder(nn.TransformerEncoderLayer(**shape), DEPTH)  # type: ignore[arg-type]
        self.decoder = nn.TransformerDecoder(nn.TransformerDecoderLayer(**shape), 1)  # type: ignore[arg-type]
        self.out, self.choice = nn.Linear(WIDTH, MODES * numbers), nn.Linear(WIDTH, MODES)
        self.register_buffer("felt", torch.stack([torch.zeros(joints), torch.ones(joints)]))  # mean, spread
        self.register_buffer("sent", torch.stack([torch.zeros(numbers), torch.ones(numbers)]))

    def forward(self, pictures: list[Tensor], body: Tensor) -> tuple[Tensor, Tensor]:
        seen = [eye(view.float() / 255.0 - 0.5) for eye, view in zip(self.eyes, pictures, strict=True)]
        felt = self.body((body - self.felt[0]) / self.felt[1])
        known = self.encoder(torch.stack([felt, *seen], 1) + self.places)
        foreseen = self.decoder(self.queries.expand(len(body), -1, -1), known)
        ways = self.out(foreseen).unflatten(2, (MODES, -1)).transpose(1, 2)
        return ways * self.sent[1] + self.sent[0], self.choice(known[:, 0])

    def loss(self, pictures: list[Tensor], body: Tensor, chunks: Tensor) -> Tensor:
        """How far the nearest way is from what was done, [N, CHUNK, A], in spreads of it, and how unlikely it was."""
        ways, choice = self(pictures, body)
        off = ((ways - chunks[:, None]) / self.sent[1]).square().mean((2, 3))  # a median never drives
        near, which = off.min(1)
        unlikely = nn.functional.cross_entropy(choice, which)
        return (1.0 - LOSERS) * near.mean() + LOSERS * off.mean() + CHOOSING * unlikely


def small(picture: Any, view: str) -> np.ndarray:
    """A camera's square picture, [S, S, 3], as the network sees it in a view, [3, H, W]."""
    _, part, (rows, columns) = VIEWS[view]
    top, left, height, width = (round(share * len(picture)) for share in part)
    picture = picture[top : top + height, left : left + width]
    return np.ascontiguousarray(cv2.resize(picture, (columns, rows), interpolation=cv2.INTER_AREA).transpose(2, 0, 1))


def film(path: Path, view: str) -> np.ndarray:
    """All pictures of a camera's film in a view, [T, 3, H, W]."""
    video = cv2.VideoCapture(str(path))
    return np.stack([small(picture[:, :, ::-1], view) for _, picture in iter(video.read, (False, None))])


def felt(qpos: np.ndarray, held: np.ndarray) -> np.ndarray:
    """What the robot feels, [N, J]: its joints, and whether it holds something."""
    return np.column_stack([qpos[:, BASE:], held])


def sent(one: Any) -> np.ndarray:
    """What was sent from one picture to the next in a demonstration, [T, A]: the mean, which can be sent as long."""
    every, actions = one.meta["every"], one.frames["action"]
    return np.stack([actions[frame : frame + every].mean(0) for frame in range(0, len(actions), every)])


def rows_of(one: Any, views: list[str]) -> Rows:
    """The rows of a demonstration, one for each picture."""
    actions, at = sent(one), np.arange(0, len(one.frames["action"]), one.meta["every"])
    body = felt(one.frames["qpos"][at], one.frames["held"][at] >= 0)
    chunks = actions[np.minimum(np.arange(len(at))[:, None] + np.arange(CHUNK), len(at) - 1)]
    pictures = [torch.from_numpy(film(one.films[VIEWS[view][0]], view)[: len(at)]) for view in views]
    return Rows(pictures, torch.from_numpy(body).float(), torch.from_numpy(chunks).float())


def read(folders: list[Path]) -> list[Any]:
    """The demonstrations of datasets that were recorded with the same cameras."""
    every = [one for folder in folders for one in demonstrations(folder)]
    if not every:
        raise SystemExit(f"{', '.join(map(str, folders))}: no episode")
    return every


def train(folders: list[Path], /, *, out: Path, minutes: float = 30.0, seed: int = 0) -> None:
    """Train for some minutes on the datasets in `folders`, and write the policy."""
    every = read(folders)
    views, one = [*every[0].films], every[0]
    env = {"task": one.result.env_id, "cameras": views[1:], "every": one.meta["every"], "robot_uids": one.meta["robot"]}
    learn(env, views, [rows_of(one, views) for one in every], out, minutes, seed)


def learn(env: dict[str, Any], views: list[str], rows: list[Rows], out: Path, minutes: float, seed: int) -> None:
    """Train on `rows`, and write the policy, to be played in `env`; one that is there already goes on learning."""
    torch.manual_seed(seed)
    pictures = [[seen for part in rows for seen in part.pictures[view]] for view in range(len(views))]  # not copied
    body, chunks = (torch.cat([getattr(part, name) for part in rows]) for name in ("body", "chunks"))
    model = Chunks(len(views), body.shape[1], chunks.shape[2])
    for name, numbers in (("felt", body), ("sent", chunks.flatten(0, 1))):
        getattr(model, name).copy_(torch.stack([numbers.mean(0), numbers.std(0).clamp(min=LEAST)]))
    out.mkdir(parents=True, exist_ok=True)
    (out / "settings.json").write_text(json.dumps({"views": views, "env": env}, indent=1))
    if (out / "policy.safetensors").exists():
        model.load_state_dict(load_file(out / "policy.safetensors"))
    start, done, losses = time.monotonic(), 0.0, []
    optimiser = torch.optim.AdamW(model.parameters(), RATE, weight_decay=WEIGHT_DECAY)
    while done < 1.0:
        done = (time.monotonic() - start) / (60.0 * minutes)
        optimiser.param_groups[0]["lr"] = RATE * max(0.02, 0.5 + 0.5 * np.cos(np.pi * min(done, 1.0)))
        batch = torch.randint(len(body), (BATCH,))
        noisy = body[batch] + JITTER * model.felt[1] * torch.randn(BATCH, body.shape[1])
        shift = torch.randint(-SHIFT, SHIFT + 1, (2,)).tolist()  # as if cameras were not quite in place
        seen = [torch.roll(torch.stack([view[k] for k in batch.tolist()]), shift, (-1, -2)) for view in pictures]
        loss = model.loss(seen, noisy, chunks[batch])
        optimiser.zero_grad()
        loss.backward()
        nn.utils.clip_grad_norm_(model.parameters(), 1.0)
        optimiser.step()
        losses.append(loss.item())
        if len(losses) % 200 == 0:
            save_file(model.state_dict(), out / "policy.safetensors")
            told = f"{len(losses)},{60.0 * minutes * done:.0f},{np.mean(losses[-200:]):.4f}"
            print(f"{100 * done:.0f} %: steps, seconds, loss: {told}", flush=True)
            with (out / "curve.csv").open("a") as curve:
                print(told, file=curve)
    save_file(model.state_dict(), out / "policy.safetensors")
    print(f"{len(losses)} steps in {minutes:g} minutes: loss {np.mean(losses[-50:]):.3f}")


class Policy:
    """A policy that was written by `learn`."""

    def __init__(self, folder: Path) -> None:
        self.settings = json.loads((folder / "settings.json").read_text())
        weights = load_file(folder / "policy.safetensors")
        self.model = Chunks(len(self.settings["views"]), weights["felt"].shape[1], weights["sent"].shape[1])
        self.model.eval().load_state_dict(weights)

    def env(self, split: str, hazards: Names, load: str = "hazard_ms.tasks.practice") -> Any:
        """The environment that it plays in; `load`: the module that registers its task."""
        importlib.import_module(load)
        env = {**self.settings["env"], **({"hazards": list(hazards)} if hazards else {})}
        return gym.make("hazard_ms.lerobot:HazardRobot-v1", split=split, render_mode=None, **env)

    def act(self, seen: dict[str, Any]) -> np.ndarray:
        """The coming actions, [CHUNK, A], from an observation of HazardRobot-v1."""
        told = seen["agent_pos"][None]  # joints, how fast they move, the pose, the hand, whether it holds something
        body = felt(np.split(told[:, :-7], 2, axis=1)[0], told[:, -1])[:, -self.model.felt.shape[1] :]
        pictures = [small(seen["pixels"][VIEWS[view][0]], view) for view in self.settings["views"]]
        with torch.no_grad():
            ways, choice = self.model([torch.from_numpy(one)[None] for one in pictures], torch.from_numpy(body).float())
        return ways[0, int(choice.argmax())].numpy()  # the likeliest way to go on


def run(env: Any, coming: Callable[[dict[str, Any], int], np.ndarray], seeds: range) -> list[bool]:
    """Which seeds succeed if `coming`, from what is seen and the steps so far, tells what to send until asked again."""
    succeeded = []
    for seed in seeds:
        (seen, _), over, steps, info = env.reset(seed=seed), False, 0, {}
        while not over:
            for action in coming(seen, steps):
                if not over:
                    seen, _, terminated, truncated, info = env.step(action)
                    steps, over = steps + 1, terminated or truncated
        succeeded.append(info["is_success"])
        print(f"seed {seed}: {'success' if succeeded[-1] else 'failed'} after {steps} steps", flush=True)
    env.close()
    print(f"{sum(succeeded)} of {len(seeds)} succeeded, {100 * np.mean(succeeded):.0f} %")
    return succeeded


def play(policy: Path, /, *, episodes: int = 25, seed: int = 0, split: str = "test", hazards: Names = ()) -> list[bool]:
    """Play episodes with a policy, beside hazards such as fire. Returns which of them succeeded."""
    who = Policy(policy)
    return run(who.env(split, hazards), lambda seen, _: who.act(seen)[:CARRIED], range(seed, seed + episodes))


if __name__ == "__main__":
    tyro.extras.subcommand_cli_from_dict({"train": train, "play": play}, description=__doc__)
