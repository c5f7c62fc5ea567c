"""The mitigation `push`: the cart at hand is taken to a thing to rescue, so that the ways to it are short.

How that is done is `hazard_ms.skills.pushing`.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from hazard_ms.sensing.semantic_map import SemanticMap
from hazard_ms.skills import failures
from hazard_ms.skills.context import Skill, Stage
from hazard_ms.skills.decision import Result
from hazard_ms.skills.pushing import push

# distance from the thing at which the middle of the cart is left [m] [ours: a robot that draws it is between them]
SHORT = 1.6
WORTH = 2.5  # distance from the cart to a thing to rescue from which on a push makes sense [m] [ours]


def far_things(stage: Stage) -> tuple[str, ...]:
    """Names of known things to rescue that are far from the cart at hand, while the hand is empty."""
    cart = None if stage.held >= 0 else _at_hand(stage)
    if cart is None:
        return ()
    place, seen = stage.seen.objects[cart].position[:2], stage.seen.objects
    left = [t for t in stage.labeller.targets() if not t.rescued and t.index in seen]
    return tuple(t.name for t in left if np.hypot(*(seen[t.index].position[:2] - place)) > WORTH)


def push_to(stage: Stage, name: str) -> Skill:
    """Take the known cart that is nearest to the robot to the thing called `name`."""
    if stage.held >= 0:
        return Result(False, failures.ALREADY_HOLDING)
    cart, thing = _at_hand(stage), stage.seen.objects.get(stage.labeller.index(name))
    if cart is None or thing is None:
        return Result(False, failures.UNKNOWN)
    result: Result = yield from push(stage, cart, (float(thing.position[0]), float(thing.position[1])), SHORT)
    return result


def nearest_cart(seen: SemanticMap, carts: Sequence[int], place: tuple[float, float]) -> int | None:
    """The one of `carts`, by index in `seen`, that is nearest to a `place` [m]; None where none is known."""
    known = [index for index in carts if index in seen.objects]
    away = [float(np.hypot(*(seen.objects[index].position[:2] - place))) for index in known]
    return known[int(np.argmin(away))] if known else None


def _at_hand(stage: Stage) -> int | None:
    carts = [stage.labeller.index(name) for name in stage.labeller.containers]
    return nearest_cart(stage.seen, carts, stage.robot.base()[:2])
