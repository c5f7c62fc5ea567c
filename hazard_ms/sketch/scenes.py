"""Scenes of the sketch, made from a scene's timeline, ways and sight.

Landmarks are the things at rest that lie far enough apart to offer different views. A target that moves has a site
wherever it has gone on by SITE_STEP.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from typing import Any

import numpy as np

from hazard_ms.scenes.solids import extent_of
from hazard_ms.scenes.splits import SCENES, spare_scene
from hazard_ms.sketch.fires.making import Measures, has_measures
from hazard_ms.sketch.limits import limit_of
from hazard_ms.sketch.recording import recorded, suite_of
from hazard_ms.sketch.rescues.grid import grid_of
from hazard_ms.sketch.rescues.scene import LOOKS, SPOTS, Floats, Ints, SketchScene, spot_offsets
from hazard_ms.sketch.rescues.sites import Sites
from hazard_ms.sketch.scene_cache import kept
from hazard_ms.sketch.sight import FETCH, G1, Sight
from hazard_ms.sketch.timeline import STRIDE, Timeline
from hazard_ms.sketch.travel.ways import Ways
from hazard_ms.skills.options.landmarks import MIN_SPACING
from hazard_ms.spec import SceneSpec, Task
from hazard_ms.spec.catalogue import CATEGORIES, value_of
from hazard_ms.spec.checks import one_of, whole
from hazard_ms.spec.registry.robots import robot_class
from hazard_ms.spec.severity import USUAL
from hazard_ms.tasks import task_of

SITE_STEP = 0.6  # distance that a moving target goes on from one of its sites to the next, below NEAR [m] [ours]
FLOOR_SEEN = 5.0  # distance up to which a look shows the floor without gaps: farther off, pixels are too sparse [m]
MANY_PIXELS = 1e4  # of a thing, beyond which the number makes no difference
MOST_SCENES = 100_000  # any larger number of a scene must be a mistake [ours]
EYES = {"fetch": FETCH, "g1": G1}


def scenes_of(
    env_id: str,
    names: Sequence[str],
    seeds: Sequence[int],
    physics: str = "paper",
    robot: str = "fetch",
    max_frames: int | None = None,
    hazards: Sequence[str] | None = None,
    severity: str = USUAL,
) -> list[SketchScene]:
    """The scenes called `names` of a task, each with the fate that the seed of the same number gives it.

    `max_frames`: length of an episode at most, by default that of the task. Raises ValueError for unknown names.
    """
    task = _lasting(task_of(env_id, physics, hazards, severity), max_frames)
    return [sketch_scene(task, physics, task.build(n), seed, robot) for n, seed in zip(names, seeds, strict=True)]


def training_scenes(env_id: str, physics: str, count: int, robot: str = "fetch") -> list[SketchScene]:
    """The first `count` scenes of a task's split `train`, numbered by their seeds.

    Raises ValueError for unknown names, and for a count above its number of scenes.
    """
    names = task_of(env_id, physics).scenes("train")
    some = names[: whole(count, 1, len(names), "count")]
    return scenes_of(env_id, some, range(len(some)), physics, robot)


def more_scenes(
    env_id: str, physics: str, first: int, count: int, robot: str = "fetch", max_frames: int | None = None
) -> list[SketchScene]:
    """`count` scenes that belong to no split, in the places of the split `train` in turn.

    Their numbers begin with `first`, and are their seeds; `max_frames` is that of `scenes_of`. Raises ValueError for
    unknown names, and for numbers of scenes that belong to a split.
    """
    task = _lasting(task_of(env_id, physics), max_frames)
    whole(first, SCENES, MOST_SCENES, "first")
    numbers = range(first, first + whole(count, 0, MOST_SCENES, "count"))
    return [sketch_scene(task, physics, spare_scene(task.scenes("train"), number), number, robot) for number in numbers]


def _lasting(task: Task, max_frames: int | None) -> Task:
    return task if max_frames is None else dataclasses.replace(task, max_frames=max_frames)


def level_ranges(env_id: str, physics: str) -> list[tuple[float, float]]:
    """The ends of the usual level of each hazard of a task, in its unit. Raises ValueError for unknown names."""
    return [(hazard.level.low, hazard.level.high) for hazard in task_of(env_id, physics).hazards]


def measures_of(env_id: str, physics: str) -> bool:
    """Whether options of a task have measures about a fire. Raises ValueError for unknown names."""
    return has_measures(task_of(env_id, physics))


def sketch_scene(task: Task, physics: str, spec: SceneSpec, seed: int, robot: str = "fetch") -> SketchScene:
    """The scene `spec` with the fate that `seed` gives it in `task` under the preset `physics`, for `robot`.

    It is kept in the cache folder. Raises ValueError for an unknown preset or robot.
    """
    follows_from = f"{suite_of(task, physics, spec)} {task.safe_place.containers} {seed} {robot}"

    def made() -> SketchScene:
        future, measures = recorded(task, physics, spec, seed), Measures.of(task, physics, spec, seed)
        return _Maker(task, spec, future, robot, measures).scene()

    return kept(spec.name, follows_from, made)


class _Maker:
    """Makes one scene of the sketch."""

    def __init__(self, task: Task, spec: SceneSpec, future: Timeline, robot: str, measures: Measures | None) -> None:
        if future.stride != STRIDE:
            raise ValueError(f"stride of the timeline must be {STRIDE} frames, got {future.stride}")
        self.task, self.spec, self.future, self.measures = task, spec, future, measures
        self.sight = Sight(spec, EYES[one_of(robot, EYES, "robot")])
        self.ways = Ways(spec, radius=robot_class(robot).build.radius)
        self.start = np.asarray(spec.agent_start.position, dtype=np.float64)
        named = {thing.name: number for number, thing in enumerate(spec.things)}
        self.targets = [named[body.name] for body in spec.targets]
        self.carts = [n for name, n in named.items() if spec.things[n].category in task.safe_place.containers]

    def scene(self) -> SketchScene:
        """All arrays of the scene."""
        sites = Sites([np.array([*self.start, 0.0])], [-1])
        course, grid = self._courses(sites), grid_of(self.spec.room, self.ways.places)
        carts = [sites.add(self.future.start[n].astype(np.float64), n) for n in self.carts]
        marks = [sites.add(self.future.start[n].astype(np.float64), n) for n in self._landmarks()]
        measures = self._measures(sites, grid["stand"])
        position = np.array(sites.position)
        edge = np.array([0.0 if n < 0 else np.hypot(*extent_of(self.spec.things[n])[:2]) / 2 for n in sites.thing])
        height = self.future.start[self.targets, 2].astype(np.float64)
        return SketchScene(
            name=self.spec.name,
            max_frames=self.task.max_frames,
            heading=self.spec.agent_start.heading,
            position=position[:, :2],
            target_site=course,
            cart_site=np.array(carts, np.int64),
            landmark_site=np.array(marks, np.int64),
            value=np.array([value_of(self.spec.things[n]) for n in self.targets], np.float64),
            height=height,
            clearance=self._clearance(position[course[0], :2]),
            damaged_at=self.future.damaged_at[self.targets].astype(np.int64),
            safe_at=self.future.safe_at[self.targets].astype(np.int64),
            level=self.future.levels[:, :, self.targets].astype(np.float64).transpose(0, 2, 1),
            limit=self._limits(height),
            traits=self._traits(),
            **grid,
            **self._travel(grid["stand"], position[:, :2], edge),
            **self._views(grid["stand"], position, np.array(sites.thing), marks),
            **measures,
        )

    def _courses(self, sites: Sites) -> Ints:
        """The sites of the targets at every sample, [K, T]; one sample if nothing moves."""
        places = self.future.positions(np.array(self.targets)).astype(np.float64)
        made = np.zeros(places.shape[:2], np.int64)
        for t, number in enumerate(self.targets):
            anchor, site = places[0, t], sites.add(places[0, t], number)
            for k, place in enumerate(places[:, t]):
                if np.linalg.norm(place - anchor) > SITE_STEP:
                    anchor, site = place, sites.add(place, number)
                made[k, t] = site
        return made[:1] if (made == made[0]).all() else made

    def _measures(self, sites: Sites, stand: Floats) -> dict[str, Any]:
        """The arrays about fires and extinguishers, whose sites are added; none where the task has no measures.

        `stand` [P, 2] [m]: from where they are seen.
        """
        if self.measures is None:
            return {}
        stands, tools = self.measures.stands(self.ways, self.sight, self.start), self.measures.tools
        fire_site = [sites.add(np.array([*stand, 0.0]), -1) for stand in stands]
        tool_site = [sites.add(self.future.start[n].astype(np.float64), n) for n in tools]
        seen = self.measures.seen(self.sight, stand)
        return {"fire_seen": seen, **self.measures.arrays(self.targets, fire_site, tool_site)}

    def _landmarks(self) -> list[int]:
        """Numbers along B of the things that are landmarks: things at rest, furniture first, MIN_SPACING apart."""
        moving = {int(n) for n in self.future.moves}
        bodies, everything = range(len(self.spec.bodies)), range(len(self.spec.things))
        chosen: list[int] = []
        for n in (*everything[len(bodies) :], *bodies):
            place = self.future.start[n, :2]
            apart = all(np.hypot(*(place - self.future.start[c, :2])) >= MIN_SPACING for c in chosen)
            if n not in moving and apart:
                chosen.append(n)
        return chosen

    def _travel(self, stand: Floats, position: Floats, edge: Floats) -> dict[str, Any]:
        """Ways from `stand` [P, 2] [m] to things of `edge` [S] [m] at `position` [S, 2] [m]."""
        route = self.ways.route(stand[:, None], position[None], edge[None])
        metres = np.where(np.isfinite(route.metres), route.metres, 0.0)
        share = np.arange(1, LOOKS + 1) / LOOKS
        way = self.ways.along(
            stand[:, None, None], position[None, :, None], metres[..., None] * share, edge[None, :, None]
        )
        parts = {"travel": route.frames(), "first": route.first, "last": route.last, "way": way}
        return {name: part.astype(np.float32) for name, part in parts.items()}

    def _clearance(self, position: Floats) -> Floats:
        """Distance from things at `position` [m], [T, 2], to where the robot can stand [m], [T]."""
        floor = self.ways.places
        return np.array([np.hypot(*(floor - place).T).min() for place in position]).reshape(len(position))

    def _traits(self) -> Floats:
        """What agents are told of the targets beside their values, [T, 3]: see TRAITS."""
        kinds = [CATEGORIES[self.spec.things[n].category] for n in self.targets]
        return np.array([(k.flammable, k.waterproof, k.ignition_temperature) for k in kinds], np.float64).reshape(-1, 3)

    def _limits(self, height: Floats) -> Floats:
        """Level of each hazard from which each target is damaged, [T, H]; infinite where it never is."""
        return np.array(
            [
                [limit_of(hazard, self.spec.things[n].category, float(h)) for hazard in self.task.hazards]
                for n, h in zip(self.targets, height, strict=True)
            ]
        ).reshape(len(self.targets), len(self.task.hazards))

    def _views(self, stand: Floats, position: Floats, thing: Ints, marks: Sequence[int]) -> dict[str, Any]:
        """The sight from `stand` [P, 2] [m] of `thing`, numbers along B, [S], at `position` [S, 3] [m]."""
        pixels = np.zeros((len(stand), len(position)), np.float16)
        some = thing >= 0
        pixels[:, some] = np.minimum(self.sight.pixels(stand, None, thing[some], position[some]), MANY_PIXELS)
        return {"pixels": pixels, "spots": self._spots(stand, position[list(marks), :2])}

    def _spots(self, places: Floats, marks: Floats) -> Floats:
        """The floor around landmarks at `marks` [m], [L, 2], that is seen from `places` [m], [P, 2]: bits, [P, L]."""
        points = (marks[:, None] + spot_offsets()).reshape(-1, 2)
        cell = np.floor((points - self.ways.origin) / self.ways.cell).astype(int)
        inside = ((cell >= 0) & (cell < np.array(self.ways.free.shape[::-1]))).all(axis=1)
        free = np.zeros(len(points), bool)
        free[inside] = self.ways.free[cell[inside, 1], cell[inside, 0]]
        near = np.hypot(*np.moveaxis(places[:, None] - points, -1, 0)) <= FLOOR_SEEN
        seen = near & free & self.sight.clear(places, np.pad(points, ((0, 0), (0, 1))))
        bits = seen.reshape(len(places), len(marks), SPOTS) << np.arange(SPOTS)
        return bits.sum(axis=-1).astype(np.uint16)
