"""The action `look_at`: the robot comes near enough to a thing to tell what it is, and faces it.

A small thing that had n pixels at the distance r and the depth z, along the optical axis, has n z^3 / r of them 1 m
before the middle of the picture (`Sighting.size`): a pinhole camera shows it on f^2 / cos^3 times its solid angle. From
a horizontal distance d a level camera that faces it shows at least size / d^2: it stands lower or higher than the
camera, which makes its picture larger by the same law. A camera that looks down shows a thing below it on fewer.
"""

from __future__ import annotations

import math

import numpy as np

from hazard_ms.sensing.sighting import Sighting
from hazard_ms.skills import failures
from hazard_ms.skills.context import Skill, Stage
from hazard_ms.skills.decision import Result
from hazard_ms.skills.mitigations.approach import approach
from hazard_ms.skills.motor.walking import ARRIVED, known

TOLD = 256.0  # pixels from which a detector tells most things: below, its AP50 is half as high (results/detector.md)


def doubtful(stage: Stage) -> tuple[str, ...]:
    """Names of known things to rescue that may be something else: all that an agent has found by itself."""
    rows = stage.labeller.targets()
    return tuple(t.name for t in rows if not (t.rescued or t.held) and t.index in stage.seen.objects)


def sight_of(sighting: Sighting, widest: float) -> float:
    """Horizontal distance from which a thing has TOLD pixels [m]; no less than where a walk to it arrives.

    `widest`: half the width that it can have [m].
    """
    return max(math.sqrt(sighting.size / TOLD), ARRIVED + min(sighting.radius, widest))


def look_at(stage: Stage, name: str) -> Skill:
    """Turn to the thing called `name`, from where the robot stands if it is near enough; the look follows the action.

    Else it walks until it is, or as near as it gets, for as many frames as a walk has.
    """
    index = stage.labeller.index(name)
    if not known(stage, index):
        return Result(False, failures.UNKNOWN)
    seen = stage.seen.objects[index]
    near = sight_of(seen, stage.labeller.half_width(index))
    away = math.dist(stage.robot.base()[:2], seen.position[:2].tolist())
    result: Result = yield from approach(stage, seen.position.astype(np.float64), near, away)
    return result
