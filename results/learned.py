"""Trains policies and scores them in the simulator: `./run python results/learned.py [KIND-TASK-SEED...]`.

Names are such as rl-fire-0; without names it makes all of KINDS, TASKS and SEEDS. Each policy learns in the sketch, by
the command that learned.md names, and plays the 25 scenes of its task's split `test`, `bc` up to three times, as do
`greedy` and `planner`. It resumes where it stopped, and writes learned.md, where rows of policies made elsewhere stay,
and the curves in rl/. With `tables` alone it makes nothing.
"""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

from hazard_ms.evaluation.comparison.pairing import Episode, difference
from hazard_ms.spec.checks import one_of
from results.tables import COMMAND, HERE, TASKS, evaluate, machine, results_in, value_of, words

RAW = HERE.parent / "build" / "learned"
PLAIN = RAW / "plain"  # where the agents play that policies are compared with
SHIPPED = HERE.parent / "hazard_ms" / "agents" / "weights"
KINDS = {"rl": ["ppo"], "bc": ["bc"], "rl_paper": ["ppo", "--actions", "paper"]}
SEEDS = (0, 1, 2)
# scenes of flood and wind take longer to make: half a million decisions in fewer of them is what an hour allows
SCENES = {"fire": 225, "flood": 150, "wind": 60}
FEWER = {"fire": 225, "flood": 225, "wind": 80}  # of `bc`, which learns in a few minutes: much of its time is scenes
ONCE = 25  # episodes: each scene of `test`
OFTEN = {"fire": 75, "flood": 75, "wind": ONCE}  # of `bc`, which differs from `greedy` by less than ONCE can tell
DECISIONS = {"fire": 1_000_000, "flood": 600_000, "wind": 500_000}
SIX_DECISIONS = 100_000  # of rl_paper, as of the original; its updates take ten times as long
LONGEST = 600  # of a training: machines that do other things, too, must not change what it learns [min]
HEAD = """# Learned policies

Made by `./run python results/learned.py`. Each policy learned in the sketch, in scenes that belong to no split, and
then played the 25 scenes of its task's split `test` in the simulator, once or three times. Values are in percent, with
95 % bootstrap intervals over scenes, differences paired by episode. "Sketch" is the mean Value in 24 scenes of the
sketch that chose the best moment of the training, beside that of `greedy` in the same scenes. Policies `rl` and
`rl_paper` learned before landmarks in the sketch were as in the simulator. The package brings the policies in bold: of
each task and kind the one that is best in the sketch. A dash: not played. `rl_paper` learned from the paper's six
actions, map and reward; the paper's own learner has a Value of 46.1 in fire, 35.0 in flood and 12.4 in wind, in the
original's simulator (docs/benchmark.md, section 4.1). Written at {machine}.

| policy | seed | sketch | `greedy` there | Value | less `greedy` | less `planner` | share of `planner` | episodes |
|---|---|---|---|---|---|---|---|---|
"""


def weights(name: str) -> Path:
    """The file of the policy called `name`."""
    kind, task, _ = name.split("-")
    return RAW / name / f"{kind}_{TASKS[task]}.safetensors"


def make(name: str) -> None:
    """Train and score a policy, as far as that is missing."""
    kind, task, seed = name.split("-")
    scenes = (FEWER if kind == "bc" else SCENES)[task]
    options = [*KINDS[kind], "-e", TASKS[task], "-o", str(RAW / name), "--seed", seed, "--scenes", str(scenes)]
    decisions = 0 if kind == "bc" else SIX_DECISIONS if kind == "rl_paper" else DECISIONS[task]
    if decisions:
        options += ["--decisions", str(decisions), "--minutes", str(LONGEST)]
    if not weights(name).exists() or learnt_from(name) < decisions:
        subprocess.run([*COMMAND, "train", *options], check=True)
    count = ("--episodes", str(OFTEN[task] if kind == "bc" else ONCE))
    evaluate(task, RAW / name, *count, "--agents", f"{kind}:weights={weights(name)}")
    evaluate(task, PLAIN / task, *count, "--agents", "greedy", "planner")


def learnt_from(name: str) -> float:
    """The decisions that a policy has learnt from so far; 0 without a curve, as after behaviour cloning."""
    made = weights(name).with_suffix(".csv")
    return float(made.read_text(encoding="utf-8").splitlines()[-1].split(",")[0]) if made.exists() else 0.0


def values(folder: Path, agent: str) -> dict[Episode, float]:
    """The Value of each episode of an agent that was played."""
    return {(r.seed, r.scene): r.tally.value for r in results_in(folder) if r.agent.partition(":")[0] == agent}


def sketched(name: str) -> tuple[float, float]:
    """The mean Value of a policy in the sketch's validation scenes, and that of `greedy` there."""
    told = json.loads(weights(name).with_suffix(".json").read_text(encoding="utf-8"))
    if "rounds" in told:
        best = max(told["rounds"], key=lambda each: each["student"])
        return best["student"], best["greedy"]
    return told["best"]["validation"], told["best"]["greedy"]


def row(name: str) -> str:
    """The row of a policy; empty if it was not trained."""
    kind, task, seed = name.split("-")
    results = results_in(RAW / name)
    if not weights(name).exists():
        return ""
    own, plain = values(RAW / name, kind), PLAIN / task
    greedy, planner = values(plain, "greedy"), values(plain, "planner")
    common = set(own) & set(planner)
    share = sum(own[e] for e in common) / max(sum(planner[e] for e in common), 1e-9)
    found, there = sketched(name)
    shipped = SHIPPED / weights(name).name
    same = shipped.exists() and shipped.read_bytes() == weights(name).read_bytes()
    cells = [f"{100 * found:.1f}", f"{100 * there:.1f}", *["-"] * 4, "0"]
    if results:
        cells[2:5] = map(words, (value_of(results), difference(own, greedy), difference(own, planner)))
        cells[5:] = f"{share:.0%}", str(len(results))
    title = f"**{task}, {kind}**" if same else f"{task}, {kind}"
    return f"| {title} | {seed} | {' | '.join(cells)} |\n"


def rows(names: list[str]) -> str:
    """The rows of all policies; those that were trained elsewhere stay as they were written there."""
    page = HERE / "learned.md"
    older = {}
    for line in page.read_text(encoding="utf-8").splitlines() if page.exists() else ():
        cells = [cell.strip(" *") for cell in line.split("|")[1:3]]
        if len(cells) == 2 and cells[1].isdigit():
            task, kind = cells[0].split(", ")
            older[f"{kind}-{task}-{cells[1]}"] = f"{line}\n"
    return "".join(row(name) or older.get(name, "") for name in names)


def curve(name: str) -> None:
    """Keep the curve of a training."""
    made = weights(name).with_suffix(".csv")
    if made.exists():
        shutil.copyfile(made, HERE / "rl" / f"{name}.csv")


def main(wanted: list[str]) -> None:
    """Make the policies called `wanted`, or all, and write what there is. Raises ValueError for unknown names."""
    names = [f"{kind}-{task}-{seed}" for kind in KINDS for task in TASKS for seed in SEEDS]
    for name in [] if wanted == ["tables"] else [one_of(each, names, "a policy") for each in wanted] or names:
        make(name)
    for name in names:
        curve(name)
    (HERE / "learned.md").write_text(HEAD.format(machine=machine()) + rows(names), encoding="utf-8")


if __name__ == "__main__":
    os.environ.setdefault("OMP_NUM_THREADS", "1")
    main(sys.argv[1:])
