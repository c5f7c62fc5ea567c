"""Episodes of agents on the scenes of a split, each in a file of its own, played in several processes.

Episodes whose files are there are not played again, so an interrupted run is resumed by starting it again.
"""

from __future__ import annotations

import multiprocessing
import os
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

from hazard_ms import __version__
from hazard_ms.evaluation.options import EpisodeOptions, SweepOptions
from hazard_ms.evaluation.report import report
from hazard_ms.evaluation.result import EpisodeResult

EPISODES_PER_PROCESS = 8  # after which a process is replaced, so that no leak of memory adds up [ours]
BROKEN = "simulation error"  # how an episode ends whose simulation broke


def evaluate(options: SweepOptions) -> int:
    """Play the missing episodes and print the table. Returns 1 if a simulation broke, else 0.

    Raises ValueError for what cannot be played, and where the folder holds results of another version.
    """
    episodes = options.episode_options()
    options.output.mkdir(parents=True, exist_ok=True)
    _play_all([(e, options.place(e)) for e in episodes if not options.place(e).is_file()], options.workers)
    results = [EpisodeResult.read(options.place(e)) for e in episodes]
    others = {str(r.versions["hazard-ms"]) for r in results} - {__version__}
    if others:
        raise ValueError(
            f"output must hold results of hazard-ms {__version__} only, got {options.output} "
            f"with results of {', '.join(sorted(others))}"
        )
    print(report(options, results))
    return int(any(r.ended == BROKEN for r in results))


def _play_all(jobs: list[tuple[EpisodeOptions, Path]], workers: int) -> None:
    """Play `jobs` in batches, each in new processes; raises BrokenProcessPool if one of them dies."""
    workers = workers or os.cpu_count() or 1
    batch = workers * EPISODES_PER_PROCESS
    for start in range(0, len(jobs), batch):
        with ProcessPoolExecutor(workers, multiprocessing.get_context("spawn")) as pool:
            for done, line in enumerate(pool.map(_play, jobs[start : start + batch]), start + 1):
                print(f"{done}/{len(jobs)} {line}", flush=True)


def _play(job: tuple[EpisodeOptions, Path]) -> str:
    """Play one episode and keep its result; its file appears whole or not at all."""
    from hazard_ms.evaluation.runner import play, summary

    episode, place = job
    result = play(episode)
    draft = place.with_suffix(".part")
    result.write(draft)
    draft.replace(place)
    return summary(result)
