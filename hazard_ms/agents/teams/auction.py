"""Auctions allocate targets to the robots of a team.

Every robot tells how far it would have come when it gets to a target, each target goes to the lowest bid, one after
the other, and each robot fetches what it was allocated as the greedy agent does (sequential single-item auctions:
Lagoudakis et al., RSS 2005). Robots bid for targets that they have seen themselves.
"""

from __future__ import annotations

import math
from collections.abc import Mapping

from hazard_ms.agents.base import known, open_targets
from hazard_ms.agents.greedy import HANDLING, Greedy
from hazard_ms.agents.team import APPROACH, TeamAgent
from hazard_ms.skills.brief import Brief
from hazard_ms.skills.decision import EXPLORE, STOP, Action, Decision


class Auction(TeamAgent):
    """Greedy agents that fetch what they were allocated by an auction, held anew whenever one is asked."""

    def reset(self, briefs: Mapping[str, Brief]) -> None:
        self._agents = {name: Greedy() for name in briefs}
        for name, brief in briefs.items():
            self._agents[name].reset(brief)
        self._last: dict[str, Decision] = {}  # what each robot knew when it was last asked
        self._aims: dict[str, str] = {}  # the target that each robot is on its way to, or holds

    def act(self, decisions: Mapping[str, Decision]) -> dict[str, Action]:
        self._last.update(decisions)
        for name, decision in decisions.items():
            self._aims.pop(name, None)
            if decision.held is not None:
                self._aims[name] = decision.held
        made, notes = {}, dict[str, str | None]()
        for name, decision in decisions.items():
            others = frozenset(target for target, who in self._allocated(decision).items() if who != name)
            self._agents[name].left_to_others = others
            action = self._agents[name].act(decision)
            notes[name] = self._agents[name].note
            if action.verb == STOP and others:
                action, notes[name] = Action(EXPLORE), "it may be needed when another fails"
            target = action.target
            if action.verb == STOP:
                self._last.pop(name)  # it bids no more
            elif action.verb in APPROACH and target is not None and target in {t.name for t in decision.targets}:
                self._aims[name] = target
            made[name] = action
        self.notes = notes
        return made

    def _allocated(self, now: Decision) -> dict[str, str]:
        """The robot to which each target goes; `now`: what is rescued.

        What a robot is on its way to, or holds, stays its own.
        """
        won = {target: name for name, target in self._aims.items()}
        rescued = {t.name for t in now.targets if t.rescued}
        places, ways = {}, dict.fromkeys(self._last, 0.0)
        bids: dict[str, dict[str, tuple[float, float]]] = {}
        for name, decision in self._last.items():
            seen = known(decision, open_targets(decision))
            spots = {n: (float(s.position[0]), float(s.position[1])) for n, s in seen.items() if n not in rescued}
            places[name] = decision.agent_position
            aim = self._aims.get(name)
            if aim is not None and aim in spots:
                ways[name] += math.dist(places[name], spots[aim]) + HANDLING
                places[name] = spots[aim]
            given_up = self._agents[name].has_given_up
            bids[name] = {n: spot for n, spot in spots.items() if n not in won and not given_up(n)}
        while any(bids.values()):
            _, name, target = min(
                (ways[name] + math.dist(places[name], spot), name, target)
                for name, spots in bids.items()
                for target, spot in spots.items()
            )
            won[target], spot = name, bids[name][target]
            ways[name] += math.dist(places[name], spot) + HANDLING
            places[name] = spot
            for spots in bids.values():
                spots.pop(target, None)
        return won
