"""The judge of a running episode, who sees what is hidden: the true state, and what will happen."""

from __future__ import annotations

from collections import Counter

import numpy as np
from numpy.typing import NDArray

from hazard_ms.agents.action_values import ActionValues, Notion, Place, Reach, State
from hazard_ms.agents.aims import Aim
from hazard_ms.agents.truth import Future
from hazard_ms.hazards.base import pushes
from hazard_ms.sketch import skill_times
from hazard_ms.sketch.planning.problem import Problem
from hazard_ms.sketch.rescue_problem import RescueScene
from hazard_ms.sketch.skill_times import SkillTimes
from hazard_ms.sketch.timeline import Timeline
from hazard_ms.skills.decision import Action, Result
from hazard_ms.skills.executor import SkillEnv
from hazard_ms.skills.failures import BLOCKED, NO_PATH, UNREACHABLE
from hazard_ms.spec.catalogue import DAMAGED_SHARE
from hazard_ms.spec.registry.mitigations import MITIGATIONS

FAILED = {UNREACHABLE: 2, NO_PATH: 1, BLOCKED: 1}  # how much each failure tells of a target's being out of reach [ours]
OUT_OF_REACH = 2  # of that in a row, from which a target counts as out of reach [ours]


class Judge:
    """The judge of a running episode: its true state and future, and what choices are worth there."""

    def __init__(self, env: SkillEnv, times: SkillTimes | None = None) -> None:
        """Take an environment in which an episode has just begun; `times` of skills, as measured if None."""
        base, robot = env.base, env.brief().robot
        self._env, self._future = env, Future(env)
        self.scene = scene = RescueScene(base.specs[0], robot, base.agent.build.radius, env.max_frames)
        averts = base.task.averted and base.task.several_rooms
        self.aim = Aim(averts, averts and pushes(base.task.hazards))
        carts = tuple(base.world.index(0, cart.name) for cart in base.specs[0].containers)
        self._values = ActionValues(scene, carts, times or skill_times.shipped(robot), self.aim)
        self.targets = {target.index: target for target in base.observer.table.rows(base.world)}
        self.truth = Notion({index: target.value for index, target in self.targets.items()})
        self._failures: Counter[int] = Counter()

    def state(self) -> State:
        """The true state now. Targets that skills failed to get count as out of reach."""
        base = self._env.base
        world, rescue = base.world, base.episode.rescue
        safe, gone, held = world.safe[0].cpu(), (world.away & ~world.safe)[0].cpu(), world.held[0].cpu()
        damaged = rescue.damaged[0].cpu()
        saved = sum(t.value * (DAMAGED_SHARE if damaged[b] else 1.0) for b, t in self.targets.items() if safe[b])
        saved += self._kept([b for b in self.targets if not safe[b]])
        left = [b for b in self.targets if held[b] or not (safe[b] or gone[b] or self._failures[b] >= OUT_OF_REACH)]
        holding = next((b for b in left if held[b]), None)
        x, y, heading = base.agent.base()
        tools = [] if world.equipment is None else (world.equipment.tool & world.held)[0].nonzero()[:, 0].tolist()
        tool = int(tools[0]) if tools else None
        return State((float(x), float(y)), float(heading), self._env.frame, holding, tuple(left), float(saved), tool)

    def _kept(self, targets: list[int]) -> float:
        """The value that `targets`, indices along B, count by the aim if nobody rescues them."""
        if not self.aim.averts:
            return 0.0
        held = (self._env.base.world.held[0].nonzero()[:, 0].tolist() or [None])[0]
        values = np.array([self.targets[b].value for b in targets])
        return float(self.aim.kept(np.array(targets, np.int64), values, self.future(), self.scene, held).sum())

    def future(self) -> Timeline:
        """The timeline from here on if nobody acts."""
        return self._future.timeline()

    def problem(self, state: State) -> tuple[Problem | None, list[int]]:
        """The true rest of the rescue with the targets' own values, and its targets, indices along B."""
        return self._values.problem(state, self.truth, self.future())

    def after(self, state: State, action: Action, place: Place | None = None) -> State:
        """The state in which `action` usually leaves a rescue; `place` as for `choice`."""
        return self._values.after(state, action, self.truth, self.future(), place)

    def note(self, action: Action, result: Result) -> None:
        """Count a failure of `action` that can be due to where its target is; what works ends the count.

        What was done about a hazard changes what will happen.
        """
        if action.verb in MITIGATIONS and result.frames:
            self._future.forget()
        for index, target in self.targets.items():
            if target.name == action.target and (result.ok or result.reason in FAILED):
                self._failures[index] = 0 if result.ok else self._failures[index] + FAILED[result.reason]

    def place(self, index: int) -> NDArray[np.float32]:
        """The true place of the thing `index`, x and y [m], [2]."""
        return self._env.base.world.position[0, index, :2].cpu().numpy()

    def limits(self, state: State) -> Reach:
        """The last frame of the episode at each of PACES, as it looks from `state`."""
        return self._values.limits(state.frame)

    def best(self, state: State, limits: Reach, notion: Notion | None = None) -> Reach:
        """The value that the best plan reaches from `state` by each of `limits`; `notion`: by default the truth."""
        return self._values.best(state, notion or self.truth, self._future.timeline(), limits)

    def choice(
        self,
        state: State,
        action: Action,
        limits: Reach,
        best: Reach,
        notion: Notion | None = None,
        place: Place | None = None,
    ) -> Reach:
        """The value that the best course that begins with `action` reaches by each of `limits`; `best`: any course.

        `place` [m]: where somebody walks whose target is nothing that there is.
        """
        return self._values.choice(state, action, notion or self.truth, self._future.timeline(), limits, best, place)

    def begins_with(self, state: State, limit: float) -> str:
        """The first rescue of the best plan from `state` by `limit` in words; empty where it has none."""
        return self._values.begins_with(state, self.truth, self._future.timeline(), limit)
