"""The worth of measures about the hazard of a home beyond rescues, with the true future: for judging decisions.

Limits: those of `sketch/planning/beginning.py`; a measure that is done later than foreseen (offers.py) spares as much.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from hazard_ms.agents.action_values import EASE, Place, State
from hazard_ms.agents.aims import LITTLE
from hazard_ms.agents.judge import Judge
from hazard_ms.agents.mitigating import costs
from hazard_ms.agents.mitigating.prospects import FETCH, Prospect, seats_of
from hazard_ms.evaluation.regret.offers import Offers
from hazard_ms.sketch.futures import seats
from hazard_ms.sketch.futures.interventions import OUT, SHUT, fire_of
from hazard_ms.sketch.planning.beginning import best_course
from hazard_ms.sketch.planning.begun import begun
from hazard_ms.sketch.planning.measures import Measures
from hazard_ms.sketch.planning.problem import Problem
from hazard_ms.skills.decision import DROP, PICK_UP, WALK_TO, Action, Decision, Result
from hazard_ms.skills.executor import SkillEnv
from hazard_ms.skills.mitigations.extinguish import AROUND

EFFORT = (400, 20)  # labels of a search, and of a layer beyond [ours]
EXTINGUISH, SHUT_DOOR = "extinguish", "shut"
FIRE = "fire"
HOT, SEEN_NEAR = 100.0, 1.5  # of floor [C], and how near the middle of a fire it makes that known [m] [ours]
NOTHING = 1e-3  # value of the targets up to which nothing is lost [ours]


class MeasureWorth:
    """The worth of measures in one episode, in units of the targets' values."""

    def __init__(self, env: SkillEnv, mind: Judge) -> None:
        """Take an environment in which an episode has just begun, and its judge."""
        self._env, self._base, self._mind = env, env.base, mind
        self._offers = Offers(env, mind)
        self._last: tuple[State, tuple[Problem, Measures] | None] | None = None
        self.names: list[str] = []  # of the measures of the course that was judged last, in words

    def note(self, action: Action, result: Result) -> None:
        """Foresee anew when it is asked next if something was done about the hazard."""
        if action.verb in (EXTINGUISH, SHUT_DOOR, "open") and result.frames:
            self._offers.forget()
            self._last = None

    def is_measure(self, action: Action) -> bool:
        """Whether an action is one about the hazard: a mitigation, or one to a tool."""
        index = self._index(action)
        tools = self._base.world.equipment
        held = tools is not None and bool((tools.tool & self._base.world.held)[0].any())
        fetches = tools is not None and index >= 0 and bool(tools.tool[0, index])
        return action.verb in self._base.task.mitigations or fetches or (action.verb == DROP and held)

    def gain(self, state: State, best: float, known: Decision | None = None) -> float:
        """The value that the best course with measures keeps from `state` on beyond that of rescues alone.

        `best`: the value that rescues alone keep; where that is all, measures add nothing. `known`: a decision whose
        map has all tools, fires and doors that count; None for all.
        """
        self.names = []
        if best >= sum(self._mind.truth.values.values()) - NOTHING:
            return 0.0
        given = self._given(state)
        if given is None:
            return 0.0
        problem, measures = given
        if known is not None:
            never = problem.limit + 1.0
            rows = zip(measures.measures, self._offers.made, strict=True)
            measures = replace(
                measures, measures=[m if self._is_known(p, known) else replace(m, frames=never) for m, p in rows]
            )
        course = best_course(problem, measures, most_labels=EFFORT[0], beam=EFFORT[1], beside=LITTLE)
        self.names = [self._offers.words(self._offers.made[step.measure]) for step in course.steps]
        return max(0.0, course.value - course.plain)

    def begun(self, state: State, action: Action) -> float | None:
        """The gain of the best course that begins with the measure of `action`, below 0 where it costs more.

        None where `action` begins no measure that is weighed.
        """
        given = self._given(state)
        if given is None:
            return None
        problem, measures = given
        plain = best_course(problem, measures, 0, *EFFORT, beside=LITTLE).plain
        left = [begun(problem, measures, number) for number in self._numbers(action, measures.in_hand)]
        values = [best_course(*one, 4, *EFFORT, beside=LITTLE).value for one in left if one is not None]
        return max(values) - plain if values else None

    def after(self, state: State, action: Action, place: Place | None) -> State | None:
        """The state in which `action` usually leaves a rescue; None where `begun` says what its measure leads to.

        `place` [m]: where somebody walks whose target is nothing that there is.
        """
        index, later = self._index(action), 0.0
        if action.verb in self._base.task.mitigations:
            if self._begins(action, state.tool):
                return None
            if action.verb == EXTINGUISH and state.tool is None:
                return state  # it cannot work, and takes no time
            later = costs.FIGHT if action.verb == EXTINGUISH else costs.DOOR
        elif self.is_measure(action) and action.verb == PICK_UP:
            made = self._mind.after(state, Action(WALK_TO, action.target))
            state, later = replace(made, tool=index), self._mind.scene.pick
        elif self.is_measure(action) and action.verb == DROP:
            state, later = replace(state, tool=None), costs.PUT_DOWN
        else:
            made = self._mind.after(state, action, place)
            return replace(made, frame=max(state.frame, made.frame - EASE))
        return replace(state, frame=state.frame + round(later))

    def _begins(self, action: Action, tool: int | None) -> bool:
        held = [k for k, p in enumerate(self._offers.made) if p.kind == FETCH and p.numbers[0] == tool]
        return bool(self._numbers(action, held[0] if held else None))

    def _is_known(self, what: Prospect, decision: Decision) -> bool:
        """Whether the map of a decision has what a measure is about: the tool, warm floor at each fire, the door."""
        if what.kind == FETCH:
            name = self._base.world.names[0][what.numbers[0]]
            there = name in decision.names and decision.index(name) in decision.map.objects
            return there or decision.held == name
        if what.kind == SHUT:
            return any(o.name == self._env.stage.doors.names[what.numbers[0]] for o in decision.openings)
        seen = decision.map
        fires = [k for k, hazard in enumerate(self._base.task.hazards) if hazard.name == FIRE]
        y, x = np.nonzero(seen.levels[fires[0]] >= HOT)
        hot = seen.origin + (np.stack([x, y], -1) + 0.5) * seen.cell
        places = {seat.number: seat.place for seat in seats_of(self._base)}
        gaps = [np.hypot(*(hot - places[n]).T).min(initial=np.inf) if n in places else np.inf for n in what.numbers]
        return all(gap <= SEEN_NEAR for gap in gaps)

    def _numbers(self, action: Action, in_hand: int | None) -> list[int]:
        """The measures that `action` begins."""
        index = self._index(action)
        if action.verb == SHUT_DOOR:
            door = self._env.stage.doors.names.index(action.target) if action.target else -1
            return [k for k, p in enumerate(self._offers.made) if p.kind == SHUT and p.numbers == (door,)]
        if action.verb != EXTINGUISH:
            return [k for k, p in enumerate(self._offers.made) if p.kind == FETCH and p.numbers == (index,)]
        fire = fire_of(self._base.episode)
        if fire is None or index < 0:
            return []
        burning = seats.flames(fire, self._base.world.frame)[0].cpu().numpy()
        places = fire.flame_place[0, :, :2].cpu().numpy().astype(np.float64)
        gaps = np.where(burning >= 0, np.hypot(*(places - self._mind.place(index)).T), np.inf)
        if not gaps.min(initial=np.inf) <= AROUND:
            return []
        seat = int(burning[gaps.argmin()])
        return [
            k
            for k, (p, one) in enumerate(zip(self._offers.made, self._offers.needs(), strict=True))
            if p.kind == OUT and p.numbers[0] == seat and one == in_hand
        ]

    def _index(self, action: Action) -> int:
        """Index along B of the target of an action; -1 where that is not a thing."""
        names = self._base.world.names[0]
        return names.index(action.target) if action.target in names else -1

    def _given(self, state: State) -> tuple[Problem, Measures] | None:
        """The problem of a state among the targets at risk, and the measures; None where there is nothing to weigh."""
        if self._last is None or self._last[0] != state:
            empty = state if state.holding is None else self._mind.after(state, Action(DROP))
            self._last = state, self._offers.given(empty)
        return self._last[1]
