"""Our best agent without privileges: it plans the whole rest of the rescue, exactly, on what it believes.

At each decision it forecasts from what it has seen when each known target will be damaged and where it will be, takes
the walks over its map, adds the places where the targets that it has not seen may be found, and solves the problem of
the rescue (`hazard_ms.planning.orienteering`). It does what the plan begins with.
"""

from __future__ import annotations

from hazard_ms.agents.search.outlook import Outlook, Weights
from hazard_ms.agents.search.searcher import GIVE_UP, REACH, First, Searcher
from hazard_ms.planning.orienteering import solve

MOST_LABELS = 20_000  # of the exact search: half a second [ours]
MOST_IN_HOMES = 3_000  # where values differ little by the aim `averted`, so that a proof takes long [ours]
BEAM = 300  # labels of a layer beyond that [ours]
SHOWN = 4  # goals of a plan that the note names [ours]


class Planner(Searcher):
    """Solves the believed rest of the rescue at each decision, and does what the plan begins with."""

    def __init__(
        self,
        loyalty: float = 0.1,
        fading: float = 0.1,
        search: float = 1.0,
        caution: float = 1.0,
        reach: float = REACH,
        give_up: int = GIVE_UP,
        belief: float = 1.0,
        mitigate: bool = True,
    ) -> None:
        """Choose how it weighs things.

        `loyalty`: share of the way to where it is going already that is not counted; `fading`: share of its value that
        a target loses if it is saved at the last frame; `search`: share of what may be found by searching that counts;
        `caution`: from 0, where plans count on usual durations, to 1, where they leave time for what goes wrong;
        `reach`: length of the way from which a target is picked up without walking up to it first [m]; `give_up`:
        failures after which a thing is given up; `belief`: share of the doubts about what things are that counts;
        `mitigate`: whether it shuts doors and puts out fires where that averts more than rescues do.
        Raises ValueError for numbers out of range.
        """
        super().__init__(Weights(loyalty, fading, search, caution, belief), reach, give_up, mitigate)

    def first(self, ahead: Outlook) -> First | None:
        """The first rescue of the best plan."""
        plan = solve(ahead.problem, MOST_IN_HOMES if self._brief.several_rooms else MOST_LABELS, BEAM)
        if not plan.rescues:
            return None
        steps = [
            f"{'search at ' if ahead.is_search(r.target) else ''}{ahead.name(r.target)} by {r.safe:.0f} ({r.value:.1f})"
            for r in plan.rescues
        ]
        more = f" and {len(steps) - SHOWN} more" if len(steps) > SHOWN else ""
        proof = "best of all orders" if plan.exact else f"at most {plan.gap:.1f} below the best"
        why = f"{', '.join(steps[:SHOWN])}{more}: worth {plan.value:.1f}, {proof}"
        return First(plan.rescues[0].target, plan.rescues[0].cart, why)
