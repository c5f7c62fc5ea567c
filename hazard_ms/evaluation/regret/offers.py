"""The measures about the hazard of a home that there are in a running episode, and the outcome of each.

Futures are foreseen in copies of the episode (`hazard_ms.sketch.futures`), and kept for KEPT frames. The measures are
those that the oracle weighs (`hazard_ms.agents.mitigating.prospects`), with the frames that it plans with.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from hazard_ms.agents.action_values import State
from hazard_ms.agents.judge import Judge
from hazard_ms.agents.mitigating import costs
from hazard_ms.agents.mitigating.prospects import (
    FETCH,
    MOST_FUTURES,
    Array,
    Prospect,
    closes,
    doors,
    fights,
    tools_of,
    ways_between,
)
from hazard_ms.sketch.futures.interventions import OUT, SHUT, Foreseen, Intervention, foresee
from hazard_ms.sketch.planning.measures import Measure, Measures
from hazard_ms.sketch.planning.problem import Problem
from hazard_ms.sketch.planning.travel import StaticTravel
from hazard_ms.skills.executor import SkillEnv

KEPT = 600  # frames for which futures are kept [ours]


class Offers:
    """Finds the measures about the hazard in one episode, and foresees the outcome of each."""

    def __init__(self, env: SkillEnv, mind: Judge) -> None:
        """Take an environment in which an episode has just begun, and its judge."""
        self._env, self._base, self._mind = env, env.base, mind
        self._foreseen: Foreseen | None = None
        self.made: list[Prospect] = []  # tools first, then what is done with each, and doors
        self._rows: list[int] = []  # of `_foreseen`, for each of `made`; 0: as if nobody acts

    def forget(self) -> None:
        """Foresee anew when it is asked next: something was done about the hazard."""
        self._foreseen = None

    def needs(self) -> list[int | None]:
        """The number of the measure that fetches what each of `made` needs."""
        tools, turn = sum(p.kind == FETCH for p in self.made), itertools.count()
        return [next(turn) % tools if p.kind == OUT else None for p in self.made]

    def words(self, what: Prospect) -> str:
        """A measure in words."""
        names = self._base.world.names[0]
        if what.kind == FETCH:
            return f"fetch {names[what.numbers[0]]}"
        if what.kind == SHUT:
            return f"shut {self._env.stage.doors.names[what.numbers[0]]}"
        return "put out " + " and ".join(f"fire {n}" for n in what.numbers)

    def given(self, state: State) -> tuple[Problem, Measures] | None:
        """The problem of a state with an empty hand or a tool in it, and its measures; None where there are none."""
        problem, targets = self._mind.problem(replace(state, tool=None))  # a tool is put down where that is needed
        if problem is None or not isinstance(problem.travel, StaticTravel):
            return None
        if self._foreseen is None or state.frame - self._foreseen.first > KEPT:
            self._foreseen = self._foresee(targets, np.array(state.place))
        if not self.made:
            return None
        whole = self._foreseen.whole_until()
        problem = replace(problem, damaged_at=whole[0, targets].tolist())
        stays = np.tile(np.array(problem.gone_at or ()), (len(whole), 1))
        if problem.gone_at is not None:
            gone = np.full(whole.shape[1], np.inf)
            gone[targets] = problem.gone_at
            stays = self._foreseen.stays_until(gone)[:, targets]
        return problem, self._measures(state, targets, whole[:, targets], stays)

    def _foresee(self, targets: list[int], here: Array) -> Foreseen:
        """Find what can be done now, and foresee what it leads to."""
        base, scene, future = self._base, self._mind.scene, self._mind.future()
        lost = [t for t in targets if future.whole_until()[t] < scene.limit]
        lost = lost or (targets if self._mind.aim.carried_off else [])
        places = base.world.position[0, lost, :2].cpu().numpy().astype(np.float64).reshape(-1, 2)
        tools = tools_of(base, scene)
        ends = [p for p in (*fights(base, scene, places, here), *doors(base, places)) if tools or p.kind != OUT]
        ends = ends[:MOST_FUTURES] if lost else []
        now = int(base.world.frame[0])
        each = [(p, row, k) for row, p in enumerate(ends, 1) for k in range(len(tools) if p.kind == OUT else 1)]
        self.made = [*tools, *(p for p, _, _ in each)] if ends else []
        self._rows = [*([0] * len(tools)), *(row for _, row, _ in each)]
        return foresee(base, [_events(p, now + self._delay(p, tools, here)) for p in ends])

    def _delay(self, end: Prospect, tools: Sequence[Prospect], here: Array) -> float:
        """Frames until something is done if it is done at once, with the extinguisher that is fetched soonest."""
        ways = self._mind.scene.ways
        via = [float(ways.frames(here, end.first, edge=end.edge))]
        if end.kind == OUT:
            via = [
                float(ways.frames(here, t.first, edge=t.edge))
                + t.frames
                + float(ways.frames(t.first, end.first, edge=end.edge))
                for t in tools
            ]
        return min(via) + end.frames if np.isfinite(via).any() else 0.0

    def _measures(self, state: State, targets: list[int], whole: Array, stays: Array) -> Measures:
        """The measures by the frames until which targets are whole, and stay, in each row of the futures, [R, T]."""
        scene, edges = self._mind.scene, self._mind.scene.edges[targets]
        goals = self._base.world.position[0, targets, :2].cpu().numpy().astype(np.float64)
        made = []
        for p, row, needs in zip(self.made, self._rows, self.needs(), strict=True):
            behind: list[int] = []
            if p.kind == SHUT and bool((whole[row] > whole[0]).any() or (stays[row] > stays[0]).any()):
                behind = closes(scene.spec, p.numbers[0], scene.ways.radius, state.place, goals, edges)
            spared = [0.0] * len(targets) if p.kind == FETCH else whole[row].tolist()
            there = stays[row].tolist() if stays.size and p.kind != FETCH else None
            made.append(Measure(self.words(p), p.frames, spared, needs, p.jet, p.charge, there, tuple(behind)))
        ways = ways_between(scene, np.array(state.place), goals, edges, self.made)
        held = [k for k, p in enumerate(self.made) if p.kind == FETCH and p.numbers[0] == state.tool]
        between = (ways["to"], ways["between"], ways["onward"])
        return Measures(made, *between, in_hand=held[0] if held else None, put_down=costs.PUT_DOWN)


def _events(end: Prospect, done: float) -> list[Intervention]:
    """The interventions that stand for something done by the frame `done`: one seat of fire after another."""
    each, last = end.frames / len(end.numbers), len(end.numbers) - 1
    return [Intervention(end.kind, n, round(done - each * (last - k))) for k, n in enumerate(end.numbers)]
