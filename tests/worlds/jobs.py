"""What workers do in tests, in place of episodes: the seed of a job says whether it ends, and how."""

from __future__ import annotations

import dataclasses
import os
import signal
import time
from pathlib import Path

from hazard_ms.evaluation.options import EpisodeOptions
from hazard_ms.evaluation.workers import Job, Outcome, Say, Word
from tests.worlds.results import result_of

WELL, DIES, DIES_ONCE, HANGS_ASKED, HANGS_BETWEEN = range(5)
HOUR = 3600.0  # [s]


def job(seed: int, folder: Path, decision_seconds: float = HOUR) -> Job:
    """A job of `attempt`, which may leave a mark in `folder`."""
    return Job(EpisodeOptions(agent=str(folder), seed=seed), decision_seconds)


def attempt(job: Job, say: Say) -> Outcome:
    """Do as the seed says, once the agent was asked; `error` of the outcome is the id of the process."""
    kind = job.options.seed % 5
    result = result_of(job.options)
    say(Word(dataclasses.replace(result, ended="running", frames=100)))
    mark = Path(job.options.agent, f"{job.options.seed}.died")
    if kind == DIES or (kind == DIES_ONCE and not mark.exists()):
        mark.touch()
        os.kill(os.getpid(), signal.SIGKILL)
    if kind == HANGS_ASKED:
        time.sleep(HOUR)
    say(Word(None))
    if kind == HANGS_BETWEEN:
        time.sleep(HOUR)
    return Outcome(result, str(os.getpid()))
