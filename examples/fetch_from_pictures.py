"""Walk to a thing, take it and put it into the bag, from pictures: one policy walks, another takes.

    python examples/fetch_from_pictures.py look learned/calm.npz
    python examples/fetch_from_pictures.py look learned/fire.npz --each 12 --seed 1 --hazards fire
    python examples/fetch_from_pictures.py look learned/flood.npz --each 8 --seed 2 --hazards flood
    python examples/fetch_from_pictures.py walk learned/calm.npz learned/{fire,fire,flood,flood}.npz --out learned/walk
    hazard-ms demos record -e HazardStow-v1 --load hazard_ms.tasks.practice -a oracle \\
        --obs rgb --cameras head+wrist --perturb control:2 --no-verify -n 300 -o demos
    python examples/act_from_pictures.py train demos/HazardStow-v1/oracle --out learned/take
    python examples/fetch_from_pictures.py play learned/walk learned/take --episodes 25

Both are those of `act_from_pictures.py`. The one that takes is shown how by demonstrations that begin before a thing.
The one that walks is shown no walk: the robot is put anywhere in rooms of `train`, before stands on which nothing is,
too, and looks; what belongs to the picture is what a walk that begins there would send, worked out on the plan of the
room. So it sees all that it may come to, and not only what a walk sees that goes straight to its goal (the corrections
of DAgger without playing: Ross et al., AISTATS 2011). Where the thing is not in the picture, it is shown to turn left.

It sees all that is before it at the full resolution of its camera, in which a thing 4 m away is three pixels wide.
Beside what it sends it foresees whether it has arrived, and where the thing then is before it: nothing acts on the
latter, but who foresees it learns sooner what to look for. If nothing is in the hand TAKES tenths of a second after it
has arrived, it backs off and walks again.
"""

from __future__ import annotations

import importlib
from pathlib import Path
from typing import Any

import act_from_pictures as act
import gymnasium as gym
import numpy as np
import torch
import tyro

from hazard_ms.skills.motor.motion import ALONG, PASSED, wrap
from hazard_ms.skills.motor.navigation import plan

VIEWS = ["far", "near"]  # of the policy that walks
ENV = {"task": "HazardFetch-v1", "cameras": ["wrist"], "every": 3, "robot_uids": "fetch"}
LOOKS = 2  # actions of a walk that are carried out before it looks again
TAKES = 30  # tenths of a second in which something must be in the hand; 99 % of demonstrations need less
BACK = 6  # tenths of a second in which it drives back then, by 0.3 m
ARRIVED, MORE, TURN = -3, 3, -4  # where it foresees whether it has arrived; numbers beside an action; where it turns
EDGE = np.pi / 3  # where pictures end to the left and right [rad]
FRAMES = 12  # from one look beside a hazard to the next
CELL, BESIDE = 0.05, 0.02  # of the plan of a room; least distance of the robot's side from anything where it looks [m]
END, FACING = 0.7, 0.1  # a walk ends so far from the thing [m], turned to it so well [rad]
NEAR, ELSEWHERE, CLOSE_BY = (0.45, 1.3), 0.4, 0.6  # looks from near [m]; chances that they go to a stand, are from near
ASKEW = 1.6  # most that a look is turned away from what it goes to [rad]; half of them are by less than an eighth of it


class Plan:
    """A room from above, and how one walks in it."""

    def __init__(self, base: Any) -> None:
        """Draw the room of the environment `base`."""
        spec, self.robot = base.specs[0], base.agent.build
        self.size = np.array(spec.room.size[:2])
        self.thing = np.array(spec.bodies[0].position[:2])
        self.stands = np.array([(*one.position[:2], one.scale[0] / 2) for one in spec.fixtures])  # middle, half a side
        x, y = np.meshgrid(*(np.arange(-CELL / 2, side + CELL, CELL) for side in self.size))
        inside = (x > 0.0) & (x < self.size[0]) & (y > 0.0) & (y < self.size[1])
        self.height = (~inside | (self.gap(np.stack([x, y], -1)) <= 0.0)).astype(np.float32)

    def gap(self, points: np.ndarray) -> np.ndarray:
        """Distance of `points`, [..., 2], from the nearest stand [m], [...]."""
        beyond = np.abs(points[..., None, :] - self.stands[:, :2]) - self.stands[:, 2:]
        return np.linalg.norm(beyond.clip(min=0.0), axis=-1).min(-1)

    def look(self, chance: np.random.Generator) -> np.ndarray:
        """Anywhere that the robot may stand: x, y [m], heading [rad]; it mostly faces the thing or a stand."""
        while True:
            goal = self.stands[chance.integers(len(self.stands)), :2] if chance.random() < ELSEWHERE else self.thing
            at, angle = chance.uniform((0.0, 0.0), self.size), chance.uniform(-np.pi, np.pi)
            if chance.random() < CLOSE_BY:
                at = goal - chance.uniform(*NEAR) * np.array([np.cos(angle), np.sin(angle)])
            margin = self.robot.radius + BESIDE
            if self.gap(at) > margin and (at > margin).all() and (at < self.size - margin).all():
                off = ASKEW * chance.uniform(-1.0, 1.0) ** 3
                return np.array([*at, wrap(np.arctan2(*(goal - at)[::-1]) + off)])

    def before(self, pose: np.ndarray) -> np.ndarray:
        """Where the thing is before a robot at `pose`: forward, left [m]."""
        east, north = self.thing - pose[:2]
        cos, sin = np.cos(pose[2]), np.sin(pose[2])
        return np.array([cos * east + sin * north, cos * north - sin * east])

    def walk(self, pose: np.ndarray) -> np.ndarray:
        """What a walk to the thing sends from `pose` on, [CHUNK, 2 + MORE].

        It is drive and turn of each tenth of a second, whether it has arrived then, and where the thing is before it.
        Where the thing is not in the picture, it turns left.
        """
        if abs(np.arctan2(*self.before(pose)[::-1])) > EDGE:
            return np.tile((0.0, 1.0, 0.0, *self.before(pose)), (act.CHUNK, 1))
        origin, goal = np.full(2, -CELL), (float(self.thing[0]), float(self.thing[1]))
        start, explored = (float(pose[0]), float(pose[1])), np.ones(self.height.shape, bool)
        path = plan(self.height, explored, CELL, origin, start, goal, self.robot.radius, END - CELL)
        points, rows, pose = list(path.points) if path else [], [], pose.copy()
        for _ in range(act.CHUNK):
            before, sent = self.before(pose), []
            for _ in range(int(ENV["every"])):
                there = np.hypot(*self.before(pose)) <= END
                if there:
                    points = []
                while len(points) > 1 and np.hypot(*(points[0] - pose[:2])) < PASSED:
                    points.pop(0)
                east, north = (points[0] if points else self.thing) - pose[:2]
                off = wrap(np.arctan2(north, east) - pose[2])
                arrived = there and abs(off) < FACING
                turn = np.clip(off / self.robot.turn_step, -1.0, 1.0) * (not arrived)
                drive = float(bool(points) and abs(off) < ALONG)
                ahead = drive * self.robot.forward_step * np.array([np.cos(pose[2]), np.sin(pose[2])])
                pose[:2], pose[2] = pose[:2] + ahead, pose[2] + turn * self.robot.turn_step
                sent.append((drive, turn, arrived))
            rows.append((*np.mean(sent, 0)[:2], sent[0][2], *before))
        return np.array(rows)


def look(
    out: Path, /, *, each: int = 70, rooms: int = 90, seed: int = 0, split: str = "train", hazards: act.Names = ()
) -> None:
    """Look from `each` places in `rooms` rooms, and write the pictures and what a walk sends from there.

    Beside hazards such as fire, FRAMES pass from one look to the next.
    """
    importlib.import_module("hazard_ms.tasks.practice")
    settings = {**ENV, "cameras": [], **({"hazards": list(hazards)} if hazards else {})}
    env = gym.make("hazard_ms.lerobot:HazardRobot-v1", split=split, render_mode=None, **settings)
    base, chance = env.unwrapped.env.unwrapped, np.random.default_rng(seed)
    pictures, chunks = {view: [] for view in VIEWS}, []
    for number in range(rooms):
        env.reset(seed=seed, options={"scene": f"practice/{number}"})
        room, rest = Plan(base), base.agent.action(0.0, 0.0, base.agent.tucked, True)
        for _ in range(each):
            for _ in range(FRAMES if hazards else 0):
                env.unwrapped.env.step(rest)
            room.thing = base.world.position[0, 0, :2].cpu().numpy().astype(float)  # a flood may carry it off
            pose = room.look(chance)
            at = torch.from_numpy(pose).float()
            base.agent.place(torch.tensor([0]), at[None, :2], at[2:])
            seen = base.observer.look()[0].cpu().numpy()
            for view in VIEWS:
                pictures[view].append(act.small(seen, view))
            walk = room.walk(pose)
            chunks.append(np.concatenate([np.tile(rest[: TURN - 1 + MORE], (len(walk), 1)), walk], 1))
        print(f"room {number}: {len(chunks)} looks", flush=True)
    env.close()
    out.parent.mkdir(parents=True, exist_ok=True)
    stacked = {view: np.stack(seen) for view, seen in pictures.items()}
    np.savez_compressed(out, chunks=np.stack(chunks).astype(np.float32), **stacked)


def mirrored(looks: Path) -> act.Rows:
    """The rows of a file of looks, and the same in a mirror; where the thing is hidden, it turns left in both."""
    file = np.load(looks)
    chunks = torch.from_numpy(file["chunks"])
    other = chunks * torch.tensor([*[1.0] * (chunks.shape[2] - 4), -1.0, 1.0, 1.0, -1.0])
    hidden = torch.atan2(chunks[:, 0, -1], chunks[:, 0, -2]).abs() > EDGE
    other[hidden, :, TURN] = 1.0
    pictures = [torch.from_numpy(file[view]) for view in VIEWS]
    both = [torch.cat([view, view.flip(-1)]) for view in pictures]
    return act.Rows(both, torch.zeros(2 * len(chunks), 1), torch.cat([chunks, other]))


def walk(looks: list[Path], /, *, out: Path, minutes: float = 15.0, seed: int = 0) -> None:
    """Train the policy that walks, for some minutes, on the files `looks`, and write it."""
    act.learn(ENV, VIEWS, [mirrored(file) for file in looks], out, minutes, seed)


class Fetching:
    """Who walks until it has arrived, and then takes; without success it walks again."""

    def __init__(self, walks: Path, takes: Path) -> None:
        self.walker, self.taker = act.Policy(walks), act.Policy(takes)
        self.since: int | None = None  # the step since which it takes
        self.until = 0  # the step until which it backs off from where it took nothing

    def coming(self, seen: dict[str, Any], steps: int) -> np.ndarray:
        """The actions to carry out before it is asked again, [K, A], after `steps` of an episode."""
        if steps == 0:
            self.since, self.until = None, 0
        if self.since is not None and steps - self.since >= TAKES and not seen["agent_pos"][-1]:
            self.since, self.until = None, steps + BACK
        if self.since is None:
            foreseen = self.walker.act(seen)
            if steps < self.until:
                foreseen[:, TURN - 1 : ARRIVED + 1] = -1.0, 0.0, 0.0
            on_the_way = int((foreseen[:, ARRIVED] < 0.5).cumprod().sum())
            if on_the_way:
                return foreseen[: min(on_the_way, LOOKS), :-MORE]
            self.since = steps
        return self.taker.act(seen)[: act.CARRIED]


def play(
    walks: Path, takes: Path, /, *, episodes: int = 25, seed: int = 0, split: str = "test", hazards: act.Names = ()
) -> list[bool]:
    """Play episodes with both policies, beside hazards such as fire. Returns which of them succeeded."""
    who = Fetching(walks, takes)
    return act.run(who.walker.env(split, hazards), who.coming, range(seed, seed + episodes))


if __name__ == "__main__":
    tyro.extras.subcommand_cli_from_dict({"look": look, "walk": walk, "play": play}, description=__doc__)
