"""Plays the benchmark and writes its tables: `./run python results/make.py [TASK-ROBOT...]`; resumes where it stopped.

With `tables` alone it plays nothing.

Every agent plays the 25 scenes of each task's split `test` once, and the agents that are compared with `planner` play
them three times with Fetch; raw results go to build/results, from where `hazard-ms report` and `hazard-ms regret` can
read them. Rescues of people, played with `hazard-ms serve --folder build/results/SWEEP/people`, become a row `human`.
README.md and scores.csv beside this file are written anew; sweeps of which this machine has no raw results stay in
them as they are.
"""

from __future__ import annotations

import csv
import json
import subprocess
import sys
from pathlib import Path
from typing import Any

from hazard_ms.evaluation.choices import HUMAN
from hazard_ms.evaluation.comparison.summary import interval
from hazard_ms.evaluation.result import EpisodeResult
from hazard_ms.robots import robot_class
from hazard_ms.sketch.bound import bound
from hazard_ms.sketch.recording import recorded
from hazard_ms.spec.checks import one_of
from hazard_ms.tasks import task_of
from results.tables import COMMAND, HERE, TASKS, evaluate, machine, results_in

RAW = HERE.parent / "build" / "results"
MAIN = ("greedy", "mcts", "planner", "oracle")
ALL = (*MAIN, "random", "rule", "oracle:known=true", "paper/greedy", "paper/rule", "paper/mcts")
COLUMNS = ("task", "robot", "agent", "scene", "seed", "value", "bound", "frames", "ended", "rescued", "targets")
COMPARED = ("greedy", "mcts", "planner")
SCENES, SEEDS = 25, 75  # episodes of an agent, and of those that are compared
SWEEPS = {f"{task}-{robot}": ALL if robot == "fetch" else MAIN for robot in ("fetch", "g1") for task in TASKS}
PEOPLE = "people"  # folder beside raw results: those of people
PLAYED = "played.txt"  # beside raw results: the commits and machines that they were played on, one a line


def play(sweep: str) -> None:
    """Play what is missing of a sweep."""
    task, robot = sweep.split("-")
    (RAW / sweep).mkdir(parents=True, exist_ok=True)
    note, here = RAW / sweep / PLAYED, machine()
    before = note.read_text(encoding="utf-8").splitlines() if note.exists() else []
    note.write_text("".join(f"{line}\n" for line in dict.fromkeys([*before, here])), encoding="utf-8")
    for agents, episodes in ((SWEEPS[sweep], SCENES), *(((COMPARED, SEEDS),) if robot == "fetch" else ())):
        options = ["-r", robot, "--split", "test", "--episodes", str(episodes), "--workers", "2"]
        evaluate(task, RAW / sweep, *options, "--agents", *agents, check=False)


def bounds(env_id: str, robot: str, results: list[EpisodeResult]) -> dict[int, float]:
    """The Value that no agent can exceed with each seed of `results`."""
    task, build, made = task_of(env_id, "paper"), robot_class(robot).build, dict[int, float]()
    for result in results:
        if result.seed not in made:
            spec = task.build(result.scene)
            values = [t.value for t in result.targets]
            timeline = recorded(task, "paper", spec, result.seed)
            made[result.seed] = bound(timeline, spec, build, values, result.max_frames)
    return made


def title(sweep: str) -> str:
    """The heading of a sweep in the README."""
    task, robot = sweep.split("-")
    return f"## {task.capitalize()}, {robot}\n"


def kept(sweep: str) -> tuple[str, list[dict[str, Any]]]:
    """The section of a sweep in the README as it is, and its rows in scores.csv; empty if there are none."""
    task, robot = sweep.split("-")
    _, heading, rest = (HERE / "README.md").read_text(encoding="utf-8").partition(title(sweep))
    with (HERE / "scores.csv").open(newline="", encoding="utf-8") as file:
        rows = [row for row in csv.DictReader(file) if (row["task"], row["robot"]) == (task, robot)]
    return f"\n{heading}{rest.split(chr(10) + '## ')[0]}" if heading else "", rows


def table(sweep: str) -> tuple[str, list[dict[str, Any]]]:
    """The section of a sweep in the README, and its rows in scores.csv."""
    task, robot = sweep.split("-")
    results = [*results_in(RAW / sweep), *results_in(RAW / sweep / PEOPLE)]
    if not results:
        return kept(sweep)
    best, rows = bounds(TASKS[task], robot, results), []
    for r in results:
        rows.append(
            {
                "task": task,
                "robot": robot,
                "agent": r.agent,
                "scene": r.scene,
                "seed": r.seed,
                "value": round(r.tally.value, 4),
                "bound": round(best[r.seed], 4),
                "frames": r.frames,
                "ended": r.ended,
                "rescued": sum(t.rescued for t in r.targets),
                "targets": len(r.targets),
            }
        )
        if r.tally.value > best[r.seed] + 1e-9:
            raise AssertionError(f"Value must not exceed its bound {best[r.seed]}, got {r.tally.value} of {r.agent}")
    told = subprocess.run([*COMMAND, "report", str(RAW / sweep), "--json"], check=True, capture_output=True, text=True)
    played = "; ".join((RAW / sweep / PLAYED).read_text(encoding="utf-8").splitlines())
    lines = [f"\n{title(sweep)}", f"Played at {played}.\n"]
    for group in json.loads(told.stdout)["groups"]:
        lines += section(group)
    lines.append(f"\nNo agent can exceed {100 * sum(best.values()) / len(best):.1f} on average (the bound).")
    if robot == "fetch":
        lines += fidelity(RAW / sweep)
    return "\n".join(lines) + "\n", rows


def fidelity(folder: Path) -> list[str]:
    """What the sketch gives beside the real episodes in a folder, as `hazard-ms sketch check` tells it."""
    told = subprocess.run([*COMMAND, "sketch", "check", str(folder)], capture_output=True, text=True)
    if not told.stdout:
        raise ValueError(f"hazard-ms sketch check must tell how far off the sketch is, got {told.stderr!r:.300}")
    return ["\nThe sketch beside these episodes (`hazard-ms sketch check`):\n", "```text", told.stdout.strip(), "```"]


def section(group: dict[str, Any]) -> list[str]:
    """The table of a group as `hazard-ms report` tells it, and the differences from `planner`; people are one row."""
    lines = [f"{group['settings']}.\n", "| agent | Value | Step | Damage | regret | rescued | episodes |"]
    lines.append("|---|---|---|---|---|---|---|")
    for name, agent in sorted(group["agents"].items(), key=lambda item: -item[1]["value"]["mean"]):
        cells = [interval(agent["value"]), interval(agent["step"], 1), interval(agent["damage"])]
        regret = interval(agent["regret"]) if "regret" in agent else "-"
        saved, shown = f"{agent['rescued']} of {agent['targets']}", f"{name} (people)" if name == HUMAN else name
        lines.append(f"| {shown} | {' | '.join(cells)} | {regret} | {saved} | {agent['episodes']} |")
    lines.append("")
    for pair in group["differences"]:
        if pair["agent"] == "planner" and pair["other"] != "random":
            common = f" on {pair['episodes']} episodes" if pair["other"] == HUMAN else ""
            lines.append(f"- planner less {pair['other']}: {interval(pair['value'])}{common}")
    return lines


def main(wanted: list[str]) -> None:
    """Play the sweeps called `wanted`, or all, and write the tables. Raises ValueError for unknown names."""
    chosen = [] if wanted == ["tables"] else [one_of(name, SWEEPS, "a sweep") for name in wanted] or [*SWEEPS]
    for sweep in chosen:
        play(sweep)
    tables = [table(sweep) for sweep in SWEEPS]
    with (HERE / "scores.csv").open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, COLUMNS, lineterminator="\n")
        writer.writeheader()
        for _, rows in tables:
            writer.writerows(rows)
    head = (HERE / "head.md").read_text(encoding="utf-8")
    (HERE / "README.md").write_text(head + "".join(text for text, _ in tables), encoding="utf-8")


if __name__ == "__main__":
    main(sys.argv[1:])
