"""Watchers look on while an episode is played: a progress bar, a film, a recorder. The runner knows none of them."""

from __future__ import annotations

import sys
from typing import Any

from tqdm import tqdm

from hazard_ms.evaluation.result import Played
from hazard_ms.skills.decision import Action, Decision, Result
from hazard_ms.skills.executor import SkillEnv
from hazard_ms.skills.team import TeamSkills

BAR_EVERY = 0.1  # time between two updates of a progress bar on a terminal [s]
LOG_EVERY = 5.0  # the same in a file, where every update is a line of its own [s]


class Watcher:
    """Base of watchers: a `Runner` calls these methods; each does nothing unless it is overridden."""

    colours: bool = False  # whether it reads `decision.images.rgb`, which is None where nobody does

    def begin(self, env: Any, decision: Decision) -> None:
        """The episode has begun, and `decision` is the first one; `env`: SkillEnv, or TeamSkills for a team."""

    def asked(self, so_far: Played) -> None:
        """The agent is about to be asked for its next action, after the decisions of `so_far`."""

    def decided(self, decision: Decision, action: Action, note: str) -> None:
        """The agent has chosen `action` at `decision`; `note` is its reason."""

    def frame(self, action: Any) -> None:
        """A frame has passed under the low-level `action`, [A], in the units of the robot's controllers.

        Of a team those of all robots, by name.
        """

    def ended(self, result: Result) -> None:
        """The action chosen last has ended with `result`."""

    def finish(self, reason: str) -> None:
        """The episode is over because of `reason`, one of those of `EpisodeResult.ended`."""


class Progress(Watcher):
    """A progress bar on stderr that counts the frames of the episode."""

    def __init__(self, title: str) -> None:
        self._title = title
        self._bar: Any = None

    def begin(self, env: SkillEnv | TeamSkills, decision: Decision) -> None:
        """Draw the bar, with the name of the scene."""
        title = f"{self._title} in {env.base.specs[0].name}"
        every = BAR_EVERY if sys.stderr.isatty() else LOG_EVERY
        self._bar = tqdm(total=env.max_frames, unit="frame", desc=title, mininterval=every)

    def frame(self, action: Any) -> None:
        """Count a frame; `action`, [A], in the units of the robot's controllers, is not looked at."""
        self._bar.update()

    def finish(self, reason: str) -> None:
        """Leave the bar as it stands."""
        self._bar.close()
