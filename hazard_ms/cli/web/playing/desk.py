"""The desk of a rescue: it hears what the page asks for, and tells and shows it what happens."""

from __future__ import annotations

import time
from dataclasses import replace
from pathlib import Path
from typing import Any

from hazard_ms.cli.web import rescue as rescues
from hazard_ms.cli.web.playing.link import PICTURES, Link
from hazard_ms.cli.web.playing.menu import Choice, Choices
from hazard_ms.cli.web.playing.pictures import Pictures
from hazard_ms.cli.web.rescue import ALL, PLAY, Rescue, Taken
from hazard_ms.demonstrations.watching.sentences import sentence
from hazard_ms.evaluation.metrics import Tally
from hazard_ms.evaluation.result import DecisionRecord, Played
from hazard_ms.evaluation.runner import fates
from hazard_ms.evaluation.watchers import Watcher
from hazard_ms.skills.context import LowLevel
from hazard_ms.skills.decision import Action, Decision, Result
from hazard_ms.skills.executor import SkillEnv
from hazard_ms.skills.failures import UNFINISHED
from hazard_ms.skills.mitigations.offers import tools

ROW = ("frame", "verb", "target", "ok", "reason", "frames", "waited", "note", "value")  # of a decision, that pages show
ASKED = ("choose", "point", "thing", "pace", "pause", "go", "step", "world", "end")
FASTEST = 12.0  # pictures per second, at most: fast machines do not fly [ours]


def tell_row(link: Link, number: int, record: DecisionRecord) -> None:
    """Tell the page of a decision that has ended."""
    row = {name: getattr(record, name) for name in ROW}
    link.say("row", number=number, unfinished=record.reason in UNFINISHED, **row)


class EndedError(Exception):
    """Raised where the page ends a rescue: its journal stays."""


class Desk(Watcher):
    """Stands between one episode and its page; a watcher of the episode, and the ear of its player."""

    def __init__(self, link: Link, rescue: Rescue, folder: Path) -> None:
        self.link, self.rescue, self._folder = link, rescue, folder
        self.choices = Choices()
        self.paused, self.steps = False, 0
        self.runs_on, self.every = rescue.runs_on, rescue.every
        self.chosen: Choice | None = None
        self.phase, self._replaying = "building", len(rescue.taken)
        self._action: Action | None = None
        self._taken: list[Taken] = []
        self._told = 0
        self._last_picture = 0.0
        self._pictures: Pictures | None = None

    @property
    def replaying(self) -> bool:
        """Whether recorded decisions are being taken again."""
        return len(self._taken) < self._replaying

    def begin(self, env: SkillEnv, decision: Decision) -> None:
        """Tell the page of the episode."""
        self._env, brief = env, env.brief()
        self.link.say(
            "begun",
            scene=env.base.specs[0].name,
            text=brief.text,
            frame_seconds=brief.frame_seconds,
            max_frames=brief.max_frames,
            played=self.rescue.kind == PLAY,
            agent=self.rescue.episode.agent,
            task=self.rescue.episode.env_id,
            seed=self.rescue.episode.seed,
            runs_on=self.runs_on,
            every=self.every,
            room=self.rescue.view == ALL,
        )

    def pictures(self) -> Pictures:
        """The camera, which begins with the first picture that is wanted."""
        if self._pictures is None:
            self._pictures = Pictures(self._env, self.rescue.view == ALL)
        return self._pictures

    def asked(self, so_far: Played) -> None:
        """Keep the journal; `so_far` holds every decision."""
        self.tell_rows(so_far)
        if len(self._taken) >= self._replaying:
            rescues.keep(self._folder, self.so_far())

    def so_far(self) -> Rescue:
        """The rescue with all decisions that have been taken."""
        return replace(self.rescue, taken=tuple(self._taken), runs_on=self.runs_on, every=self.every)

    def tell_rows(self, so_far: Played) -> None:
        """Tell of the decisions that have ended and were not told of."""
        for number in range(self._told, len(so_far.decisions)):
            tell_row(self.link, number, so_far.decisions[number])
        self._told = len(so_far.decisions)
        if self.replaying and self._taken:
            self.link.say("replaying", done=len(self._taken), of=self._replaying)

    def decided(self, decision: Decision, action: Action, note: str) -> None:
        """The action is under way from now on."""
        self._action = action
        self._taken.append(Taken(action.verb, action.target, self._env.frame - decision.frame, note))
        if not self.replaying and len(self._taken) > self._replaying:
            self.tell("doing", intent=sentence(action, decision), note=note)

    def frame(self, action: LowLevel) -> None:
        """Show the frame if it is due, and hear what the page asks for."""
        if self.replaying:
            if self._env.frame % 50 == 0:
                self.hear(0.0)
            return
        self.pictures().moved()
        if self._env.frame % self.every == 0:
            self.show()
            self.hear(max(0.0, 1.0 / FASTEST - (time.monotonic() - self._last_picture)))
            self._last_picture = time.monotonic()

    def ended(self, result: Result) -> None:
        """Nothing is under way any more; a failure is told with the next decision."""
        self._action = None

    def show(self, everything: bool = False) -> None:
        """Take the pictures that are due, or all of them, and send them."""
        goal = None if self._action is None else self._action.target
        for picture, jpeg in self.pictures().due(goal, everything):
            self.link.show(picture, jpeg)
        env = self._env
        value = Tally.of(fates(env)).value
        self.link.say("tick", frame=env.frame, value=value, held=env.labeller.held)

    def tell(self, phase: str, **more: Any) -> None:
        """Tell the page how things stand."""
        self.phase, env = phase, self._env
        known = env.labeller.targets(env.seen.seen_damaged)
        targets = [
            {
                "name": t.name,
                "value": t.value,
                "rescued": t.rescued,
                "damaged": t.damaged,
                "held": t.held,
                "seen": t.index in env.seen.objects,
            }
            for t in known
        ]
        asking, doors = phase == "asking", env.stage.doors.rows()
        self.link.say(
            "state",
            phase=phase,
            number=len(self._taken),
            frame=env.frame,
            value=Tally.of(fates(env)).value,
            held=env.labeller.held,
            targets=targets,
            doors=[{"name": o.name, "open": o.open, "broken": o.broken} for o in doors if o.kind == "door"],
            tools=[{"name": t.name, "left": t.left, "held": t.held} for t in tools(env.stage)],
            choices=[c.row() for c in self.choices.options] if asking else [],
            things=self.choices.things() if asking else [],
            runs_on=self.runs_on,
            every=self.every,
            **more,
        )

    # ------------------------------------------------------------------ what the page asks for

    def hear(self, seconds: float | None) -> None:
        """Do what the page has asked for, all of it, after waiting for the first message for `seconds`.

        Raises EndedError when the page ends the rescue, EOFError when the server has gone.
        """
        message = self.link.hear(seconds)
        while message is not None:
            try:
                self._do(message)
            except ValueError as error:
                self.link.say("refused", why=str(error))
            message = self.link.hear(0.0)

    def _do(self, message: dict[str, Any]) -> None:
        what = message.get("do")
        if what == "end":
            raise EndedError
        if what == "choose":
            if message.get("number") != len(self._taken) or self.phase != "asking":
                raise ValueError("choice must belong to the current decision, got one from an earlier decision")
            self.chosen = self.choices.find(message.get("key"))
        elif what == "point":
            self._point(message)
        elif what == "thing":
            self._about(str(message.get("name")))
        elif what == "pace":
            self.every = rescues.pace(message.get("every"))
        elif what in ("pause", "go", "step"):
            self.paused, self.steps = what != "go", self.steps + (what == "step")
        elif what == "world":
            self.runs_on = message.get("runs_on") is True
        else:
            raise ValueError(f"do must be one of {', '.join(ASKED)}, got {what!r:.100}")

    def _point(self, message: dict[str, Any]) -> None:
        where, place = message.get("picture"), (message.get("across"), message.get("down"))
        if where not in PICTURES or not all(isinstance(p, float | int) and 0.0 <= p <= 1.0 for p in place):
            raise ValueError("point must be a picture and two numbers from 0 to 1")
        name = self.pictures().thing_at(where, float(place[0] or 0.0), float(place[1] or 0.0))
        if name is None:
            self.link.say("pointed", name=None, choices=[], why="there is nothing to act on here")
        else:
            self._about(name)

    def _about(self, name: str) -> None:
        """Tell what can be done with a thing."""
        found = self.choices.of(name) if self.phase == "asking" else []
        why = "" if found else self._why_not(name)
        self.link.say("pointed", name=name, choices=[c.row() for c in found], why=why)

    def _why_not(self, name: str) -> str:
        if self.phase != "asking":
            return "the robot is busy"
        env = self._env
        known = name in env.labeller.names and env.labeller.index(name) in env.seen.objects
        known |= env.stage.doors.find(name) is not None
        return "nothing can be done with it now" if known else "the robot has not seen it yet"
