"""Plays one episode in a process that must survive it: whatever an agent raises costs that episode alone."""

from __future__ import annotations

import traceback
from dataclasses import replace
from pathlib import Path

import torch

from hazard_ms.agents.base import Agent, PrivilegedAgent, agent
from hazard_ms.evaluation.averted.account import Account
from hazard_ms.evaluation.options import EpisodeOptions
from hazard_ms.evaluation.result import ERROR, EpisodeResult, Played
from hazard_ms.evaluation.runner import play, result_of
from hazard_ms.evaluation.teams.player import RecordedTeam
from hazard_ms.evaluation.teams.player import play as play_team
from hazard_ms.evaluation.watchers import Watcher
from hazard_ms.evaluation.workers import Job, Outcome, Say, Word
from hazard_ms.skills.actions import wait
from hazard_ms.skills.brief import Brief
from hazard_ms.skills.decision import STOP, Action, Decision
from hazard_ms.skills.executor import SkillEnv
from hazard_ms.skills.team import TeamSkills
from hazard_ms.spec.registry import AGENTS, load

LONGEST_ERROR = 300  # characters of an agent's error that are shown [ours]


def attempt(job: Job, say: Say) -> Outcome:
    """Play one episode in this process, with one thread. Whatever its agent raises costs only this episode."""
    torch.set_num_threads(1)
    teller = Teller(job.options, say)
    try:
        result = _played(job, [teller, *([Account()] if job.averted else [])])
        result.to_json()  # what cannot be written is this agent's fault, not that of who gathers results
        return Outcome(result)
    except KeyboardInterrupt:
        raise
    except BaseException as error:
        shown, so_far = told(error), teller.so_far
        return Outcome(so_far and replace(so_far, ended=ERROR, error=shown), shown)


def _played(job: Job, watchers: list[Watcher]) -> EpisodeResult:
    """The episode of a job, of one robot or of a team."""
    if job.options.team:
        team = None if job.actions is None else RecordedTeam(job.actions, job.robots, job.options.agent)
        return play_team(job.options, watchers, team)
    return play(
        job.options, watchers, None if job.actions is None else Recorded(job.actions, job.options.agent, job.waits)
    )


class Teller(Watcher):
    """Says before each decision what the episode has come to, and after it that the agent has answered."""

    def __init__(self, options: EpisodeOptions, say: Say) -> None:
        self._options, self._say = options, say
        self.so_far: EpisodeResult | None = None

    def begin(self, env: SkillEnv | TeamSkills, decision: Decision) -> None:
        """Remember the environment."""
        self._env = env

    def asked(self, so_far: Played) -> None:
        """Say what the episode has come to."""
        self.so_far = result_of(self._options, self._env, so_far)
        self._say(Word(self.so_far))

    def decided(self, decision: Decision, action: Action, note: str) -> None:
        """Say that the agent has answered."""
        self._say(Word(None))


class Accompanied(PrivilegedAgent):
    """Decides beside another agent, which learns all that it would learn if it decided itself; None for nobody."""

    _env: SkillEnv
    _source: Agent | None

    def attach(self, env: SkillEnv) -> None:
        """Take the environment, and show it to the other agent if that is privileged."""
        self._env = env
        if isinstance(self._source, PrivilegedAgent):
            self._source.attach(env)

    def reset(self, brief: Brief) -> None:
        """Begin an episode."""
        if self._source is not None:
            self._source.reset(brief)


class Recorded(Accompanied):
    """Takes the actions that an agent took earlier, after waiting as long as it did, and stops after the last one.

    Where that agent is privileged, it is asked, too, since it tells the map what it knows. Its answers do not matter.
    Nobody's code is loaded because a file names it: only registered agents are asked. `notes`: its reasons, for films.
    """

    colours = False

    def __init__(
        self,
        actions: tuple[tuple[str, str | None], ...],
        name: str,
        waits: tuple[int, ...] = (),
        notes: tuple[str, ...] = (),
    ) -> None:
        self._left = [Action(STOP), *(Action(verb, target) for verb, target in reversed(actions))]
        self._waits, self._notes = list(reversed(waits)), list(reversed(notes))
        entry = AGENTS.get(name.partition(":")[0])
        asked = entry is not None and issubclass(load(entry.agent), PrivilegedAgent)
        self._source = agent(name) if asked else None

    def act(self, decision: Decision) -> Action:
        """The next action of the record."""
        if self._source is not None:
            self._source.act(decision)
        self.note = self._notes.pop() if self._notes else ""
        if self._waits and (frames := self._waits.pop()):
            self._env.run(wait(self._env.stage, frames))
        return self._left.pop() if len(self._left) > 1 else self._left[0]


def told(error: BaseException) -> str:
    """An error in one line, with the place in the code where it was raised."""
    calls = traceback.extract_tb((error.__cause__ or error).__traceback__)
    where = f" ({Path(calls[-1].filename).name}, line {calls[-1].lineno})" if calls else ""
    text = "".join(c if c.isprintable() else " " for c in f"{type(error).__name__}: {error}")
    return f"{text[:LONGEST_ERROR]}{where}"
