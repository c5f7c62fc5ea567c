"""The oracle of teams: a reference for what a team could reach with the skills that all share.

Each robot has an oracle (hazard_ms.agents.oracle), which sees what is hidden, and they divide targets, tools, doors and
carts as `sharing.py` says. They need not tell one another anything. What is done about the hazard is foreseen by the
robot that weighs it: what another one has begun about it counts once it is done.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping
from typing import Any

from hazard_ms.agents.mitigating.prospects import FETCH, Part
from hazard_ms.agents.oracle import LOYALTY_ADRIFT, Oracle
from hazard_ms.agents.team import PrivilegedTeam
from hazard_ms.agents.teams.sharing import APART, TURNS, WALKS, Sharing, place_of
from hazard_ms.agents.truth import Future, Truth
from hazard_ms.sensing.semantic_map import SemanticMap
from hazard_ms.sketch.planning.averting import averting
from hazard_ms.sketch.planning.problem import Problem
from hazard_ms.skills.brief import Brief
from hazard_ms.skills.context import Stage
from hazard_ms.skills.decision import EXPLORE, STOP, Action, Decision
from hazard_ms.skills.team import TeamSkills

FAR = 2.0 * APART  # distance of a thing from which a walk to it need not wait for who works there [m] [ours]
BESIDE = 0.8  # distance from one that stands, its arm tucked, within which none begins to [m] [ours: it knows of it]


class TeamOracle(Sharing, PrivilegedTeam):
    """Oracles that divide what they rescue, and what they do about hazards."""

    standing, soon = BESIDE, APART
    _env: TeamSkills | None = None

    def attach(self, env: TeamSkills) -> None:
        self._env = env

    def reset(self, briefs: Mapping[str, Brief]) -> None:
        """Begin an episode. Raises ValueError where `attach` was not called before."""
        if self._env is None:
            raise ValueError("an environment must be attached to the oracles before their reset, got none")
        self._seers: dict[str, _Seer] = {}
        self._future = Future(_Member(self._env, self._env.names[0]))
        super().reset(briefs)

    def _partner(self, name: str) -> _Seer:
        assert self._env is not None
        made = self._seers[name] = _Seer(name, self, Truth(_Member(self._env, name), False, self._future))
        return made

    def act(self, decisions: Mapping[str, Decision]) -> dict[str, Action]:
        return super().act({name: self._seers[name].told(decision) for name, decision in decisions.items()})

    def _ended(self, name: str, decision: Decision) -> None:
        super()._ended(name, decision)
        self._stands.pop(name)  # who is asked before it does not wait for it to go
        last, result = decision.last_action, decision.last_result
        if last is None or last.target is None or result is None or decision.held is not None:
            return
        if last.verb in WALKS and result.ok:
            self._aims[name] = last.target

    def crowded_things(self, name: str, decision: Decision) -> set[str]:
        """The things near to where another one works, but for what is far: it may be done before this one comes."""
        return {thing for thing in super().crowded_things(name, decision) if _is_near(decision, thing, FAR)}

    def forget(self, name: str) -> None:
        """The robot `name` plans to fetch nothing."""
        self._ahead.pop(name, None)

    def begun(self, name: str, decision: Decision) -> set[Part]:
        """Parts of what others than the robot `name` have begun about hazards, and things that they fetch or hold."""
        made = {part for other, seer in self._seers.items() if other != name for part in seer.begun}
        things = self.fetched(name) | self.handled(name)
        return made | {(FETCH, decision.index(thing)) for thing in things if thing in decision.names}


class _Member:
    """The environment as one robot of the team has it, in the place of a `SkillEnv`."""

    def __init__(self, env: TeamSkills, name: str) -> None:
        self._env, self._knowledge = env, env.knowledge[name]
        self.base: Any = env.base

    @property
    def seen(self) -> SemanticMap:
        return self._knowledge.seen

    @property
    def maps(self) -> list[SemanticMap]:
        return self._knowledge.maps

    @property
    def stage(self) -> Stage:
        return self._knowledge.stage

    @property
    def frame(self) -> int:
        return self._env.frame


@dataclasses.dataclass(frozen=True)
class _Known:
    """The rest of the rescue as an oracle plans it."""

    problem: Problem
    names: tuple[str, ...]  # of its targets

    def name(self, goal: int) -> str:
        return self.names[goal]


class _Seer(Oracle):
    """An oracle that leaves to others what they fetch, and what they are at."""

    def __init__(self, name: str, team: TeamOracle, truth: Truth) -> None:
        super().__init__()
        self._name, self._team, self._truth = name, team, truth

    def reset(self, brief: Brief) -> None:
        super().reset(brief)
        self._loyalty = LOYALTY_ADRIFT  # what others fetch changes plans, too
        self._crowded: set[str] = set()
        self._waited = 0

    @property
    def begun(self) -> frozenset[Part]:
        """What it has begun about the hazard."""
        return frozenset() if self._mitigator is None else self._mitigator.begun

    def told(self, decision: Decision) -> Decision:
        """The decision with the truth in its map, without what others hold, which it is not to rescue."""
        assert self._truth is not None
        env = self._truth.env
        held = {decision.names[index] for index in env.base.world.held[0].nonzero()[:, 0].tolist()} - {decision.held}
        for name in held:
            env.seen.forget(decision.index(name))
        self._truth.reveal()
        left = tuple(target for target in decision.targets if target.name not in held)
        return dataclasses.replace(decision, targets=left, map=env.seen.frozen())

    def _next(self, decision: Decision, truth: Truth) -> Action:
        """As the oracle; near to where another robot works it waits for its turn, but not for ever."""
        waits = self._waited < TURNS
        self._crowded = self._team.crowded_things(self._name, decision) if waits else set()
        if self._mitigator is not None:
            self._mitigator.leave(self._team.begun(self._name, decision))
        action = super()._next(decision, truth)
        denied = self._team.denied(self._name, decision, action)
        if denied and not (waits and any(tool.held for tool in decision.tools)):
            denied, action = False, self._without_measures(decision, truth)
        later = action.verb == STOP and any(t.name in self._crowded and not t.rescued for t in decision.targets)
        waits &= denied or later or action.target in self._crowded
        if waits:
            self._waited += 1
        elif action.verb not in WALKS:  # a walk is followed by what it waited for
            self._waited = 0
        return self._say("another robot is at work there", Action(EXPLORE)) if waits else action

    def _without_measures(self, decision: Decision, truth: Truth) -> Action:
        """What it does if it does nothing about the hazard now."""
        kept, self._mitigator = self._mitigator, None
        if self._gale is not None:
            self._gale.idle = True
        action = self._choose(decision, truth)
        self._mitigator = kept
        if self._gale is not None:
            self._gale.idle = False
        return action

    def _problem(self, decision: Decision, truth: Truth) -> tuple[list[int], Problem | None]:
        """The problem that is left to it: without what others fetch, or are to by the best plans of all."""
        targets, problem = super()._problem(decision, truth)
        if problem is None:
            self._team.forget(self._name)
            return targets, None
        aims = truth.env.base.task.averted and self._gale is None
        ahead = _Known(averting(problem) if aims else problem, tuple(decision.names[index] for index in targets))
        taken = self._team.taken(self._name, ahead) | self._crowded
        left = tuple(t for t in decision.targets if t.held or t.name not in taken)
        return super()._problem(dataclasses.replace(decision, targets=left), truth)

    def _arrived_at(self, decision: Decision, truth: Truth, planned: int) -> int:
        index = super()._arrived_at(decision, truth, planned)
        return planned if decision.names[index] in self._team.fetched(self._name) else index


def _is_near(decision: Decision, thing: str | None, reach: float) -> bool:
    """Whether a thing is within `reach` [m], or not on the map."""
    place = place_of(decision, thing)
    return place is None or math.dist(decision.agent_position, place) <= reach
