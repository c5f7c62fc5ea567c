"""Results of episodes that nobody played, with decisions and the fates of several targets."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from hazard_ms.evaluation.metrics import Fate
from hazard_ms.evaluation.result import DecisionRecord, EpisodeResult


def fate(value: float, frame: int | None, damaged_frame: int | None = None) -> Fate:
    """The fate of a target that was rescued at `frame` and damaged at `damaged_frame`; None: never."""
    return Fate("thing", "bottle", value, frame is not None, damaged_frame is not None, frame, damaged_frame)


def course(
    agent: str,
    seed: int,
    targets: Sequence[Fate],
    decisions: Sequence[DecisionRecord] = (),
    env_id: str = "HazardFire-v1",
    **changes: object,
) -> EpisodeResult:
    """The result of an episode of 1,500 frames with these `targets` and `decisions`; `changes` are of its fields."""
    fields = {
        "settings": {"split": "test", "physics": "paper", "robot_uids": "fetch", "affects_agent": False},
        "frames": 1500,
        "max_frames": 1500,
        "ended": "time",
        "command": f"hazard-ms play -e {env_id} --agent {agent} -s {seed}",
        "wall_seconds": 20.0,
        "phase_seconds": {"build": 2.0, "looks": 8.0, "physics": 6.0, "agent": 1.0},
        **changes,
    }
    return EpisodeResult(
        env_id, agent, seed, f"kitchen_b/{seed:02d}", targets=tuple(targets), decisions=tuple(decisions), **fields
    )


def drawn(agent: str, seed: int, skill: float, env_id: str = "HazardFire-v1") -> EpisodeResult:
    """An episode with a course drawn from `seed`, in which an agent of more `skill`, 0 to 1, rescues more."""
    draw = np.random.default_rng((seed, int(1000 * skill)))
    worth = np.random.default_rng(seed).choice([1.0, 5.0], size=10)
    decisions, targets, now = [], [], 0
    for value in worth:
        for verb, frames in (("walk_to", 100), ("pick_up", 90), ("drop", 5)):
            ok = False
            while now < 1500 and not ok:
                ok = bool(draw.random() < skill)
                decisions.append(DecisionRecord(now, verb, "thing", ok, "" if ok else "max_frames", frames))
                now += frames
        burnt, saved = int(draw.integers(500, 4000)), now < 1500
        struck = burnt if burnt < (now if saved else 1500) else None
        targets.append(fate(float(value), now if saved else None, struck))
    decisions.append(DecisionRecord(min(now, 1499), "explore", None, False, "episode_over", 60))
    return course(agent, seed, targets, decisions, env_id)
