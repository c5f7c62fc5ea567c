"""Keeps account of an episode: where things were put, what the robot bore, and what is lost when all time is up."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import torch

from hazard_ms.evaluation.averted.contacts import Collisions
from hazard_ms.evaluation.averted.loss import Loads, Loss
from hazard_ms.evaluation.metrics import Fate
from hazard_ms.evaluation.watchers import Watcher
from hazard_ms.hazards.base import Hazard
from hazard_ms.hazards.fire.realistic.tenability import dose_rate
from hazard_ms.hazards.places import SETTLING, follow, strayed
from hazard_ms.skills.actions import wait
from hazard_ms.skills.context import LowLevel
from hazard_ms.skills.decision import Decision
from hazard_ms.skills.executor import SkillEnv

DOSE = "agent_dose"  # entry of `info` of a fire that adds up the dose itself
WET = 0.01  # depth from which the robot wades [m] [ours]


class Account(Watcher):
    """Watches one episode; `close` lets the rest of the task's time pass and tells what is lost then."""

    def __init__(self) -> None:
        self._dose: float | None = None
        self._wading: float | None = None
        self._water: float | None = None

    def begin(self, env: SkillEnv, decision: Decision) -> None:
        """Note where everything stands."""
        self._env, self._base = env, env.base
        world = env.base.world
        self._place = world.position.clone()
        self._rested = torch.full_like(world.value, SETTLING)
        self._put = torch.zeros_like(world.frame[:1]).expand(world.num_bodies)  # frames
        self._seconds = float(env.base.control_timestep)
        self._collisions = None if env.base.gpu_sim_enabled else Collisions(env.base)

    def frame(self, action: LowLevel) -> None:
        """Follow what is in the hand, and count collisions; `action`, [A], in the controllers' units, plays no part."""
        self._follow(action)
        if self._collisions is not None:
            self._collisions.count()
        if self._base.affects_agent:
            self._sample()

    def _follow(self, action: LowLevel) -> None:
        world = self._base.world
        follow(self._place, self._rested, world, self._seconds)
        self._put = torch.where(world.held[0], world.frame[0], self._put)

    def _sample(self) -> None:
        """Add what acts on the robot in this frame."""
        told = self._told({"agent_temperature", "water_depth"}, {DOSE})
        if "agent_temperature" in told:
            temperature = torch.tensor([told["agent_temperature"]])
            rate = dose_rate(temperature, torch.zeros_like(temperature))
            self._dose = (self._dose or 0.0) + self._seconds * float(rate)
        if "water_depth" in told:
            deep = told["water_depth"]
            self._wading = (self._wading or 0.0) + self._seconds * (deep >= WET)
            self._water = (self._water or 0.0) + self._seconds * deep

    def _told(self, wanted: set[str], but: set[str]) -> dict[str, float]:
        """What hazards that tell something `wanted`, and nothing of `but`, tell of the robot, each in its unit [-]."""
        episode, world = self._base.episode, self._base.world
        able = [h for h in episode.hazards if wanted & h.tells.keys() and not but & h.tells.keys()]
        every = [h.agent_info(episode.states[h.name], world) for h in able]
        return {name: float(value[0]) for told in every for name, value in told.items()}

    def loads(self) -> Loads:
        """The loads on the robot up to now."""
        dose = self._told({DOSE}, set()).get(DOSE, self._dose) if self._base.affects_agent else None
        found = None if self._collisions is None else self._collisions.number
        return Loads(dose, self._wading, self._water, found)

    def close(self) -> Loss | None:
        """The loss at the end of the task's time, for the rest of which nobody acts; None if physics broke.

        What is in the hand stays there, what is in the bag is safe.
        """
        env, world = self._env, self._base.world
        if (left := env.max_frames - env.frame) > 0 and not self._settled():
            watched, env.watch = env.watch, self._follow
            try:
                env.run(wait(env.stage, left))
            finally:
                env.watch = watched
        if bool(self._base.episode.sim_error[0]):
            return None
        rescue, damage = self._base.episode.rescue, self._base.episode.damage
        safe = rescue.safe[0]
        gone = self.strayed() & ~safe & ~world.held[0]
        damaged = torch.where(safe, rescue.damaged[0], damage.damaged[0])
        loose = slice(0, len(self._base.specs[0].bodies))
        value, target, *marks = (
            part[loose].cpu().numpy() for part in (world.value[0].double(), world.target[0], gone, damaged)
        )
        return Loss.of(np.asarray(value), target, marks[0], marks[1])

    def strayed(self) -> torch.Tensor:
        """Things that a hazard has carried off from where they were put, bool [B]: none where no hazard pushes."""
        moved = strayed(self._place, self._base.world)[0]
        pushed = any(type(hazard).force is not Hazard.force for hazard in self._base.task.hazards)
        return moved if pushed else torch.zeros_like(moved)

    def closed(self, fates: Callable[[], tuple[Fate, ...]]) -> dict[str, Any]:
        """The fields of a result that tell of loads, loss and targets, whose `fates` are asked for at the end."""
        loads, lost = self.loads(), self.close()
        return {"loads": loads, "lost": lost, **({} if lost is None else self._kept(fates))}

    def _kept(self, fates: Callable[[], tuple[Fate, ...]]) -> dict[str, Any]:
        """The targets, as `fates` tells, where what lies where it was put counts as rescued; nothing elsewhere."""
        if not self._base.task.safe_place.at_rest:
            return {}
        gone, world, made = self.strayed(), self._base.world, []
        for fate in fates():
            b = world.index(0, fate.name)
            lies = not fate.rescued and not bool(gone[b] & ~world.held[0, b])
            made.append(replace(fate, rescued=True, frame=int(self._put[b])) if lies else fate)
        return {"targets": tuple(made)}

    def _settled(self) -> bool:
        """Whether nothing can be lost any more: every loose thing is safe."""
        loose = slice(0, len(self._base.specs[0].bodies))
        return bool(self._base.episode.rescue.safe[0, loose].all())
