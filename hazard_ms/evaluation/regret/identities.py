"""The true things behind those that an agent knows, so that its choices can be judged by what they really are.

An agent that is told the truth knows every thing by its index along B. One that sees for itself has tracks; the true
thing of a track is what a hand would meet where the track was when it was last seen.
"""

from __future__ import annotations

from typing import NamedTuple

from hazard_ms.agents.action_values import Place
from hazard_ms.skills.decision import Action
from hazard_ms.skills.executor import SkillEnv

NOTHING = -1  # in place of an index along B


class Meant(NamedTuple):
    """An action as one to true things, and the place where its target is believed to be."""

    action: Action  # with the true thing as its target, where there is one
    body: int  # index along B of the true thing, or NOTHING
    place: Place | None  # where it is believed to be [m]; None: nowhere


class Identities:
    """The true things of what an agent knows in one episode, as of the last look at each."""

    def __init__(self, env: SkillEnv) -> None:
        """Begin with what the first look of the episode showed."""
        self._env = env
        self._bodies: dict[int, int] = {}
        self.looked()

    def looked(self) -> None:
        """Identify what the last look has shown."""
        env = self._env
        for index, seen in env.seen.objects.items():
            if seen.frame == env.frame:
                self._bodies[index] = env.labeller.thing(index)

    def body(self, index: int) -> int:
        """Index along B of the true thing that the agent knows as `index`, or NOTHING."""
        return self._bodies[index] if index in self._bodies else self._env.labeller.thing(index)

    def meant(self, action: Action) -> Meant:
        """The `action` as one to true things."""
        if action.target is None:
            return Meant(action, NOTHING, None)
        if (opening := self._env.stage.doors.find(action.target)) is not None:
            return Meant(action, NOTHING, opening.position[:2])
        index, names = self._env.labeller.index(action.target), self._env.base.world.names[0]
        body, known = self.body(index), self._env.seen.objects.get(index)
        place = None if known is None else (float(known.position[0]), float(known.position[1]))
        return Meant(Action(action.verb, names[body]) if body >= 0 else action, body, place)
