"""Our best agent without privileges: it plans the whole rest of the rescue, exactly, on what it believes.

At each decision it forecasts from what it has seen when each known target will be damaged and where it will be, takes
the walks over its map, adds the places where the targets that it has not seen may be found, and solves the problem of
the rescue (`hazard_ms.sketch.planning.orienteering`). It does what the plan begins with.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from hazard_ms.agents.search.outlook import Outlook, Weights
from hazard_ms.agents.search.searcher import GIVE_UP, REACH, First, Searcher
from hazard_ms.sketch.planning.orienteering import solve
from hazard_ms.sketch.planning.problem import Plan, Problem
from hazard_ms.sketch.planning.travel import StaticTravel
from hazard_ms.skills.brief import Brief
from hazard_ms.skills.decision import WALK_ONE_STEP, WALK_TO, Action, Decision
from hazard_ms.skills.failures import UNFINISHED

MOST_LABELS = 20_000  # of the exact search: half a second [ours]
MOST_IN_HOMES = 3_000  # where values differ little by the aim `averted`, so that a proof takes long [ours]
BEAM = 300  # labels of a layer beyond that [ours]
# share by which another plan must be better than what a walk of many legs was begun for, in homes and with a detector:
# there the estimates change with each leg, and who turns round every time arrives nowhere [ours]
WAVERING = 0.1
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

    def reset(self, brief: Brief) -> None:
        """Begin an episode on the way to nothing."""
        super().reset(brief)
        self._under_way: str | None = None

    def act(self, decision: Decision) -> Action:
        """The next action, as all searchers have it; it remembers where a walk leads that is not at its end."""
        result = decision.last_result
        if result is None or result.reason not in UNFINISHED:
            self._under_way = None
        action = super().act(decision)
        self._under_way = action.target if action.verb in (WALK_TO, WALK_ONE_STEP) else None
        return action

    def first(self, ahead: Outlook) -> First | None:
        """The first rescue of the best plan, or of that for which it is on its way, where that is hardly worse."""
        plan = self._loyal(ahead, self._solved(ahead.problem))
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

    def _loyal(self, ahead: Outlook, plan: Plan) -> Plan:
        """The best plan that begins with what it is on its way to, if it is hardly worse than `plan`; else that."""
        problem, travel = ahead.problem, ahead.problem.travel
        unsure = self._brief.several_rooms or self._brief.looks
        if not (unsure and plan.rescues and isinstance(travel, StaticTravel)):
            return plan
        begun = [ahead.name(goal) == self._under_way for goal in range(travel.targets)]
        if problem.holding is not None or not any(begun) or begun[plan.rescues[0].target]:
            return plan
        ways = [met for met, _ in travel.meetings(travel.start, 0.0, range(travel.targets))]
        only = [*np.where(begun, ways, np.inf), *travel.to_carts(travel.start)]
        kept = self._solved(replace(problem, travel=travel.starting(only)))
        return kept if kept.rescues and kept.value >= (1.0 - WAVERING) * plan.value else plan

    def _solved(self, problem: Problem) -> Plan:
        return solve(problem, MOST_IN_HOMES if self._brief.several_rooms else MOST_LABELS, BEAM)
