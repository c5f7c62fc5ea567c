"""Tasks, hazards, robots and agents by name: the one list of each, which third parties can add to.

An entry names what it stands for as text, "package.module:attribute", or holds the object itself. Text is imported by
`load` when it is first needed, so that this module imports nothing heavy.

    import hazard_ms
    hazard_ms.register_hazard("earthquake", "my_package.earthquake:earthquake")
    hazard_ms.register_task("HazardEarthquake-v1", "my_package.rescue:earthquake_rescue", max_frames=900)
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any, TypeVar

from hazard_ms.spec.registry.loading import load as load
from hazard_ms.spec.registry.loading import load_plugin as load_plugin

MOST_ROBOTS = 4  # of one environment [ours]
FRAMES = 1500  # of an episode [docs/benchmark.md 1]
HARD = MappingProxyType({"hard": 900})  # frames of an episode in the split `hard` [ours]
TASK_NAME = re.compile(r"[A-Za-z]\w*-v\d+")
NAME = re.compile(r"[A-Za-z]\w*")
AGENT_NAME = re.compile(r"[A-Za-z]\w*(/[A-Za-z]\w*)?")


@dataclass(frozen=True)
class TaskEntry:
    """A task: `maker(physics, **options)` gives the `hazard_ms.spec.Task`; episodes last `max_frames` at most.

    `split_frames`: that number for each split in which it differs; `affects_agent`: whether the hazards act on the
    agent where nobody says whether they shall.
    """

    name: str  # the id under which gymnasium knows it, "HazardFire-v1"
    maker: Any
    max_frames: int = FRAMES
    split_frames: tuple[tuple[str, int], ...] = ()
    affects_agent: bool = False

    def frames(self, split: str) -> int:
        """The greatest length of an episode in a split [frames]."""
        return dict(self.split_frames).get(split, self.max_frames)


@dataclass(frozen=True)
class HazardEntry:
    """A hazard: `maker(preset)` gives the `hazard_ms.hazards.base.Hazard`.

    `looks`: class of its effects in pictures, see `hazard_ms.effects.looks`; `cases`: functions that give validation
    cases; `charts`: function that gives the curves of the validation page.
    """

    name: str
    maker: Any
    looks: Any = None
    cases: tuple[Any, ...] = ()
    charts: Any = None


@dataclass(frozen=True)
class RobotEntry:
    """A robot: a class that keeps `hazard_ms.robots.planar.PlanarRobot`; `uid` is ManiSkill's name of it."""

    name: str
    robot: Any
    uid: str


@dataclass(frozen=True)
class AgentEntry:
    """An agent: a subclass of `hazard_ms.agents.base.Agent`.

    `goals`: verbs of the goals that it can pursue where not all targets are to be rescued; None: any.
    """

    name: str
    agent: Any
    goals: tuple[str, ...] | None = None


Entry = TaskEntry | HazardEntry | RobotEntry | AgentEntry
_Kind = TypeVar("_Kind")

_tasks: dict[str, TaskEntry] = {}
_hazards: dict[str, HazardEntry] = {}
_robots: dict[str, RobotEntry] = {}
_agents: dict[str, AgentEntry] = {}
TASKS: Mapping[str, TaskEntry] = MappingProxyType(_tasks)
HAZARDS: Mapping[str, HazardEntry] = MappingProxyType(_hazards)
ROBOTS: Mapping[str, RobotEntry] = MappingProxyType(_robots)
AGENTS: Mapping[str, AgentEntry] = MappingProxyType(_agents)

_followers: list[tuple[Callable[[Entry], None], Callable[[Entry], None]]] = []


def register_task(
    name: str,
    maker: Any,
    max_frames: int = FRAMES,
    split_frames: Mapping[str, int] | None = None,
    affects_agent: bool = False,
) -> None:
    """Add a task, and make it known to gymnasium and ManiSkill.

    `max_frames`: the greatest length of an episode; `split_frames`: that for each split in which it differs;
    `affects_agent`: whether the hazards act on the agent unless gym.make says otherwise.

    Raises ValueError for a name that no environment can have, one that is taken, and a wrong number of frames.
    """
    others = tuple((split_frames or {}).items())
    for what, frames in (("max_frames", max_frames), *((f"split_frames[{s!r}]", n) for s, n in others)):
        if isinstance(frames, bool) or not isinstance(frames, int) or frames < 1:
            raise ValueError(f"{what} must be a whole number from 1, got {frames!r}")
    _add(_tasks, TaskEntry(name, maker, max_frames, others, affects_agent), TASK_NAME, "'Name-v0'")


def affects_agent(name: str) -> bool:
    """Whether hazards act on the agent in the task called `name` where nobody says whether they shall."""
    return name in _tasks and _tasks[name].affects_agent


def register_hazard(name: str, maker: Any, looks: Any = None, cases: Any = (), charts: Any = None) -> None:
    """Add a hazard. `cases` is one function, or a tuple of them. Raises ValueError for a name that is taken."""
    several = cases if isinstance(cases, tuple) else (cases,)
    _add(_hazards, HazardEntry(name, maker, looks, several, charts))


def register_robot(name: str, robot: Any, uid: str | None = None) -> None:
    """Add a robot; `uid`: by default that of its class, else hazard_NAME. Raises ValueError for a taken name."""
    _add(_robots, RobotEntry(name, robot, uid or getattr(robot, "uid", None) or f"hazard_{name}"))


def register_agent(name: str, agent: Any, goals: tuple[str, ...] | None = None) -> None:
    """Add an agent. Its name may have two parts, "paper/greedy"; `goals`: see AgentEntry.

    Raises ValueError for a name that is taken.
    """
    _add(_agents, AgentEntry(name, agent, goals), AGENT_NAME, "'name' or 'group/name'")


def unregister(entry: Entry) -> None:
    """Remove an entry, everywhere that it was made known. Raises KeyError if it is not registered."""
    table: Any = {TaskEntry: _tasks, HazardEntry: _hazards, RobotEntry: _robots, AgentEntry: _agents}[type(entry)]
    if table[entry.name] != entry:
        raise KeyError(f"{entry.name!r} is registered as something else")
    del table[entry.name]
    for _, removed in _followers:
        removed(entry)


def follow(added: Callable[[Entry], None], removed: Callable[[Entry], None] = lambda entry: None) -> None:
    """Call `added` with every entry there is and every later one, and `removed` with those that are taken away."""
    _followers.append((added, removed))
    entries: list[Entry] = [*_tasks.values(), *_hazards.values(), *_robots.values(), *_agents.values()]
    for entry in entries:
        added(entry)


def find(table: Mapping[str, _Kind], name: Any, what: str) -> _Kind:
    """The entry called `name` in a table by name. Raises ValueError for others, which says `what` it is."""
    from hazard_ms.spec.checks import one_of  # loads numpy

    return table[one_of(name, table, what)]


def _add(table: dict[str, Any], entry: Entry, form: re.Pattern[str] = NAME, shown: str = "'name'") -> None:
    if not isinstance(entry.name, str) or not form.fullmatch(entry.name):
        raise ValueError(f"a registered name must look like {shown}, got {entry.name!r}")
    if entry.name in table:
        if table[entry.name] == entry:
            return
        raise ValueError(
            f"a registered name must be new, got {entry.name!r}, which is already registered as {table[entry.name]}"
        )
    table[entry.name] = entry
    for added, _ in _followers:
        added(entry)


register_task("HazardFire-v1", "hazard_ms.tasks.fire:hazard_fire", FRAMES, HARD)
register_task("HazardFlood-v1", "hazard_ms.tasks.flood:hazard_flood", FRAMES, HARD)
register_task("HazardWind-v1", "hazard_ms.tasks.wind:hazard_wind", 3000, {"hard": 1800})
register_task("HazardCompound-v1", "hazard_ms.tasks.compound:hazard_compound", FRAMES, HARD)
register_task("HazardHouseFire-v1", "hazard_ms.tasks.house:hazard_house_fire", 3000, affects_agent=True)
register_task("HazardHouseFlood-v1", "hazard_ms.tasks.house:hazard_house_flood", 3000, affects_agent=True)
register_task("HazardGale-v1", "hazard_ms.tasks.gale:hazard_gale", 3000, affects_agent=True)

register_hazard(
    "fire",
    "hazard_ms.hazards.presets:fire",
    "hazard_ms.effects.fire:FireEffects",
    tuple(f"hazard_ms.validation.{name}_cases:cases" for name in ("fire", "blaze", "smoke", "mitigation.fire")),
    "hazard_ms.validation.curves:fire_charts",
)
register_hazard(
    "flood",
    "hazard_ms.hazards.presets:flood",
    "hazard_ms.effects.flood:FloodEffects",
    tuple(f"hazard_ms.validation.{name}_cases:cases" for name in ("flood", "shallow", "mitigation.door")),
    "hazard_ms.validation.curves:flood_charts",
)
register_hazard(
    "wind",
    "hazard_ms.hazards.presets:wind",
    "hazard_ms.effects.wind:WindEffects",
    ("hazard_ms.validation.wind_cases:cases", "hazard_ms.validation.storm_cases:cases"),
    "hazard_ms.validation.curves:wind_charts",
)

register_robot("fetch", "hazard_ms.robots.fetch:HazardFetch")
register_robot("g1", "hazard_ms.robots.g1:HazardG1")

register_agent("random", "hazard_ms.agents.random:Random")
register_agent("greedy", "hazard_ms.agents.greedy:Greedy")
register_agent("fighter", "hazard_ms.agents.fighter:Fighter")
for _name in ("rule", "oracle", "planner", "mcts"):
    register_agent(_name, f"hazard_ms.agents.{_name}:{_name.capitalize()}")
for _name, _class in (("bc", "Bc"), ("rl", "Rl"), ("rl_paper", "RlPaper")):  # which learned to rescue
    register_agent(_name, f"hazard_ms.agents.learned.players:{_class}", goals=())
register_agent("llm", "hazard_ms.agents.llm.agent:Llm")
_PAPER = (("greedy", "greedy:Greedy"), ("rule", "rule:Rule"), ("mcts", "mcts:Mcts"), ("mcts_diff", "mcts:MctsDiff"))
for _name, _place in _PAPER:
    register_agent(f"paper/{_name}", f"hazard_ms.agents.paper.{_place}", goals=("walk_to", "pick_up", "drop"))
