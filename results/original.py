"""Plays the original's scenes: `./run python results/original.py FOLDER [TASK...]`; resumes where it stopped.

FOLDER holds the original's folders `indoor` and `outdoor` of published scenes, which are not part of this project. 25
of each are imported; the agents that are written after the paper's play them with Fetch and the constants that its code
has (preset `shipped`). Writes original.md beside this file, with the paper's own scores. With `tables` in place of
FOLDER it plays nothing.
"""

from __future__ import annotations

import itertools
import os
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

from hazard_ms.evaluation.comparison.pairing import difference
from hazard_ms.evaluation.metrics import Tally, scores
from hazard_ms.evaluation.result import STUCK, EpisodeResult
from hazard_ms.scenes.files import read_scenes
from hazard_ms.scenes.reach import reachable
from hazard_ms.skills.decision import EXPLORE, WALK_TO
from hazard_ms.skills.failures import NO_PATH
from hazard_ms.spec.checks import one_of
from hazard_ms.spec.registry.robots import robot_class
from results.tables import COMMAND, HERE, evaluate, machine, results_in, value_of, words

RAW = HERE.parent / "build" / "original"
PLACES = {"fire": "indoor", "flood": "indoor", "wind": "outdoor"}
SCENES, ROBOT = 25, "fetch"
AGENTS = ("paper/mcts", "paper/mcts:value=false", "paper/rule", "random", "paper/greedy", "greedy", "planner")
# Value in fire, flood and wind, without perception: Zhou et al. 2024, docs/benchmark.md section 4.1
PAPER = {
    "paper/mcts": (75.9, 43.7, 18.0),
    "paper/rule": (53.1, 27.3, 0.0),
    "random": (43.8, 28.1, 7.1),
    "paper/greedy": (35.4, 18.5, 0.2),
}
HEAD = """# The original's scenes

Made by `./run python results/original.py FOLDER`: of the scenes that the original published, every third room and every
third street, 25 of each, imported with `hazard-ms scenes import`; preset `shipped`, Fetch, one episode each. Values are
in percent, with 95 % bootstrap intervals over scenes. "Reachable": the same Value, counted on targets that the robot
can get at (`hazard-ms scenes reach`) alone. "No path": of the walks to such targets, those that failed since there
was no path; a walk that is asked for again from the same place is the same walk. "Stuck": episodes that ended early,
after 100 decisions in a row that took no time: walks to where there is no path and pick-ups of what cannot be reached,
which an agent asks for again and again. The paper's Value is that of its own test scenes, in its simulator, with a
person as the agent. Tasks and agents without a row were not played. Written at
{machine}.

| task | agent | Value | reachable | Step | Damage | no path | stuck | the paper's Value | episodes |
|---|---|---|---|---|---|---|---|---|---|
"""


def bring(folder: Path) -> None:
    """Import every third scene of the original's `folder`, unless they are there. Raises ValueError without them."""
    for place in sorted(set(PLACES.values())):
        scenes = sorted(path for path in (folder / place).glob("*") if path.is_dir())
        if len(scenes) < 3 * SCENES:
            raise ValueError(f"FOLDER must hold at least {3 * SCENES} scenes in {place}, got {len(scenes)} in {folder}")
        if not (RAW / place).is_dir():
            chosen = map(str, scenes[: 3 * SCENES : 3])
            subprocess.run([*COMMAND, "scenes", "import", *chosen, "-o", str(RAW / place)], check=True)


def play(task: str) -> None:
    """Play what is missing of a task."""
    options = ["--scenes", str(RAW / PLACES[task]), "--physics", "shipped", "-r", ROBOT]
    evaluate(task, RAW / task, *options, "--agents", *AGENTS, check=False)


def at_reach(place: str) -> dict[str, frozenset[str]]:
    """Names of the targets that the robot can get at in each scene of a place."""
    build = robot_class(ROBOT).build
    return {name: frozenset(reachable(spec, build)) for name, spec in read_scenes(RAW / place).items()}


def row(task: str, agent: str, results: Sequence[EpisodeResult], reach: dict[str, frozenset[str]]) -> str:
    """The row of an agent in a task."""
    every = scores([result.tally for result in results])
    fates = [[fate for fate in r.targets if fate.name in reach[r.scene]] for r in results]
    got = scores([Tally.of(each) for each in fates if each])["value"]
    walks = [reason for result in results for reason in _walks(result, reach[result.scene])]
    lost = walks.count(NO_PATH)
    step, damage = every["step"].mean, every["damage"].mean
    cells = [words(value_of(results)), words(got), "-" if step is None else f"{step:.0f}"]
    cells += ["-" if damage is None or task == "wind" else f"{100 * damage:.1f}", f"{lost} of {len(walks)}"]
    cells.append(str(sum(r.ended == STUCK for r in results)))
    told = PAPER.get(agent)
    cells += [str(told[list(PLACES).index(task)]) if told else "-", str(len(results))]
    return f"| {task} | {agent} | {' | '.join(cells)} |\n"


def _walks(result: EpisodeResult, reach: frozenset[str]) -> list[str]:
    """How the walks to targets in `reach` ended; one that is asked for again from the same place is the same walk."""
    ended: dict[tuple[str, int], str] = {}
    moves = 0
    for decision in result.decisions:
        if decision.verb == WALK_TO and decision.target in reach:
            ended[decision.target, moves] = decision.reason
        moves += decision.frames > 0 and decision.verb != EXPLORE
    return list(ended.values())


def page() -> str:
    """Rows of all agents, and the differences between those that the paper has, paired by episode."""
    rows, apart = "", ""
    for task, place in PLACES.items():
        played = results_in(RAW / task) if (RAW / task).is_dir() else []
        by = {agent: [result for result in played if result.agent == agent] for agent in AGENTS}
        reach = at_reach(place) if played else {}
        rows += "".join(row(task, agent, results, reach) for agent, results in by.items() if results)
        values = {agent: {(r.seed, r.scene): r.tally.value for r in results} for agent, results in by.items()}
        for one, other in itertools.combinations(PAPER, 2):
            if values[one] and values[other]:
                apart += f"- {task}: {one} less {other}: {words(difference(values[one], values[other]))}\n"
    return f"{rows}\nDifferences in Value, paired by episode:\n\n{apart}"


def main(arguments: Sequence[str]) -> None:
    """Play `arguments`: the folder, then tasks, or all. Raises ValueError for an unknown task or a wrong folder."""
    if not arguments:
        raise ValueError("FOLDER must be that of the original's scenes, or `tables`, got nothing")
    tasks = [one_of(task, PLACES, "a task") for task in arguments[1:]] or list(PLACES)
    if arguments[0] != "tables":
        bring(Path(arguments[0]))
        for task in tasks:
            play(task)
    text = HEAD.format(machine=machine()) + page()
    (HERE / "original.md").write_text(text, encoding="utf-8")
    print(text)


if __name__ == "__main__":
    os.environ.setdefault("OMP_NUM_THREADS", "1")
    main(sys.argv[1:])
