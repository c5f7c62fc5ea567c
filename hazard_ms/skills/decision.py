"""What passes between agent and world at a decision: a `Decision` comes, an `Action` goes, a `Result` tells how it went."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hazard_ms.sensing.semantic_map import SemanticMap
from hazard_ms.sensing.target_table import Target

WALK_TO, WALK_ONE_STEP, PICK_UP, DROP, EXPLORE, STOP = "walk_to", "walk_one_step", "pick_up", "drop", "explore", "stop"
VERBS = (WALK_TO, WALK_ONE_STEP, PICK_UP, DROP, EXPLORE, STOP)
NEED_TARGET = (WALK_TO, WALK_ONE_STEP, PICK_UP)


@dataclass(frozen=True)
class Action:
    """A verb and the name of the thing that it is done to. `drop` takes a container, or None: the bag, or the ground."""

    verb: str
    target: str | None = None

    def __post_init__(self) -> None:
        if self.verb not in VERBS:
            raise ValueError(f"no action is called {self.verb!r}; there are {', '.join(VERBS)}")
        if self.target is not None and not isinstance(self.target, str):
            raise ValueError(f"the target of {self.verb} is {self.target!r}; it must be the name of a thing, or None")
        if self.verb in NEED_TARGET and self.target is None:
            raise ValueError(f"{self.verb} needs the name of a thing as its target")

    def __str__(self) -> str:
        return self.verb if self.target is None else f"{self.verb} {self.target}"


@dataclass(frozen=True)
class Result:
    """How an action went: whether it worked, why not, and how many frames it took."""

    ok: bool
    reason: str = ""  # empty when ok
    frames: int = 0


@dataclass(frozen=True)
class Images:
    """What the head camera saw last, H x W. `segmentation`: labels of `hazard_ms.sensing.camera`; None: withheld."""

    rgb: NDArray[np.uint8]  # [H, W, 3]
    depth: NDArray[np.float32]  # [H, W], along the optical axis [m]; 0: nothing there
    segmentation: NDArray[np.int64] | None  # [H, W]
    hazard: NDArray[np.float32]  # [16, 16], temperature [C] or water level [m]


@dataclass(frozen=True)
class Decision:
    """All that an agent knows when it must choose its next action. World frame, metres, radians."""

    frame: int
    max_frames: int
    agent_position: tuple[float, float]  # [m]
    agent_heading: float  # anticlockwise from +x [rad]
    held: str | None  # name of the thing in the hand
    targets: tuple[Target, ...]  # what is known of the things to rescue
    containers: tuple[str, ...]  # carts, in wind; empty where the safe place is the bag
    map: SemanticMap  # what has been seen so far
    images: Images | None  # None where nothing renders
    available: tuple[Action, ...]  # what can be tried now
    names: tuple[str, ...]  # of the things that `map.objects` and the segmentation refer to by index
    last_action: Action | None = None
    last_result: Result | None = None

    def index(self, name: str) -> int:
        """Index of the thing called `name` in `map.objects`."""
        if name not in self.names:
            raise ValueError(f"nothing is called {name!r}; there are {', '.join(self.names)}")
        return self.names.index(name)

    def target(self, name: str) -> Target:
        """What is known of the target called `name`."""
        for row in self.targets:
            if row.name == name:
                return row
        raise ValueError(f"{name!r} is no target; targets are {', '.join(t.name for t in self.targets)}")
