"""The knowledge that one robot has of an episode: the map of what it has seen, its last look, its last action."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import torch

from hazard_ms.sensing.detection.perception import Perception
from hazard_ms.sensing.observations import Observer
from hazard_ms.sensing.semantic_map import CEILING, FEWEST_CELLS, LINTELS, MAP_CELL, SemanticMap
from hazard_ms.sensing.sighting import Sighting, with_missing
from hazard_ms.simulation.robot import Robot
from hazard_ms.simulation.world import World
from hazard_ms.skills.brief import Brief, brief_of, has_several_rooms
from hazard_ms.skills.context import Rescuer, Stage
from hazard_ms.skills.decision import PICK_UP, Action, Decision, Images, Message, Result, Teammate, available
from hazard_ms.skills.failures import REFUSED, TOO_FAR, UNREACHABLE
from hazard_ms.skills.mitigations.offers import offered, tools, verbs_of
from hazard_ms.skills.motor.grasping import may_begin
from hazard_ms.spec.registry.mitigations import TELL
from hazard_ms.tasks.episode.episode import Episode
from hazard_ms.tasks.episode.grasp import Hand

EYESHOT = 4.0  # distance around a scene's area up to which things are remembered [m] [ours]


@dataclass
class OneRobot:
    """One robot of a team as skills need it."""

    agent: Robot
    world: World
    hand: Hand
    episode: Episode
    control_timestep: float  # [s]


class Knowledge:
    """The knowledge of one robot in the episode that has begun in one environment."""

    def __init__(
        self,
        base: Any,
        robot: Rescuer,
        observer: Observer,
        perception: Perception,
        max_frames: int,
        look: Callable[[], None] | None = None,
    ) -> None:
        """Begin with nothing seen.

        `base`: the HazardEnv; `robot`: the robot in it, which sees by `observer`; `look`: what skills call to look, by
        default `look` of this.
        """
        self._base, self._robot, self._observer, self._perception = base, robot, observer, perception
        self.max_frames = max_frames
        world, spec = robot.world, base.specs[0]
        cells, hazards = _cells_for(spec.room.size), len(base.task.hazards)
        carts = [t.name for t in spec.things if t.category in base.task.safe_place.containers]
        self.labeller = perception.labeller(world, carts)
        ceiling = LINTELS if has_several_rooms(base) else CEILING
        self.seen = SemanticMap(
            self._place(),
            self.labeller.loose,
            cells=cells,
            hazards=hazards,
            ceiling=ceiling,
            clears=self.labeller.withheld,
        )
        self.maps = [self.seen]
        self.stage = Stage(robot, self.seen, look or self.look, self.labeller)
        self.stage.maps, self.stage.on_ground = self.maps, base.task.safe_place.at_rest
        self.look_seconds = 0.0  # wall time spent in looks
        self._images: Images | None = None
        self._last: tuple[Action | None, Result | None] = (None, None)
        self._messages: tuple[Message, ...] = ()

    def _place(self) -> tuple[float, float]:
        x, y, _ = self._robot.world.agent_position[0].tolist()
        return x, y

    @property
    def verbs(self) -> tuple[str, ...]:
        """The verbs that it has beyond the six of the benchmark; without a detector those of the task."""
        told = (TELL,) if self.stage.others else ()
        return (*verbs_of(self.labeller, self._base.task.mitigations), *told)

    def brief(self, number: int = 0) -> Brief:
        """Everything that the agent of robot `number` is told before the episode: nothing that identifies the scene."""
        return brief_of(
            self._base, self._robot.agent, self.labeller, self.max_frames, self._perception.sight, number=number
        )

    def ended(self, action: Action, result: Result) -> None:
        """Remember that `action` has ended with `result`, and what follows for the thing that it was done to."""
        if action.verb == PICK_UP and action.target is not None:
            index = self.labeller.index(action.target)
            if result.ok:
                self.labeller.took(index)
                for seen in self.maps:
                    seen.forget(index)
            elif result.reason in REFUSED:
                self.labeller.refused(index, result.reason != UNREACHABLE)
            elif result.reason == TOO_FAR:  # it is not where the map has it, if that is not too far
                for seen in self.maps:
                    known = seen.objects.get(index)
                    if known is not None and may_begin(self.stage, known.position):
                        seen.objects = {**seen.objects, index: replace(known, missing=True)}
        self._last = (action, result)

    def hear(self, message: Message, seen: Mapping[int, Sighting]) -> None:
        """Take a message, and enter what its sender has `seen` of the things in it, unless it has been seen later."""
        self._messages += (message,)
        gone = self.labeller.unmapped()
        for known in self.maps:
            new = {i: s for i, s in seen.items() if i not in gone and not _later(known.objects.get(i), s)}
            known.objects = {**known.objects, **new}

    def look(self, colours: bool = False) -> None:
        """Look through the head camera, with `colours` or where a detector needs them, and enter what is seen."""
        start, world, base, labeller = time.perf_counter(), self._robot.world, self._base, self.labeller
        frame = int(world.frame[0])
        rgb = None
        if colours or labeller.needs_colours:
            picture, true = self._observer.look()
            rgb = picture.cpu().numpy().copy()
        else:
            true = self._observer.glance()
        view = labeller.view(rgb, true, frame)
        gone, damaged = labeller.unmapped(), labeller.damaged(base.episode.damage.damaged[0].cpu().numpy())
        where = self._place()
        if base.task.mitigations:
            self.stage.doors.look(view, frame, self.maps)
        for seen in self.maps:
            for index in gone:
                seen.forget(index)
            seen.update(view, frame, where, gone, damaged)
            if base.affects_agent:
                self._bar(seen)
            if not labeller.withheld:  # detectors overlook things, and labellers of theirs forget by themselves
                seen.objects = with_missing(seen.objects, view, frame, gone)
            seen.mark_free(where, self._robot.agent.build.radius)
        hazard = np.zeros((len(base.task.hazards), 1, 1), np.float32) if view.level is None else view.level
        self._images = Images(rgb, view.depth, None if labeller.withheld else view.labels, hazard)
        self.look_seconds += time.perf_counter() - start

    def _bar(self, seen: SemanticMap) -> None:
        """Mark on a map what of the floor seen just now a hazard keeps the robot out of, and what it no longer does."""
        y, x = np.nonzero(seen.told_at == seen.frame)
        floor = np.pad(seen.centre_of(y, x), ((0, 0), (0, 1)))
        points = torch.as_tensor(floor, dtype=torch.float32, device=self._robot.world.device)
        seen.barred[y, x] = self._robot.episode.forbidden(points[None])[0].cpu().numpy()

    def decision(self, others: Mapping[str, tuple[float, float]] | None = None) -> Decision:
        """All that an agent may know now; the map is a copy that cannot be written to.

        `others`: places of the bases of the other robots of its team [m], world frame, by their names.
        """
        labeller = self.labeller
        x, y, heading = self.stage.robot.base()
        targets, acts = labeller.targets(self.seen.seen_damaged), bool(self._base.task.mitigations)
        return Decision(
            frame=int(self._robot.world.frame[0]),
            max_frames=self.max_frames,
            agent_position=(x, y),
            agent_heading=heading,
            held=labeller.held,
            targets=targets,
            containers=labeller.containers,
            map=self.seen.frozen(),
            images=self._images,
            available=available(labeller, self.seen.objects, targets) + offered(self.stage, self.verbs),
            names=labeller.names,
            last_action=self._last[0],
            last_result=self._last[1],
            openings=self.stage.doors.rows() if acts else (),
            tools=tools(self.stage) if acts else (),
            messages=self._messages,
            others=tuple(Teammate(name, place) for name, place in (others or {}).items()),
        )


def _cells_for(size: tuple[float, float]) -> int:
    """The number of cells along each side of a map that holds an area of `size` [m], wherever the agent starts."""
    return max(FEWEST_CELLS, 2 * round((max(size) + EYESHOT) / MAP_CELL))


def _later(own: Sighting | None, other: Sighting) -> bool:
    return own is not None and own.frame >= other.frame
