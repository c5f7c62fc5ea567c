"""Two rooms with a door between them and a robot in one: mitigation in the whole simulation, without rendering."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from typing import Any

import gymnasium as gym
import numpy as np
import torch

import hazard_ms
from hazard_ms.scenes import floor
from hazard_ms.sensing.semantic_map import SemanticMap
from hazard_ms.sensing.sighting import Sighting
from hazard_ms.simulation.mitigation import hinges
from hazard_ms.skills import failures
from hazard_ms.skills.actions import skill
from hazard_ms.skills.context import Skill, Stage
from hazard_ms.skills.decision import Action, Result
from hazard_ms.spec import AgentStart, Body, Fixture, Opening, Partition, Room, SceneSpec
from hazard_ms.spec.registry import ROBOTS
from tests.worlds.registering import registered_task

SIZE, AT = (7.0, 4.0), 3.5  # of both rooms together, and where the wall between them is [m]
DOOR = Opening("door", "middle", 2.0, 0.9, 2.05, open=0.0)
HINGE = np.array([AT, 1.55])  # the lower end of the door, in the middle of the wall [m]
HALL = AgentStart((1.5, 2.0), 0.0)  # before the door, on the side into which it turns
FAR = AgentStart((5.5, 2.0), np.pi)
ONE = torch.arange(1)
VERBS = ("open", "shut", "extinguish")


def spec(
    door: Opening | None = DOOR,
    start: AgentStart = HALL,
    bodies: Sequence[Body] = (),
    fixtures: Sequence[Fixture] = (),
    fires: Sequence[tuple[float, float]] = (),
    openings: Sequence[Opening] = (),
) -> SceneSpec:
    """The scene: things of category `bottle` are targets, and one lies in a corner."""
    inner = () if door is None else (door,)
    room = Room(SIZE, openings=(*inner, *openings), partitions=(Partition("middle", "y", AT),) if inner else ())
    target = Body("bottle_0", "bottle", "plain_box", (6.7, 0.3, 0.0), scale=(0.08, 0.08, 0.2), mass=0.5)
    return SceneSpec("test/two_rooms", room, tuple(fixtures), (target, *bodies), ("bottle",), tuple(fires), start)


class TwoRooms:
    """One episode in such rooms; the map is told what stands there."""

    def __init__(self, env: Any) -> None:
        """Take the environment `env`, which has been reset."""
        self.env, self.base = env, env.unwrapped
        self.world = self.base.world
        seen = SemanticMap((3.5, 2.0), self.world.movable[0].numpy(), hazards=len(self.base.task.hazards))
        self.stage = Stage(self.base, seen, self.look)
        self.look()

    def look(self) -> None:
        """See everything: an ideal camera, so that these tests are about acting."""
        seen, scene, stage = self.stage.seen, self.base.specs[0], self.stage
        for number in range(len(scene.room.openings)):
            stage.doors.enter(number, stage.frame, stage.maps)
        y, x = np.mgrid[0 : len(seen.explored), 0 : len(seen.explored)]
        x, y = seen.origin[0] + (x + 0.5) * seen.cell, seen.origin[1] + (y + 0.5) * seen.cell
        within = (x > 0.0) & (x < SIZE[0]) & (y > 0.0) & (y < SIZE[1])
        height = np.where(within, 0.0, 2.0).astype(np.float32)
        without = tuple(replace(o, open=1.0) if o.kind == "door" else o for o in scene.room.openings)
        for box in floor.partitions(replace(scene.room, openings=without)):
            over = (np.abs(x - box.x) < box.half_x + 0.02) & (np.abs(y - box.y) < box.half_y + 0.02)
            height[over & (box.low < 1.8)] = 2.0
        for number, o in enumerate(scene.room.openings):
            if o.kind == "door" and o.wall == "middle" and not bool(self.world.openings.state.broken[0, number]):
                angle = hinges.angle(float(self.world.openings.share[0, number]))
                for point in hinges.under_leaf(scene.room, o, angle):
                    height[(np.abs(x - point[0]) < seen.cell / 2) & (np.abs(y - point[1]) < seen.cell / 2)] = 2.0
        levels = self.base.episode.levels(self.world.position)[0].numpy()
        objects = {}
        for b, thing in enumerate(scene.things):
            if bool(self.world.held[0, b] | self.world.away[0, b]):
                continue
            place, half = self.world.position[0, b].numpy().copy(), self.world.extent[0, b].numpy() / 2
            under = (np.abs(x - place[0]) < half[0] + 0.05) & (np.abs(y - place[1]) < half[1] + 0.05)
            height[under] = np.maximum(height[under], place[2] + half[2])
            known = tuple(float(level) for level in levels[:, b])
            objects[b] = Sighting(place, float(np.hypot(*half[:2])), float(place[2] + half[2]), 0, 99, known)
            assert thing.name == self.world.names[0][b]
        seen._firm[:] = height
        seen.explored |= within
        seen.objects = objects

    def run(self, doing: Skill, limit: int = 1500) -> Result:
        """Do a skill to its end, in as many actions as it takes frames, and check that it counts these right."""
        frames = 0
        try:
            action = next(doing)
            while True:
                self.base.advance(action)
                frames += 1
                assert frames <= limit, "a skill hangs"
                action = next(doing)
        except StopIteration as ended:
            result: Result = ended.value
            assert result.frames == frames
            return result

    def index(self, name: str) -> int:
        """Index along B of the thing called `name`."""
        return self.world.index(0, name)

    def share(self, number: int = 0) -> float:
        """How far the door is open."""
        return float(self.world.openings.share[0, number])


@contextmanager
def two_rooms(
    scene: SceneSpec,
    hazards: Sequence[str] = ("fire",),
    physics: str = "paper",
    robot: str = "fetch",
    verbs: Sequence[str] = VERBS,
    **laws: Any,
) -> Iterator[TwoRooms]:
    """An environment in `scene` whose agents have the mitigations `verbs`; `laws`: what its hazards have otherwise."""

    def maker(preset: str) -> Any:
        made = hazard_ms.rescue([replace(hazard_ms.hazard(name, preset), **laws) for name in hazards])
        return replace(made, scenes=lambda split: (scene.name,), build=lambda name: scene, mitigations=tuple(verbs))

    with registered_task("HazardTwoRooms-v0", maker) as name:
        env = gym.make(
            name,
            physics=physics,
            robot_uids=ROBOTS[robot].uid,
            obs_mode="none",
            control_mode="pd_joint_pos",
            render_backend="none",
        )
        env.reset(seed=0)
        yield TwoRooms(env)
        env.close()


def acted(rooms: TwoRooms, action: Action) -> Result:
    """The result of an action, asked for again where it is not finished."""
    for _ in range(8):
        result = rooms.run(skill(rooms.stage, action))
        rooms.look()
        if result.reason != failures.MAX_FRAMES:
            break
    return result
