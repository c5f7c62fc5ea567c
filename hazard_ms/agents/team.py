"""Agents of teams: they choose the actions of all robots. Independent ones know nothing of one another.

Those that divide the work: `hazard_ms.agents.teams`.
"""

from __future__ import annotations

import abc
from collections.abc import Mapping
from types import MappingProxyType
from typing import TYPE_CHECKING, ClassVar, cast

from hazard_ms.agents.base import Agent, agent, made_of
from hazard_ms.skills.brief import Brief
from hazard_ms.skills.decision import PICK_UP, WALK_ONE_STEP, WALK_TO, Action, Decision
from hazard_ms.spec.checks import one_of
from hazard_ms.spec.registry.loading import load

if TYPE_CHECKING:
    from hazard_ms.skills.team import TeamSkills

APPROACH = (WALK_TO, WALK_ONE_STEP, PICK_UP)  # verbs by which a robot goes for a target


class TeamAgent(abc.ABC):
    """Chooses for several robots, which are known by their names. Notes and counters are as those of an `Agent`."""

    notes: Mapping[str, str | None] = MappingProxyType({})  # of each robot
    counters: Mapping[str, float] = MappingProxyType({})  # of all together
    privileged: ClassVar[bool] = False  # whether it may see what is hidden: only subclasses of PrivilegedTeam do

    @abc.abstractmethod
    def reset(self, briefs: Mapping[str, Brief]) -> None:
        """Begin an episode; `briefs`: what each robot is told."""

    @abc.abstractmethod
    def act(self, decisions: Mapping[str, Decision]) -> dict[str, Action]:
        """The next action of each robot in `decisions`; called again when one of them has ended."""


class PrivilegedTeam(TeamAgent):
    """An agent of teams that sees what is hidden from all others: a reference that honest ones are compared with."""

    privileged: ClassVar[bool] = True

    @abc.abstractmethod
    def attach(self, env: TeamSkills) -> None:
        """Take the environment in which an episode has just begun; called before `reset`."""


class Independent(TeamAgent):
    """One agent for each robot, each on its own."""

    def __init__(self, name: str = "greedy") -> None:
        """`name`: of the agents, as `hazard_ms.agents.base.agent` takes it, which says what else it raises.

        Raises ValueError for agents that see what is hidden, and for those that move the robot by themselves.
        """
        kind = type(agent(name))
        if kind.privileged or kind.skill is not Agent.skill:
            raise ValueError(
                f"agents of a team must see only what robots see and must use the benchmark's skills, got {name}"
            )
        self._name = name

    def reset(self, briefs: Mapping[str, Brief]) -> None:
        self._agents: dict[str, Agent] = {name: agent(self._name) for name in briefs}
        for name, brief in briefs.items():
            self._agents[name].reset(brief)

    def act(self, decisions: Mapping[str, Decision]) -> dict[str, Action]:
        made = {name: self._agents[name].act(decision) for name, decision in decisions.items()}
        self.notes = {name: self._agents[name].note for name in decisions}
        return made


TEAM_AGENTS = {  # the class of each, imported when it is asked for
    "independent": "hazard_ms.agents.team:Independent",
    "auction": "hazard_ms.agents.teams.auction:Auction",
    "joint": "hazard_ms.agents.teams.joint:Joint",
    "llm": "hazard_ms.agents.teams.language:LanguageModels",
    "oracle": "hazard_ms.agents.teams.oracle:TeamOracle",
}
FOLLOWED = ("independent", "llm")  # those that an agent follows, or parameters


def team_agent(name: str) -> TeamAgent:
    """A new agent of teams: "joint", "auction", "independent", "llm", "oracle", package.module:Class or file.py:Class.

    An agent may follow the third, as in "independent:planner", parameters the last two: "llm:model=NAME,way=letter".
    Raises ValueError for others, RuntimeError for one of one's own that calls sys.exit.
    """
    if _own(name):
        return made_of(name, TeamAgent)  # type: ignore[type-abstract]
    kind, _, member = name.partition(":")
    made = load(TEAM_AGENTS[one_of(kind, TEAM_AGENTS, "team agent")])
    if member and kind not in FOLLOWED:
        raise ValueError(f"team agent must be {kind} alone, since it brings its own agents, got {name!r}")
    return cast(TeamAgent, made(member) if member else made())


def check_team_name(text: str) -> None:
    """Raises ValueError unless `text` is an agent of teams, as `team_agent` takes it.

    Code of a module or a file that it names is not run: whether there is one is seen where episodes are played.
    """
    if not _own(text.removeprefix("independent:")):
        team_agent(text)


def _own(text: str) -> bool:
    """Whether an agent is named by its module or file and its class."""
    module, _, rest = text.partition(":")
    return module not in TEAM_AGENTS and rest != "" and "=" not in rest.partition(":")[0]
