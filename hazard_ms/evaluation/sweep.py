"""Episodes of agents on the scenes of a split, each in a file of its own, played in several processes.

Episodes whose files are there are not played again, so an interrupted run is resumed by starting it again. An agent
that raises, calls sys.exit or kills its process costs that episode alone.
"""

from __future__ import annotations

import multiprocessing
import os
import signal
import threading
import traceback
from collections.abc import Callable, Iterator
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from pathlib import Path
from typing import NamedTuple

from hazard_ms import __version__
from hazard_ms.evaluation.options import EpisodeOptions, SweepOptions
from hazard_ms.evaluation.report import report
from hazard_ms.evaluation.result import BROKEN, DamagedResultError, EpisodeResult
from hazard_ms.machine.files import make_folder

EPISODES_PER_PROCESS = 8  # after which a process is replaced, so that no leak of memory adds up [ours]
LONGEST_ERROR = 300  # characters of an agent's error that are shown [ours]

Job = tuple[EpisodeOptions, Path]


class Outcome(NamedTuple):
    """The line that says how an episode went, or which error kept it from having a result."""

    line: str
    failed: bool = False


def evaluate(options: SweepOptions) -> int:
    """Play the missing episodes and print the table. Returns 1 if a simulation broke or an episode failed, else 0.

    Files that hold no whole result are named, and their episodes played again. Raises ValueError for what cannot be
    played, where the folder holds results of another version, and where a result cannot be written.
    """
    from hazard_ms.agents.base import check_name  # loads torch

    episodes = options.episode_options()
    for agent in options.agents:
        check_name(agent)
    make_folder(options.output)
    found = {e: result for e in episodes if (result := _kept(options.place(e))) is not None}
    others = {str(r.versions.get("hazard-ms")) for r in found.values()} - {__version__}
    if others:
        raise ValueError(
            f"output must hold results of hazard-ms {__version__} only, got {options.output} "
            f"with results of {', '.join(sorted(others))}"
        )
    failed = _play_all([(e, options.place(e)) for e in episodes if e not in found], options.workers)
    results = [found.get(e) or EpisodeResult.read(options.place(e)) for e in episodes if e not in failed]
    print(report(options, results, [e.agent for e in failed]))
    for episode, line in failed.items():
        print(f"no result: {line}; to see it again: {episode.command}")
    return int(bool(failed) or any(r.ended == BROKEN for r in results))


def _kept(place: Path) -> EpisodeResult | None:
    """The result that an earlier run left in a file, None where there is none or only a part."""
    try:
        return EpisodeResult.read(place) if place.exists() else None
    except DamagedResultError as damaged:
        print(f"{damaged}: its episode is played again", flush=True)
        return None


def _play_all(jobs: list[Job], workers: int) -> dict[EpisodeOptions, str]:
    """Play `jobs` in batches, each in new processes. Returns those that have no result, with their errors."""
    workers, failed, done = workers or os.cpu_count() or 1, {}, 0

    def tell(job: Job, outcome: Outcome) -> None:
        nonlocal done
        done += 1
        if outcome.failed:
            failed[job[0]] = outcome.line
        print(f"{done}/{len(jobs)} {outcome.line}", flush=True)

    batch = workers * EPISODES_PER_PROCESS
    for start in range(0, len(jobs), batch):
        _play_batch(jobs[start : start + batch], workers, tell)
    return failed


def _play_batch(jobs: list[Job], workers: int, tell: Callable[[Job, Outcome], None]) -> None:
    """Play `jobs`. If a process dies, it is not known which one it played: then what is left gets one process each."""
    left = []
    with _pool(workers) as pool:
        waiting = {pool.submit(_play, job): job for job in jobs}
        for future in as_completed(waiting):
            try:
                tell(waiting[future], future.result())
            except BrokenProcessPool:
                left.append(waiting[future])
    with ThreadPoolExecutor(workers) as threads:
        for job, outcome in zip(left, threads.map(_play_alone, left), strict=True):
            tell(job, outcome)


def _play_alone(job: Job) -> Outcome:
    """Play one episode in a process of its own, which may die."""
    try:
        with _pool(1) as pool:
            return pool.submit(_play, job).result()
    except BrokenProcessPool:
        return Outcome(f"{_name(job[0])}: its process ended, killed or by os._exit", failed=True)


@contextmanager
def _pool(workers: int) -> Iterator[ProcessPoolExecutor]:
    """Processes that end with this one, and at once where the block raises."""
    pool = ProcessPoolExecutor(workers, multiprocessing.get_context("spawn"), initializer=_prepare)
    try:
        yield pool
    except BrokenProcessPool:
        raise
    except BaseException:  # Ctrl-C, or a disk that is full
        for process in multiprocessing.active_children():
            process.kill()
        raise
    finally:
        pool.shutdown(cancel_futures=True)


def _prepare() -> None:
    """Let this process end when the one that started it is gone; Ctrl-C is for that one."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    threading.Thread(target=_end_with_parent, daemon=True).start()


def _end_with_parent() -> None:
    parent = multiprocessing.parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)


def _play(job: Job) -> Outcome:
    """Play one episode and keep its result. Raises ValueError where that cannot be written."""
    from hazard_ms.evaluation.runner import play, summary

    episode, place = job
    try:
        result = play(episode)
    except BaseException as error:  # whatever an agent raises, sys.exit included, costs only its episode
        return Outcome(f"{_name(episode)}: {_told(error)}", failed=True)
    result.write(place)
    return Outcome(summary(result))


def _name(episode: EpisodeOptions) -> str:
    return f"{episode.agent}, seed {episode.seed}"


def _told(error: BaseException) -> str:
    """An error in one line, with the place in the code where it was raised."""
    calls = traceback.extract_tb((error.__cause__ or error).__traceback__)
    where = f" ({Path(calls[-1].filename).name}, line {calls[-1].lineno})" if calls else ""
    text = "".join(c if c.isprintable() else " " for c in f"{type(error).__name__}: {error}")
    return f"{text[:LONGEST_ERROR]}{where}"
