"""The mitigation `push`: a cart is pushed to where something is still to be rescued, so that the ways to it are short.

How it is pushed is `hazard_ms.skills.pushing`.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from hazard_ms.skills import failures
from hazard_ms.skills.context import Skill, Stage
from hazard_ms.skills.decision import Result
from hazard_ms.skills.pushing import push

SHORT = 1.0  # distance from the thing at which the cart is left: the robot gets between them [m] [ours]
WORTH = 2.0  # distance from a cart to the nearest thing to rescue from which on a push makes sense [m] [ours]


def far_carts(stage: Stage) -> tuple[str, ...]:
    """Names of known carts from which the nearest thing to rescue is far, while the hand is empty."""
    if stage.held >= 0:
        return ()
    there = [name for name in stage.labeller.containers if stage.labeller.index(name) in stage.seen.objects]
    return tuple(name for name in there if (way := _way(stage, name)) is not None and np.hypot(*way) > WORTH)


def push_cart(stage: Stage, name: str) -> Skill:
    """Push the cart called `name` towards the nearest known thing that is still to be rescued."""
    if stage.held >= 0:
        return Result(False, failures.ALREADY_HOLDING)
    index, way = stage.labeller.index(name), _way(stage, name)
    if way is None:
        return Result(False, failures.UNKNOWN)
    length = float(np.hypot(*way))
    goal = stage.seen.objects[index].position[:2] + way * max(0.0, 1.0 - SHORT / max(length, SHORT))
    result: Result = yield from push(stage, index, (float(goal[0]), float(goal[1])))
    return result


def _way(stage: Stage, name: str) -> NDArray[np.float64] | None:
    """From the thing called `name` to the nearest known one to rescue [m], [2], world frame; None if none is known."""
    cart = stage.seen.objects.get(stage.labeller.index(name))
    left = [t.index for t in stage.labeller.targets() if not (t.rescued or t.held) and t.index in stage.seen.objects]
    if cart is None or not left:
        return None
    ways = np.array([stage.seen.objects[index].position[:2] - cart.position[:2] for index in left], np.float64)
    return np.asarray(ways[int(np.hypot(*ways.T).argmin())])
