"""Tracks of the leaderboard: which episodes a submission must hold, and by which rules they are played."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Any

from hazard_ms.agents.latency import OFF, TOKENS
from hazard_ms.evaluation.options import EpisodeOptions
from hazard_ms.sensing.detection.perception import parts
from hazard_ms.spec.checks import one_of
from hazard_ms.spec.registry.detectors import TRUTH
from hazard_ms.tasks import task_of
from hazard_ms.tasks.spare import file_of

Place = tuple[str, int]  # task and seed of an episode
PUBLISHED = ("HazardFire-v1", "HazardFlood-v1", "HazardWind-v1")
HIDDEN = "hidden-"  # how names of tracks of hidden scenes begin
PAIR = ("fetch", "fetch")
HOMES = ("HazardHouseFire-v1", "HazardHouseFlood-v1")


@dataclass(frozen=True)
class Track:
    """One track: every seed from 0 on of each of its tasks, once each.

    `detectors`: those of which one must tell the agent of things; `averted`: whether the score is what was averted, not
    Value; `scenes`: those of each task that belong to no split; seed k plays scene k. None: those of the split.
    """

    name: str
    words: str  # what it asks, for people
    tasks: tuple[str, ...]
    episodes: int  # of each task
    detectors: tuple[str, ...] = (TRUTH,)
    clock: str = OFF
    averted: bool = False
    scenes: Mapping[str, tuple[str, ...]] | None = None
    split: str = field(default="test", kw_only=True)
    physics: str = field(default="paper", kw_only=True)
    robot: str | tuple[str, ...] = field(default="fetch", kw_only=True)  # several are a team

    @property
    def places(self) -> list[Place]:
        """The episodes in the order in which a submission holds them: task by task, and by seed."""
        return [(task, seed) for task in self.tasks for seed in range(self.episodes)]

    def names(self, task: str) -> tuple[str, ...]:
        """The scenes of the split of a task, of which its hidden ones have the places."""
        return tuple(task_of(task, self.physics).scenes(self.split))

    def scene(self, place: Place) -> str:
        """The scene that an episode must be played in."""
        task, seed = place
        names = self.names(task) if self.scenes is None else self.scenes[task]
        return names[seed % len(names)]

    def options(self, place: Place, agent: str = "random", perception: str = TRUTH) -> EpisodeOptions:
        """The episode that the track asks for; a scene that belongs to no split must still be given as a file."""
        return EpisodeOptions(
            env_id=place[0],
            split=self.split,
            physics=self.physics,
            robot_uids=self.robot,
            agent=agent,
            seed=place[1],
            perception=perception,
        )

    def settings(self, place: Place) -> dict[str, Any]:
        """The settings of an episode, as the file of its result must tell them."""
        settings = self.options(place).settings
        return {name: list(value) if isinstance(value, tuple) else value for name, value in settings.items()}

    @contextmanager
    def scene_file(self, place: Place) -> Iterator[str | None]:
        """The file of an episode's scene while the context lasts; None for one of the split."""
        if self.scenes is None:
            yield None
            return
        with file_of(self.scene(place), self.names(place[0])) as path:
            yield path

    def perceives(self, perception: str) -> bool:
        """Whether a perception is one that the track asks for: by name, without a file of somebody's own."""
        if perception.partition(":")[0] not in self.detectors:
            return False
        try:
            _, _, own = parts(perception)
        except ValueError:
            return False
        return "path" not in own


TRACKS = {
    track.name: track
    for track in (
        Track("published", "the paper's three tasks in the scenes of its test split", PUBLISHED, 25),
        Track("perception", "the same, told of things by the detector `small`", PUBLISHED, 25, detectors=("small",)),
        Track("clock", "the same, while hazards go on by the tokens that a model takes", PUBLISHED, 25, clock=TOKENS),
        Track("houses", "whole homes in fire and in flood; the score is what was averted", HOMES, 50, averted=True),
        Track("teams", "two robots rescue together, in the scenes of the track `published`", PUBLISHED, 25, robot=PAIR),
        Track("trial", "two episodes, to try everything out: too few to compare agents", PUBLISHED[:1], 2),
        Track("trial-teams", "the same two with two robots", PUBLISHED[:1], 2, robot=PAIR),
    )
}


def track_of(name: str, hidden: Track | None = None) -> Track:
    """The track called `name`: one of TRACKS, or the `hidden` one, whose scenes have been published.

    Raises ValueError for other names, with what a hidden one needs.
    """
    if hidden is not None and name == hidden.name:
        return hidden
    if name.startswith(HIDDEN):
        raise ValueError(f"track {name!r:.100} must be given with its files: --hidden COMMITMENTS PUBLISHED")
    return TRACKS[one_of(name, TRACKS, "track")]


def hidden_track(name: str, scenes: Mapping[str, tuple[str, ...]]) -> Track:
    """The track of the hidden set called `name`, by its published scenes of each task."""
    words = "the published tasks in scenes that nobody knew while agents were made"
    return Track(HIDDEN + name, words, tuple(scenes), min(map(len, scenes.values())), scenes=scenes)
