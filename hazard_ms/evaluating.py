"""`hazard-ms evaluate`: agents on the scenes of a split, each episode in its own file, and the table of scores with 95 % intervals.

Episodes run in processes of their own, several at a time. What is there already is not played again, so a broken run goes on where
it stopped.
"""

from __future__ import annotations

import multiprocessing
import os
import sys
from collections import Counter
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

from hazard_ms import __version__
from hazard_ms.evaluating_order import Evaluation
from hazard_ms.evaluation.metrics import Score, scores
from hazard_ms.evaluation.result import EpisodeResult, machine, versions
from hazard_ms.order import Order

EPISODES_PER_PROCESS = 8  # then a new one: whatever leaks goes with it


def evaluate(evaluation: Evaluation) -> int:
    """Play what is not there yet, then print the table. Ends with 1 if a simulation broke."""
    orders = evaluation.orders()
    evaluation.out.mkdir(parents=True, exist_ok=True)
    left = [(o, evaluation.place(o)) for o in orders if not evaluation.place(o).is_file()]
    workers = evaluation.workers or os.cpu_count() or 1
    if os.getcwd() not in sys.path:
        sys.path.insert(0, os.getcwd())  # where a user's own agent is; worker processes inherit it
    batch = workers * EPISODES_PER_PROCESS
    for start in range(0, len(left), batch):
        with ProcessPoolExecutor(workers, multiprocessing.get_context("spawn")) as pool:  # raises BrokenProcessPool if one dies
            for done, line in enumerate(pool.map(_play, left[start : start + batch]), start + 1):
                print(f"{done}/{len(left)} {line}", flush=True)
    results = [EpisodeResult.read(evaluation.place(o)) for o in orders]
    other = {str(r.versions["hazard-ms"]) for r in results} - {__version__}
    if other:
        raise ValueError(f"{evaluation.out} holds results of hazard-ms {', '.join(sorted(other))}; give another folder to {__version__}")
    print(report(evaluation, results))
    return int(any(r.ended == "simulation error" for r in results))


def _play(job: tuple[Order, Path]) -> str:
    """Play one episode and keep its result; its file appears whole or not at all."""
    from hazard_ms.play import play, summary

    order, place = job
    result = play(order, quiet=True)
    draft = place.with_suffix(".part")
    result.write(draft)
    draft.replace(place)
    return summary(result)


def report(evaluation: Evaluation, results: list[EpisodeResult]) -> str:
    """The table of scores, why episodes ended, and which actions failed why."""
    e = evaluation
    what = ", ".join(
        [e.env_id, *e.hazards, f"split {e.split}", f"physics {e.physics}", f"robot {e.robot}"] + ["agent affected"] * e.affects_agent
    )
    lines = [f"{what}, {e.episodes} episodes each, seeds from {e.first}"]
    lines.append(f"{'agent':16s} {'Value':>22s} {'Step':>26s} {'Damage':>22s} {'rescued':>8s} {'s/episode':>10s}")
    for agent in e.agents:
        own = [r for r in results if r.agent == agent]
        found = scores([r.tally for r in own])
        saved = sum(r.tally.rescued for r in own)
        seconds = sum(r.wall_seconds for r in own) / len(own)
        lines.append(
            f"{agent:16s} {_shown(found['value'], 100):>22s} {_shown(found['step']):>26s} {_shown(found['damage'], 100):>22s} "
            f"{saved:4d}/{sum(len(r.targets) for r in own):<4d} {seconds:9.1f}"
        )
    for agent in e.agents:
        own = [r for r in results if r.agent == agent]
        ends = Counter(r.ended for r in own)
        failures = Counter(f"{d.verb} {d.reason}" for r in own for d in r.decisions if not d.ok)
        lines.append(f"{agent}: ended by {_counted(ends)}; failures: {_counted(failures) or 'none'}")
    lines.append(", ".join(f"{k} {v}" for k, v in {**versions(), **machine()}.items()))
    return "\n".join(lines)


def _shown(score: Score, factor: float = 1.0) -> str:
    if score.mean is None or score.low is None or score.high is None:
        return "-"
    return f"{factor * score.mean:.1f} [{factor * score.low:.1f}, {factor * score.high:.1f}]"


def _counted(counter: Counter[str]) -> str:
    return ", ".join(f"{n} {what}" for what, n in counter.most_common())
