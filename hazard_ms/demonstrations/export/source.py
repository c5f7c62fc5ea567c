"""The episodes that are to be exported, and the settings that all of them share."""

from __future__ import annotations

import importlib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

from tqdm import tqdm

from hazard_ms.demonstrations.layout import datasets
from hazard_ms.demonstrations.reading import Demonstration, demonstrations, entries
from hazard_ms.evaluation.options import EpisodeOptions
from hazard_ms.evaluation.replay import episode_of
from hazard_ms.skills.options.description import lines, sections_of

SHARED = ("robot", "control_mode", "joints", "reward_mode", "obs", "fps", "every")  # of an episode's `meta`
STATE, HIDDEN = "state", "none"  # observation modes in which recordings hold and do not hold observations
EXTRA = "demos"  # the extra of this package that names what the formats need


@dataclass(frozen=True)
class Common:
    """The settings that all episodes of an export share."""

    env_id: str
    agent: str
    settings: Mapping[str, Any]  # keywords of gym.make
    robot: str
    control_mode: str
    joints: list[str]  # in the order of `qpos`
    hazards: list[str]  # names of the levels in `hazard`
    reward_mode: str
    obs: str  # what was recorded of the observations, as `hazard-ms demos record --obs` takes it
    fps: float  # frames per second of simulated time
    every: int  # frames from one picture to the next
    cameras: tuple[str, ...]  # of which there are films, that of the head first
    max_frames: int  # of an episode

    @property
    def observed(self) -> bool:
        """Whether observations of the mode "state" were recorded."""
        return STATE in self.obs.split("+")

    @classmethod
    def of(cls, one: Demonstration) -> Common:
        """The settings of one episode, which the others of its dataset share."""
        episode = one.result
        meta: dict[str, Any] = {"hazards": one.meta.get("hazards", []), **{key: one.meta[key] for key in SHARED}}
        return cls(
            env_id=episode.env_id,
            agent=episode.agent,
            settings=episode_of(episode).settings,
            cameras=tuple(one.films),
            max_frames=episode.max_frames,
            **meta,
        )


@dataclass(frozen=True)
class Source:
    """The episodes of the dataset in `folder`, and what is wanted of them; iterating shows a progress bar."""

    folder: Path
    obs: str | None = None  # mode of the observations that are made by simulating again; None: what was recorded
    states: bool = False  # whether every state of the environment is wanted, by simulating again
    privileged: bool = False  # whether what only a privileged teacher knows is wanted
    load: tuple[str, ...] = ()  # modules that register what the episodes need
    language: bool = False  # whether the skills that run are written as sentences that hold from a time on

    @cached_property
    def dataset(self) -> Path:
        """The folder of the dataset, which may lie in `folder`. Raises ValueError where there is not exactly one."""
        found = list(datasets(self.folder))
        if len(found) > 1:
            raise ValueError(f"folder must hold one dataset, got {len(found)}: {', '.join(map(str, found))}")
        return found[0]

    @cached_property
    def count(self) -> int:
        """Number of episodes. Raises ValueError for a dataset without any."""
        found = len(entries(self.dataset))
        if not found:
            raise ValueError(f"folder must hold at least one episode, got none in {self.dataset}")
        return found

    @cached_property
    def common(self) -> Common:
        """The settings that all episodes share. Raises ValueError for a dataset without any."""
        assert self.count
        first = next(iter(demonstrations(self.dataset)))
        self.options(first).check()
        return Common.of(first)

    def options(self, one: Demonstration) -> EpisodeOptions:
        """The episode that a demonstration is of."""
        return episode_of(one.result, self.load)

    def __iter__(self) -> Iterator[Demonstration]:
        for one in tqdm(demonstrations(self.dataset), total=self.count, unit="episode", desc="export"):
            found = Common.of(one)
            if found != self.common:
                raise ValueError(
                    f"{one.folder} must be recorded like the other episodes, with {self.common}, got {found}"
                )
            yield one

    @cached_property
    def actions(self) -> list[Any]:
        """Rows that describe the numbers of an action, as `hazard-ms describe` prints them."""
        common = self.common
        wanted = {**common.settings, "control_mode": common.control_mode, "robot_uids": common.robot}
        return sections_of(common.env_id, STATE, **wanted)["action"]

    @property
    def action_text(self) -> str:
        """A text that says what the numbers of an action mean."""
        told = "\n".join(line.rstrip() for row in self.actions for line in lines(row))
        return (
            f"Actions of control mode {self.common.control_mode}, as they were sent in each frame: targets that the "
            f"controllers are to reach, not changes, unless a row says so.\n{told}"
        )

    @property
    def action_names(self) -> list[str]:
        """The name of each number of an action."""
        return [f"{name}.{part}" for row in self.actions for name, part in _named(row)]


def _named(row: Any) -> Iterator[tuple[str, str]]:
    """Controller and name of each number of a row of actions."""
    controller = row.key.split()[-1]
    for k in range(row.shape[-1]):
        yield controller, row.entries[k] if row.entries else str(k)


def needed(package: str, form: str) -> Any:
    """A package that a format needs. Raises ValueError where it is not installed."""
    try:
        return importlib.import_module(package)
    except ImportError:
        raise ValueError(
            f"format {form} needs the package {package}, which is not installed: pip install 'hazard_ms[{EXTRA}]'"
        ) from None
