"""Makes the part of a scene of the sketch that measures are about: its fires, and its extinguishers."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hazard_ms.hazards.presets import FREQUENCIES
from hazard_ms.simulation.mitigation.equipment import kind_of
from hazard_ms.sketch.fires.alone import Fires, fires_alone
from hazard_ms.sketch.sight import Sight
from hazard_ms.sketch.travel.ways import Ways
from hazard_ms.skills.options.features import JET_WAY
from hazard_ms.skills.options.fires import EXTINGUISH, measured
from hazard_ms.spec import SceneSpec, Task
from hazard_ms.spec.extinguishers import EXTINGUISHERS
from hazard_ms.spec.registry.mitigations import tools_of

SEEN_FROM = 6.0  # distance up to which heat around a fire is seen on the map [m] [ours]
LOW = 0.1  # height of flames on the floor [m] [ours]

Floats = NDArray[np.float64]


def has_measures(task: Task) -> bool:
    """Whether options of `task` have measures about a fire."""
    return measured(task.mitigations, [hazard.name for hazard in task.hazards]) is not None


@dataclass(frozen=True)
class Measures:
    """The fires and the extinguishers of a scene."""

    fires: Fires
    tools: tuple[int, ...]  # numbers along B of the extinguishers
    charge: Floats  # frames that each lasts, [E]

    @classmethod
    def of(cls, task: Task, physics: str, spec: SceneSpec, seed: int) -> Measures | None:
        """Make those of a scene with the fate that `seed` gives it; None where its task has none."""
        if not has_measures(task):
            return None
        categories = tools_of([EXTINGUISH])
        kinds = {n: kind_of(thing.name) for n, thing in enumerate(spec.things) if thing.category in categories}
        rate = FREQUENCIES[physics][0]
        charge = np.array([EXTINGUISHERS[kind].seconds * rate for kind in kinds.values()], np.float64)
        (fires,) = fires_alone(task, physics, (spec,), (seed,))
        return cls(fires, tuple(kinds), charge)

    def stands(self, ways: Ways, sight: Sight, start: Floats) -> Floats:
        """The places from which each fire is fought [m], [F, 2]: nearest to `start` [m], [2], with a view of it."""
        made = []
        for place in self.fires.place:
            away = np.hypot(*(ways.places - place).T)
            near = ways.places[away <= JET_WAY]
            seen = near[sight.clear(near, np.array([[*place, LOW]]))[:, 0]] if len(near) else near
            if not len(seen):
                made.append(ways.places[int(away.argmin())])
                continue
            frames = ways.frames(seen, start)
            made.append(seen[int(frames.argmin())])
        return np.array(made, np.float64).reshape(-1, 2)

    def seen(self, sight: Sight, stand: Floats) -> NDArray[np.bool_]:
        """Whether each fire is in sight of each `stand` [m], [P, 2]: [P, F]."""
        made = np.zeros((len(stand), len(self.fires.place)), bool)
        for k, shown in enumerate(self.fires.shown):
            clear = sight.clear(stand, np.pad(shown, ((0, 0), (0, 1)), constant_values=LOW))
            made[:, k] = clear.any(axis=1) & (np.hypot(*(stand - self.fires.place[k]).T) <= SEEN_FROM)
        return made

    def arrays(self, targets: Sequence[int], fire_site: Sequence[int], tool_site: Sequence[int]) -> dict[str, Any]:
        """The arrays of `SketchScene` about them but for what is seen; `targets`: numbers along B."""
        own = np.array(targets, np.int64)
        return {
            "fire_site": np.array(fire_site, np.int64),
            "fire_place": self.fires.place,
            "hit_at": self.fires.hit_at[:, own],
            "fire_level": self.fires.level[..., own],
            "flames": self.fires.flames,
            "tool_site": np.array(tool_site, np.int64),
            "tool_charge": self.charge,
        }
