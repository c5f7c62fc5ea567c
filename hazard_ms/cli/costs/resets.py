"""Measures resets: a change of scene and a new start in the same scene beside stock's, and many changes of scene.

After many changes of scene the memory must be what it was, and each episode that of an environment built for it alone.
"""

from __future__ import annotations

import hashlib
import os
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import gymnasium as gym
import numpy as np

from hazard_ms.cli.costs.tables import table
from hazard_ms.cli.costs.turns import Case, actions_of, one_thread
from hazard_ms.evaluation.report import machine_line
from hazard_ms.scenes.splits import scene
from hazard_ms.spec.checks import whole

SCENES, ROUNDS = 20, 10  # 200 resets over 20 scenes
FEWEST_ROUNDS = 3  # the first one builds what later ones find, the second settles [ours]
MOST = 10**4  # scenes, rounds [-] [ours]
FRAMES = 5  # played after each reset, before its state is compared [ours]
STATE = {"obs_mode": "state", "render_backend": "none"}


@dataclass(frozen=True)
class Resets:
    """The resets of one environment that went through its scenes round after round."""

    seconds: tuple[tuple[float, ...], ...]  # processor time of each change of scene, by round [s]
    memory: tuple[float, ...]  # of the process at the end of each round [MiB]
    differing: tuple[int, ...]  # seeds of which an episode was not that of an environment built for it alone

    @property
    def growth(self) -> float:
        """Memory that a round takes and does not give back [MiB]: the slope of a line through all but the first."""
        return float(np.polyfit(range(len(self.memory) - 1), self.memory[1:], 1)[0])


def over_scenes(case: Case, scenes: int = SCENES, rounds: int = ROUNDS) -> Resets:
    """Go through the scenes of the seeds 0 to `scenes` - 1, `rounds` times, and compare each episode's start.

    Raises ValueError for too few scenes or rounds.
    """
    whole(scenes, 2, MOST, "scenes")
    whole(rounds, FEWEST_ROUNDS, MOST, "rounds")
    env = case.make(**STATE)
    scene.cache_clear()  # the first round generates its scenes
    seconds, memory, digests = [], [], []
    for _ in range(rounds):
        row = []
        for seed in range(scenes):
            row.append(seconds_of(lambda seed=seed: env.reset(seed=seed)))  # type: ignore[misc]
            digests.append((seed, started(env, seed)))
        seconds.append(tuple(row))
        memory.append(resident())
    env.close()
    alone = {seed: alone_of(case, seed) for seed in range(scenes)}
    differing = sorted({seed for seed, digest in digests if digest != alone[seed]})
    return Resets(tuple(seconds), tuple(memory), tuple(differing))


def alone_of(case: Case, seed: int) -> str:
    """The digest of the start of an episode in an environment that is made for it."""
    env = case.make(**STATE)
    env.reset(seed=seed)
    digest = started(env, seed)
    env.close()
    return digest


def started(env: gym.Env, seed: int) -> str:
    """SHA-256 of every number of an episode's state, after its reset and after FRAMES random actions."""
    base: Any = env.unwrapped
    made = hashlib.sha256()
    _add(made, base.get_state_dict())
    for action in actions_of(env, "random", FRAMES, seed):
        env.step(action)
    _add(made, base.get_state_dict())
    return made.hexdigest()


def _add(digest: Any, state: Any) -> None:
    if isinstance(state, dict):
        for name in sorted(state):
            digest.update(name.encode())
            _add(digest, state[name])
    else:
        digest.update(np.ascontiguousarray(state.cpu().numpy()).tobytes())


def resident() -> float:
    """Memory that this process holds [MiB]."""
    return int(Path("/proc/self/statm").read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE") / 2**20


def seconds_of(reset: Callable[[], Any]) -> float:
    """Processor time of a reset [s]."""
    start = time.process_time()
    reset()
    return time.process_time() - start


def report(cases: Sequence[Case], scenes: int = SCENES, rounds: int = ROUNDS) -> str:
    """The table of `over_scenes` for each of `cases`."""
    with one_thread():
        found = {case: over_scenes(case, scenes, rounds) for case in cases}
    lead = (
        f"{scenes * rounds} resets over {scenes} scenes, each a change of scene: median processor time [ms], memory of "
        f"the process [MiB], and scenes that do not start bit for bit as in an environment made for them, {FRAMES} "
        "frames included:"
    )
    return "\n\n".join([machine_line(), lead, resets_table(found)])


def resets_table(found: Mapping[Case, Resets]) -> str:
    """A row for each case."""
    rows = []
    for case, made in found.items():
        later = [seconds for row in made.seconds[1:] for seconds in row]
        spans = [f"{1e3 * value:.0f}" for value in (np.median(made.seconds[0]), np.median(later), max(later))]
        memory = [f"{made.memory[0]:.0f}", f"{made.memory[-1]:.0f}", f"{made.growth:+.2f}"]
        rows.append([case.env_id, case.robot, case.physics, *spans, *memory, str(len(made.differing))])
    headings = ["first time", "later", "later, longest", "after a round", "at the end", "growth a round", "differ"]
    return table(["task", "robot", "preset", *headings], rows, 3)


def beside_stock(stock: Sequence[Case], ours: Sequence[Case], scenes: int, rounds: int) -> str:
    """The table of resets of `ours` and of `stock`, taken in turn: a scene that changes, and one that stays.

    Raises ValueError for too few scenes or rounds.
    """
    whole(scenes, 2, MOST, "scenes")
    whole(rounds, FEWEST_ROUNDS, MOST, "rounds")
    changing = {case: case.make(**STATE) for case in (*stock, *ours)}
    staying = {case: case.make(deterministic=False, **STATE) for case in ours} | {c: changing[c] for c in stock}
    spans: dict[Case, dict[str, list[float]]] = {case: {"first": [], "later": [], "same": []} for case in changing}
    with one_thread():
        for each in range(rounds):
            for seed in range(scenes):
                for case, env in changing.items():
                    if not each:
                        scene.cache_clear()  # the first round generates its scenes, which tasks may share
                    options = {"reconfigure": True} if case in stock else {}
                    span = seconds_of(lambda: env.reset(seed=seed, options=options))  # noqa: B023 called at once
                    spans[case]["later" if each else "first"].append(span)
                for case, env in staying.items():
                    spans[case]["same"].append(seconds_of(lambda: env.reset(seed=0)))  # noqa: B023 called at once
    for env in {*changing.values(), *staying.values()}:
        env.close()
    rows = []
    for case, kinds in spans.items():
        median = {kind: float(np.median(row)) for kind, row in kinds.items()}
        shown = [f"{1e3 * median[kind]:.1f}" for kind in median]
        rows.append([case.env_id, case.robot, case.physics or "stock", *shown])
    return table(["task", "robot", "preset", "changed, first time", "changed, later", "same"], rows, 3)
