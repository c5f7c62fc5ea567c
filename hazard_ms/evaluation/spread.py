"""Spreads episodes over processes and machines. Results depend neither on how many there are nor on the order.

`shard`s are for any scheduler: each plays its own part of the episodes, chosen by the names of their files.
"""

from __future__ import annotations

import contextlib
import hashlib
import os
import re
import sys
from collections import deque
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from hazard_ms.evaluation.attempts import attempt as play
from hazard_ms.evaluation.choices import BACKENDS, RAY
from hazard_ms.evaluation.options import MOST_WORKERS
from hazard_ms.evaluation.result import DIED
from hazard_ms.evaluation.workers import Attempt, Crew, Job, Outcome, ending
from hazard_ms.machine.cores import cores
from hazard_ms.machine.processes import needs_key, without_keys
from hazard_ms.spec.checks import one_of, whole

STARTS = 3  # of each actor of ray that may fail [ours]
MOST_SHARDS = 100_000  # [ours]
SCHEDULER = "SLURM_ARRAY_TASK_"  # how the variables of an array job begin


def shard(text: str | None, variables: Mapping[str, str] = os.environ) -> tuple[int, int]:
    """The number of this part, from 1, and of all parts: of `text`, "2/3", else of the scheduler's `variables`.

    Raises ValueError for other texts, and for variables of the scheduler that are not numbers.
    """
    if text is None:
        if f"{SCHEDULER}ID" not in variables:
            return 1, 1
        told = [variables.get(f"{SCHEDULER}{name}", usual) for name, usual in (("ID", ""), ("MIN", "0"), ("STEP", "1"))]
        count = variables.get(f"{SCHEDULER}COUNT", "")
        if not all(word.isdecimal() for word in (*told, count)) or told[2] == "0":
            raise ValueError(f"{SCHEDULER}ID, _MIN, _STEP and _COUNT must be numbers, got {told} and {count!r}")
        task, first, step = map(int, told)
        text = f"{(task - first) // step + 1}/{count}"
    found = re.fullmatch(r"(\d{1,6})/(\d{1,6})", text)
    part, parts = (int(found[1]), int(found[2])) if found else (0, 0)
    if not 1 <= part <= parts <= MOST_SHARDS:
        raise ValueError(f"shard must be i/N with i from 1 to N, such as 2/3, got {text!r}")
    return part, parts


def in_shard(name: str, part: int, parts: int) -> bool:
    """Whether the file `name` belongs to `part`, from 1 to `parts`. Each name belongs to one part, everywhere."""
    return int.from_bytes(hashlib.sha256(name.encode()).digest()[:8], "big") % parts == part - 1


@dataclass(frozen=True)
class Where:
    """The arguments of `spread` that say where jobs are done: 0 workers are one for each core.

    Raises ValueError for a number of workers or a backend that cannot be.
    """

    workers: int = 0
    backend: str = "local"
    address: str | None = None

    def __post_init__(self) -> None:
        """Raise ValueError for what cannot be."""
        whole(self.workers, 0, MOST_WORKERS, "workers")
        one_of(self.backend, BACKENDS, "backend")


@contextlib.contextmanager
def spread(
    jobs: Sequence[Job],
    workers: int,
    backend: str = "local",
    address: str | None = None,
    attempt: Attempt = play,
) -> Iterator[Iterator[tuple[Job, Outcome]]]:
    """Do `jobs` where `backend` says, each by `attempt`, and give it with its outcome as soon as it is there.

    serial: in this process, where an agent that dies or hangs takes it along; local: in `workers` processes; ray: on
    the machines of the ray cluster at `address`, by default this one alone. 0 workers: one for each core. Raises
    ValueError where ray is missing.
    """
    if backend == "serial" or not jobs:
        yield ((job, attempt(job, lambda word: None)) for job in jobs)
        return
    if backend == RAY:
        crew: _RaySeats | Crew = _RaySeats(workers, jobs, address, attempt)
    else:
        crew = Crew(min(workers or cores(), len(jobs)), attempt)
    with ending(crew.end):
        yield crew.play(jobs)


class _RaySeats:
    """As many actors of ray as there are workers, each with one process that it may replace.

    A job whose actor is lost with its machine is done once more by another one. In place of that actor a new one is
    asked for, which gets jobs once it has started: where no machine has room for it, the others do them all.
    """

    def __init__(self, workers: int, jobs: Sequence[Job], address: str | None, attempt: Attempt) -> None:
        try:
            import ray
        except ImportError:
            wanted = "backend ray needs the package ray, which is not installed: pip install 'hazard_ms[cluster]'"
            raise ValueError(wanted) from None
        paths = os.pathsep.join(filter(None, sys.path))
        keyed = any(needs_key(job.options.agent, job.options.load) for job in jobs)
        with without_keys(needed=keyed):  # processes of ray get our environment
            ray.init(address=address, runtime_env={"env_vars": {"PYTHONPATH": paths}}, include_dashboard=False)
        self._count = min(workers or int(ray.cluster_resources().get("CPU", 1)), len(jobs))
        self._attempt = attempt
        self._kind = ray.remote(num_cpus=1, scheduling_strategy="SPREAD")(_Seat)

    def play(self, jobs: Sequence[Job]) -> Iterator[tuple[Job, Outcome]]:
        """Do `jobs` in any order. Those whose machine is lost twice have no result.

        Raises ValueError where actors fail to start again and again, as without this package on the machines.
        """
        import ray

        waiting, idle = deque((job, 1) for job in jobs), list[Any]()
        seats = [self._kind.remote(self._attempt) for _ in range(self._count)]
        starting = {seat.ready.remote(): seat for seat in seats}
        busy, failed = dict[Any, tuple[Any, Job, int]](), 0
        while waiting or busy:
            while waiting and idle:
                seat, given = idle.pop(), waiting.popleft()
                busy[seat.play.remote(given[0])] = seat, *given
            (ready, *_), _ = ray.wait([*starting, *busy])
            job: Job | None = None
            if ready in busy:
                seat, job, attempt = busy.pop(ready)
            else:
                seat, attempt = starting.pop(ready), 1
            try:
                outcome = ray.get(ready)
            except (ray.exceptions.RayActorError, ray.exceptions.NodeDiedError) as error:
                failed += job is None
                if failed > STARTS * self._count:
                    raise ValueError(
                        f"address must be that of a cluster that can play episodes, got {error!s:.500}"
                    ) from None
                with contextlib.suppress(ray.exceptions.RayError):
                    ray.kill(seat)
                seat = self._kind.remote(self._attempt)
                starting[seat.ready.remote()] = seat
                if job is not None and attempt == 1:
                    waiting.append((job, 2))
                elif job is not None:
                    yield job, Outcome(None, f"{DIED}: lost with its machine", died=True, attempts=attempt)
                continue
            idle.append(seat)
            if job is not None:
                yield job, outcome._replace(attempts=max(attempt, outcome.attempts))

    def end(self, now: bool = False) -> None:
        """Leave the cluster; processes end with their actors."""
        import ray

        ray.shutdown()


class _Seat:
    """What an actor of ray does: one job at a time in a process of its own."""

    def __init__(self, attempt: Attempt) -> None:
        self._crew = Crew(1, attempt)

    def ready(self) -> None:
        """Tell that it has started."""

    def play(self, job: Job) -> Outcome:
        """Do one job."""
        return next(self._crew.play([job]))[1]
