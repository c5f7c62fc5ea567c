"""Measures our tasks beside ManiSkill's own in one process, in turn, for `hazard-ms bench --against stock`.

ManiSkill's PickCube-v1 has one thing that moves; our rooms have 60, our streets 15.
"""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from typing import Any

import gymnasium as gym
import mani_skill.envs  # noqa: F401 registers ManiSkill's own tasks

from hazard_ms.cli.costs.frames import FEWEST, MOST, watched, watched_maniskill
from hazard_ms.cli.costs.resets import beside_stock
from hazard_ms.cli.costs.tables import table
from hazard_ms.cli.costs.turns import WARM_UP, Case, Turn, actions_of, frames_in_turn, one_thread, phases_in_turn, spent
from hazard_ms.evaluation.report import machine_line
from hazard_ms.spec.checks import whole

STOCK = (Case("PickCube-v1", "fetch"), Case("PickCube-v1", "panda"))  # the first is what all others are compared with
TASKS = ("HazardFire-v1", "HazardFlood-v1", "HazardWind-v1", "HazardCompound-v1")
USUAL = tuple(Case(env_id, "fetch", "paper") for env_id in TASKS)  # what our other cases are compared with
OTHERS = tuple(Case(env_id, *how) for how in (("fetch", "realistic"), ("g1", "paper")) for env_id in TASKS)
STATE = {"obs_mode": "state", "render_backend": "none"}
ROUNDS = 12  # [ours]
SCENES, RESETS = 8, 4  # scenes that resets go through, and how often [ours]
PHASES = {"physics": ("physics",), "robot": ("robot",), "observation": ("observe",)}  # of every environment
HAZARDS = ("read", "push", "force", "advance", "hand")  # phases that only our environments have


def report(frames: int, seed: int) -> str:
    """The tables of frames, of shares within our tasks, of phases and of resets; `frames` of each case.

    Raises ValueError for too few frames.
    """
    length = max(whole(frames, FEWEST, MOST, "frames") // ROUNDS, 1)
    envs = {case: case.make(**STATE) for case in (*STOCK, *USUAL, *OTHERS)}
    try:
        with one_thread():
            for env in envs.values():
                env.reset(seed=seed)
                spent(env, actions_of(env, "random", WARM_UP, seed))
            turns = frames_in_turn(envs, length, ROUNDS, seed)
            watches = {
                case: (watched if case.physics else watched_maniskill)(env.unwrapped, time.process_time)
                for case, env in envs.items()
            }
            phases = phases_in_turn(envs, watches, length, ROUNDS, seed)
            moving = {case: _moving(case, env) for case, env in envs.items()}
    finally:
        for env in envs.values():
            env.close()
    how = f"State observations, one environment, one thread, {ROUNDS} rounds of {length} frames in turn, medians; "
    parts = [
        machine_line(),
        how + "frames a second of processor time (of wall time in brackets), and how many times as many as stock's:",
        frames_table(turns, moving),
        "Rate of a task as a share of its rate with `paper` and Fetch, random actions:",
        shares_table(turns),
        "Processor time of a frame with random actions by phase [us]; in brackets how many times less than stock's:",
        phases_table(phases),
        f"Processor time of a reset [ms], in turn, medians over {SCENES} scenes: one that changes the scene, the first "
        f"time and {RESETS - 1} later ones, and one in the same scene (`deterministic=False`):",
        beside_stock(STOCK, USUAL, SCENES, RESETS),
    ]
    return "\n\n".join(parts)


def frames_table(turns: Mapping[Case, Turn], moving: Mapping[Case, int]) -> str:
    """Frames a second of each case, and their ratio to those of the first of STOCK. `moving`: its moving things."""
    first = turns[STOCK[0]]
    rows = []
    for case, turn in turns.items():
        rates = [f"{1 / turn.cpu[kind]:.0f} ({1 / turn.wall[kind]:.0f})" for kind in turn.cpu]
        ratios = [f"{first.cpu[kind] / turn.cpu[kind]:.2f}" for kind in turn.cpu]
        rows.append([*_names(case), str(moving[case]), *rates, *ratios])
    kinds = [*first.cpu]
    headings = ["task", "robot", "preset", "moving", *kinds, *(f"{kind}, ratio" for kind in kinds)]
    return table(headings, rows, 3)


def shares_table(turns: Mapping[Case, Turn]) -> str:
    """The rate of each of OTHERS as a share of that of its task in USUAL, random actions."""
    usual = {case.env_id: turns[case].cpu["random"] for case in USUAL}
    rows = [[*_names(case), f"{usual[case.env_id] / turns[case].cpu['random']:.0%}"] for case in OTHERS]
    return table(["task", "robot", "preset", "share"], rows, 3)


def phases_table(phases: Mapping[Case, Mapping[str, float]]) -> str:
    """Time of each phase of a frame, given in [s], its ratio to that of the first of STOCK, and frame by physics."""
    shown = {case: _grouped(found) for case, found in phases.items()}
    first = shown[STOCK[0]]
    rows = []
    for case, found in shown.items():
        cells = [
            f"{1e6 * seconds:.0f}" + (f" ({first[phase] / seconds:.1f})" if seconds and first[phase] else "")
            for phase, seconds in found.items()
        ]
        rows.append([*_names(case), *cells, f"{found['frame'] / found['physics']:.2f}"])
    return table(["task", "robot", "preset", *first, "frame by physics"], rows, 3)


def _grouped(found: Mapping[str, float]) -> dict[str, float]:
    """Phases as the table shows them [s]: those of every environment, those of ours, what is left, and the frame."""
    made = {name: sum(found.get(p, 0.0) for p in parts) for name, parts in {**PHASES, "hazards": HAZARDS}.items()}
    return {**made, "rest": found["frame"] - sum(made.values()), "frame": found["frame"]}


def _names(case: Case) -> Sequence[str]:
    return case.env_id, case.robot, case.physics or "stock"


def _moving(case: Case, env: gym.Env) -> int:
    """How many things may move besides the robot."""
    base: Any = env.unwrapped
    if case in STOCK:
        return 1  # the cube
    return int((base.world.exists & base.world.movable).sum())
