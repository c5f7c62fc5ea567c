"""The choice of a cart to take along: whether, and to which thing, the cart at hand is pushed before the next rescue.

Each push that is possible is weighed by the best plan of rescues after it, with the cart where it is then. So a push is
chosen only where it gains, by usual times; what was begun is gone on with as long as it does not lose.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from hazard_ms.sketch.travel.ways import WALK
from hazard_ms.skills.decision import Action, Decision
from hazard_ms.skills.failures import UNFINISHED
from hazard_ms.skills.mitigations.carts import SHORT, WORTH, nearest_cart
from hazard_ms.skills.pushing import PUSH_FRAMES, cart_ways

PUSH = "push"
GRIP = 75.0  # frames of a push beyond those of its length [measured: 6 to 170 in 14 pushes, 74 on average, Fetch]
LETS_GO = 1.1  # distance from the middle of the cart to the robot that has pushed it [m] [measured: 0.9 to 1.2]
GAIN = (
    0.05  # share of the value of the plan without it by which a push must be better, or may be worse once begun [ours]
)
FAILURES = 2  # of pushes to one thing, after which none is tried [ours]
MOST_LABELS, BEAM = 400, 20  # of the search for the rescues after a push [ours]


class Push(NamedTuple):
    """A push that is possible, and what it leads to."""

    thing: str
    cart: int  # index of the cart in the map
    frames: float  # that it takes, with the walk to the cart
    place: NDArray[np.float64]  # where the cart is then [m], [2]
    robot: NDArray[np.float64]  # where the robot is then [m], [2]


def pushes(decision: Decision, things: Sequence[str]) -> list[Push]:
    """The pushes of the cart that is nearest to the robot to those of `things` that are far enough from it."""
    seen, here = decision.map, np.asarray(decision.agent_position, np.float64)
    cart = nearest_cart(seen, [decision.index(name) for name in decision.containers], decision.agent_position)
    if cart is None:
        return []
    middle = np.asarray(seen.objects[cart].position[:2], np.float64)
    known = {name: seen.objects.get(decision.index(name)) for name in things}
    places = {name: thing.position[:2] for name, thing in known.items() if thing is not None}
    far = [name for name in places if np.hypot(*(places[name] - middle)) > WORTH]
    made = []
    for name, path in zip(far, cart_ways(seen, middle, [places[name] for name in far], SHORT), strict=True):
        if path is None:
            continue
        length = path.length + float(np.hypot(*(middle - here)))
        frames = WALK * length + GRIP * np.ceil((WALK * length + GRIP) / PUSH_FRAMES)
        end = np.asarray(path.points[-1], np.float64)
        onward = (places[name] - end) / max(float(np.hypot(*(places[name] - end))), 1e-6)
        made.append(Push(name, cart, float(frames), end, end + LETS_GO * onward))
    return made


class Pushing:
    """The pushes of one episode; `note` says why one was chosen."""

    def __init__(self) -> None:
        """Begin an episode."""
        self._failed: dict[str, int] = {}  # pushes to each thing that came to nothing
        self._begun: str | None = None  # the thing to which a cart is on its way
        self.note = ""

    def choose(
        self, decision: Decision, things: Sequence[str], plain: Callable[[], float], after: Callable[[Push], float]
    ) -> Action | None:
        """The push to begin with, to one of `things`, or to go on with; None where rescues alone are better.

        `plain` gives the value of the best plan without a push, `after` that of the best plan after one.
        """
        self._enter(decision)
        last, result = decision.last_action, decision.last_result
        walking = last is not None and last.verb != PUSH and result is not None and result.reason in UNFINISHED
        if decision.held is not None or walking or decision.walked_up_to in things:
            return None
        possible = [p for p in pushes(decision, things) if self._failed.get(p.thing, 0) < FAILURES]
        possible = [p for p in possible if decision.frame + p.frames < decision.max_frames]
        if not possible:
            return None
        without = plain()
        begun = [p for p in possible if p.thing == self._begun]
        for tried, least in ((begun, (1.0 - GAIN) * without), (possible, (1.0 + GAIN) * without)):
            worth = [after(push) for push in tried]
            if tried and max(worth) > least:
                best = tried[int(np.argmax(worth))]
                self._begun = best.thing
                self.note = (
                    f"the cart to {best.thing} first, {best.frames:.0f} frames: {max(worth):.1f}, not {without:.1f}"
                )
                return Action(PUSH, best.thing)
        self._begun = None
        return None

    def _enter(self, decision: Decision) -> None:
        last, result = decision.last_action, decision.last_result
        if last is None or result is None or last.verb != PUSH or last.target is None:
            return
        if result.ok or result.reason not in UNFINISHED:
            self._begun = None
        if not result.ok and result.reason not in UNFINISHED:
            self._failed[last.target] = self._failed.get(last.target, 0) + 1
