"""The planner with one fault planted between it and the world, and what of the value that it costs is put down to it.

    python -m tests.evaluation.planted_faults [--seeds 0 1 2] [--env-id HazardFire-v1]

By default in the plaza of tests/worlds/plaza.py, where everything is in view from the start: elsewhere a fault also
leads to places from where less is seen, which no decision is blamed for.

Each fault's share is counted so: all parts of the loss (`EpisodeRegret.lost`) of the planner with the fault, less those
of the planner without any in the same scenes; the part that the fault should show in, over the sum of all parts that
grew. How long pick-ups usually take is measured in the same scenes before.
"""

from __future__ import annotations

import argparse
import copy
import dataclasses
import functools
import itertools
from collections.abc import Sequence
from types import MappingProxyType

import numpy as np
import torch

from hazard_ms.agents.base import PrivilegedAgent, agent, open_targets
from hazard_ms.agents.judge import Judge
from hazard_ms.evaluation.options import EpisodeOptions
from hazard_ms.evaluation.regret.appraiser import Appraiser
from hazard_ms.evaluation.regret.causes import EXECUTION, LATENCY, MEMORY, PARTS, PERCEPTION, PLANNING, EpisodeRegret
from hazard_ms.evaluation.regret.command import regret_of
from hazard_ms.evaluation.runner import play
from hazard_ms.sensing.semantic_map import SemanticMap
from hazard_ms.sensing.sighting import Sighting
from hazard_ms.sketch.skill_times import SkillRow, SkillTimes, load
from hazard_ms.skills.actions import wait
from hazard_ms.skills.brief import Brief
from hazard_ms.skills.context import Skill
from hazard_ms.skills.decision import PICK_UP, STOP, Action, Decision, Result
from hazard_ms.skills.executor import SkillEnv
from hazard_ms.skills.failures import UNREACHABLE
from hazard_ms.spec.catalogue import CATEGORIES
from hazard_ms.spec.registry import register_task
from tests.worlds.plaza import CHEAP, DEAR, FRAMES, TASK, task

NONE, BLIND, FORGETFUL, RANDOM, SLOW, CLUMSY = "none", "perception", "memory", "choice", "clock", "skills"
SHOWN_IN = {BLIND: PERCEPTION, FORGETFUL: MEMORY, RANDOM: PLANNING, SLOW: LATENCY, CLUMSY: EXECUTION}
OFTEN = 0.5  # share of the targets or pick-ups that go wrong; memory fails for all that is out of sight
RANDOMLY = 0.7  # share of the choices that are random
PAUSE = 60  # frames that the slow one takes for a choice
ABORTED = 12  # frames after which a clumsy pick-up is broken off
IN_VAIN = 100  # frames that it takes then: as a pick-up that fails
SHIFT = 8.0  # how far off the forgetful one takes things to be [m]

Objects = dict[int, Sighting]


class Faulty(PrivilegedAgent):
    """The planner with `fault`. It is given an environment to plant it there; it decides by what it is shown alone."""

    def __init__(self, fault: str) -> None:
        self._fault, self._planner = fault, agent("planner")

    def attach(self, env: SkillEnv) -> None:
        """Plant the fault in what the environment shows, or in its skills."""
        self._env, self._broken = env, False
        decision, run = env.decision, env.run

        def shown() -> Decision:
            return self._shown(decision())

        def aborted(doing: Skill) -> Result:
            return run(self._broken_off(doing) if self._broken else doing)

        env.decision, env.run = shown, aborted  # type: ignore[method-assign]

    def reset(self, brief: Brief) -> None:
        """Begin an episode; whatever goes wrong by chance follows from its seed."""
        self._planner.reset(brief)
        self._shown_once: set[int] = set()
        self._noticed: set[int] = set()  # what the first decision showed, before the fault was planted
        self._draw = np.random.default_rng(brief.random_seed)
        names = sorted(target.name for target in brief.targets)
        self._wrong = dict(zip(names, self._draw.random(len(names)) < OFTEN, strict=True))
        self._lost = dict(zip(names, self._draw.random(len(names)) < OFTEN, strict=True))
        self._angle = dict(zip(names, self._draw.uniform(-np.pi, np.pi, len(names)), strict=True))

    def act(self, decision: Decision) -> Action:
        """The planner's choice, unless the fault is in it."""
        if not decision.frame:
            self._noticed = set(decision.map.objects)
        action = self._planner.act(decision)
        self.note, looked = self._planner.note, decision.frame > 0  # around, as the planner does first
        if self._fault == RANDOM and looked and self._draw.random() < RANDOMLY:
            action = self._any(decision)
        if self._fault == SLOW and looked and action.verb != STOP:
            self._env.run(wait(self._env.stage, PAUSE))
        self._broken = self._fault == CLUMSY and action.verb == PICK_UP and bool(self._draw.random() < OFTEN)
        return action

    def _any(self, decision: Decision) -> Action:
        """Any action that makes sense to try, but stop."""
        some = [action for action in decision.available if action.verb != STOP]
        return some[int(self._draw.integers(len(some)))]

    def _broken_off(self, doing: Skill) -> Skill:
        """The beginning of a skill, which then fails."""
        yield from itertools.islice(doing, ABORTED)
        doing.close()
        yield from wait(self._env.stage, IN_VAIN - ABORTED)
        return Result(False, UNREACHABLE, IN_VAIN)

    def _shown(self, decision: Decision) -> Decision:
        """What the planner gets to see."""
        if self._fault == BLIND:
            return self._missed(decision)
        return self._forgotten(decision) if self._fault == FORGETFUL else decision

    def _missed(self, decision: Decision) -> Decision:
        """Some targets are overlooked, and some of the others are taken for something else."""
        kept, rows = dict(decision.map.objects), []
        for row in decision.targets:
            if self._wrong[row.name] and self._lost[row.name] and row.index not in self._noticed:
                kept.pop(row.index, None)  # what is noticed and then gone would be forgotten
            elif self._wrong[row.name]:
                taken = CHEAP if row.value > 1.0 else DEAR
                row = dataclasses.replace(row, category=taken, value=float(CATEGORIES[taken].value))
            rows.append(row)
        return dataclasses.replace(decision, targets=tuple(rows), map=_with(decision, kept))

    def _forgotten(self, decision: Decision) -> Decision:
        """Some targets that are out of sight are forgotten, and some are remembered elsewhere."""
        kept = dict(decision.map.objects)
        for name in open_targets(decision):
            index = decision.index(name)
            if index not in kept:
                continue
            if index in decision.map.in_view or index not in self._shown_once:
                self._shown_once.add(index)
                continue
            seen = kept.pop(index)
            if not self._lost[name]:
                off = SHIFT * np.array([np.cos(self._angle[name]), np.sin(self._angle[name]), 0.0], np.float32)
                kept[index] = dataclasses.replace(seen, position=seen.position + off)
        return dataclasses.replace(decision, map=_with(decision, kept))


def _with(decision: Decision, objects: Objects) -> SemanticMap:
    """The map of a decision with other objects."""
    made = copy.copy(decision.map)
    vars(made)["objects"] = MappingProxyType(objects)  # it cannot be written to otherwise
    return made


def measured(episodes: Sequence[EpisodeOptions]) -> SkillTimes:
    """The usual skill times, but pick-ups as long as those of the planner without a fault that work in `episodes`."""
    usual = load("fetch")
    decisions = [d for episode in episodes for d in play(episode, [], Faulty(NONE)).decisions if d.verb == PICK_UP]
    took = tuple(sorted(float(d.frames) for d in decisions if d.ok))
    rows = [row for row in usual.rows if row.skill != PICK_UP]
    return SkillTimes("fetch", (*rows, SkillRow(PICK_UP, len(took), len(took) / len(decisions), took, (IN_VAIN,))))


def judged(fault: str, episode: EpisodeOptions, times: SkillTimes) -> EpisodeRegret:
    """The regret of the planner with a fault in an episode, where skills usually take the `times`."""
    appraiser = Appraiser(mind=functools.partial(Judge, times=times))
    result = play(episode, [appraiser], Faulty(fault))
    return regret_of(dataclasses.replace(result, agent=fault), "", appraiser)


def added(faulty: Sequence[EpisodeRegret], sound: Sequence[EpisodeRegret]) -> dict[str, float]:
    """The mean by which each part of the loss is greater with a fault than without it."""
    return {
        part: float(np.mean([a.lost[part] - b.lost[part] for a, b in zip(faulty, sound, strict=True)]))
        for part in PARTS
    }


def share(fault: str, more: dict[str, float]) -> float:
    """The share of what a fault added to any part of the loss that it added to its own."""
    return more[SHOWN_IN[fault]] / sum(max(size, 0.0) for size in more.values())


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("--env-id", default=TASK)
    parser.add_argument("--seeds", type=int, nargs="+", default=[0, 1, 2])
    parser.add_argument("--faults", nargs="+", choices=list(SHOWN_IN), default=list(SHOWN_IN))
    parser.add_argument("--decisions", action="store_true", help="print each decision with a regret")
    args = parser.parse_args()
    torch.set_num_threads(1)
    if args.env_id == TASK:
        register_task(TASK, task, FRAMES)
    episodes = [EpisodeOptions(args.env_id, split="test", seed=seed) for seed in args.seeds]
    times = measured(episodes)
    sound = [judged(NONE, episode, times) for episode in episodes]
    print(f"{'added by':12s} " + " ".join(f"{part:>10s}" for part in PARTS) + "        all  share")
    for fault in args.faults:
        faulty = [judged(fault, episode, times) for episode in episodes]
        more = added(faulty, sound)
        parts = " ".join(f"{100 * more[part]:10.1f}" for part in PARTS)
        print(f"{fault:12s} {parts} {100 * sum(more.values()):10.1f}  {100 * share(fault, more):4.0f} %", flush=True)
        for row in (row for one in faulty for row in one.decisions if args.decisions and row.regret > 0.0):
            print(f"    {row.frame:5d} {row.verb} {row.target}: {100 * row.regret:.1f} {row.cause}, {row.evidence}")


if __name__ == "__main__":
    main()
