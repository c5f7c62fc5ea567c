"""One row of numbers for each episode, as CSV, for tools that make tables of their own."""

from __future__ import annotations

import csv
import io
from collections.abc import Sequence

from hazard_ms.evaluation.averted.loss import averted_of_all
from hazard_ms.evaluation.comparison.folders import Group
from hazard_ms.evaluation.metrics import damage, step
from hazard_ms.evaluation.result import EpisodeResult

COLUMNS = (
    *("settings", "agent", "seed", "scene", "ended", "frames", "value", "step", "damage", "rescued", "targets"),
    *("averted", "averted_of_all", "heat", "wading", "water", "collisions"),
)


def table(groups: Sequence[Group]) -> str:
    """The episodes of `groups` as CSV with a line of COLUMNS; shares are 0 to 1, what is undefined is left empty."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(COLUMNS)
    for group in groups:
        writer.writerows((group.title, *row(result)) for result in group.results)
    return text.getvalue()


def row(result: EpisodeResult) -> tuple[object, ...]:
    """The numbers of an episode, in the order of COLUMNS, from `agent` on."""
    tally, loads = result.tally, result.loads
    borne = (None,) * 4 if loads is None else (loads.heat, loads.wading, loads.water, loads.collisions)
    return (
        *(result.agent, result.seed, result.scene, result.ended, result.frames),
        *(tally.value, step([tally]), damage([tally]), tally.rescued, len(result.targets)),
        *(result.averted, averted_of_all(result.lost, result.lost_alone), *borne),
    )
