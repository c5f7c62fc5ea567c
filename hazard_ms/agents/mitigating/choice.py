"""Chooses what is worth doing about the hazard before rescues, for who sees what will happen.

Where the plan of rescues alone saves all that would be lost, there is nothing to choose. Else the futures under all
prospects (prospects.py) are foreseen in one batch, and kept until something was done, or for KEPT frames.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import replace

import numpy as np

from hazard_ms.agents.mitigating import costs
from hazard_ms.agents.mitigating.barred import Barred, nearer, sided
from hazard_ms.agents.mitigating.prospects import (
    FETCH,
    MOST_FUTURES,
    Array,
    Part,
    Prospect,
    blocks,
    doors,
    fights,
    tools_of,
    ways_between,
)
from hazard_ms.hazards.base import pushes
from hazard_ms.sketch.futures.interventions import OUT, SHUT, Foreseen, Intervention, foresee
from hazard_ms.sketch.futures.surroundings import Home
from hazard_ms.sketch.planning.averting import averting
from hazard_ms.sketch.planning.beginning import Course, best_course
from hazard_ms.sketch.planning.measures import Measure, Measures
from hazard_ms.sketch.planning.orienteering import solve
from hazard_ms.sketch.planning.problem import Problem
from hazard_ms.sketch.planning.travel import StaticTravel
from hazard_ms.sketch.rescue_problem import RescueScene

KEPT = 400  # frames for which futures are kept [ours]
LEAST = 0.02  # share of what the targets at risk would lose from which on a loss is worth a thought [ours]
LEAST_GAIN = 0.03  # share of what the targets at risk are worth that a course must avert beyond rescues [ours]
# The same in floods, where things drift meanwhile [measured: in two homes of `train`, courses that were to avert 0.03
# and 0.09 more came to 0.07 less than rescues alone; one that was to avert 0.28 came to 0.20 more]
LEAST_IN_WATER = 0.15
# frames by which a rescue takes longer than planned in homes [ours: of 14 to 17 that were planned in three floods of
# `train`, 7 to 9 were done by the end]; plans without them would save all, and no fire would be worth a fight
UNPLANNED = 120.0
EFFORT = (2_000, 60)  # labels of a search, and of a layer beyond [ours]
UNEXPECTED = 1.5  # factor by which a fire takes longer than is planned, since it grows meanwhile [ours]

Key = tuple[str, tuple[int, ...]]


class Chooser:
    """Chooses what is worth doing in one episode of `base`."""

    def __init__(self, base: Home) -> None:
        self._base = base
        self.others: frozenset[Part] = frozenset()  # what the other robots of a team are at
        self.forget()

    def forget(self) -> None:
        """Foresee anew when it is asked next: something was done."""
        self._foreseen: Foreseen | None = None
        self._rows: dict[Key, int] = {}

    def course(
        self,
        problem: Problem,
        targets: Sequence[int],
        scene: RescueScene,
        here: tuple[float, float],
        in_hand: int,
        failed: Collection[Key],
    ) -> tuple[Course | None, list[Prospect]]:
        """The best course and the prospects that its steps mean; None where rescues alone avert enough.

        `problem` has the targets' own values; `targets`: their indices along B; `here` [m]; `in_hand`: index along B
        of the extinguisher in the hand, or -1; what is among `failed` is left out.
        """
        if not isinstance(problem.travel, StaticTravel):
            return None, []
        problem = self._delayed(problem)
        lost = self._lost(problem)
        if not lost:
            return None, []
        goals = self._base.world.position[0, list(targets), :2].cpu().numpy().astype(np.float64)
        edges, start = scene.edges[list(targets)], np.array(here)
        # a fire that is out also saves the time of rescues
        fires = fights(self._base, scene, goals[self._risky(problem)], start)
        ends = [*fires, *blocks(self._base, scene, start, self.others), *doors(self._base, goals[lost])]
        ends = self._open(ends, failed)[:MOST_FUTURES]
        tools = self._open(tools_of(self._base, scene), failed)
        ends = [p for p in ends if tools or p.kind != OUT]
        if not ends:
            return None, []
        foreseen = self._foresee(ends, tools, scene, start)
        gone_at = self._gone_at(problem, targets)
        ends = self._helpful(ends, foreseen, targets, gone_at)
        made = [*tools, *(p for p in ends if p.kind != SHUT), *sided(scene.spec, [p for p in ends if p.kind == SHUT])]
        if not made:
            return None, []
        ways = ways_between(scene, start, goals, edges, made)
        ways |= {name: nearer(ways[name], made) for name in ("to", "between")}
        held = [k for k, tool in enumerate(tools) if tool.numbers[0] == in_hand]
        fetching = ways["to"][-1, : len(tools)] + [tool.frames for tool in tools]
        fetching[held] = 0.0
        needs = (fetching[:, None] + ways["between"][: len(tools)]).argmin(0).tolist() if tools else [0] * len(made)
        measures = self._measures(made, needs, foreseen, targets, gone_at)
        barred = Barred(scene, goals, edges, made)
        chosen = Measures(measures, **ways, in_hand=held[0] if held else None, put_down=costs.PUT_DOWN, changed=barred)
        course = best_course(problem, chosen, most_labels=EFFORT[0], beam=EFFORT[1])
        return (course if self._is_worth_it(course, problem) else None), made

    def _open(self, made: Sequence[Prospect], failed: Collection[Key]) -> list[Prospect]:
        """What is neither among `failed` nor among what others are at."""
        return [p for p in made if (p.kind, p.numbers) not in failed and not p.parts & self.others]

    def _delayed(self, problem: Problem) -> Problem:
        """The problem with what delays rescues; in water a course must avert more instead (LEAST_IN_WATER)."""
        if pushes(self._base.task.hazards):
            return problem
        return replace(problem, pick=[frames + UNPLANNED for frames in problem.pick])

    def _is_worth_it(self, course: Course, problem: Problem) -> bool:
        """Whether a course averts enough beyond rescues alone for all that may go otherwise than planned."""
        share = LEAST_IN_WATER if pushes(self._base.task.hazards) else LEAST_GAIN
        least = share * sum(problem.values[t] for t in self._risky(problem))
        return bool(course.steps) and course.value - course.plain > least

    def _gone_at(self, problem: Problem, targets: Sequence[int]) -> Array | None:
        """The last frame before each thing is carried off as far as `problem` says, [B]; None where it says nothing."""
        if problem.gone_at is None:
            return None
        made = np.full(self._base.world.num_bodies, np.inf)
        made[list(targets)] = problem.gone_at
        return made

    def _lost(self, problem: Problem) -> list[int]:
        """The targets that the best rescues do not save from damage; none where they are hardly worth anything."""
        plan = solve(averting(problem), *EFFORT)
        gone = problem.gone_at or [np.inf] * len(problem.values)
        saved = {r.target for r in plan.rescues if r.safe <= problem.damaged_at[r.target] or gone[r.target] < np.inf}
        risky = self._risky(problem)
        lost = [t for t in risky if t not in saved]
        least = LEAST * sum(problem.values[t] for t in risky)
        return lost if sum(problem.values[t] for t in lost) > least else []

    def _risky(self, problem: Problem) -> list[int]:
        """The targets that would be damaged or carried off by the limit, and are not yet."""
        gone = problem.gone_at or [np.inf] * len(problem.values)
        by = [min(pair) for pair in zip(problem.damaged_at, gone, strict=True)]
        return [t for t, frame in enumerate(by) if problem.frame <= frame < problem.limit]

    def _foresee(
        self, ends: Sequence[Prospect], tools: Sequence[Prospect], scene: RescueScene, here: Array
    ) -> Foreseen:
        """The futures under `ends`: those that are kept, or new ones."""
        keys = {(p.kind, p.numbers) for p in ends}
        now = int(self._base.world.frame[0])
        if self._foreseen is None or not keys <= self._rows.keys() or now - self._foreseen.first > KEPT:
            sets = [self._events(p, now + self._delay(p, tools, scene, here)) for p in ends]
            self._foreseen = foresee(self._base, sets)
            self._rows = {(p.kind, p.numbers): row for row, p in enumerate(ends, 1)}
        return self._foreseen

    def _delay(self, end: Prospect, tools: Sequence[Prospect], scene: RescueScene, here: Array) -> float:
        """Frames until something is done if it is done at once, with the extinguisher that is fetched soonest."""
        direct = float(scene.ways.frames(here, end.first, edge=end.edge))
        if end.kind == OUT:
            via = [
                float(scene.ways.frames(here, t.first, edge=t.edge))
                + t.frames
                + float(scene.ways.frames(t.first, end.first, edge=end.edge))
                for t in tools
            ]
            direct = min(via)
        return direct + end.frames if np.isfinite(direct) else 0.0

    def _events(self, end: Prospect, done: float) -> list[Intervention]:
        """The interventions that stand for something done by the frame `done`: one seat of fire after another."""
        each = end.frames / len(end.numbers)
        last = len(end.numbers) - 1
        return [Intervention(end.kind, n, round(done - each * (last - k))) for k, n in enumerate(end.numbers)]

    def _helpful(
        self, ends: Sequence[Prospect], foreseen: Foreseen, targets: Sequence[int], gone_at: Array | None
    ) -> list[Prospect]:
        """Those of `ends` that are fires, or keep a target for longer than if nobody acts."""
        whole = foreseen.whole_until()[:, list(targets)]
        stays = whole if gone_at is None else foreseen.stays_until(gone_at)[:, list(targets)]
        rows = [self._rows[p.kind, p.numbers] for p in ends]
        gains = [bool((whole[row] > whole[0]).any() or (stays[row] > stays[0]).any()) for row in rows]
        return [p for p, gain in zip(ends, gains, strict=True) if gain or p.kind == OUT]

    def _measures(
        self,
        made: Sequence[Prospect],
        needs: Sequence[int],
        foreseen: Foreseen,
        targets: Sequence[int],
        gone_at: Array | None,
    ) -> list[Measure]:
        """The measures that stand for what can be `made`; `needs`: numbers of the tools that are fetched for each."""
        whole = foreseen.whole_until()[:, list(targets)]
        stays = None if gone_at is None else foreseen.stays_until(gone_at)[:, list(targets)]
        measures = []
        for p, tool in zip(made, needs, strict=True):
            if p.kind == FETCH:
                nothing = [0.0] * len(targets)
                measures.append(Measure(f"fetch {p.numbers[0]}", p.frames, nothing, charge=p.charge))
                continue
            row = self._rows[p.kind, p.numbers]
            spared, there = whole[row], None if stays is None else stays[row].tolist()
            name = f"{p.kind} {'+'.join(map(str, p.numbers))}"
            if p.kind == OUT:
                jet = costs.FLAME * float(foreseen.burning[row])
                frames = costs.FIGHT * len(p.numbers) + p.between + UNEXPECTED * jet
                measures.append(Measure(name, frames, spared.tolist(), tool, jet, stays_until=there))
                continue
            measures.append(Measure(name, p.frames, spared.tolist(), stays_until=there))
        return measures
