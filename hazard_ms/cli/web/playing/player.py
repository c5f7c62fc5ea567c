"""The player of a rescue on the page: recorded decisions first, then an agent that is watched, or a person."""

from __future__ import annotations

import time
from collections.abc import Mapping

from hazard_ms.agents.base import Agent, agent, note_of
from hazard_ms.cli.web.playing.desk import Desk
from hazard_ms.cli.web.rescue import ALL, WATCH, Rescue
from hazard_ms.demonstrations.watching.sentences import sentence
from hazard_ms.evaluation.attempts import Accompanied
from hazard_ms.skills.actions import wait
from hazard_ms.skills.decision import EXPLORE, Action, Decision
from hazard_ms.skills.options.macros import Macro

PATIENCE = 0.5  # time between two looks at whether a page still listens [s] [ours]


class Player(Accompanied):
    """Chooses as the agent of the rescue does, or as the page says."""

    def __init__(self, rescue: Rescue, desk: Desk) -> None:
        self._rescue, self._desk = rescue, desk
        self._left = list(reversed(rescue.taken))
        self._source: Agent | None = agent(rescue.episode.agent) if rescue.kind == WATCH else None
        self._macro: Macro | None = None

    @property
    def counters(self) -> Mapping[str, float]:  # type: ignore[override]
        """The pictures that a person had, and how many decisions an agent took first.

        Of an agent: its own counts, and how often it was taken back to an earlier decision, if it was.
        """
        if self._source is not None:
            back = {"gone_back": float(self._rescue.gone_back)} if self._rescue.gone_back else {}
            return {**self._source.counters, **back}
        first = {"decisions_of_agent": float(len(self._rescue.taken))} if self._rescue.after else {}
        return {"third_person": float(self._rescue.view == ALL), **first}

    @property
    def colours(self) -> bool:  # type: ignore[override]
        """Whether decisions must have pictures with colours: the page has its own."""
        return self._source is not None and self._source.colours

    @property
    def ending(self) -> str:  # type: ignore[override]
        """The reason that the result gives when the episode is stopped."""
        return "stopped" if self._source is None else self._source.ending

    @property
    def fallback(self) -> bool:  # type: ignore[override]
        """Whether the last action stands in for an answer that could not be read."""
        return self._source is not None and bool(self._source.fallback)

    def act(self, decision: Decision) -> Action:
        """The next action: the recorded one, else the agent's when the page lets it go on, or the person's."""
        wanted = None
        if self._source is not None:
            if not self._desk.replaying:
                self._desk.tell("thinking")
            wanted = self._source.act(decision)
            self.note = note_of(self._source)
        if self._left:
            taken = self._left.pop()
            if taken.waited:
                self._env.run(wait(self._env.stage, taken.waited))
            self.note = taken.note
            return Action(taken.verb, taken.target)
        if wanted is not None:
            self._hold(wanted, decision)
            return wanted
        return self._next(decision)

    def _hold(self, wanted: Action, decision: Decision) -> None:
        """Wait while the page has paused the agent, which wants to do `wanted` at `decision`."""
        desk = self._desk
        desk.hear(0.0)
        if desk.paused and not desk.steps:
            desk.tell("paused", intent=sentence(wanted, decision), note=self.note)
            desk.show(everything=True)
            while desk.paused and not desk.steps:
                desk.hear(PATIENCE)
        desk.steps = max(0, desk.steps - 1)

    def _next(self, decision: Decision) -> Action:
        """The next action of what the person has chosen, or chooses now."""
        self.note = ""
        if self._macro is not None:
            try:
                return self._macro.send(decision)
            except StopIteration:
                self._macro = None
        desk = self._desk
        desk.choices.begin(decision)
        desk.chosen = None
        last, result = decision.last_action, decision.last_result
        words = "" if last is None else " ".join([last.verb.replace("_", " "), last.target or ""]).strip()
        how = None if result is None else {"action": words, "ok": result.ok, "reason": result.reason}
        desk.tell("asking", last=how)
        desk.show(everything=True)
        while desk.chosen is None:
            if not desk.runs_on:
                desk.hear(PATIENCE)
            elif not self._let_pass():
                return Action(EXPLORE)  # nothing comes of it: the episode is over
        self._macro = desk.choices.play(desk.chosen)
        return next(self._macro)

    def _let_pass(self) -> bool:
        """Let a few frames pass, at the pace of the world. Returns whether the episode goes on."""
        env, start = self._env, time.monotonic()
        frames = self._desk.every
        done = env.run(wait(env.stage, frames)).ok
        left = frames * float(env.base.control_timestep) - (time.monotonic() - start)
        self._desk.hear(max(0.0, left))
        return done
