"""Language models as a team: one conversation for each robot, which knows what its own robot knows and was told.

Nothing else joins them: what one is to know of another it must be told, with the verb `tell`.
"""

from __future__ import annotations

from collections.abc import Mapping
from concurrent.futures import ThreadPoolExecutor

from hazard_ms.agents.llm.agent import Llm
from hazard_ms.agents.team import TeamAgent
from hazard_ms.skills.brief import Brief
from hazard_ms.skills.decision import Action, Decision
from hazard_ms.spec.parameters import parameters
from hazard_ms.spec.registry.mitigations import TELL

TOLD = "told"  # the counter of messages, beside those of the agent `llm`, which are summed over all robots


class LanguageModels(TeamAgent):
    """A language model for each robot, all at the same address."""

    def __init__(self, given: str = "") -> None:
        """`given`: the parameters of `hazard_ms.agents.llm.agent.Llm`, "model=NAME,way=letter", for each robot.

        Raises ValueError for what it refuses, and for what no team can have.
        """
        self._keywords = parameters(Llm, given.split(","))
        self._players = [Llm(**self._keywords)]
        self._players[0].join("", ("another",))  # so that what no team can have is refused now

    def reset(self, briefs: Mapping[str, Brief]) -> None:
        while len(self._players) < len(briefs):
            self._players.append(Llm(**self._keywords))
        self._agents = dict(zip(briefs, self._players, strict=False))
        self._told, self.notes, self.counters = 0, {}, {}
        for name, player in self._agents.items():
            player.join(name, tuple(other for other in briefs if other != name))
            player.reset(briefs[name])

    def act(self, decisions: Mapping[str, Decision]) -> dict[str, Action]:
        """The next action of each robot in `decisions`, all of whose models are asked at the same time."""
        try:
            with ThreadPoolExecutor(max(1, len(decisions))) as threads:
                actions = threads.map(lambda name: self._agents[name].act(decisions[name]), decisions)
                made = dict(zip(decisions, actions, strict=True))
            self._told += sum(action.verb == TELL for action in made.values())
        finally:
            players = self._agents.values()
            self.notes = {name: self._agents[name].note for name in decisions}
            names = dict.fromkeys(name for player in players for name in player.counters)
            summed = {name: round(sum(p.counters.get(name, 0.0) for p in players), 6) for name in names}
            self.counters = {**summed, TOLD: self._told}
        return made
