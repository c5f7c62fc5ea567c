"""A room without physics in which agents can play: a point in the plane that does the six actions."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from hazard_ms.agents.base import Agent
from hazard_ms.sensing.semantic_map import SemanticMap
from hazard_ms.sensing.sighting import Sighting
from hazard_ms.sensing.target_table import Target
from hazard_ms.skills.brief import Brief, HazardBrief
from hazard_ms.skills.decision import DROP, EXPLORE, PICK_UP, STOP, WALK_ONE_STEP, WALK_TO, Action, Decision, Result
from hazard_ms.tasks import task_of

STRIDE = 1.6  # a walk gives up after 100 frames of 1/62 m
DRIVE_ON = 1.4  # from here a drop drives on to a cart [m]


def brief(env_id: str = "HazardFire-v1", seed: int = 0) -> Brief:
    """The brief of an agent for a task in a playground."""
    task = task_of(env_id, "paper")
    hazards = tuple(HazardBrief(h.name, h.level.title, h.level.unit, h.threatens) for h in task.hazards)
    return Brief(env_id, task.text, (), (), task.safe_place.name, hazards, task.max_frames, 1 / 30, "fetch", 0.29, seed)


@dataclass
class Playground:
    """A point in the plane that can do the six actions.

    Things are seen within `sight` when it looks around or arrives.
    """

    places: dict[str, tuple[float, float]]
    values: dict[str, float]
    broken: frozenset[str] = frozenset()  # no walk to them succeeds
    slippery: frozenset[str] = frozenset()  # no pick-up of them succeeds
    carts: tuple[str, ...] = ()
    sight: float = 3.0
    at: tuple[float, float] = (0.0, 0.0)
    frame: int = 0
    held: str | None = None
    rescued: set[str] = field(default_factory=set)
    last: tuple[Action | None, Result | None] = (None, None)

    def __post_init__(self) -> None:
        self.names = tuple(self.places)
        self.map = SemanticMap((0.0, 0.0), np.ones(len(self.names), bool))

    def look(self) -> None:
        y, x = np.mgrid[0:256, 0:256]
        here = np.hypot(
            self.map.origin[0] + (x + 0.5) * 0.1 - self.at[0], self.map.origin[1] + (y + 0.5) * 0.1 - self.at[1]
        )
        self.map.explored |= here < self.sight
        self.map.frame = self.frame
        for i, (name, place) in enumerate(self.places.items()):
            if np.hypot(place[0] - self.at[0], place[1] - self.at[1]) < self.sight and name not in self.rescued:
                self.remember(i, Sighting(np.array([*place, 0.5], np.float32), 0.1, 0.6, self.frame, 50))

    def remember(self, index: int, sighting: Sighting) -> None:
        self.map.objects = {**self.map.objects, index: sighting}

    def decision(self) -> Decision:
        rows = tuple(
            Target(self.names.index(n), n, "bottle", v, True, False, 300.0, n in self.rescued, n == self.held)
            for n, v in self.values.items()
        )
        every = tuple(Action(v) for v in (DROP, EXPLORE, STOP))
        action, result = self.last
        return Decision(
            self.frame,
            1500,
            self.at,
            0.0,
            self.held,
            rows,
            self.carts,
            self.map,
            None,
            every,
            self.names,
            action,
            result,
        )

    def do(self, action: Action) -> None:
        self.last = (action, self._do(action))
        self.frame += max(1, self.last[1].frames)

    def _do(self, action: Action) -> Result:
        if action.verb == EXPLORE:
            self.look()
            return Result(True, frames=60)
        if action.verb in (WALK_TO, WALK_ONE_STEP):
            assert action.target is not None
            return self._walk(action.target)
        if action.verb == PICK_UP:
            return self._pick(action.target)
        if action.verb == DROP:
            return self._drop(action.target)
        return Result(True)

    def _walk(self, name: str) -> Result:
        if name in self.broken or self.names.index(name) not in self.map.objects:
            return Result(False, "no_path", 1)
        way = np.array(self.places[name]) - self.at
        length = float(np.hypot(*way))
        go = min(STRIDE, max(0.0, length - 0.5))
        self.at = tuple((self.at + way / max(length, 1e-9) * go).tolist())
        self.look()
        return Result(True, frames=int(62 * go)) if length - go < 0.51 else Result(False, "max_frames", 100)

    def _pick(self, name: str | None) -> Result:
        far = name is None or np.hypot(*(np.array(self.places[name]) - self.at)) > 0.8
        if far or self.held is not None or name not in self.values or name in self.slippery or name in self.rescued:
            return Result(False, "too_far", 1)
        self.held = name
        self.map.forget(self.names.index(name))
        return Result(True, frames=60)

    def _drop(self, cart: str | None) -> Result:
        if self.held is None:
            return Result(False, "not_holding", 1)
        if self.carts and (cart is None or np.hypot(*(np.array(self.places[cart]) - self.at)) > DRIVE_ON):
            return Result(False, "cart_unreachable", 1)
        self.rescued.add(self.held)
        self.held = None
        return Result(True, frames=20)


def play(player: Agent, ground: Playground, seed: int = 0, most: int = 400) -> list[Action]:
    """Decisions until it stops, time is over (1500 frames) or `most` are taken."""
    player.reset(brief(seed=seed))
    taken = []
    while ground.frame < 1500 and len(taken) < most:
        taken.append(player.act(ground.decision()))
        if taken[-1].verb == STOP:
            break
        ground.do(taken[-1])
    return taken
