"""The rows of the leaderboard: what signed reports of whole submissions cover, and nothing else."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from hazard_ms.evaluation.metrics import Score, interval, resampled, scores
from hazard_ms.evaluation.submissions.copies import copied
from hazard_ms.evaluation.submissions.report import SUFFIX, Report, read_report
from hazard_ms.evaluation.submissions.signing import signer
from hazard_ms.evaluation.submissions.tracks import TRACKS, Place

SIGNERS = "signers"  # file in the folder: whose reports count
FILM = ".mp4"


@dataclass(frozen=True)
class Row:
    """One submission that counts: its report, the name of its files, who signed, and its films by episode."""

    name: str
    report: Report
    signers: tuple[str, ...]
    films: dict[Place, Path] = field(default_factory=dict)

    @property
    def title(self) -> str:
        """The name under which it is listed."""
        assert self.report.card is not None
        return self.report.card.name

    @property
    def privileged(self) -> bool:
        """Whether it knew what agents cannot know: it then has no rank."""
        return self.report.card is not None and self.report.card.privileged

    @property
    def values(self) -> dict[Place, float]:
        """The score of each episode: Value, or what was averted, where its track asks for that and it is defined."""
        track = TRACKS.get(self.report.track)
        if track is None or not track.averted:
            return {one.place: one.tally.value for one in self.report.seen}
        return {one.place: one.averted for one in self.report.seen if one.averted is not None}

    @property
    def scenes(self) -> dict[Place, str]:
        """The scene of each episode."""
        return {one.place: one.scene for one in self.report.seen}

    @property
    def score(self) -> Score:
        """The score of the track: the mean over its tasks."""
        return pooled(self.values, self.scenes)

    def task_scores(self) -> dict[str, Score]:
        """The score of each task."""
        tasks = dict.fromkeys(task for task, _ in self.values)
        return {t: pooled({p: v for p, v in self.values.items() if p[0] == t}, self.scenes) for t in tasks}

    def other_scores(self) -> dict[str, Score]:
        """Value, Step [frames] and Damage over all episodes."""
        return scores([one.tally for one in self.report.seen], [one.scene for one in self.report.seen])


def pooled(values: Mapping[Place, float], scenes: Mapping[Place, str]) -> Score:
    """The mean over tasks of the mean of their episodes; the bootstrap draws scenes within each task."""
    tasks = list(dict.fromkeys(task for task, _ in values))
    means, drawn = [], []
    for seed, task in enumerate(tasks):
        own = [place for place in values if place[0] == task]
        numbers = np.array([values[place] for place in own], np.float64)
        parts = np.stack([numbers, np.ones_like(numbers)], axis=-1)
        total, count = resampled(parts, [scenes[place] for place in own], seed).T
        means.append(float(numbers.mean()))
        drawn.append(total / count)
    return interval(float(np.mean(means)), np.mean(drawn, axis=0)) if tasks else Score(None, None, None)


def apart(one: Row, other: Row) -> Score:
    """The score by which a row is above another, on the episodes of both, paired."""
    theirs = other.values
    return pooled({p: v - theirs[p] for p, v in one.values.items() if p in theirs}, one.scenes)


def standings(folder: Path) -> tuple[dict[str, list[Row]], list[str]]:
    """The rows of each track, the best first, and a line for each report in `folder` that does not count.

    Raises ValueError for a folder without a file of signers.
    """
    if not (folder / SIGNERS).is_file():
        raise ValueError(f"folder must contain the file {SIGNERS}, which names those whose reports count, got {folder}")
    found: dict[str, Row] = {}
    left_out: list[str] = []
    for path in sorted(folder.rglob(f"*{SUFFIX}")):
        name = path.name.removesuffix(SUFFIX)
        try:
            report, who = read_report(path), signer(path, folder / SIGNERS)
        except ValueError as error:
            left_out.append(f"{name}: {error}")
            continue
        if not report.verified or report.card is None:
            left_out.append(f"{name}: {report.verdict}")
            continue
        row = Row(name, report, (who,), _films(path.with_name(name)))
        older = found.get(report.submission)
        found[report.submission] = row if older is None else _merged(older, row)
    tracks: dict[str, list[Row]] = {}
    counted: list[Report] = []
    for row in sorted(found.values(), key=lambda r: (r.report.date, r.name)):
        faults = copied(row.report, counted)
        if faults:
            left_out += [f"{row.name}: {fault}" for fault in faults]
            continue
        counted.append(row.report)
        tracks.setdefault(row.report.track, []).append(row)
    order = [name for name in (*TRACKS, *sorted(tracks.keys() - TRACKS.keys())) if name in tracks]
    return {name: sorted(tracks[name], key=lambda r: (-(r.score.mean or 0.0), r.name)) for name in order}, left_out


def _merged(one: Row, other: Row) -> Row:
    """One row of two reports on the same submission: that of the first, signed by both."""
    first, second = sorted((one, other), key=lambda row: row.report.date)
    who = tuple(dict.fromkeys((*first.signers, *second.signers)))
    return Row(first.name, first.report, who, one.films or other.films)


def _films(folder: Path) -> dict[Place, Path]:
    """The films in a folder, HazardFire-v1-0003.mp4 and so on, by episode."""
    found: dict[Place, Path] = {}
    for path in sorted(folder.glob(f"*{FILM}")) if folder.is_dir() else ():
        task, _, seed = path.stem.rpartition("-")
        if seed.isascii() and seed.isdigit() and len(seed) <= 9 and path.is_file() and not path.is_symlink():
            found[task, int(seed)] = path
    return found
