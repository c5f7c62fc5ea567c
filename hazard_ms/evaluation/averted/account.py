"""Keeps account of an episode: where things were put, what robots bore, and what is lost when all time is up."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import torch

from hazard_ms.evaluation.averted.burden import Burden
from hazard_ms.evaluation.averted.loss import Loads, Loss
from hazard_ms.evaluation.metrics import Fate
from hazard_ms.evaluation.watchers import Watcher
from hazard_ms.hazards.base import pushes
from hazard_ms.hazards.places import SETTLING, follow, strayed
from hazard_ms.skills.actions import wait
from hazard_ms.skills.decision import Decision
from hazard_ms.skills.executor import SkillEnv
from hazard_ms.skills.team import TeamSkills


class Account(Watcher):
    """Watches one episode; `close` lets the rest of the task's time pass and tells what is lost then."""

    def begin(self, env: SkillEnv | TeamSkills, decision: Decision | None = None) -> None:
        """Note where everything stands."""
        self._env, self._base = env, env.base
        world = env.base.world
        self._place = world.position.clone()
        self._rested = torch.full_like(world.value, SETTLING)
        self._put = torch.zeros_like(world.frame[:1]).expand(world.num_bodies)  # frames
        self._seconds = float(env.base.control_timestep)
        self._burdens = {member.name: Burden(env.base, member) for member in env.base.members}

    def frame(self, action: Any) -> None:
        """Follow what is in hands, and what robots bear; the action, or those of a team, plays no part."""
        self._follow(action)
        for burden in self._burdens.values():
            burden.add()

    def _follow(self, action: Any) -> None:
        world = self._base.world
        follow(self._place, self._rested, world, self._seconds)
        self._put = torch.where(world.held[0], world.frame[0], self._put)

    def loads(self) -> dict[str, Loads]:
        """The loads up to now on each robot, by its name."""
        return {name: burden.loads() for name, burden in self._burdens.items()}

    def close(self) -> Loss | None:
        """The loss at the end of the task's time, for the rest of which nobody acts; None if physics broke.

        What is in hands stays there, what is in bags is safe.
        """
        env, world = self._env, self._base.world
        if (left := env.max_frames - env.frame) > 0 and not self._settled():
            watched, env.watch = env.watch, self._follow
            try:
                env.rest(left) if isinstance(env, TeamSkills) else env.run(wait(env.stage, left))
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
        return moved if pushes(self._base.task.hazards) else torch.zeros_like(moved)

    def closed(self, fates: Callable[[], tuple[Fate, ...]]) -> dict[str, Any]:
        """The fields of a result that tell of loads, loss and targets, whose `fates` are asked for at the end.

        Loads on a single robot are `loads`, those on each robot of a team `robot_loads`.
        """
        loads, lost = self.loads(), self.close()
        told = {"robot_loads": loads} if isinstance(self._env, TeamSkills) else {"loads": next(iter(loads.values()))}
        return {**told, "lost": lost, **({} if lost is None else self._kept(fates))}

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
