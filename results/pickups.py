"""How often pick-ups and walks work in episodes: `./run python results/pickups.py [EPISODES] [TASK...]`.

Plays the agents below in the first EPISODES scenes (10) of each split that nobody trains on, physics `paper`, Fetch,
and prints the share of pick-ups and walks that worked, with reason, stand and frames of each kind of failure. `--write`
also writes every attempt to build/pickups.jsonl. An attempt counts once it has begun: refusals, such as `too_far`, and
what the end of the episode broke off do not.
"""

from __future__ import annotations

import json
import sys
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass, field

import numpy as np

from hazard_ms.agents.base import agent
from hazard_ms.evaluation.options import EpisodeOptions
from hazard_ms.evaluation.runner import Runner
from hazard_ms.evaluation.watchers import Watcher
from hazard_ms.simulation.world import rotate
from hazard_ms.skills import failures
from hazard_ms.skills.decision import PICK_UP, WALK_ONE_STEP, WALK_TO, Action, Decision, Result
from hazard_ms.skills.executor import SkillEnv
from hazard_ms.tasks import task_of
from results.tables import HERE, TASKS, machine

AGENTS = ("greedy", "oracle")
SPLITS = ("test", "new_objects", "hard", "large")
EPISODES = 10
FILE = HERE.parent / "build" / "pickups.jsonl"
VERBS = (PICK_UP, WALK_TO, WALK_ONE_STEP)
REFUSALS = {
    failures.TOO_FAR,
    failures.NOT_A_TARGET,
    failures.ALREADY_RESCUED,
    failures.ALREADY_HOLDING,
    failures.UNKNOWN,
    failures.EPISODE_OVER,
}
MOVING = 0.1  # speed from which a thing counts as moving [m/s] [ours]
NEAR = 0.06  # height by which a thing may seem to lie off what it lies on [m] [ours]
OVER = 0.5  # height up to which a thing above another one is in the way of a hand [m] [ours]


@dataclass
class Attempt:
    """One pick-up or walk."""

    task: str
    split: str
    agent: str
    scene: str
    frame: int
    verb: str
    target: str
    stand: str  # where the thing was
    height: float  # of its middle [m]
    speed: float  # of it [m/s]
    away: float  # from the base's middle to its middle [m]
    ok: bool = False
    reason: str = ""
    frames: int = 0
    last: float = 0.0  # from the base's middle to where the thing is at the end [m]


@dataclass
class Attempts(Watcher):
    """Notes the attempts of one episode."""

    task: str
    split: str
    agent: str
    made: list[Attempt] = field(default_factory=list)
    _now: Attempt | None = None

    def begin(self, env: SkillEnv, decision: Decision) -> None:
        """Remember the environment."""
        self._env = env

    def decided(self, decision: Decision, action: Action, note: str) -> None:
        """Note where the thing is that the action is for."""
        self._now = None
        if action.verb not in VERBS or action.target is None:
            return
        index = self._env.labeller.thing(decision.index(action.target))
        world = self._env.base.world
        self._index = index
        self._now = Attempt(
            self.task,
            self.split,
            self.agent,
            self._env.base.specs[0].name,
            decision.frame,
            action.verb,
            action.target,
            stand(self._env, index),
            round(float(world.position[0, index, 2]), 3),
            round(float(world.velocity[0, index].norm()), 3),
            self._away(),
        )

    def _away(self) -> float:
        x, y, _ = self._env.stage.robot.base()
        return round(float(np.hypot(*(self._env.stage.position(self._index)[:2] - (x, y)))), 3)

    def ended(self, result: Result) -> None:
        """Note what became of it."""
        if self._now is not None:
            self._now.ok, self._now.reason, self._now.frames = result.ok, result.reason, result.frames
            self._now.last = self._away()
            self.made.append(self._now)


def stand(env: SkillEnv, index: int) -> str:
    """Where the thing of `index` along B is, in words."""
    world = env.base.world
    place, half = world.position[0].cpu().numpy(), world.extent[0].cpu().numpy() / 2
    present = (world.exists & ~world.away & ~world.held)[0].cpu().numpy()
    present[index] = False
    local = rotate(world.rotation[0], world.position[0, index] - world.position[0], back=True).cpu().numpy()
    over = present & (np.abs(local[:, :2]) < half[:, :2]).all(-1)  # its middle is over, in or under them
    low, high = place[index, 2] - half[index, 2], place[index, 2] + half[index, 2]
    bottoms, tops = place[:, 2] - half[:, 2], place[:, 2] + half[:, 2]
    kinds = [name.rpartition("_")[0] for name in world.names[0]]
    words = []
    if float(world.velocity[0, index].norm()) > MOVING:
        words.append("moving")
    water = world.fields.get("water")
    if water is not None and float(water(world.position[:, index : index + 1])[0, 0]) > low + NEAR:
        words.append("in water")
    if low < NEAR:
        words.append("floor")
    words += [f"in {kinds[n]}" for n in np.flatnonzero(over & (bottoms < low - NEAR) & (tops > low + NEAR))]
    words += [f"on {kinds[n]}" for n in np.flatnonzero(over & (np.abs(tops - low) <= NEAR))]
    words += [f"under {kinds[n]}" for n in np.flatnonzero(over & (bottoms > high - NEAR) & (bottoms < high + OVER))]
    return ", ".join(words) or "in the air"


def played(task: str, split: str, name: str, episodes: int) -> Iterator[Attempt]:
    """The attempts of an agent in the first `episodes` scenes of a split."""
    options = EpisodeOptions(env_id=TASKS[task], split=split, physics="paper", agent=name, effects="off")
    env = SkillEnv.make(options.env_id, effects="off", **{k: options.settings[k] for k in ("split", "physics")})
    try:
        for seed in range(episodes):
            watcher = Attempts(task, split, name)
            Runner(env, agent(name), (watcher,)).run(seed)
            yield from watcher.made
    finally:
        env.close()


def scenes(task: str, split: str) -> int:
    """The number of scenes of a split; 0 in splits of rooms alone for a task in streets."""
    try:
        return len(task_of(TASKS[task], "paper").scenes(split))
    except ValueError:
        return 0


def rates(made: Sequence[Attempt]) -> str:
    """The tables of `made`."""
    lines = ["| task | split | agent | pick-ups worked | of | walks failed | of |", "|---|---|---|---|---|---|---|"]
    begun = [a for a in made if a.reason not in REFUSALS]
    cells = sorted({(a.task, a.split, a.agent) for a in made})
    for cell in [*cells, ("all", "", "")]:
        own = [a for a in begun if cell[0] == "all" or (a.task, a.split, a.agent) == cell]
        picks = [a for a in own if a.verb == PICK_UP]
        walks = [a for a in own if a.verb != PICK_UP]
        worked, failed = sum(a.ok for a in picks), sum(not a.ok and a.reason != failures.MAX_FRAMES for a in walks)
        shares = [f"{100 * n / max(len(of), 1):.1f} %" for n, of in ((worked, picks), (failed, walks))]
        lines.append(f"| {' | '.join(cell)} | {shares[0]} | {len(picks)} | {shares[1]} | {len(walks)} |")
    for what, verbs in (("pick-ups", (PICK_UP,)), ("walks", (WALK_TO, WALK_ONE_STEP))):
        lost = [a for a in begun if a.verb in verbs and not a.ok and a.reason != failures.MAX_FRAMES]
        lines += ["", f"| {what} that failed | task | stand | times | frames lost |", "|---|---|---|---|---|"]
        for (reason, task, where), times in Counter((a.reason, a.task, a.stand) for a in lost).most_common(40):
            frames = sum(a.frames for a in lost if (a.reason, a.task, a.stand) == (reason, task, where))
            lines.append(f"| {reason} | {task} | {where} | {times} | {frames} |")
    return "\n".join(lines)


def main(words: Sequence[str]) -> None:
    """Play and print."""
    counts = [int(word) for word in words if word.isdigit()]
    tasks = [word for word in words if word in TASKS] or [*TASKS]
    splits = [word for word in words if word in SPLITS or word == "train"] or [*SPLITS]
    agents = [word for word in words if word in AGENTS] or [*AGENTS]
    made: list[Attempt] = []
    for task in tasks:
        for split in splits:
            episodes = min(scenes(task, split), counts[0] if counts else EPISODES)
            for name in agents if episodes else ():
                made += played(task, split, name, episodes)
                print(task, split, name, file=sys.stderr, flush=True)
                if "--write" in words:
                    FILE.parent.mkdir(exist_ok=True)
                    FILE.write_text("".join(json.dumps(asdict(a)) + "\n" for a in made))
    print(f"Played at {machine()}; {', '.join(agents)}.\n\n{rates(made)}")


if __name__ == "__main__":
    main(sys.argv[1:])
