"""A whole rescue without a planned motion: three small networks walk, reach and stow, and an agent decides what for.

    python examples/rescue/learn.py reach reaches.npz
    python examples/rescue/learn.py demonstrate rescues.npz
    python examples/rescue/learn.py train reaches.npz rescues.npz --out learned/rescue
    hazard-ms evaluate -e HazardFire-v1 --split test \\
        --agents greedy examples/rescue/policies.py:Policies:weights=learned/rescue

Skills plan: walks follow a path point by point, a reach solves the arm's kinematics and looks for a way past furniture.
Here `greedy`, or any other agent, still decides what to fetch, but a network plays each of its actions: it reads
numbers and says, thirty times a second, how base, arm and hand move. A search over the map tells walks where the way
leads, once in two seconds, as in a navigation stack. Only `explore`, a turn once around, is as it was.

Reaches and stows read the numbers of clone_pick_up.py and the heights before the base (hands.py); a walk reads the map
around the robot as pictures that turn with it (walks.py). After a reach that failed, the walk leads to another side.
They are for Fetch, for tasks whose safe place is its bag, and for things that are told as they are (no detector).
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import torch
from safetensors.torch import load_file

from hazard_ms import Action, Agent
from hazard_ms.agents.base import agent
from hazard_ms.skills import actions
from hazard_ms.skills.brief import Brief
from hazard_ms.skills.context import Skill, Stage
from hazard_ms.skills.decision import DROP, PICK_UP, WALK_ONE_STEP, WALK_TO, Decision

sys.path.insert(0, str(Path(__file__).parent))
from hands import ARM, SEEN, Hand, reached, stowed  # noqa: E402
from walks import Place, Walker, walked  # noqa: E402

VERBS = {WALK_TO: "walk", WALK_ONE_STEP: "walk", PICK_UP: "reach", DROP: "stow"}


class Deciding(Agent):
    """Decides as another agent does."""

    def __init__(self, decides: str = "greedy") -> None:
        """Raises ValueError for an agent that sees what is hidden."""
        self.inner = agent(decides)
        if self.inner.privileged:
            raise ValueError(f"decides must be an agent that sees what the robot sees, got {decides!r}")
        self.colours = self.inner.colours

    def reset(self, brief: Brief) -> None:
        """Begin an episode."""
        self.inner.reset(brief)

    def act(self, decision: Decision) -> Action:
        """What the other agent does."""
        action, self.note = self.inner.act(decision), self.inner.note
        return action


class Policies(Deciding):
    """Moves by the networks in the folder `weights`."""

    def __init__(self, weights: str, decides: str = "greedy") -> None:
        super().__init__(decides)
        self.failed: dict[str, list[Place]] = {}  # where reaches for things failed [m]
        torch.set_num_threads(1)  # quicker for networks as small as these
        self.models: dict[str, Any] = {"walk": Walker(), **{n: Hand(torch.zeros(2, SEEN)) for n in ARM}}
        for name, model in self.models.items():
            model.load_state_dict(load_file(Path(weights) / f"{name}.safetensors"))
            model.eval()

    def reset(self, brief: Brief) -> None:
        """Begin an episode."""
        super().reset(brief)
        self.failed = {}

    def skill(self, stage: Stage, action: Action) -> Skill:
        """The network that does `action`, or the benchmark's skill where none has learned it."""
        verb = VERBS.get(action.verb)
        if verb == "stow" and action.target is None:
            return stowed(stage, self.models["stow"])
        if verb not in ("walk", "reach") or action.target not in stage.labeller.names:
            return actions.skill(stage, action)
        index = stage.labeller.index(action.target)
        if verb == "walk":
            return walked(stage, index, self.models["walk"], self.failed.get(action.target, ()))
        return self.noted(stage, action.target, reached(stage, index, self.models["reach"]))

    def noted(self, stage: Stage, target: str, doing: Skill) -> Skill:
        """A reach for the `target`; where it fails is remembered, so that the next one is tried from elsewhere."""
        result = yield from doing
        if not result.ok:
            x, y, _ = stage.robot.base()
            self.failed.setdefault(target, []).append((x, y))
        return result
