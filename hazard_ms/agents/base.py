"""The contract that every agent keeps, and how agents are found and made.

A third party's agent needs no entry in the registry: `agent("package.module:Class")` or `agent("folder/file.py:Class")`
imports it. Parameters follow the name: `agent("greedy:give_up=3")`.
"""

from __future__ import annotations

import abc
import math
import os
import re
import sys
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, ClassVar, TypeVar

import numpy as np

from hazard_ms.agents.latency import Thought
from hazard_ms.sensing.sighting import Sighting
from hazard_ms.skills.actions import skill
from hazard_ms.skills.brief import Brief
from hazard_ms.skills.context import Skill, Stage
from hazard_ms.skills.decision import DROP, EXPLORE, PICK_UP, WALK_TO, Action, Decision
from hazard_ms.skills.failures import UNFINISHED
from hazard_ms.spec.checks import one_of
from hazard_ms.spec.parameters import parameters
from hazard_ms.spec.registry import AGENTS, load, load_plugin

if TYPE_CHECKING:
    from hazard_ms.skills.executor import SkillEnv

Made = TypeVar("Made")
LONGEST_NOTE = 2000  # characters of a note that are kept [ours]
DOUBTFUL = 0.3  # doubt about a target from which it is looked at on the way before it is walked up to [ours]
CLOSER = 1.5  # length of the way from which that is done [m] [ours]
AT_HAND = 0.7  # distance from which a thing is picked up without a walk, as for `greedy` [m]
PARAMETERS = re.compile(r":(?=\w+=)")  # what stands between an agent and its parameters; values may hold colons


class Agent(abc.ABC):
    """Chooses the next action from what has been seen.

    `note`, a str or None, may say why; it is shown with the decision and changes nothing. Neither does `fallback`,
    which `hazard-ms regret` reads. Parameters of `__init__` that are annotated as int, float, bool or str can be given
    with the agent's name.
    """

    note: str | None = ""
    fallback: bool = False  # whether its last action stands in for an answer that could not be read
    ending: str = "stopped"  # how an episode ends that it stops
    thought: Thought | None = None  # what its last decision took, where it knows better than a watch
    counters: Mapping[str, float] = MappingProxyType({})  # its own counts of the episode, kept with the result
    colours: bool = True  # whether it reads `decision.images.rgb`: None without, and an episode takes less time
    privileged: ClassVar[bool] = False  # whether it may see what is hidden: only subclasses of PrivilegedAgent do

    @abc.abstractmethod
    def reset(self, brief: Brief) -> None:
        """Begin an episode. All randomness of the agent is derived from `brief.random_seed`."""

    @abc.abstractmethod
    def act(self, decision: Decision) -> Action:
        """The next action; called again when that has ended."""

    def asked(self, decision: Decision, verb: str) -> Action | None:
        """The action that a goal asks for which `verb` of the brief achieves; None where the agent has to choose.

        It is done to what is nearest. Agents have to choose where targets are to be rescued (`verb` is ""), where they
        know no target yet, hold one, or have failed just now.
        """
        if not verb:
            return None
        action = (_nearest_target if verb in (WALK_TO, PICK_UP, DROP) else _nearest_opening)(decision, verb)
        self.note = self.note if action is None else "what the task asks for"
        return action

    def skill(self, stage: Stage, action: Action) -> Skill:
        """Make the skill that does `action`: the benchmark's, unless an agent moves the robot by itself.

        Decisions of an agent that does cannot be submitted to a leaderboard, where the benchmark's skills play them.
        """
        return skill(stage, action)


class PrivilegedAgent(Agent):
    """An agent that sees what is hidden from all others: a reference that honest agents are compared with."""

    privileged: ClassVar[bool] = True

    @abc.abstractmethod
    def attach(self, env: SkillEnv) -> None:
        """Take the environment in which an episode has just begun; called before `reset`."""


def note_of(player: Agent) -> str:
    """The agent's note as it is shown: one line of printable characters, cut after LONGEST_NOTE.

    Raises ValueError for a note that is neither a str nor None.
    """
    return shown_note(player.note, player)


def shown_note(note: Any, player: object) -> str:
    """A `note` of an agent, or of one of teams, as `note_of` gives it. Raises ValueError as that does."""
    if note is not None and not isinstance(note, str):
        raise ValueError(f"note of {type(player).__name__} must be a str or None, got a {type(note).__name__}")
    shown = "".join(c if c.isprintable() else " " for c in (note or "")[: LONGEST_NOTE + 1])
    return shown if len(shown) <= LONGEST_NOTE else shown[: LONGEST_NOTE - 1] + "…"


def counters_of(player: Any) -> dict[str, float]:
    """The counters of an agent, or of one of teams, whose numbers have the units that it gives them.

    Raises ValueError for names that are not short texts, and for values that are not finite numbers.
    """
    who, made = type(player).__name__, dict(player.counters)
    for name, value in made.items():
        if not isinstance(name, str) or len(name) > LONGEST_NOTE:
            raise ValueError(
                f"counter names of {who} must be strings of at most {LONGEST_NOTE} characters, got {name!r:.100}"
            )
        if not isinstance(value, int | float) or not math.isfinite(value):
            raise ValueError(f"counter {name!r:.100} of {who} must be a finite number, got {value!r:.100}")
    return made


@contextmanager
def staying(what: str) -> Iterator[None]:
    """Keep `what`, an agent's code, from ending the process. Raises RuntimeError where it calls sys.exit."""
    try:
        yield
    except SystemExit as error:
        raise RuntimeError(f"{what} must return or raise an error, got sys.exit({error.code!r})") from error


def check_name(text: str) -> None:
    """Raises ValueError unless `text`, an agent as `agent` takes it, is registered or names a module or a file."""
    name = text.partition(":")[0]
    if name == text or "=" in text.removeprefix(f"{name}:").partition(":")[0]:
        one_of(name, AGENTS, "agent")


def user_path() -> None:
    """Let Python find modules in the current folder, where an installed command does not look by itself.

    Processes that are started later inherit it.
    """
    if os.getcwd() not in sys.path:
        sys.path.insert(0, os.getcwd())


def agent(text: str) -> Agent:
    """A new agent: a registered name, package.module:Class or file.py:Class, then perhaps :key=value,key=value.

    Raises ValueError for an agent that cannot be found, and for parameters that it does not have, RuntimeError for one
    that calls sys.exit.
    """
    return made_of(text, Agent)  # type: ignore[type-abstract]


def made_of(text: str, kind: type[Made]) -> Made:
    """A new agent of `kind`, as `agent` takes it. Raises ValueError and RuntimeError as that does."""
    with staying(f"the agent {text}"):
        name, *given = PARAMETERS.split(text, maxsplit=1)
        made = _class(name)
        if not (isinstance(made, type) and issubclass(made, kind)):
            wanted = f"{kind.__module__}.{kind.__name__}"
            raise ValueError(f"agent must be a subclass of {wanted}, got {text!r}, which is {made!r}")
        return made(**parameters(made, "".join(given).split(",")))


def _class(name: str) -> Any:
    module, colon, attribute = name.rpartition(":")
    if not colon:
        return load(AGENTS[one_of(name, AGENTS, "agent")].agent)
    if not module.endswith(".py"):
        return load(name)
    found = getattr(load_plugin(module), attribute, None)
    if found is None:
        raise ValueError(f"agent must name a class in {module}, got {attribute!r}")
    return found


def distance(decision: Decision, sighting: Sighting) -> float:
    """Horizontal distance from the agent to a thing it has seen [m]."""
    return float(np.hypot(*(sighting.position[:2] - np.asarray(decision.agent_position))))


def known(decision: Decision, names: tuple[str, ...], missing: bool = False) -> dict[str, Sighting]:
    """The things among `names` that were seen and are remembered, nearest first.

    `missing`: whether also those that are no longer where they were seen.
    """
    objects = decision.map.objects
    seen = {name: objects[i] for name in names if (i := decision.index(name)) in objects}
    seen = {name: sighting for name, sighting in seen.items() if missing or not sighting.missing}
    return dict(sorted(seen.items(), key=lambda item: distance(decision, item[1])))


def open_targets(decision: Decision) -> tuple[str, ...]:
    """Names of the targets that are neither rescued nor in the hand."""
    return tuple(t.name for t in decision.targets if not t.rescued and t.name != decision.held)


def _nearest_opening(decision: Decision, verb: str) -> Action:
    """The mitigation `verb` on the nearest opening that it makes sense on; a look around where there is none.

    A look is also what follows a failure.
    """
    last, here = decision.last_result, decision.agent_position
    failed = decision.last_action is not None and last is not None and decision.last_action.verb == verb and not last.ok
    places = {o.name: o.position for o in decision.openings}
    on = [action for action in decision.available if action.verb == verb and action.target in places]
    if failed or not on:
        return Action(EXPLORE)
    return min(on, key=lambda action: float(np.hypot(*np.subtract(places[str(action.target)][:2], here))))


def ends_belief(decision: Decision, name: str) -> bool:
    """Whether `decision`, which follows the refusal of `name` by a hand, no longer takes that thing for the target.

    Without beliefs, as of detectors whose errors nobody counted, it is still on the map and as sure as before.
    """
    sure = any(target.name == name and target.belief >= 1.0 for target in decision.targets)
    return not (sure and decision.index(name) in decision.map.objects)


def _nearest_target(decision: Decision, verb: str) -> Action | None:
    """The walk to the nearest whole target that it knows, then the pick-up, which turns to it; at hand that at once.

    None where it knows none, holds something, or has failed just now. `verb`: of the goal.
    """
    result = decision.last_result
    failed = result is not None and not result.ok and result.reason not in UNFINISHED
    whole = tuple(name for name in open_targets(decision) if not decision.target(name).damaged)
    name = next(iter(known(decision, whole)), None)
    if failed or decision.held is not None or name is None:
        return None
    near = verb != WALK_TO and distance(decision, decision.map.objects[decision.index(name)]) < AT_HAND
    return Action(PICK_UP if near or decision.walked_up_to == name else WALK_TO, name)
