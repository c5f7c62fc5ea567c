"""The truth that is hidden from all agents but the oracle: where things really are, and what will happen."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from hazard_ms.agents.search.walks import detours
from hazard_ms.sensing.furniture import told
from hazard_ms.sensing.semantic_map import SemanticMap
from hazard_ms.sensing.sighting import Sighting
from hazard_ms.sketch.recording import ahead, recorded
from hazard_ms.sketch.rescue_problem import RescueScene
from hazard_ms.sketch.timeline import Timeline
from hazard_ms.skills.context import Stage
from hazard_ms.skills.decision import Decision
from hazard_ms.skills.motor.walking import ARRIVED
from hazard_ms.skills.options.landmarks import WALKABLE

LASTS = 300  # frames for which the future of a home is kept, whatever is picked up [ours]
SURPRISE = 0.25  # how far a target may be from where it was expected before the future is predicted again [m] [ours]


class Played(Protocol):
    """The part of a `SkillEnv` that the truth is read from, and entered into; one robot of a team has it, too."""

    @property
    def base(self) -> Any:
        """The HazardEnv in which the robot is."""

    @property
    def seen(self) -> SemanticMap:
        """The map of what the robot has seen."""

    @property
    def maps(self) -> list[SemanticMap]:
        """All maps into which its looks are entered."""

    @property
    def stage(self) -> Stage:
        """The episode as its skills see it."""

    @property
    def frame(self) -> int:
        """Frames since the start of the episode."""


class Future:
    """The future of a running episode if nobody acts, predicted when it is asked for and kept while it holds.

    Robots of a team share one. `changes`: how often something was done about the hazard.
    """

    changes = 0

    def __init__(self, env: Played) -> None:
        self._env = env
        self._told: Timeline | None = None
        self._free: NDArray[np.bool_] = np.zeros(0, bool)  # the things that were free when the future was predicted

    def timeline(self) -> Timeline:
        """The timeline from here on if nobody acts, predicted again when a target is not as predicted."""
        base = self._env.base
        world, now = base.world, int(base.world.frame[0])
        free = (~(world.safe | world.held | world.away)[0]).cpu().numpy()
        if self._told is not None and (np.array_equal(free, self._free) or self._lasts(now)):
            things = slice(len(self._told.names))
            off = world.position[0, things].cpu().numpy() - self._told.position_at(now)
            damaged = base.episode.damage.damaged[0, things].cpu().numpy()
            expected = (self._told.damaged_at >= 0) & (self._told.damaged_at <= now)
            as_told = (np.linalg.norm(off, axis=-1) <= SURPRISE) & (damaged == expected)
            if as_told[(free & world.target[0].cpu().numpy())[things]].all():
                return self._told
        self._told, self._free = ahead(base), free
        return self._told

    def _lasts(self, now: int) -> bool:
        """Whether a future in which something was not yet picked up is kept: in tasks of homes, for a time.

        What is gone from there no longer burns, which changes little; to predict a home takes seconds.
        """
        return self._env.base.task.several_rooms and self._told is not None and now - self._told.first < LASTS

    def forget(self) -> None:
        """Predict anew when it is asked next: something was done about the hazard."""
        self._told = None
        self.changes += 1


class Truth:
    """The true state and future of a running episode, and how it gets into the map."""

    def __init__(self, env: Played, only_known: bool, future: Future | None = None) -> None:
        """Enter where things are into the map of `env` after every look; `only_known`: only those that it knows.

        `future`: that of the episode, where another robot's truth has one.
        """
        self.env, self._only_known = env, only_known
        self.aim: dict[int, NDArray[np.float32]] = {}  # where the map is to place some things instead [m], by index
        self.also: set[int] = set()  # things that are entered beside targets and containers, by index
        self._future = Future(env) if future is None else future
        self._record: Timeline | None = None
        self.furniture = False  # whether the map is told where all furniture is, as it is of containers
        look = env.stage.look

        def looked() -> None:
            look()
            self.reveal()

        env.stage.look = looked

    def knows(self, index: int) -> bool:
        """Whether the thing `index` along B may be part of a plan."""
        held = bool(self.env.base.world.held[0, index])
        return not self._only_known or held or index in self.env.seen.objects

    def position(self, index: int) -> NDArray[np.float32]:
        """The position of the middle of the thing `index` [m], [3], world frame."""
        return self.env.base.world.position[0, index].cpu().numpy()

    def future(self) -> Timeline:
        """The timeline from here on if nobody acts, predicted again when a target is not as predicted."""
        return self._future.timeline()

    def forget(self) -> None:
        """Predict the future anew when it is asked for next: something was done about the hazard."""
        self._future.forget()

    @property
    def changes(self) -> int:
        """Number of times that something was done about the hazard."""
        return self._future.changes

    def record(self) -> Timeline:
        """The timeline of the whole episode if nobody acts from its start on."""
        if self._record is None:
            base = self.env.base
            self._record = recorded(base.task, base.physics, base.specs[0], int(base.world.chance.seed[0]))
        return self._record

    def detours(self, decision: Decision, scene: RescueScene, targets: Sequence[int]) -> NDArray[np.float64]:
        """Frames by which the walk to each of `targets`, [T], is longer now, past what floats or was pushed about."""
        goals, edges = np.stack([self.position(i)[:2] for i in targets]), scene.edges[list(targets)]
        here, radius = decision.agent_position, scene.ways.radius
        plain = scene.ways.frames(np.array([here]), goals, edge=edges)
        return detours(decision.map, here, goals.astype(float), ARRIVED + edges, radius, plain)

    def furnish(self, decision: Decision) -> Decision:
        """Enter furniture and walls into the map, and return the decision; in a gale with the map as it is then.

        With `only_known`, floor stays unexplored until it is seen, so that there is something to search.
        """
        seen, spec = self.env.seen, self.env.base.specs[0]
        height, within = told(seen, spec, self.env.base.actors[0][len(spec.bodies) :])
        seen.tell(height, height >= WALKABLE if self._only_known else within)
        if not self.furniture:
            return decision
        self.reveal()
        return dataclasses.replace(decision, map=seen.frozen())

    def reveal(self) -> None:
        """Enter into the map where targets and containers really are, or where `aim` says."""
        base, seen = self.env.base, self.env.seen
        world = base.world
        there = (world.target[0] & ~(world.safe | world.held | world.away)[0]).cpu().numpy()
        there[[*(world.index(0, cart.name) for cart in base.specs[0].containers), *self.also]] = True
        if self.furniture:
            spec = base.specs[0]
            there[len(spec.bodies) : len(spec.things)] = True
        if base.task.mitigations and not self._only_known:
            for number in range(len(base.specs[0].room.openings)):
                self.env.stage.doors.enter(number, self.env.frame, self.env.maps)
        places, extents = world.position[0].cpu().numpy(), world.extent[0].cpu().numpy()
        damaged = base.episode.damage.damaged[0].cpu().numpy()
        made = {}
        for index in np.flatnonzero(there).tolist():
            if not self.knows(index):
                continue
            place, (x, y, z) = self.aim.get(index, places[index]), extents[index]
            old = seen.objects.get(index)
            levels, history = (old.levels, old.history) if old else ((), ())
            radius, top = float(np.hypot(x, y)) / 2, float(place[2] + z / 2)
            # no pixels: the next look knows better
            made[index] = Sighting(place, radius, top, self.env.frame, 0, levels, bool(damaged[index]), history)
        seen.objects = {**seen.objects, **made}
