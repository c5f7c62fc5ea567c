"""The page of `hazard-ms demos show`: datasets in numbers and curves, and every episode with its film."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from markupsafe import Markup

from hazard_ms.demonstrations.layout import FAILURES, HEAD, MANIFEST, Entry, datasets
from hazard_ms.demonstrations.reading import described, films_in
from hazard_ms.demonstrations.sound import Named
from hazard_ms.demonstrations.stats import Stats
from hazard_ms.evaluation import page as episode_page
from hazard_ms.evaluation.comparison import charts, curves
from hazard_ms.evaluation.result import EpisodeResult
from hazard_ms.skills.decision import PICK_UP
from hazard_ms.skills.failures import UNFINISHED

TEMPLATE = Path(__file__).with_name("show.html")
SUBTASKS = {  # what verbs that take frames are called
    "walk_to": "walk",
    "walk_one_step": "walk one step",
    "pick_up": "pick up",
    "drop": "put away",
    "explore": "look around",
}
WAITING, WAITING_COLOUR = "wait", "#c8ced8"
KEPT, LOST, MEAN = "kept", "not kept", "mean of all"
STROKES = {
    KEPT: ("#5cadff", 1.0),
    LOST: ("#ef5f54", 1.0),
    MEAN: ("#ff8a3d", 3.0),
}  # colours and widths [pixels] of lines
BIN_WIDTHS = (5, 10, 20, 50, 100, 200, 500)  # [frames] [ours]
MOST_BINS = 12  # of a distribution, unless the widest bins are too narrow for that [ours]
CHART_WIDTH = 600.0  # of charts that stand side by side [pixels]

Bars = dict[str, list[tuple[str, float, str, float]]]  # as `charts.bars` takes them


@dataclass(frozen=True)
class Recorded:
    """An episode as its page shows it."""

    entry: Entry
    result: EpisodeResult
    reach: float  # value of the best plan from the start, as a share of all
    video: Path | None
    shown: bool  # with its film and timeline, not only in the table

    @property
    def steps(self) -> str:
        """The curve of value rescued over frames, as timeline.html takes it."""
        return episode_page.rescue_curve(self.result)


def page(folder: Path, output: Path, films: int) -> str:
    """The page of the datasets in `folder`, HTML, to be written to `output`; it shows `films` films of each, at most.

    Films are part of the page if they are small together, else links. Raises ValueError for a folder without episodes,
    and a DamagedDatasetError for an episode that cannot be read.
    """
    found = [stats for stats in map(Stats.of, _datasets(folder)) if stats.entries]
    if not found:
        raise ValueError(f"folder must hold a recorded episode, got {folder} without any; `demos repair` may find some")
    episodes = [_episodes(stats, films) for stats in found]
    videos = [e.video for own in episodes for e in own if e.shown and e.video]
    embedded = sum(video.stat().st_size for video in videos) <= episode_page.LARGEST_EMBEDDED
    return episode_page.rendered(
        TEMPLATE,
        datasets=[_shown(stats, own) for stats, own in zip(found, episodes, strict=True)],
        film=lambda video: episode_page.address(video, "") if embedded else episode_page.link(video, output),
        colours=episode_page.COLOURS,
        line_colours={name: colour for name, (colour, _) in STROKES.items()},
        subtasks=SUBTASKS,
        unfinished=UNFINISHED,
    )


def _datasets(folder: Path) -> list[Path]:
    """The datasets in `folder`, those too of which no episode was kept."""
    shelves = datasets(folder, failures=True)
    return list(dict.fromkeys(p.parent if p.name == FAILURES and p != folder else p for p in shelves))


def _episodes(stats: Stats, films: int) -> list[Recorded]:
    made = []
    for number, (entry, folder) in enumerate(zip(stats.entries, stats.folders, strict=True)):
        result, meta = described(folder)
        made.append(Recorded(entry, result, meta["reach"], films_in(folder).get(HEAD), number < films))
    return made


def _shown(stats: Stats, episodes: Sequence[Recorded]) -> dict[str, Any]:
    """What the template shows of a dataset."""
    results = [episode.result for episode in episodes]
    return {
        "recipe": Named(f"the recipe in {stats.dataset / MANIFEST}", stats.entries[0].recipe),
        "numbers": stats.rows(),
        "value_chart": Markup(_value_chart(episodes)),
        "subtask_chart": _bars(_subtasks(results), "frames"),
        "pick_up_chart": _bars(_pick_ups(results), "times"),
        "shown": sum(episode.shown for episode in episodes),
        "episodes": episodes,
    }


def _value_chart(episodes: Sequence[Recorded]) -> str:
    """The value of each episode over frames, and their mean, as SVG."""
    frames = curves.times(max(episode.result.max_frames for episode in episodes))
    lines, strokes = {}, {}
    for e in episodes:
        name = f"{e.entry.name}: {100 * e.entry.value:.1f} %"
        lines[name] = curves.value_curve([e.result], frames)
        strokes[name] = STROKES[LOST if e.entry.reason else KEPT]
    lines[MEAN], strokes[MEAN] = np.mean(list(lines.values()), axis=0), STROKES[MEAN]
    return charts.lines(lines, frames, strokes=strokes)


def _bars(rows: Bars, unit: str) -> str:
    return Markup(charts.bars(rows, unit, CHART_WIDTH)) if rows else ""


def _subtasks(results: Sequence[EpisodeResult]) -> Bars:
    """Frames an episode of each subtask, by how it ended; empty if none passed."""
    rows: Bars = {}
    skills = curves.skill_frames(results)
    for verb in (verb for verb in SUBTASKS if verb in skills):
        pieces = [
            (
                f"{outcome}: {frames / len(results):.0f} frames an episode, {tries} times in all",
                frames / len(results),
                episode_page.COLOURS[verb],
                charts.OPACITY[outcome],
            )
            for outcome, (tries, frames) in skills[verb].items()
            if frames
        ]
        rows |= {SUBTASKS[verb]: pieces} if pieces else {}
    waited = sum(decision.waited for result in results for decision in result.decisions) / len(results)
    if waited:
        rows[WAITING] = [(f"{waited:.0f} frames an episode", waited, WAITING_COLOUR, 1.0)]
    return rows


def _pick_ups(results: Sequence[EpisodeResult]) -> Bars:
    """Pick-ups by the frames that they took and how they ended; empty if there are none."""
    tried = [d for result in results for d in result.decisions if d.verb == PICK_UP]
    if not tried:
        return {}
    longest = max(d.frames for d in tried)
    width = next((width for width in BIN_WIDTHS if longest < width * MOST_BINS), BIN_WIDTHS[-1])
    rows: Bars = {}
    for low in range(min(d.frames for d in tried) // width * width, longest + 1, width):
        counts = Counter(curves.outcome(d) for d in tried if low <= d.frames < low + width)
        rows[f"{low} to {low + width - 1} frames"] = [
            (f"{counts[outcome]} {outcome}", counts[outcome], episode_page.COLOURS[PICK_UP], charts.OPACITY[outcome])
            for outcome in curves.OUTCOMES
            if counts[outcome]
        ]
    return rows
