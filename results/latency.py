"""Value of agents that need a fixed time for each decision: `./run python results/latency.py [fire|flood|wind...]`.

The hazard goes on while they think. Plays the 25 scenes of the split `test` for each of DELAYS, resumes where it
stopped, and writes latency.csv beside this file and docs/latency.svg. With `chart` alone it plays nothing.
"""

from __future__ import annotations

import csv
import os
import sys
from collections.abc import Sequence

from hazard_ms.agents.base import Agent, agent
from hazard_ms.agents.latency import Thought
from hazard_ms.agents.llm.choices import forced
from hazard_ms.evaluation.result import EpisodeResult
from hazard_ms.skills.brief import Brief
from hazard_ms.skills.decision import Action, Decision
from hazard_ms.spec.checks import one_of
from results.tables import HERE, TASKS, evaluate, percent, results_in, value_of

RAW = HERE.parent / "build" / "latency"
CHART = HERE.parent / "docs" / "latency.svg"
PLAYERS = {"planner": "planner", "model": "llm:base_url=scripted,model=greedy"}
LABELS = {"planner": "planner", "model": "llm, scripted model"}  # in the chart
DELAYS = (0, 1, 2, 5, 10)  # time for a decision [s]


class Slow(Agent):
    """One of PLAYERS that takes `seconds` for each decision that does not follow by itself from the last one."""

    def __init__(self, player: str, seconds: float) -> None:
        self._inner, self._seconds = agent(PLAYERS[one_of(player, PLAYERS, "player")]), seconds

    def reset(self, brief: Brief) -> None:
        """Begin an episode."""
        self._inner.reset(brief)

    def act(self, decision: Decision) -> Action:
        """What the player does, after its time."""
        action = self._inner.act(decision)
        follows = action == forced(decision)
        self.thought = Thought(0.0 if follows else self._seconds)
        self.note, self.fallback, self.counters = self._inner.note, self._inner.fallback, self._inner.counters
        self.ending = self._inner.ending
        return action


def play(task: str) -> None:
    """Play what is missing of a task."""
    agents = [f"results/latency.py:Slow:player={player},seconds={delay}" for delay in DELAYS for player in PLAYERS]
    evaluate(task, RAW / task, "--clock", "wall", "--split", "test", "--agents", *agents)


def played() -> list[tuple[str, str, int, EpisodeResult]]:
    """The task, player and delay [s] of every episode that was played, and its result."""
    found = []
    for task in TASKS:
        for result in results_in(RAW / task):
            given = dict(pair.split("=") for pair in result.agent.rpartition(":")[2].split(","))
            found.append((task, given["player"], int(given["seconds"]), result))
    return sorted(found, key=lambda one: (*one[:3], one[3].seed))


def write(episodes: Sequence[tuple[str, str, int, EpisodeResult]]) -> None:
    """Write one row for each of `episodes`."""
    with (HERE / "latency.csv").open("w", newline="", encoding="utf-8") as file:
        rows = csv.writer(file, lineterminator="\n")
        rows.writerow(("task", "player", "delay_s", "seed", "value", "decisions", "thinking_frames", "frames"))
        for task, player, delay, result in episodes:
            decisions = sum(record.thought > 0.0 for record in result.decisions)
            value = round(result.tally.value, 4)
            rows.writerow((task, player, delay, result.seed, value, decisions, thinking(result), result.frames))


def thinking(result: EpisodeResult) -> int:
    """The frames of an episode in which the agent thought."""
    return sum(record.waited for record in result.decisions)


def chart(episodes: Sequence[tuple[str, str, int, EpisodeResult]]) -> None:
    """Draw mean Value with 95 % intervals over the time of a decision, and print it."""
    import matplotlib

    matplotlib.use("svg")
    matplotlib.rcParams.update({"svg.hashsalt": "latency", "font.size": 11})
    from matplotlib import pyplot

    tasks = [task for task in TASKS if any(one[0] == task for one in episodes)]
    figure, axes = pyplot.subplots(1, len(tasks), figsize=(4.2 * len(tasks), 3.4), sharey=True, squeeze=False)
    for ax, task in zip(axes[0], tasks, strict=True):
        for player, name in LABELS.items():
            delays, means, below, above = [], [], [], []
            for delay in DELAYS:
                mine = [one[3] for one in episodes if one[:3] == (task, player, delay)]
                if not mine:
                    continue
                mean, low, high = percent(value_of(mine))
                share = sum(map(thinking, mine)) / sum(result.frames for result in mine)
                print(
                    f"{task}, {name}, {delay:2d} s: Value {mean:.1f} [{low:.1f}, {high:.1f}], "
                    f"{len(mine)} episodes, {share:.0%} of frames thinking"
                )
                delays.append(delay)
                means.append(mean)
                below.append(mean - low)
                above.append(high - mean)
            ax.errorbar(delays, means, [below, above], marker="o", capsize=3, label=name)
        ax.set_xticks(DELAYS, [str(delay) for delay in DELAYS])
        ax.set(title=task, xlabel="time for a decision [s]", ylim=(0, 100))
        ax.grid(alpha=0.3)
    axes[0][0].set_ylabel("Value [%]")
    axes[0][0].legend(loc="lower left", frameon=False)
    figure.tight_layout()
    figure.savefig(CHART, metadata={"Date": None})


def main(wanted: list[str]) -> None:
    """Play the tasks `wanted`, or all, and draw. Raises ValueError for unknown names."""
    for task in [] if wanted == ["chart"] else [one_of(name, TASKS, "a task") for name in wanted] or [*TASKS]:
        play(task)
    episodes = played()
    write(episodes)
    chart(episodes)


if __name__ == "__main__":
    os.environ.setdefault("OMP_NUM_THREADS", "1")
    main(sys.argv[1:])
