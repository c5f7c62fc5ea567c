"""Forecasts of when things come to harm, from the levels of the hazards that were seen."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from hazard_ms.agents.search.fire_watch import FireWatch
from hazard_ms.agents.search.floor_plan import FloorPlan, shut_doors
from hazard_ms.agents.search.house_fire import HouseFire
from hazard_ms.agents.search.house_water import HouseWater, floats_at, soaked_at
from hazard_ms.sensing.door_memory import KnownOpening
from hazard_ms.sensing.semantic_map import SemanticMap
from hazard_ms.sensing.sighting import Sighting
from hazard_ms.sensing.target_table import Target
from hazard_ms.sketch.planning.belief import WaterPlane, extended, last_whole
from hazard_ms.skills.brief import Brief, HazardBrief
from hazard_ms.skills.decision import Decision

STRIDE = 20  # frames between those for which levels are forecast [ours]
WATER = "flood"  # the hazard whose level is that of a plane of water (docs/physics.md 1.2)
FIRE = "fire"  # the hazard that creeps over the floor (docs/physics.md 1.1)
# share of the value of a home's targets that is lost if nobody acts [ours: ten homes of `train` lose 0.32 and 0.65]
RISK = {FIRE: 0.28, WATER: 0.65}
# frame by which fires have burned half of what they burn [measured: four homes of `train`, as candidates.BURNT_BY]
HALF_BURNT = 1150.0

Array = NDArray[np.float64]


class Unseen(NamedTuple):
    """The share of things never seen that the hazards of a home take, and by when."""

    lost: float  # share of their value that is lost if nobody acts
    damaged_by: float  # frame by which half of what is damaged is; inf: nothing is
    gone_by: float  # frame by which all that is carried off is; inf: nothing is


def unseen_losses(brief: Brief) -> Unseen:
    """The losses of things never seen: fires burn them; water carries them off, whence they can still be saved."""
    names = [hazard.name for hazard in brief.hazards]
    if WATER in names:
        return Unseen(RISK[WATER], np.inf, brief.max_frames - 1.0)
    return Unseen(RISK[FIRE], HALF_BURNT, np.inf) if FIRE in names else Unseen(0.0, np.inf, np.inf)


class Forecast:
    """The levels to come, and when they harm what is at a place."""

    def __init__(
        self,
        brief: Brief,
        decision: Decision,
        watch: FireWatch | HouseFire,
        shut: Sequence[KnownOpening] = (),
        without: Sequence[int] = (),
        boarded: Sequence[KnownOpening] = (),
    ) -> None:
        """Forecast the hazards of `brief` from `decision` to the end of the episode; `watch` remembers a fire.

        `shut`: doors that are shut as soon as that; `without`: numbers of fires, `HouseFire.seats`, that are put out;
        `boarded`: outer doors as they are once boards stand in them.
        """
        self._hazards = brief.hazards
        self._frames = np.arange(decision.frame, decision.max_frames + STRIDE, STRIDE, dtype=np.float64)
        then = {o.name: o for o in (*decision.openings, *boarded)}
        self._water: dict[int, WaterPlane | HouseWater] = {
            number: HouseWater(
                decision.map, number, FloorPlan(decision.map, (*shut_doors(decision.openings), *shut)), [*then.values()]
            )
            if brief.several_rooms
            else _water(decision.map, number)
            for number, hazard in enumerate(brief.hazards)
            if hazard.name == WATER
        }
        self._fire = {
            number: _burning(watch, decision, number, without)
            for number, hazard in enumerate(brief.hazards)
            if hazard.name == FIRE and number < len(decision.map.levels)
        }

    def whole_until(self, target: Target, sighting: Sighting) -> float:
        """The frame until which a target is believed to stay whole where it was seen: 0 if it is damaged, else inf."""
        if target.damaged:
            return 0.0
        return min(
            (self._until(number, target, sighting) for number in range(min(len(self._hazards), len(sighting.levels)))),
            default=float("inf"),
        )

    def stays_until(self, target: Target, sighting: Sighting) -> float:
        """The frame until which water in a home leaves a target where it was seen; inf for all along."""
        water = [number for number, plane in self._water.items() if isinstance(plane, HouseWater)]
        carries = partial(_reaches, floats_at(target, sighting))
        return min((last_whole(carries, self._frames, self._levels(n, sighting)) for n in water), default=float("inf"))

    def _until(self, number: int, target: Target, sighting: Sighting) -> float:
        burning = self._fire.get(number, {}).get(target.index)
        if burning is not None:
            return burning
        harms = partial(_harms, self._hazards[number], target, float(sighting.position[2]))
        if isinstance(self._water.get(number), HouseWater):
            harms = partial(_reaches, soaked_at(target, sighting))
        return last_whole(harms, self._frames, self._levels(number, sighting))

    def _levels(self, number: int, sighting: Sighting) -> Array:
        water = self._water.get(number)
        if water is not None:
            return water.at(sighting.position[:2], self._frames)[:, 0]
        history = sighting.history or ((sighting.frame, sighting.levels),)
        frames = [frame for frame, _ in history]
        return extended(frames, [levels[number] for _, levels in history], self._frames)


def _burning(watch: FireWatch | HouseFire, decision: Decision, number: int, without: Sequence[int]) -> dict[int, float]:
    """The frame until which each known thing stays whole from a fire, by index."""
    if isinstance(watch, FireWatch):
        return watch.whole_until(decision, number)
    watch.look(decision, number)
    return watch.whole_until(without)


def _harms(hazard: HazardBrief, target: Target, height: float, level: float) -> bool:
    return bool(hazard.threatens(target, level, height))


def _reaches(least: float, level: float) -> bool:
    return level >= least


def _water(seen: SemanticMap, number: int) -> WaterPlane:
    """The plane of water through all levels that were seen on things."""
    rows: Sequence[tuple[NDArray, int, float]] = [
        (sighting.position[:2], frame, levels[number])
        for sighting in seen.objects.values()
        for frame, levels in sighting.history
        if number < len(levels)
    ]
    points, frames, levels = zip(*rows, strict=True) if rows else ((), (), ())
    return WaterPlane.fitted(np.array(points, np.float64), frames, levels)
