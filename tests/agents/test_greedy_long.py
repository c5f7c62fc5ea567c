"""Greedy and random agents on the same 20 seeds; `./run test --long -k greedy -s` prints the table (15 minutes)."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import gymnasium as gym
import numpy as np
import pytest

import hazard_ms  # noqa: F401
from hazard_ms.agents.base import agent
from hazard_ms.evaluation.metrics import Tally, scores
from hazard_ms.evaluation.options import EpisodeOptions
from hazard_ms.evaluation.result import versions
from hazard_ms.evaluation.runner import Runner, fates
from hazard_ms.evaluation.watchers import Watcher
from hazard_ms.skills.decision import Decision
from hazard_ms.skills.executor import SkillEnv

pytestmark = [pytest.mark.long, pytest.mark.render, pytest.mark.timeout(5400)]
SEEDS = range(20)
AGENTS = ("greedy", "random")
MARGIN = 0.1  # of Value, by which greedy must be better than random on the mean of the seeds [ours]
BELOW_FLOOR = -0.05  # a body whose middle is lower has fallen through the floor [m]


@dataclass(frozen=True)
class Outcome:
    """One episode."""

    seed: int
    agent: str
    tally: Tally
    frames: int
    ended: str
    faults: tuple[str, ...]  # what should never happen, with the first frame in which it did


class Faults(Watcher):
    """Looks at the world after every frame for what should never happen."""

    def __init__(self) -> None:
        self.faults: dict[str, int] = {}  # what -> first frame

    def begin(self, env: SkillEnv, decision: Decision) -> None:
        self.env = env

    def finish(self, reason: str) -> None:
        self.frame(None)

    def frame(self, action: Any) -> None:
        world, base = self.env.base.world, self.env.base
        width, depth = world.room[0].tolist()
        x, y, _z = world.agent_position[0].tolist()
        if not (0.0 < x < width and 0.0 < y < depth):
            self._note("robot outside the room")
        place = world.position[0].numpy()
        if not (np.isfinite(place).all() and np.isfinite(base.agent.robot.get_qpos().numpy()).all()):
            self._note("NaN")
        outside = (place[:, :2] < 0.0).any(1) | (place[:, :2] > (width, depth)).any(1)
        # what the hand holds touches nothing, not even the floor
        fallen = (place[:, 2] < BELOW_FLOOR) & ~world.held[0].numpy()
        there = (world.exists & world.movable & ~world.safe)[0].numpy()
        for index in np.flatnonzero((outside | fallen) & there):
            self._note(f"{world.names[0][index]} outside the room")
        if bool(base.episode.sim_error[0]):
            self._note("simulation error")

    def _note(self, what: str) -> None:
        self.faults.setdefault(what, self.env.frame)


def play_watched(env: SkillEnv, name: str, seed: int) -> Outcome:
    """An episode in an environment that is used again."""
    watch = Faults()
    played = Runner(env, agent(name), [watch]).run(seed)
    faults = tuple(f"{what} (frame {frame})" for what, frame in watch.faults.items())
    return Outcome(seed, name, Tally.of(fates(env)), env.frame, played.ended, faults)


def print_row(outcome: Outcome) -> None:
    tally = outcome.tally
    step = f"{tally.last_rescue / tally.rescued:7.1f}" if tally.rescued else "      -"
    damage = f"{tally.rescued_damaged / tally.rescued:7.2f}" if tally.rescued else "      -"
    row = f"{outcome.seed:4d} {outcome.agent:>7} {tally.rescued:8d} {tally.value:6.3f} {step} {damage}"
    print(f"{row} {outcome.frames:6d}", outcome.ended, *outcome.faults, flush=True)


@pytest.fixture(scope="module")
def outcomes() -> Iterator[dict[str, list[Outcome]]]:
    options = EpisodeOptions()
    env = gym.make(options.env_id, obs_mode="none", control_mode="pd_joint_pos", **options.settings)
    print(f"\n{options.env_id}, {options.settings};", ", ".join(f"{k} {v}" for k, v in versions().items()))
    print("seed   agent  rescued  value    step  damage frames ended", flush=True)
    played: dict[str, list[Outcome]] = {name: [] for name in AGENTS}
    for seed in SEEDS:
        for name in AGENTS:
            played[name].append(play_watched(SkillEnv(env), name, seed))
            print_row(played[name][-1])
    env.close()
    for name, made in played.items():
        for score, of in scores([o.tally for o in made]).items():
            interval = "" if of.low is None or of.high is None else f" [{of.low:.3f}, {of.high:.3f}]"
            print(f"{name:>7} {score:>6} {'-' if of.mean is None else f'{of.mean:.3f}'}{interval}")
    yield played


@pytest.mark.parametrize("name", AGENTS)
def test_nothing_leaves_the_room_or_breaks(outcomes: dict[str, list[Outcome]], name: str) -> None:
    assert {o.seed: o.faults for o in outcomes[name] if o.faults} == {}
    assert all(o.ended in ("all rescued", "stopped", "time") for o in outcomes[name])


def test_greedy_rescues_something_in_18_of_20(outcomes: dict[str, list[Outcome]]) -> None:
    assert sum(o.tally.rescued >= 1 for o in outcomes["greedy"]) >= 18


def test_random_does_worse_than_greedy(outcomes: dict[str, list[Outcome]]) -> None:
    """Paired over the seeds: the mean gain of Value is above MARGIN, and more than three standard errors above 0."""
    gain = np.array(
        [g.tally.value - r.tally.value for g, r in zip(outcomes["greedy"], outcomes["random"], strict=True)]
    )
    assert gain.mean() > MARGIN
    assert gain.mean() > 3.0 * gain.std(ddof=1) / np.sqrt(len(gain))
