"""`hazard-ms bench`: where the time of a step goes, and how fast an episode runs; printed with versions and machine.

Times are medians of whole frames, taken in one run. Compare ratios; absolute times belong to the machine that is printed with them.
"""

from __future__ import annotations

import time
from collections import defaultdict
from collections.abc import Callable
from typing import Any

import gymnasium as gym
import numpy as np

from hazard_ms import MAX_FRAMES
from hazard_ms.agents.base import agent
from hazard_ms.checks import one_of, whole
from hazard_ms.evaluation.result import machine, versions
from hazard_ms.play import Episode
from hazard_ms.skills.decision import EXPLORE, Action
from hazard_ms.skills.executor import SkillEnv

PHASES = ("read", "force", "push", "physics", "advance", "hand", "robot", "observe")
HOOKS = ("force", "advance")  # what hazards do, "damaged" included


class Stopwatch:
    """Adds up the time spent in wrapped callables, by phase; a phase inside another counts for itself only."""

    def __init__(self) -> None:
        self.seconds: dict[str, float] = defaultdict(float)
        self._inner = [0.0]

    def wrap(self, owner: Any, method: str, phase: str) -> None:
        plain: Callable[..., Any] = getattr(owner, method)

        def timed(*args: Any, **kwargs: Any) -> Any:
            self._inner.append(0.0)
            start = time.perf_counter()
            try:
                return plain(*args, **kwargs)
            finally:
                spent = time.perf_counter() - start
                self.seconds[phase] += spent - self._inner.pop()
                self._inner[-1] += spent

        object.__setattr__(owner, method, timed)  # hazards are frozen dataclasses


def phases(env_id: str, frames: int, seed: int, **keywords: Any) -> dict[str, Any]:
    """Microseconds per frame and phase of an environment under random actions of the base; `hooks`: the hazards' share of a frame."""
    env = gym.make(env_id, **keywords)
    env.reset(seed=seed)
    base: Any = env.unwrapped
    env.step(np.zeros(base.single_action_space.shape, np.float32))  # kernels that are new to the machine are compiled
    watch = Stopwatch()
    watch.wrap(base.world, "read", "read")
    watch.wrap(base.world, "push", "push")
    watch.wrap(base.scene, "step", "physics")
    watch.wrap(base.episode, "use_hand", "hand")
    watch.wrap(base.agent, "set_action", "robot")
    watch.wrap(base.agent, "before_simulation_step", "robot")
    watch.wrap(base, "get_obs", "observe")
    for hazard in base.task.hazards:
        watch.wrap(hazard, "force", "force")
        watch.wrap(hazard, "advance", "advance")
        watch.wrap(hazard, "damaged", "advance")
    rng = np.random.default_rng(seed)
    action = np.zeros(base.single_action_space.shape, np.float32)
    spans = []
    for _ in range(frames):
        action[-2:] = rng.uniform(-1, 1, 2)
        start = time.perf_counter()
        env.step(action)
        spans.append(time.perf_counter() - start)
    total = float(np.sum(spans))
    rows = {p: watch.seconds[p] / frames * 1e6 for p in PHASES}
    rows["rest"] = total / frames * 1e6 - sum(rows.values())
    made = {"bodies": int(base.world.exists.sum()), "moving": int((base.world.exists & base.world.movable).sum())}
    env.close()
    hooks = sum(rows[p] for p in HOOKS) / (total / frames * 1e6)
    speed = {"frames_per_second": frames / total, "median_us": float(np.median(spans)) * 1e6, "hooks": hooks}
    return {**made, **speed, "phases_us": rows}


def resets(env_id: str, **keywords: Any) -> str:
    """Time to build scenes that are new, and scenes that were built before, after a first one that loads the models' files."""
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
    return (
        f"reset: a new scene {np.median(new):.2f} s (at most {max(new):.2f}), one built before {np.median(again):.2f} s ({max(again):.2f})"
    )


def greedy_episode(env_id: str, seed: int) -> str:
    """A whole episode with an observation of 256 pixels at every decision, after a first short one that compiles the shaders."""
    made = SkillEnv(gym.make(env_id, obs_mode="none"))
    player = agent("greedy")
    episode = Episode(made, player)
    decision, _ = made.reset(seed=seed)
    made.step(Action(EXPLORE))
    start = time.perf_counter()
    decision, _ = made.reset(seed=seed)
    player.reset(made.base.task, seed)
    ended = episode.run(decision)
    seconds = time.perf_counter() - start
    made.env.close()
    per = f"{made.max_frames * seconds / made.frame:.1f} s per {made.max_frames} frames"
    return f"greedy episode, seed {seed}: {made.frame} frames, {len(episode.records)} decisions ({ended}) in {seconds:.1f} s: {per}"


def report(env_id: str, frames: int, seed: int, episode: bool) -> str:
    """The table that `hazard-ms bench` prints."""
    one_of(env_id, MAX_FRAMES, "environment")
    whole(frames, 20, 10**6, "frames")
    lines = [", ".join(f"{k} {v}" for k, v in {**versions(), **machine()}.items()), ""]
    for title, keywords in (
        ("state", {"obs_mode": "state", "render_backend": "none"}),
        ("rgb+depth+segmentation, 256 pixels", {"obs_mode": "rgb+depth+segmentation"}),
    ):
        found = phases(env_id, frames if title == "state" else max(frames // 10, 20), seed, **keywords)
        total = sum(found["phases_us"].values())
        lines.append(f"{env_id}, {title}: {found['bodies']} things, {found['moving']} of them move")
        lines.append(
            f"  {found['frames_per_second']:.0f} frames/s, median {found['median_us']:.0f} us a frame, hazards {found['hooks']:.1%} of it"
        )
        lines.append("  " + resets(env_id, **keywords))
        lines += [f"  {name:10s} {us:9.1f} us  {100 * us / total:5.1f} %" for name, us in found["phases_us"].items()]
        lines.append("")
    return "\n".join([*lines, greedy_episode(env_id, seed)] if episode else lines)
