"""Plays one episode of a team, and tells watchers of it, as `hazard_ms.evaluation.runner` does for one robot.

Robots begin and end their actions at different frames. A decision is recorded when it is taken, so that what is under
way where an episode breaks off is told, too.
"""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

from hazard_ms.agents.base import counters_of, shown_note, staying
from hazard_ms.agents.team import TEAM_AGENTS, PrivilegedTeam, TeamAgent, team_agent
from hazard_ms.evaluation.averted.account import Account
from hazard_ms.evaluation.hashes import EVERY, extended
from hazard_ms.evaluation.metrics import Tally
from hazard_ms.evaluation.options import EpisodeOptions
from hazard_ms.evaluation.result import BROKEN, DecisionRecord, EpisodeResult, Link, Played
from hazard_ms.evaluation.runner import RUNNING, fates, result_of
from hazard_ms.evaluation.watchers import Watcher
from hazard_ms.skills.brief import Brief
from hazard_ms.skills.context import LowLevel
from hazard_ms.skills.decision import STOP, Action, Decision, Result
from hazard_ms.skills.failures import EPISODE_OVER
from hazard_ms.skills.team import TeamSkills
from hazard_ms.spec.registry import load

STOPPED = "stopped"  # how an episode ends that all robots have stopped
CUT_OFF = "end of record"  # how the simulation of a record ends where a robot has no decision left


class EndOfRecordError(Exception):
    """Raised by an agent that repeats a record which ends here: the episode ends, whatever is under way."""


class TeamRunner:
    """Plays episodes of one agent of teams in one environment."""

    def __init__(self, env: TeamSkills, agent: TeamAgent, watchers: Sequence[Watcher] = ()) -> None:
        self.env, self.agent, self.watchers = env, agent, tuple(watchers)

    def run(self, seed: int | None, options: dict[str, Any] | None = None) -> Played:
        """Play an episode from its reset with `seed` and `options` to its end.

        Raises ValueError for a seed, a scene, or an action or note of the agent that is not valid, RuntimeError for an
        agent that calls sys.exit.
        """
        self._records: list[DecisionRecord] = []  # as they were taken
        self._open: dict[str, int] = {}  # the place in them of what each robot does
        self._links: list[Link] = []
        start = time.perf_counter()
        decisions, _ = self.env.reset(seed=seed, options=options)
        looks = self._looked()
        begun = time.perf_counter()
        with staying("reset of the agent"):
            if isinstance(self.agent, PrivilegedTeam):
                self.agent.attach(self.env)
            self.agent.reset({name: self.env.brief(name) for name in self.env.names})
        self._seconds = {"build": begun - start - looks, "agent": time.perf_counter() - begun, "physics": 0.0}
        self.env.watch = self._frame
        for watcher in self.watchers:
            watcher.begin(self.env, decisions[self.env.names[0]])
        try:
            ended = self._play(decisions)
        finally:
            self.env.watch = None
        for watcher in self.watchers:
            watcher.finish(ended)
        return self.played(ended)

    def played(self, ended: str = RUNNING) -> Played:
        """The course of the episode up to now; what is under way counts as broken off."""
        made = list(self._records)
        for place in self._open.values():
            made[place] = replace(made[place], reason=EPISODE_OVER, frames=self.env.frame - made[place].frame)
        seconds = {**self._seconds, "looks": self._looked()}
        return Played(ended, tuple(made), tuple(self._links), seconds, counters_of(self.agent))

    def _play(self, decisions: Mapping[str, Decision]) -> str:
        """Play from the first `decisions` on. Returns why the episode ended."""
        while True:
            extended(self._links, self.env)
            for watcher in self.watchers:
                watcher.asked(self.played())
            try:
                actions = self._asked(decisions)
            except EndOfRecordError:
                return CUT_OFF
            self._begin(decisions, actions)
            start, looked = time.perf_counter(), self._looked()
            decisions, terminated, truncated, info = self.env.step(actions)
            self._seconds["physics"] += time.perf_counter() - start - (self._looked() - looked)
            for name, result in info["results"].items():
                self._end(name, result)
            if terminated or truncated:
                extended(self._links, self.env)
                return self._reason(info)

    def _asked(self, decisions: Mapping[str, Decision]) -> dict[str, Action]:
        """What the agent chooses. Raises ValueError for anything but an action for each robot that needs one."""
        start = time.perf_counter()
        with staying("act of the agent"):
            actions = self.agent.act(decisions)
        self._seconds["agent"] += time.perf_counter() - start
        if not isinstance(actions, dict):
            raise ValueError(f"act of a team's agent must return a dict of actions, got a {type(actions).__name__}")
        self.env.check(actions)
        return actions

    def _begin(self, decisions: Mapping[str, Decision], actions: Mapping[str, Action]) -> None:
        """Record decisions; to stop is over at once."""
        value = Tally.of(fates(self.env)).value
        for name, action in actions.items():
            decision, note = decisions[name], shown_note(self.agent.notes.get(name), self.agent)
            for watcher in self.watchers:
                watcher.decided(decision, action, note)
            made = DecisionRecord(
                frame=decision.frame,
                verb=action.verb,
                target=action.target,
                ok=action.verb == STOP,
                reason="",
                frames=0,
                note=note,
                held=decision.held,
                value=value,
                robot=name,
            )
            if action.verb != STOP:
                self._open[name] = len(self._records)
            self._records.append(made)

    def _end(self, name: str, result: Result) -> None:
        """Record how the action of a robot ended."""
        for watcher in self.watchers:
            watcher.ended(result)
        place = self._open.pop(name)
        made = self._records[place]
        self._records[place] = replace(made, ok=result.ok, reason=result.reason, frames=result.frames)

    def _frame(self, moves: dict[str, LowLevel]) -> None:
        if self.env.frame % EVERY == 0:
            extended(self._links, self.env)
        for watcher in self.watchers:
            watcher.frame(moves)

    def _looked(self) -> float:
        """Wall time spent in looks since the reset [s]."""
        return sum(known.look_seconds for known in self.env.knowledge.values())

    def _reason(self, info: dict[str, Any]) -> str:
        if bool(info["sim_error"][0]):
            return BROKEN
        if bool(info["success"][0]):
            return self.env.base.task.goal.done
        if bool(info["fail"][0]):
            return "failed"
        return STOPPED if self.env.stopped == set(self.env.names) else "time"


def play(
    options: EpisodeOptions, watchers: Sequence[Watcher] = (), player: TeamAgent | None = None, **keywords: Any
) -> EpisodeResult:
    """Play one episode of a team in an environment of its own, made with `keywords` besides those of `options`.

    `player` decides in place of the agent of `options`; an Account among `watchers` adds what is lost. Raises
    ValueError for what cannot be played.
    """
    start = time.perf_counter()
    options.check(teams=True)
    player = player or team_agent(options.agent)
    env = TeamSkills.make(options.env_id, **{"reward_mode": "none", **options.settings, **keywords})
    made = time.perf_counter()
    try:
        if env.base.task.safe_place.at_rest and not any(isinstance(w, Account) for w in watchers):
            watchers = [*watchers, Account()]
        played = TeamRunner(env, player, watchers).run(options.seed, options.reset_options)
        result = result_of(options, env, played)
        for account in (w for w in watchers if isinstance(w, Account)):
            result = replace(result, **account.closed(lambda: fates(env)))
        played.phase_seconds["build"] += made - start
        return replace(result, wall_seconds=time.perf_counter() - start)
    finally:
        env.close()


class RecordedTeam(PrivilegedTeam):
    """Takes the actions that the robots of a team took earlier, each its own, in their order.

    Where their agent, one of ours, is privileged, it is asked, too, since it tells their maps what it knows. Its
    answers do not matter.
    """

    def __init__(self, actions: Sequence[tuple[str, str | None]], robots: Sequence[str], name: str = "") -> None:
        """`robots`: which of them took each of the `actions`, (verb, target); `name`: of their agent."""
        self._source = privileged_team(name)
        self._left: dict[str, list[Action]] = {}
        for robot, (verb, target) in zip(robots, actions, strict=True):
            self._left.setdefault(robot, []).insert(0, Action(verb, target))

    def attach(self, env: TeamSkills) -> None:
        """Show the environment to the agent of the record if that is privileged."""
        if self._source is not None:
            self._source.attach(env)

    def reset(self, briefs: Mapping[str, Brief]) -> None:
        """Begin an episode."""
        if self._source is not None:
            self._source.reset(briefs)

    def act(self, decisions: Mapping[str, Decision]) -> dict[str, Action]:
        """The next action of each robot. Raises EndOfRecordError where one has none left."""
        if self._source is not None:
            self._source.act(decisions)
        if not all(self._left.get(name) for name in decisions):
            raise EndOfRecordError
        return {name: self._left[name].pop() for name in decisions}


def privileged_team(name: str) -> PrivilegedTeam | None:
    """A new agent of teams if `name` is that of one of ours that sees what is hidden; None for all others."""
    made = load(TEAM_AGENTS[name]) if name in TEAM_AGENTS else None
    return made() if made is not None and issubclass(made, PrivilegedTeam) else None
