"""Everything that passes between agent and world: a `Decision` comes, an `Action` goes, a `Result` follows."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hazard_ms.sensing.detection.labeller import Labeller
from hazard_ms.sensing.door_memory import KnownOpening
from hazard_ms.sensing.semantic_map import SemanticMap
from hazard_ms.sensing.target_table import Target
from hazard_ms.spec.registry.mitigations import MITIGATIONS

WALK_TO, WALK_ONE_STEP, PICK_UP, DROP, EXPLORE, STOP = "walk_to", "walk_one_step", "pick_up", "drop", "explore", "stop"
VERBS = (WALK_TO, WALK_ONE_STEP, PICK_UP, DROP, EXPLORE, STOP)
NEED_TARGET = (WALK_TO, WALK_ONE_STEP, PICK_UP)


@dataclass(frozen=True)
class Action:
    """A verb and the name of the thing that it is done to: one of VERBS, or a registered mitigation.

    `drop` takes a container, or None: the bag, or the ground. Raises ValueError for an unknown verb, and for a target
    that the verb does not take.
    """

    verb: str
    target: str | None = None

    def __post_init__(self) -> None:
        mitigates = isinstance(self.verb, str) and self.verb in MITIGATIONS
        if not mitigates and (not isinstance(self.verb, str) or self.verb not in VERBS):
            raise ValueError(f"verb must be one of {', '.join(VERBS)}, got {self.verb!r}")
        if self.target is not None and not isinstance(self.target, str):
            raise ValueError(f"the target of {self.verb} must be the name of a thing, or None, got {self.target!r}")
        if (mitigates or self.verb in NEED_TARGET) and self.target is None:
            raise ValueError(f"the target of {self.verb} must be the name of a thing, got None")

    def __str__(self) -> str:
        return self.verb if self.target is None else f"{self.verb} {self.target}"


@dataclass(frozen=True)
class Result:
    """The outcome of an action: whether it was done, why not, and how many frames it took.

    An action that ran out of frames (`failures.UNFINISHED`) has not failed: whoever asks for it again goes on with it.
    """

    ok: bool
    reason: str = ""  # empty when ok
    frames: int = 0


@dataclass(frozen=True)
class Images:
    """The last images of the head camera, H x W. `segmentation`: labels of `sensing.camera`; None: withheld."""

    rgb: NDArray[np.uint8] | None  # [H, W, 3]; None where nobody wants colours: `Agent.colours`
    depth: NDArray[np.float32]  # [H, W], along the optical axis [m]; 0: nothing there
    segmentation: NDArray[np.int64] | None  # [H, W]
    hazard: NDArray[np.float32]  # [K, 16, 16], levels of the task's K hazards in their order, in their units


@dataclass(frozen=True)
class Tool:
    """A thing that an agent can pick up and use, but need not rescue."""

    name: str
    category: str
    kind: str  # of an extinguisher, a key of `hazard_ms.spec.extinguishers.EXTINGUISHERS`; else empty
    left: float  # share of an extinguisher's charge that is left, as its gauge shows; else 1
    held: bool


@dataclass(frozen=True)
class Message:
    """A message from another robot of the team."""

    frame: int  # at which it arrived
    sender: str  # name of the robot
    text: str


@dataclass(frozen=True)
class Teammate:
    """Another robot of the team; all of them know where the others are."""

    name: str
    position: tuple[float, float]  # of its base [m], world frame


@dataclass(frozen=True)
class Decision:
    """All that an agent knows when it must choose its next action. World frame, metres, radians."""

    frame: int
    max_frames: int
    agent_position: tuple[float, float]  # [m]
    agent_heading: float  # anticlockwise from +x [rad]
    held: str | None  # name of the thing in the hand
    targets: tuple[Target, ...]  # what is known of the things to rescue
    containers: tuple[str, ...]  # carts, or what is believed to be one, in wind; empty where the safe place is the bag
    map: SemanticMap  # what has been seen so far; it cannot be written to
    images: Images | None  # None where nothing renders
    available: tuple[Action, ...]  # what can be tried now
    names: tuple[str, ...]  # of the things that `map.objects` and the segmentation refer to by index
    last_action: Action | None = None
    last_result: Result | None = None
    # of tasks with mitigations, else empty
    openings: tuple[KnownOpening, ...] = ()  # doors, windows and doorways that were seen, as last seen
    tools: tuple[Tool, ...] = ()  # things that can be picked up to be used, wherever they are
    messages: tuple[Message, ...] = ()  # what the other robots of its team have told it so far, oldest first
    others: tuple[Teammate, ...] = ()  # the other robots of its team

    @property
    def walked_up_to(self) -> str | None:
        """The thing that the agent has just walked up to; None if the last action was something else, or failed."""
        last, result = self.last_action, self.last_result
        return last.target if last is not None and last.verb == WALK_TO and result is not None and result.ok else None

    def index(self, name: str) -> int:
        """Index of the thing called `name` in `map.objects`. Raises ValueError if nothing has that name."""
        if name not in self.names:
            raise ValueError(f"a thing must be one of {', '.join(self.names)}, got {name!r}")
        return self.names.index(name)

    def target(self, name: str) -> Target:
        """The target called `name`. Raises ValueError if no target has that name."""
        for row in self.targets:
            if row.name == name:
                return row
        raise ValueError(f"a target must be one of {', '.join(t.name for t in self.targets)}, got {name!r}")


def available(labeller: Labeller, known: Collection[int], targets: tuple[Target, ...]) -> tuple[Action, ...]:
    """The actions that make sense with the `known` things, by index; of these only `targets` can be picked up."""
    open_ones, held = {t.index for t in targets if not t.rescued}, labeller.held
    made = [Action(EXPLORE), Action(STOP)]
    if held is not None:
        made += [Action(DROP), *(Action(DROP, c) for c in labeller.containers if labeller.index(c) in known)]
    for index in sorted(known):
        name = labeller.names[index]
        made += [Action(WALK_TO, name), Action(WALK_ONE_STEP, name)]
        if held is None and index in open_ones:
            made.append(Action(PICK_UP, name))
    return tuple(made)
