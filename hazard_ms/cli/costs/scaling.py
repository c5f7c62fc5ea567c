"""Measures how the time of a frame grows with the number of things, and with the size of pictures.

Things are those of a kitchen, in turn, side by side on the floor of the task's first scene without its furniture: all
numbers of things are then the same kind of scene. A frame is taken with the robot at rest.
"""

from __future__ import annotations

import dataclasses
import itertools
import tempfile
import time
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

import gymnasium as gym
import mani_skill.envs  # noqa: F401 registers ManiSkill's own tasks
import numpy as np

from hazard_ms.cli.costs.frames import FEWEST, HOOKS, MOST, watched
from hazard_ms.cli.costs.tables import table
from hazard_ms.cli.costs.turns import WARM_UP, Case, actions_of, frames_in_turn, one_thread, phases_in_turn, spent
from hazard_ms.evaluation.report import machine_line
from hazard_ms.scenes.schema import to_json
from hazard_ms.scenes.solids import extent_of
from hazard_ms.scenes.splits import scene
from hazard_ms.spec import Body, SceneSpec
from hazard_ms.spec.checks import whole

THINGS = (20, 60, 120, 240)  # [-]
SIDES = (64, 128, 256, 512)  # of square pictures [pixels]
FIRST = {"HazardFire-v1": "kitchen_a/00", "HazardFlood-v1": "kitchen_a/00", "HazardWind-v1": "street/00"}
CELL = 0.36  # from thing to thing on the floor [m] [ours]
ROOMY = 0.5  # free floor around the robot [m] [ours]
ROUNDS = 6  # [ours]
STATE = {"obs_mode": "state", "render_backend": "none"}
PICTURE = "rgb+depth+segmentation"
PICTURES_SHARE = 10  # frames of a size for one picture [ours]
OURS, STOCK = Case("HazardFire-v1", "fetch", "paper"), Case("PickCube-v1", "panda")  # with one camera each


def report(
    frames: int, seed: int, physics: str = "paper", things: Iterable[int] = THINGS, sides: Iterable[int] = SIDES
) -> str:
    """Both tables, `frames` for each number of `things`; hazards are of the preset `physics`.

    Raises ValueError for too few frames.
    """
    whole(frames, FEWEST, MOST, "frames")
    with one_thread():
        by_things = things_table(time_of_things(tuple(things), frames, seed, physics))
        by_size = pictures_table(time_of_pictures(tuple(sides), max(frames // PICTURES_SHARE, ROUNDS), seed))
    return "\n\n".join(
        [
            machine_line(),
            f"State observations, Fetch at rest, preset {physics}, by the number of things that move: processor time "
            "of a frame [us], in brackets that of physics and the share of the frame that hazards take:",
            by_things,
            f"{PICTURE} of one camera by its size: wall time of a frame [ms], in brackets processor time:",
            by_size,
        ]
    )


def time_of_things(
    things: tuple[int, ...], frames: int, seed: int, physics: str
) -> dict[tuple[str, int], dict[str, float]]:
    """Processor time of a frame and its phases [s], by task and number of things."""
    length = max(frames // ROUNDS, 1)
    with tempfile.TemporaryDirectory() as folder:
        envs = {}
        for env_id, number in itertools.product(FIRST, things):
            file = Path(folder) / f"{env_id}-{number}.json"
            file.write_text(to_json(crowded(env_id, number)), encoding="utf-8")
            envs[env_id, number] = Case(env_id, "fetch", physics).make(scenes=str(file), **STATE)
    try:
        for env in envs.values():
            _begun(env, seed)
        watches = {key: watched(env.unwrapped, time.process_time) for key, env in envs.items()}
        return phases_in_turn(envs, watches, length, ROUNDS, seed, "zeros")
    finally:
        for env in envs.values():
            env.close()


def crowded(env_id: str, number: int) -> SceneSpec:
    """A scene of one of FIRST with `number` things on its floor. Raises ValueError where they have no room."""
    base = scene(FIRST[env_id])
    start = np.array(base.agent_start.position)
    kinds = [body for body in scene("kitchen_a/00").bodies if max(extent_of(body)[:2]) < CELL]
    middles = [np.arange(CELL / 2, size - CELL / 2, CELL) for size in base.room.size]
    places = [(x, y) for x, y in itertools.product(*middles) if np.hypot(x - start[0], y - start[1]) > ROOMY]
    whole(number, 1, len(places), "number")
    bodies = tuple(
        Body(f"{kind.category}_{k + 1}", kind.category, kind.asset, (float(x), float(y), 0.0))
        for k, (kind, (x, y)) in enumerate(zip(itertools.cycle(kinds), places[:number], strict=False))
    )
    carts = tuple(f for f in base.fixtures if f.category == "cart")
    targets = tuple(sorted({body.category for body in bodies[:1]}))
    name = f"bench/{number}_things"
    return dataclasses.replace(base, name=name, bodies=bodies, fixtures=carts, target_categories=targets)


def time_of_pictures(sides: tuple[int, ...], frames: int, seed: int) -> dict[tuple[Case, int], tuple[float, float]]:
    """Wall time and processor time of a frame [s], by case and side of its picture [pixels]."""
    envs: dict[Any, gym.Env] = {}
    for side in sides:
        size = {"obs_mode": PICTURE, "sensor_configs": {"width": side, "height": side}}
        envs[OURS, side] = OURS.make(**size)
        renderer = envs[OURS, side].unwrapped.backend.render_backend  # type: ignore[attr-defined]
        envs[STOCK, side] = STOCK.make(render_backend=renderer, **size)
    try:
        for env in envs.values():
            _begun(env, seed, 2)  # shaders are compiled at the first picture
        turns = frames_in_turn(envs, max(frames // ROUNDS, 1), ROUNDS, seed, ("zeros",))
        return {key: (turn.wall["zeros"], turn.cpu["zeros"]) for key, turn in turns.items()}
    finally:
        for env in envs.values():
            env.close()


def _begun(env: gym.Env, seed: int, frames: int = WARM_UP) -> None:
    env.reset(seed=seed)
    spent(env, actions_of(env, "zeros", frames, seed))


def things_table(found: Mapping[tuple[str, int], Mapping[str, float]]) -> str:
    """A row for each number of things, a column for each task."""
    rows: dict[int, dict[str, str]] = {}
    for (env_id, number), phases in found.items():
        frame, physics, hazards = phases["frame"], phases["physics"], sum(phases.get(hook, 0.0) for hook in HOOKS)
        rows.setdefault(number, {})[env_id] = f"{1e6 * frame:.0f} ({1e6 * physics:.0f}; {hazards / frame:.0%})"
    tasks = [*next(iter(rows.values()))]
    return table(["things", *tasks], [[str(number), *row.values()] for number, row in rows.items()], 0)


def pictures_table(found: Mapping[tuple[Case, int], tuple[float, float]]) -> str:
    """A row for each size, a column for each case, and the ratio of ours to stock."""
    rows = []
    for side in dict.fromkeys(side for _, side in found):
        both = [found[case, side] for case in (OURS, STOCK)]
        cells = [f"{1e3 * wall:.1f} ({1e3 * cpu:.1f})" for wall, cpu in both]
        rows.append([str(side), *cells, f"{both[0][0] / both[1][0]:.2f}"])
    return table(["pixels", *(f"{case.env_id}, {case.robot}" for case in (OURS, STOCK)), "ratio"], rows, 0)
