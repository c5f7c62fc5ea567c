"""A LeRobot dataset of format v3.0, written with pyarrow and av alone: lerobot itself is not needed."""

from __future__ import annotations

import json
from contextlib import closing
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hazard_ms.demonstrations.export.lerobot_card import write_card
from hazard_ms.demonstrations.export.lerobot_film import Film, picture_info, samples
from hazard_ms.demonstrations.export.lerobot_language import COLUMN, FEATURE, as_column, sentences
from hazard_ms.demonstrations.export.lerobot_stats import Stats, joined, merged, stats_of
from hazard_ms.demonstrations.export.lerobot_tables import Tables, read_columns, write_episodes, write_info, write_words
from hazard_ms.demonstrations.export.source import Common, Source, needed
from hazard_ms.demonstrations.reading import Demonstration

HAZARD = "hazard"  # a label: what begins with "observation" is what policies see
PICTURES = "observation.images."  # before the name of a camera
STATE_NAMES = ("base.x", "base.y", "base.heading", "hand.x", "hand.y", "hand.z", "hand.holding")  # after the joints
Columns = dict[str, NDArray[Any]]


def write(source: Source, folder: Path) -> str:
    """Write the dataset into `folder`. Returns "", since readers open the folder itself.

    Raises ValueError where pyarrow or av is missing, and for pictures that were not taken a whole number of times a
    second.
    """
    for package in ("pyarrow", "av"):
        needed(package, "lerobot")
    rate = rate_of(source.common)
    with closing(_Writing(folder, source.common, rate, source.language)) as writing:
        for one in source:
            writing.add(one)
    write_words(folder / "meta/tasks.parquet", "task_index", list(writing.tasks))
    if not source.language:
        write_words(folder / "meta/subtasks.parquet", "subtask_index", list(writing.subtasks))
    write_episodes(folder, writing.episodes, writing.stats)
    write_info(folder, source.common.robot, rate, writing.features(source), writing.episodes, writing.whole())
    write_card(source, rate, folder)
    return ""


def rate_of(common: Common) -> int:
    """Rows per second of simulated time. Raises ValueError where it is not a whole number, as LeRobot needs it."""
    step = _step(common)
    if step < 1 or common.fps % step:
        raise ValueError(
            f"every must divide {common.fps:g}, the frames per second, for lerobot, got {step}; record with another "
            "value"
        )
    return round(common.fps / step)


def rows_of(one: Demonstration, step: int) -> Columns:
    """The rows of an episode of T frames, one for each `step` frames: R of them in each column, [R, ...].

    The state holds joints [rad, m], their velocities [rad/s, m/s], and what `STATE_NAMES` lists [m, rad].
    """
    frames, total = one.frames, len(one.frames["action"])
    at = np.arange(0, total, step)
    body = [frames[name][at] for name in ("qpos", "qvel", "base", "hand")]
    made: Columns = {
        "observation.state": np.concatenate([*body, frames["held"][at, None] >= 0], axis=1).astype(np.float32),
        # what was sent up to the next picture, in the mean: a policy's action lasts as long
        "action": (np.add.reduceat(frames["action"], at) / np.diff([*at, total])[:, None]).astype(np.float32),
        "next.reward": np.add.reduceat(frames["reward"], at).astype(np.float32),
        "next.done": np.arange(len(at)) == len(at) - 1,
        "next.success": np.logical_or.reduceat(frames["success"], at),
        "subtask_index": frames["subtask"][at].astype(np.int64),
    }
    if "hazard" in frames:
        levels = frames["hazard"][at]
        made[HAZARD] = levels[:, 0] if levels.shape[1] == 1 else levels  # LeRobot's columns of one number hold no lists
    return {**made, "observation.environment_state": frames["obs"][at]} if "obs" in frames else made


class _Writing:
    """The parts of a dataset that grow episode by episode."""

    def __init__(self, folder: Path, common: Common, rate: int, language: bool) -> None:
        self.tasks: dict[str, int] = {}
        self.subtasks: dict[str, int] = {}
        self.episodes: list[dict[str, Any]] = []
        self.stats: list[Stats] = []
        self._folder, self._common = folder, common
        self._step, self._rate, self._start, self._language = _step(common), rate, 0, language
        self._tables = Tables(folder)
        self._films = {camera: Film(folder, PICTURES + camera, rate) for camera in common.cameras}
        self._columns: Columns = {}  # of the last episode
        self._looks: dict[str, Any] = {}  # of its pictures, by camera

    def add(self, one: Demonstration) -> None:
        """Add an episode. Raises ValueError for one with fewer pictures than rows."""
        columns, number = rows_of(one, self._step), len(self.episodes)
        count = len(columns["action"])
        columns["timestamp"] = (np.arange(count) / self._rate).astype(np.float32)  # [s]
        spoken: Columns = {}
        if self._language:
            told = sentences(columns.pop("subtask_index"), columns["timestamp"], one.meta["subtasks"])
            spoken = {COLUMN: as_column(told, count)}
        else:
            words = [self.subtasks.setdefault(text, len(self.subtasks)) for text in one.meta["subtasks"]]
            columns["subtask_index"] = np.array(words)[columns["subtask_index"]]
        columns["frame_index"] = np.arange(count)
        columns["episode_index"] = np.full(count, number)
        columns["index"] = np.arange(self._start, self._start + count)
        task = one.meta["instruction"]
        columns["task_index"] = np.full(count, self.tasks.setdefault(task, len(self.tasks)))
        entry = {"episode_index": number, "tasks": [task], "length": count}
        entry |= self._origin(one)
        entry |= {"dataset_from_index": self._start, "dataset_to_index": self._start + count}
        stats = {name: stats_of(column.reshape(count, -1)) for name, column in columns.items()}
        for camera, film in self._films.items():
            entry |= film.add(one.films[camera], count)
            shown = samples(one.films[camera], count)
            stats[PICTURES + camera] = stats_of(shown, picture=True)
            self._looks[PICTURES + camera] = picture_info(shown, self._rate)
        self.episodes.append(entry | self._tables.add(columns, **spoken))
        self.stats.append(stats)
        self._columns, self._start = columns, self._start + count

    def _origin(self, one: Demonstration) -> dict[str, Any]:
        """What plays an episode again, beside its actions: LeRobot itself ignores it."""
        return {
            "env_id": one.result.env_id,
            "seed": one.result.seed,
            "scene": one.result.scene,
            "control_mode": self._common.control_mode,
            "settings": json.dumps(dict(self._common.settings)),  # keywords of gym.make
            "versions": json.dumps(one.result.versions),
        }

    def whole(self) -> Stats:
        """The statistics of all rows, once their files are closed, and of pictures from those of episodes."""
        parts: dict[str, list[dict[str, NDArray[Any]]]] = {}
        for name, column in read_columns(self._folder):
            parts.setdefault(name, []).append(stats_of(column))
        made = {name: joined(found) for name, found in parts.items()}
        return made | {key: merged([stats[key] for stats in self.stats]) for key in self._looks}

    def features(self, source: Source) -> dict[str, Any]:
        """The description of each column in info.json."""
        joints = source.common.joints
        names = {
            "observation.state": [*joints, *(f"{joint}.velocity" for joint in joints), *STATE_NAMES],
            "action": source.action_names,
            HAZARD: source.common.hazards,
        }
        made = {
            name: {"dtype": str(column.dtype), "shape": list(column.shape[1:]) or [1], "names": names.get(name)}
            for name, column in self._columns.items()
        }
        made |= {COLUMN: FEATURE} if self._language else {}
        return {**made, **self._looks}

    def close(self) -> None:
        """Finish the files that are being written."""
        self._tables.close()
        for film in self._films.values():
            film.close()


def _step(common: Common) -> int:
    """Frames from one row to the next."""
    return common.every if common.cameras else 1
