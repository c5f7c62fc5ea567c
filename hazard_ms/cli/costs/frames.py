"""Measures where the time of a step goes and how fast an episode runs, for `hazard-ms bench`.

Times are medians of whole frames, taken in one run. Compare ratios; absolute times belong to the machine that is
printed with them.
"""

from __future__ import annotations

import time
from collections import defaultdict
from collections.abc import Callable
from typing import Any

import gymnasium as gym
import numpy as np

from hazard_ms.agents.base import agent
from hazard_ms.evaluation.options import EnvOptions
from hazard_ms.evaluation.report import machine_line
from hazard_ms.evaluation.runner import Runner
from hazard_ms.skills.decision import EXPLORE, Action
from hazard_ms.skills.executor import SkillEnv
from hazard_ms.spec.checks import whole

PHASES = ("read", "force", "push", "physics", "advance", "hand", "robot", "observe")
HOOKS = ("force", "advance")  # what hazards do, "damaged" included
FEWEST, MOST = 20, 10**6  # frames to average over [ours]
LOOKS = 20  # of each kind to take a median of [ours]


class Stopwatch:
    """Adds up the time spent in wrapped callables, by phase; a phase inside another counts for itself only."""

    def __init__(self, clock: Callable[[], float] = time.perf_counter) -> None:
        self.seconds: dict[str, float] = defaultdict(float)
        self._inner = [0.0]
        self._clock = clock

    def wrap(self, owner: Any, method: str, phase: str) -> None:
        """Count the time spent in a `method` of `owner` as that of `phase`."""
        plain: Callable[..., Any] = getattr(owner, method)

        def timed(*args: Any, **kwargs: Any) -> Any:
            self._inner.append(0.0)
            start = self._clock()
            try:
                return plain(*args, **kwargs)
            finally:
                spent = self._clock() - start
                self.seconds[phase] += spent - self._inner.pop()
                self._inner[-1] += spent

        object.__setattr__(owner, method, timed)  # hazards are frozen dataclasses


def phases(env_id: str, frames: int, seed: int, **keywords: Any) -> dict[str, Any]:
    """Microseconds per frame and phase of an environment under random actions of the base.

    "hooks" is the hazards' share of a frame.
    """
    env = gym.make(env_id, **keywords)
    env.reset(seed=seed)
    base: Any = env.unwrapped
    env.step(np.zeros(base.single_action_space.shape, np.float32))  # kernels that are new to the machine are compiled
    watch = watched(base)
    spans = _spans(env, frames, seed)
    total = float(np.sum(spans))
    rows = {p: watch.seconds[p] / frames * 1e6 for p in PHASES}
    rows["rest"] = total / frames * 1e6 - sum(rows.values())
    made = {"bodies": int(base.world.exists.sum()), "moving": int((base.world.exists & base.world.movable).sum())}
    env.close()
    hooks = sum(rows[p] for p in HOOKS) / (total / frames * 1e6)
    speed = {"frames_per_second": frames / total, "median_us": float(np.median(spans)) * 1e6, "hooks": hooks}
    return {**made, **speed, "phases_us": rows}


def watched_maniskill(base: Any, clock: Callable[[], float] = time.perf_counter) -> Stopwatch:
    """A stopwatch, by `clock` [s], on those phases of a frame that every environment of ManiSkill has."""
    watch = Stopwatch(clock)
    watch.wrap(base.scene, "step", "physics")
    watch.wrap(base.agent, "set_action", "robot")
    watch.wrap(base.agent, "before_simulation_step", "robot")
    watch.wrap(base, "get_obs", "observe")
    return watch


def watched(base: Any, clock: Callable[[], float] = time.perf_counter) -> Stopwatch:
    """A stopwatch, by `clock` [s], on all phases of a frame of a HazardEnv."""
    watch = watched_maniskill(base, clock)
    watch.wrap(base.world, "read", "read")
    watch.wrap(base.world, "push", "push")
    watch.wrap(base.episode, "use_hand", "hand")
    for hazard in base.task.hazards:
        watch.wrap(hazard, "force", "force")
        watch.wrap(hazard, "advance", "advance")
        watch.wrap(hazard, "damaged", "advance")
    return watch


def _spans(env: gym.Env, frames: int, seed: int) -> list[float]:
    """Time of each of this many frames under random motion of the base [s]."""
    rng = np.random.default_rng(seed)
    action = np.zeros(env.unwrapped.single_action_space.shape, np.float32)  # type: ignore[attr-defined]
    spans = []
    for _ in range(frames):
        action[-2:] = rng.uniform(-1, 1, 2)
        start = time.perf_counter()
        env.step(action)
        spans.append(time.perf_counter() - start)
    return spans


def resets(env_id: str, **keywords: Any) -> str:
    """The line on resets: to new scenes and to ones built before, after a first one that loads the models' files."""
    env = gym.make(env_id, **keywords)
    env.reset(seed=0)

    def seconds(seeds: range) -> list[float]:
        made = []
        for seed in seeds:
            start = time.perf_counter()
            env.reset(seed=seed)
            made.append(time.perf_counter() - start)
        return made

    new, again = seconds(range(1, 9)), seconds(range(1, 9))
    env.close()
    fresh = f"a new scene {np.median(new):.2f} s (at most {max(new):.2f})"
    return f"reset: {fresh}, one built before {np.median(again):.2f} s ({max(again):.2f})"


def greedy_episode(env_id: str, seed: int, **keywords: Any) -> str:
    """The line on a whole greedy episode, after a first look that compiles the shaders."""
    made = SkillEnv.make(env_id, **keywords)
    made.colours = False  # as greedy plays it
    made.reset(seed=seed)
    made.step(Action(EXPLORE))
    start = time.perf_counter()
    played = Runner(made, agent("greedy")).run(seed)
    seconds = time.perf_counter() - start
    made.close()
    per = f"{made.max_frames * seconds / made.frame:.1f} s per {made.max_frames} frames"
    what = f"{made.frame} frames, {len(played.decisions)} decisions ({played.ended})"
    return f"greedy episode, seed {seed}: {what} in {seconds:.1f} s: {per}"


def looks(env_id: str, seed: int, **keywords: Any) -> str:
    """The line on looks of the head camera with and without colours, taken in turn; each enters what it sees."""
    made = SkillEnv.make(env_id, **keywords)
    made.reset(seed=seed)
    spans: dict[bool, list[float]] = {False: [], True: []}
    for _ in range(LOOKS + 1):
        for colours, row in spans.items():
            start = time.process_time()
            made.look(colours)
            row.append(time.process_time() - start)
    made.close()
    plain, full = (1e3 * np.median(row[1:]) for row in spans.values())
    return f"look, medians of {LOOKS} in turn: {plain:.1f} ms of processor time, with colours {full:.1f} ms"


def report(env_id: str, frames: int, seed: int, episode: bool, physics: str = "paper", severity: str = "severe") -> str:
    """The table that `hazard-ms bench` prints. Raises ValueError for unknown names and for too few frames."""
    EnvOptions(env_id, physics=physics, severity=severity).check()
    strong = {"physics": physics, "severity": severity}
    whole(frames, FEWEST, MOST, "frames")
    lines = [machine_line(), ""]
    for title, keywords in (
        ("state", {"obs_mode": "state", "render_backend": "none"}),
        ("rgb+depth+segmentation, 256 pixels", {"obs_mode": "rgb+depth+segmentation"}),
    ):
        count = frames if title == "state" else max(frames // 10, FEWEST)
        found = phases(env_id, count, seed, **keywords, **strong)
        total = sum(found["phases_us"].values())
        speed = f"{found['frames_per_second']:.0f} frames/s, median {found['median_us']:.0f} us a frame"
        lines.append(f"{env_id}, {title}: {found['bodies']} things, {found['moving']} of them move")
        lines += [f"  {speed}, hazards {found['hooks']:.1%} of it", "  " + resets(env_id, **keywords, **strong)]
        lines += [f"  {name:10s} {us:9.1f} us  {100 * us / total:5.1f} %" for name, us in found["phases_us"].items()]
        lines.append("")
    if episode:
        lines += [looks(env_id, seed, **strong), greedy_episode(env_id, seed, **strong)]
    return "\n".join(lines)
