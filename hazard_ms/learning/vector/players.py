"""The processes of a vector environment, seen from the one that asks them. One that dies or hangs is noticed.

A process hangs if it neither answers nor does anything. One that computes is given `patience`, because the first
picture or a new kernel may take it a minute.
"""

from __future__ import annotations

import contextlib
import multiprocessing
import selectors
import signal
import time
from collections.abc import Mapping, Sequence
from typing import Any

from gymnasium.vector import AutoresetMode

from hazard_ms.learning.vector.board import NONE, Board, make_file
from hazard_ms.learning.vector.playing import Failure, Share, Spaces, serve
from hazard_ms.machine.activity import Activity
from hazard_ms.machine.cores import cores
from hazard_ms.machine.processes import few_threads, without_keys

START = 900.0  # longest time to make environments: on a crowded machine, importing all takes minutes [s] [ours]
LOOK = 0.25  # time between two looks at whether processes are at work [s] [ours]
STILL = 3.5  # time without any work after which a process counts as hanging [s] [ours]
GOODBYE = 3.0  # time that processes have to end by themselves [s] [ours]
GUARD = "; a program must start its work under `if __name__ == '__main__':`, because its processes import it again"


class LostEnvironmentError(RuntimeError):
    """An environment is lost, because its process died or hangs. The vector environment has closed itself."""

    def __init__(self, numbers: Sequence[int], why: str) -> None:
        """Name the environments that are lost, the one that was being played first, and say `why`."""
        others = ", ".join(map(str, numbers[1:]))
        super().__init__(f"environment {numbers[0]} is lost{f', and with it {others}' if others else ''}: {why}")
        self.numbers = tuple(numbers)


class Process:
    """One process and the environments that it plays."""

    def __init__(self, share: Share, threads: int) -> None:
        """Start it; its renderer draws with this many `threads`, and all else is computed with one."""
        context = multiprocessing.get_context("spawn")
        self.connection, theirs = context.Pipe()
        self.numbers, self.index = share.numbers, share.process
        self._process = context.Process(target=serve, args=(theirs, share), daemon=True)
        self._activity: Activity | None = None
        try:
            with few_threads(threads), without_keys():
                self._process.start()
        finally:
            theirs.close()

    def send(self, ticket: int, name: str, *details: Any) -> None:
        """Ask it for something; the answer will come with the same `ticket`."""
        self._activity = None
        with contextlib.suppress(BrokenPipeError, ConnectionResetError):  # it has died: `gather` will notice
            self.connection.send((ticket, name, *details))

    def idle_seconds(self) -> float:
        """Time for which it has done nothing, since the first look after it was asked [s]."""
        self._activity = self._activity or Activity(self.pid)
        return self._activity.idle_seconds()

    @property
    def pid(self) -> int:
        """The number that the system gave it."""
        return self._process.pid or 0

    def death(self) -> str:
        """The way in which it died, in words."""
        self._process.join(1.0)
        code = self._process.exitcode
        if code is None:
            return f"its process {self.pid} no longer answers"
        how = f"was ended by {signal.Signals(-code).name}" if code < 0 else f"ended by itself with code {code}"
        return f"its process {self.pid} {how}"

    def end(self, until: float) -> None:
        """Let it end by itself until that time of the monotonic clock, and then kill it."""
        if self._process.pid is not None:
            self._process.join(max(0.0, until - time.monotonic()))
            if self._process.exitcode is None:
                self._process.kill()
                self._process.join(GOODBYE)


class Processes:
    """All processes of a vector environment."""

    def __init__(
        self, env_id: str, num_envs: int, count: int, keywords: Mapping[str, Any], autoreset: AutoresetMode
    ) -> None:
        """Start `count` processes, among which `num_envs` environments are dealt out evenly and in order.

        Raises what making an environment raises, and LostEnvironmentError for a process that dies or takes too long.
        """
        ends = [num_envs * k // count for k in range(count + 1)]
        self._ticket, self._all = 0, list[Process]()
        self._board: Board | None = None
        self._selector = selectors.DefaultSelector()
        try:
            for k in range(count):
                share = Share(k, range(ends[k], ends[k + 1]), env_id, keywords, autoreset)
                self._all.append(Process(share, max(1, cores() // count)))
                self._selector.register(self._all[k].connection, selectors.EVENT_READ, self._all[k])
            answers = self._gather(self._all, START, start=True)
            self.spaces: Spaces = answers[0]
            self._share_board(num_envs)
        except BaseException:
            self.end(at_once=True)
            raise

    def _share_board(self, num_envs: int) -> None:
        space, count = self.spaces.observation, len(self._all)
        path = make_file(space, num_envs, count)
        try:
            self._board = Board(path, space, num_envs, count)
            self.ask("share", [(path, space, num_envs, count)] * count, START)
        finally:
            path.unlink()

    def seen(self) -> Any:
        """A copy of what is seen in all environments, [N, ...]."""
        assert self._board is not None
        return self._board.read()

    def spread(self, each: Any) -> list[tuple[Any]]:
        """The details for each process, from what is said of `each` environment, [N]."""
        return [(each[p.numbers.start : p.numbers.stop],) for p in self._all]

    def ask(self, name: str, details: Sequence[tuple[Any, ...] | None], patience: float) -> list[Any]:
        """Ask each process for `name` with its `details`, none where they are None: the answers, [P].

        Raises the first error that an environment raised, when all have answered, and LostEnvironmentError.
        """
        self._ticket += 1
        asked = [p for p, detail in zip(self._all, details, strict=True) if detail is not None]
        for process in asked:
            process.send(self._ticket, name, *(details[process.index] or ()))
        answers = self._gather(asked, patience)
        for answer in answers.values():
            _raise_if_failed(answer)
        return [answers.get(p.index) for p in self._all]

    def _gather(self, asked: Sequence[Process], patience: float, start: bool = False) -> dict[int, Any]:
        """The answers of processes, by their number, without those to earlier questions that were broken off."""
        waiting, answers = {p.index: p for p in asked}, dict[int, Any]()
        end = time.monotonic() + patience
        while waiting:
            ready = self._selector.select(LOOK)
            for key, _ in ready:
                process: Process = key.data
                try:
                    ticket, answer = process.connection.recv()
                except (EOFError, OSError):
                    self._lose(process, process.death() + GUARD * start)
                if ticket == self._ticket:
                    answers[process.index] = answer
                    del waiting[process.index]
                    if start:
                        _raise_if_failed(answer)
            for process in waiting.values() if not ready else ():
                if not start and process.idle_seconds() > STILL:
                    self._lose(process, f"its process {process.pid} hangs: it does nothing, and gives no answer")
                if time.monotonic() > end:
                    self._lose(process, f"its process {process.pid} took longer than {patience:g} s")
        return answers

    def _lose(self, process: Process, why: str) -> None:
        """Close all, because a process is lost. Raises LostEnvironmentError."""
        numbers = [*process.numbers]
        busy = NONE if self._board is None else int(self._board.busy[process.index])
        if busy in numbers:
            numbers = [busy, *(n for n in numbers if n != busy)]
        self.end(at_once=True)
        raise LostEnvironmentError(numbers, why)

    def end(self, at_once: bool = False) -> None:
        """Let all processes end, or kill them `at_once`; those that do not end by themselves are killed, too."""
        self._selector.close()
        for process in self._all:
            process.connection.close()  # they end when nobody can ask them any more
        until = time.monotonic() + (0.0 if at_once else GOODBYE)
        for process in self._all:
            process.end(until)
        self._all.clear()

    @property
    def pids(self) -> tuple[int, ...]:
        """The numbers that the system gave to the processes."""
        return tuple(process.pid for process in self._all)

    @property
    def ended(self) -> bool:
        """Whether there are no processes any more."""
        return not self._all


def _raise_if_failed(answer: Any) -> None:
    if isinstance(answer, Failure):
        raise answer.error from RuntimeError(f"in environment {answer.number}:\n{answer.trace}")
