"""Recordings by processes that are killed at random times.

`python -m tests.worlds.killed_recordings FOLDER KILLS [EPISODES]` records episodes, each until it is done or has been
killed KILLS times, and prints how often a process was killed, and how often the dataset was not as it should be.
"""

from __future__ import annotations

import json
import os
import random
import signal
import sys
import time
from pathlib import Path

from hazard_ms.agents.base import agent
from hazard_ms.demonstrations.options import RecordOptions
from hazard_ms.demonstrations.reading import demonstrations
from hazard_ms.demonstrations.recording import RecordJob, attempt, recorded
from hazard_ms.demonstrations.repair import repair
from hazard_ms.demonstrations.verify import verify

AGENT = "tests.evaluation.test_play:Short"
LONGEST = 20.0  # after which a process is killed [s]: some are done before


def killed_recording(options: RecordOptions, kills: int) -> tuple[int, int]:
    """Record one episode by copies of this process, of which `kills` are killed; how many were, and what was wrong."""
    chance, killed, wrong = random.Random(options.seed), 0, 0
    for k in range(kills + 1):
        child = os.fork()
        if child == 0:
            os._exit(bool(attempt(RecordJob(options.episode_options()[0], 600.0, record=options), bool).error))
        until = time.monotonic() + (chance.uniform(0.0, LONGEST) if k < kills else 600.0)
        while time.monotonic() < until and not (ended := os.waitpid(child, os.WNOHANG))[0]:
            time.sleep(0.01)
        if not ended[0]:
            os.kill(child, signal.SIGKILL)
            ended = os.waitpid(child, 0)
        killed += os.WIFSIGNALED(ended[1])
        found = recorded(options.dataset, options.recipe)
        if found:  # before anything is put in order
            wrong += len(list(demonstrations(options.dataset))) != len(found)
        repair(options.dataset)
        after = recorded(options.dataset, options.recipe)
        wrong += not {e.name for e in found} <= {e.name for e in after}
        wrong += bool(after) and verify(options.dataset)
        if any(entry.seed == options.seed for entry in after):
            break
    return killed, wrong


def main() -> None:
    output, kills, episodes = Path(sys.argv[1]), int(sys.argv[2]), int([*sys.argv, "1"][3])
    agent(AGENT)
    killed = wrong = 0
    for seed in range(episodes):
        options = RecordOptions(agent=AGENT, seed=seed, episodes=1, keep=0.0, verify=False, output=output)
        options.dataset.mkdir(parents=True, exist_ok=True)
        more = killed_recording(options, kills)
        killed, wrong = killed + more[0], wrong + more[1]
    print(json.dumps({"killed": killed, "wrong": wrong}))


if __name__ == "__main__":
    main()
