"""The loads on one robot, alone or of a team, added up frame by frame."""

from __future__ import annotations

from typing import Any

import torch

from hazard_ms.evaluation.averted.contacts import Collisions
from hazard_ms.evaluation.averted.loss import Loads
from hazard_ms.hazards.fire.realistic.tenability import dose_rate

DOSE = "agent_dose"  # entry of `info` of a fire that adds up the dose itself
WET = 0.01  # depth from which the robot wades [m] [ours]


class Burden:
    """The loads on one robot since the episode began."""

    def __init__(self, base: Any, member: Any) -> None:
        """Begin with none on the robot `member`, one of the members of `base`, a HazardEnv."""
        self._situation = member.situation
        self._seconds = float(base.control_timestep)
        self._dose: float | None = None
        self._wading: float | None = None
        self._water: float | None = None
        self._collisions = None if base.gpu_sim_enabled else Collisions(base, member.agent)

    def add(self) -> None:
        """Add what acts on the robot in the frame that has passed."""
        if self._collisions is not None:
            self._collisions.count()
        if not self._situation.affects_agent:
            return
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
        episode, world = self._situation.episode, self._situation.world
        able = [h for h in episode.hazards if wanted & h.tells.keys() and not but & h.tells.keys()]
        every = [h.agent_info(episode.states[h.name], world) for h in able]
        return {name: float(value[0]) for told in every for name, value in told.items()}

    def loads(self) -> Loads:
        """The loads up to now."""
        dose = self._told({DOSE}, set()).get(DOSE, self._dose) if self._situation.affects_agent else None
        found = None if self._collisions is None else self._collisions.number
        return Loads(dose, self._wading, self._water, found)
