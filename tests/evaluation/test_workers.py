"""Workers: what dies or hangs costs its job alone, what dies is tried once more, and processes serve many jobs."""

from __future__ import annotations

import multiprocessing
import os
from collections.abc import Iterator
from multiprocessing import forkserver
from pathlib import Path

import pytest

from hazard_ms.evaluation import workers
from hazard_ms.evaluation.workers import Crew, Job, Outcome, ending
from tests.worlds.jobs import DIES, DIES_ONCE, HANGS_ASKED, HANGS_BETWEEN, HOUR, WELL, attempt, job


@pytest.fixture(scope="module")
def quick_starts() -> Iterator[type[multiprocessing.process.BaseProcess]]:
    """Processes are copies of one that has imported everything, which takes a new one seconds. Their class."""
    context = multiprocessing.get_context("forkserver")
    context.set_forkserver_preload(["tests.worlds.jobs"])
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(workers.multiprocessing, "get_context", lambda method: context)
        yield context.Process
    forkserver._forkserver._stop()  # type: ignore[attr-defined]


def played(jobs: list[Job], count: int) -> dict[int, Outcome]:
    """Outcomes by seed; no process is left."""
    crew = Crew(count, attempt)
    with ending(crew.end):
        made = [(job.options.seed, outcome) for job, outcome in crew.play(jobs)]
        assert len(multiprocessing.active_children()) <= count
    assert not multiprocessing.active_children()
    assert len(made) == len(dict(made)), "one outcome for each job"
    return dict(made)


def test_what_dies_or_hangs_costs_its_job_alone(tmp_path: Path, quick_starts: object) -> None:
    """The limits of jobs that do not hang are an hour, so a slow machine changes nothing."""
    seeds = [WELL, DIES, 5, DIES_ONCE, HANGS_ASKED, 10]
    found = played([job(s, tmp_path, 0.5 if s == HANGS_ASKED else HOUR) for s in seeds], 2)
    assert sorted(found) == sorted(seeds)
    for seed in (WELL, 5, 10, DIES_ONCE):
        result = found[seed].result
        assert result is not None and result.ended == "time" and result.frames == 1500
        assert found[seed].attempts == (2 if seed == DIES_ONCE else 1)
    dead, slow = found[DIES].result, found[HANGS_ASKED].result
    assert dead is not None and (dead.ended, dead.frames, found[DIES].attempts) == ("worker died", 100, 2)
    assert slow is not None and (slow.ended, slow.frames, found[HANGS_ASKED].attempts) == ("too slow", 100, 1)
    assert dead.error == found[DIES].error == "worker died: killed or by os._exit"
    assert slow.error == found[HANGS_ASKED].error == "too slow: a decision took longer than 0.5 s"


def test_a_process_that_hangs_between_decisions_is_taken_for_dead(
    tmp_path: Path, quick_starts: object, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(workers, "SILENCE", 0.5)
    (found,) = played([job(HANGS_BETWEEN, tmp_path)], 1).values()
    assert found.result is not None and found.result.ended == "worker died" and found.attempts == 2
    assert found.error == "worker died: it said nothing for too long"


def test_a_process_with_one_thread_serves_many_jobs_and_is_then_replaced(
    tmp_path: Path, quick_starts: type[multiprocessing.process.BaseProcess], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(workers, "LIFETIME", 2)
    monkeypatch.setenv("OMP_NUM_THREADS", "7")
    start, threads = quick_starts.start, list[str]()

    def started(process: multiprocessing.process.BaseProcess) -> None:
        threads.append(os.environ["OMP_NUM_THREADS"])  # in what a new process inherits
        start(process)

    monkeypatch.setattr(quick_starts, "start", started)
    crew = Crew(1, attempt)
    with ending(crew.end):
        processes = [outcome.error for _, outcome in crew.play([job(5 * k, tmp_path) for k in range(3)])]
    assert [processes.count(p) for p in dict.fromkeys(processes)] == [2, 1]
    assert threads == ["1", "1"]
    assert os.environ["OMP_NUM_THREADS"] == "7", "this process keeps its own"
