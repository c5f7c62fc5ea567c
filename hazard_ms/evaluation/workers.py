"""Processes that play one episode after another: one that dies or hangs is replaced, and costs its episode alone.

A worker tells before each decision what the episode has come to, and after it that the agent has answered. So it is
known what takes so long, and what to score if nothing more comes.
"""

from __future__ import annotations

import contextlib
import multiprocessing
import os
import signal
import sys
import time
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, replace
from multiprocessing.connection import Connection, wait
from typing import NamedTuple

from hazard_ms.evaluation.options import EpisodeOptions
from hazard_ms.evaluation.result import DIED, TOO_SLOW, EpisodeResult
from hazard_ms.machine.processes import end_with_parent, needs_key, without_keys

LIFETIME = 40  # episodes, after which a process is replaced: each leaves it 10 to 25 MB larger [measured]
START = 900.0  # longest time until the first decision; where kernels are new, they are compiled [s] [ours]
SILENCE = 600.0  # longest time between two decisions, some 100 frames: minutes on a crowded machine [s] [ours]
GOODBYE = 10.0  # time that a process has to end by itself [s] [ours]


@dataclass(frozen=True)
class Job:
    """An episode to play: by its agent, or again with the `actions` (verb, target) of an earlier run.

    `waits`: the frames that passed before each of these; `averted`: whether to tell what is lost, and the loads;
    `robots`: of a team, which took each of the actions.
    """

    options: EpisodeOptions
    decision_seconds: float  # wall time that the agent has for a decision
    actions: tuple[tuple[str, str | None], ...] | None = None
    waits: tuple[int, ...] = ()
    averted: bool = False
    robots: tuple[str, ...] = ()


class Outcome(NamedTuple):
    """The result of a job, None where it failed before the first decision."""

    result: EpisodeResult | None
    error: str = ""  # why it failed, if it did
    died: bool = False  # with the process that played it
    attempts: int = 1  # more than one where a process died


class Word(NamedTuple):
    """A message of a worker while it plays: before each decision the episode `so_far`, after it None."""

    so_far: EpisodeResult | None


Say = Callable[[Word], None]
Attempt = Callable[[Job, Say], Outcome]


class Worker:
    """One process, started when it is needed, that calls `attempt` for one job at a time."""

    def __init__(self, attempt: Attempt) -> None:
        self._attempt = attempt
        self._process: multiprocessing.process.BaseProcess | None = None
        self._connection: Connection
        self._played = 0
        self._keyed = False  # whether the process has the key for models

    def begin(self, job: Job) -> None:
        """Begin with a job."""
        keyed = needs_key(job.options.agent, job.options.load)
        if self._played >= LIFETIME or keyed != self._keyed:
            self.end()
        if self._process is None:
            self._start(keyed)
        self._job, self._so_far, self._asked, self._played = job, None, False, self._played + 1
        self._deadline = time.monotonic() + START
        with contextlib.suppress(OSError):  # it has died: `outcome` will say so
            self._connection.send(job)

    def _start(self, keyed: bool) -> None:
        context = multiprocessing.get_context("spawn")
        self._connection, theirs = context.Pipe()
        self._process = context.Process(target=_serve, args=(theirs, self._attempt))
        with _one_thread(), without_keys(needed=keyed):
            self._process.start()
        theirs.close()
        self._played, self._keyed = 0, keyed

    @property
    def signs(self) -> list[Connection | int]:
        """Objects for `multiprocessing.connection.wait`: one of them becomes ready when there is news."""
        assert self._process is not None
        return [self._connection, self._process.sentinel]

    @property
    def patience(self) -> float:
        """Time until the process counts as hanging [s]."""
        return max(0.0, self._deadline - time.monotonic())

    def outcome(self) -> Outcome | None:
        """The outcome of the job, None while it is under way."""
        assert self._process is not None
        alive = self._process.is_alive()
        try:
            while self._connection.poll():
                news = self._connection.recv()
                if isinstance(news, Outcome):
                    return news
                self._asked, self._so_far = news.so_far is not None, news.so_far or self._so_far
                limit = self._job.decision_seconds if self._asked else SILENCE
                self._deadline = time.monotonic() + limit
        except (EOFError, OSError):
            alive = False
        if alive and self.patience:
            return None
        if alive and self._asked:
            return self._lost(TOO_SLOW, f"a decision took longer than {self._job.decision_seconds:g} s")
        return self._lost(DIED, "it said nothing for too long" if alive else "killed or by os._exit")

    def _lost(self, ended: str, why: str) -> Outcome:
        """Give the process up. The outcome is what the episode had come to at the last decision."""
        self.end(now=True)
        error = f"{ended}: {why}"
        return Outcome(self._so_far and replace(self._so_far, ended=ended, error=error), error, died=ended == DIED)

    def end(self, now: bool = False) -> None:
        """End the process, at once or when it has cleaned up."""
        if self._process is not None:
            self._connection.close()
            if not now:
                self._process.join(GOODBYE)
            self._process.kill()
            self._process.join()
            self._process = None


class Crew:
    """A number of workers; they stay until `end`."""

    def __init__(self, workers: int, attempt: Attempt) -> None:
        self._workers = [Worker(attempt) for _ in range(workers)]

    def play(self, jobs: Iterable[Job]) -> Iterator[tuple[Job, Outcome]]:
        """Play `jobs` in any order. Those whose process dies are played once more."""
        waiting = deque((job, 1) for job in jobs)
        idle, busy = list(self._workers), dict[Worker, tuple[Job, int]]()
        while waiting or busy:
            while waiting and idle:
                worker = idle.pop()
                busy[worker] = waiting.popleft()
                worker.begin(busy[worker][0])
            wait([sign for worker in busy for sign in worker.signs], min(worker.patience for worker in busy))
            for worker, (job, attempt) in list(busy.items()):
                outcome = worker.outcome()
                if outcome is None:
                    continue
                del busy[worker]
                idle.append(worker)
                if attempt == 1 and outcome.died:
                    waiting.append((job, 2))
                else:
                    yield job, outcome._replace(attempts=attempt)

    def end(self, now: bool = False) -> None:
        """End all processes, at once or when they have cleaned up."""
        for worker in self._workers:
            worker.end(now)


@contextlib.contextmanager
def ending(end: Callable[[bool], None]) -> Iterator[None]:
    """Call `end` of a crew after the block, and with True, at once, where an error, such as Ctrl-C, ends that."""
    try:
        yield
    except BaseException:
        end(True)
        raise
    end(False)


@contextlib.contextmanager
def _one_thread() -> Iterator[None]:
    """Let processes that are started meanwhile compute with one thread each: several would get in each other's way."""
    before = os.environ.get("OMP_NUM_THREADS")
    os.environ["OMP_NUM_THREADS"] = "1"
    try:
        yield
    finally:
        if before is None:
            del os.environ["OMP_NUM_THREADS"]
        else:
            os.environ["OMP_NUM_THREADS"] = before


def _serve(connection: Connection, attempt: Attempt) -> None:
    """Do jobs until nobody gives any. Ctrl-C is for the process that started this one."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    end_with_parent()
    with contextlib.suppress(EOFError, OSError):
        while True:
            connection.send(attempt(connection.recv(), connection.send))
            sys.stdout.flush()
