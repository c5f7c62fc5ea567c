"""Plays the benchmark and writes its tables: `./run python results/make.py [TASK-ROBOT...]`; resumes where it stopped.

With `tables` alone it plays nothing.

Every agent plays the 25 scenes of each task's split `test` once. Three times with Fetch: `rule`, so that the sketch
can be compared with it scene by scene, and, in wind, the agents that are compared with `planner`. Raw results go to
build/results, from where `hazard-ms report` and `hazard-ms regret` can read them. Rescues of people, played with
`hazard-ms serve --folder build/results/SWEEP/people`, become a row `human`. More scenes: results/splits.py.
README.md and scores.csv beside this file are written anew. Episodes in scores.csv that this machine has no raw results
of stay in the tables, as long as all their columns are there: delete the rows of a sweep whose agents or skills have
changed. Sweeps without any raw results here stay as they are.
"""

from __future__ import annotations

import csv
import subprocess
import sys
from typing import Any

from hazard_ms.evaluation.choices import HUMAN
from hazard_ms.evaluation.comparison.folders import title as settings
from hazard_ms.evaluation.comparison.summary import ORACLE, interval
from hazard_ms.evaluation.result import EpisodeResult
from hazard_ms.sketch.bound import bound
from hazard_ms.sketch.recording import recorded
from hazard_ms.spec.checks import one_of
from hazard_ms.spec.registry.robots import robot_class
from hazard_ms.tasks import task_of
from results.plans import between
from results.rows import COLUMNS, Row, group, merged, read, row_of, whole
from results.tables import COMMAND, HERE, TASKS, evaluate, machine, results_in

RAW = HERE.parent / "build" / "results"
MAIN = ("greedy", "mcts", "planner", "oracle")
ALL = (*MAIN, "random", "rule", "oracle:known=true", "paper/greedy", "paper/rule", "paper/mcts")
COMPARED = ("greedy", "mcts", "planner")
SCENES = 25  # episodes of an agent
REPEATED = {"fire-fetch": ("rule",), "flood-fetch": ("rule",), "wind-fetch": (*COMPARED, "rule")}
OFTEN = 75  # episodes of an agent in REPEATED
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
    for agents, episodes in ((SWEEPS[sweep], SCENES), *(((REPEATED[sweep], OFTEN),) if sweep in REPEATED else ())):
        options = ["-r", robot, "--split", "test", "--episodes", str(episodes), "--workers", "2"]
        evaluate(task, RAW / sweep, *options, "--agents", *agents, check=False)


def bounds(env_id: str, robot: str, results: list[EpisodeResult], known: dict[int, float]) -> dict[int, float]:
    """The Value that no agent can exceed with each seed of `results`; those in `known` are not worked out anew."""
    task, build, made = task_of(env_id, "paper"), robot_class(robot).build, dict(known)
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


def kept(sweep: str) -> str:
    """The section of a sweep in the README as it is; empty if there is none."""
    _, heading, rest = (HERE / "README.md").read_text(encoding="utf-8").partition(title(sweep))
    return f"\n{heading}{rest.split(chr(10) + '## ')[0]}" if heading else ""


def table(sweep: str) -> tuple[str, list[Row]]:
    """The section of a sweep in the README, and its rows in scores.csv."""
    task, robot = sweep.split("-")
    before = read(HERE / "scores.csv", task, robot)
    results = [*results_in(RAW / sweep), *results_in(RAW / sweep / PEOPLE)]
    if not results:
        return kept(sweep), before
    best = bounds(TASKS[task], robot, results, {int(row["seed"]): float(row["bound"]) for row in before})
    rows = merged(whole(before), (row_of(task, robot, r, best[r.seed]) for r in results))
    for row in rows:
        if row["value"] > row["bound"] + 1e-4:
            raise AssertionError(
                f"Value must not exceed its bound {row['bound']}, got {row['value']} of {row['agent']}"
            )
    lines = [f"\n{title(sweep)}", f"Played at {played(sweep, bool(whole(before)))}.\n"]
    lines += section(group(settings(results[0]), rows))
    limits = {row["seed"]: row["bound"] for row in rows if row["agent"] != "rule" or row["seed"] < SCENES}
    lines.append(f"\nNo agent can exceed {100 * sum(limits.values()) / len(limits):.1f} on average (the bound).")
    if oracle := [r for r in results if r.agent == ORACLE]:
        lines.append(f"\n{between(TASKS[task], robot, oracle)}")
    if robot == "fetch":
        lines += fidelity(sweep)
    return "\n".join(lines) + "\n", rows


def played(sweep: str, before: bool) -> str:
    """The commits and machines on which a sweep was played; with `before` also those that the README names."""
    _, _, rest = kept(sweep).partition("Played at ")
    old = rest.split(".\n")[0].replace("; commit ", "\ncommit ").splitlines() if before else []
    return "; ".join(dict.fromkeys([*old, *(RAW / sweep / PLAYED).read_text(encoding="utf-8").splitlines()]))


def fidelity(sweep: str) -> list[str]:
    """What the sketch gives beside the real episodes of a sweep here, as `hazard-ms sketch check` tells it."""
    told = subprocess.run([*COMMAND, "sketch", "check", str(RAW / sweep)], capture_output=True, text=True)
    if not told.stdout:
        raise ValueError(f"hazard-ms sketch check must tell how far off the sketch is, got {told.stderr!r:.300}")
    return ["\nThe sketch beside these episodes (`hazard-ms sketch check`):\n", "```text", told.stdout.strip(), "```"]


def section(group: dict[str, Any]) -> list[str]:
    """The table of a group as `hazard-ms report` tells it, and differences from `planner`; people are one row.

    The oracle's differences from `mcts` and `greedy` say how far above these an agent could get.
    """
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
        if pair["agent"] == ORACLE and pair["other"] in ("mcts", "greedy"):
            lines.append(f"- {ORACLE} less {pair['other']}: {interval(pair['value'])}")
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
