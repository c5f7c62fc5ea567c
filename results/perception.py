"""Value of agents whose detector misses things: `./run python results/perception.py [EPISODES] [fire|flood|wind...]`.

Plays the first EPISODES scenes of the split `test`, 25 by default, for each of MISSES and HOLDS, resumes where it
stopped, and writes perception.csv beside this file and docs/perception_value.svg. With `chart` alone it plays nothing.
"""

from __future__ import annotations

import csv
import os
import sys
from typing import NamedTuple

from hazard_ms.evaluation.result import EpisodeResult
from hazard_ms.spec.checks import one_of
from results.tables import HERE, TASKS, evaluate, percent, results_in, value_of

RAW = HERE.parent / "build" / "perception_value"
CHART = HERE.parent / "docs" / "perception_value.svg"
AGENTS = ("greedy", "planner")
MISSES = (0.0, 0.2, 0.4, 0.6)  # share of things that the detector does not find
HOLDS = (1, 300)  # frames for which a thing that is missed stays missed
EPISODES = 25  # of each agent, task and detector


class Point(NamedTuple):
    """One point of the chart; `hold` 0: the truth, without any detector."""

    task: str
    agent: str
    hold: int
    miss: float


def detectors() -> dict[str, tuple[int, float]]:
    """Each specification of a detector, and its `hold` and `miss`."""
    noisy = {f"noisy:miss={miss},hold={hold}": (hold, miss) for hold in HOLDS for miss in MISSES}
    return {"truth": (0, 0.0), **noisy}


def play(task: str, episodes: int) -> None:
    """Play what is missing of a task."""
    for text in detectors():
        words = ["--split", "test", "--agents", *AGENTS, "--episodes", str(episodes), "--perception", text]
        evaluate(task, RAW / task, *words)


def played() -> dict[Point, list[EpisodeResult]]:
    """The results of all episodes that were played, point by point."""
    found: dict[Point, list[EpisodeResult]] = {}
    for task in TASKS:
        for result in results_in(RAW / task):
            if result.perception in detectors():
                found.setdefault(Point(task, result.agent, *detectors()[result.perception]), []).append(result)
    return dict(sorted(found.items()))


def write(points: dict[Point, list[EpisodeResult]]) -> None:
    """Write one row for each episode."""
    with (HERE / "perception.csv").open("w", newline="", encoding="utf-8") as file:
        rows = csv.writer(file, lineterminator="\n")
        rows.writerow((*Point._fields, "seed", "value", "frames"))
        for point, results in points.items():
            for result in sorted(results, key=lambda one: one.seed):
                rows.writerow((*point, result.seed, round(result.tally.value, 4), result.frames))


def chart(points: dict[Point, list[EpisodeResult]]) -> None:
    """Draw mean Value with 95 % intervals over the share of things that are missed, and print it."""
    import matplotlib

    matplotlib.use("svg")
    matplotlib.rcParams.update({"svg.hashsalt": "perception", "font.size": 11})
    from matplotlib import pyplot

    tasks = [task for task in TASKS if any(point.task == task for point in points)]
    if not tasks:
        raise ValueError(f"{RAW} must hold results, got none; play them first")
    figure, axes = pyplot.subplots(1, len(tasks), figsize=(4.2 * len(tasks), 3.4), sharey=True, squeeze=False)
    values = {point: percent(value_of(results)) for point, results in points.items()}
    for point, (mean, low, high) in values.items():
        told = "truth" if point.hold == 0 else f"miss {point.miss:.1f} for {point.hold} frames"
        count = len(points[point])
        print(f"{point.task}, {point.agent}, {told}: Value {mean:.1f} [{low:.1f}, {high:.1f}], {count} episodes")
    for ax, task in zip(axes[0], tasks, strict=True):
        for number, agent in enumerate(AGENTS):
            for hold, style in zip((0, *HOLDS), (":", "-", "--"), strict=True):
                line = [point for point in values if point[:3] == (task, agent, hold)]
                told = "truth" if hold == 0 else f"missed for {hold} frame{'s' * (hold > 1)}"
                ends = [values[point] for point in line]
                means = [mean for mean, _, _ in ends]
                if hold == 0 and means:
                    ax.axhline(means[0], color=f"C{number}", linestyle=style, label=f"{agent}, {told}")
                elif means:
                    bars = [[mean - low for mean, low, _ in ends], [high - mean for mean, _, high in ends]]
                    shown = {"color": f"C{number}", "linestyle": style, "marker": "o", "capsize": 3}
                    ax.errorbar([point.miss for point in line], means, bars, label=f"{agent}, {told}", **shown)
        ax.set_xticks(MISSES)
        ax.set(title=task, xlabel="share of things missed", ylim=(0, 100))
        ax.grid(alpha=0.3)
    axes[0][0].set_ylabel("Value [%]")
    axes[0][0].legend(loc="lower left", frameon=False, fontsize=8)
    figure.tight_layout()
    figure.savefig(CHART, metadata={"Date": None})


def main(words: list[str]) -> None:
    """Play the tasks among `words`, or all, with the number of episodes among them, and draw.

    Raises ValueError for unknown names.
    """
    episodes = next((int(word) for word in words if word.isdigit()), EPISODES)
    wanted = [word for word in words if not word.isdigit()]
    for task in [] if wanted == ["chart"] else [one_of(name, TASKS, "a task") for name in wanted] or [*TASKS]:
        play(task, episodes)
    points = played()
    write(points)
    chart(points)


if __name__ == "__main__":
    os.environ.setdefault("OMP_NUM_THREADS", "1")
    main(sys.argv[1:])
