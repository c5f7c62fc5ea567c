"""Places robots: apart from one another at the start of an episode, and wherever a user asks for."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import torch
from torch import Tensor

from hazard_ms.scenes.floor import FLOOR_CELL, open_leaves, touches
from hazard_ms.scenes.reach import floor_of
from hazard_ms.simulation import clearance
from hazard_ms.simulation.robot import Robot
from hazard_ms.simulation.world import World
from hazard_ms.spec import Build

APART = 0.3  # least gap between two robots at the start, so that each can turn and bring out its arm [m] [ours]


def starts(world: World, env: int, builds: Sequence[Build]) -> list[tuple[float, float]]:
    """Places x, y [m] at which the robots of these `builds` start in scene `env`: the first where the scene says.

    Each further one gets the nearest place to it to which it could walk from there, APART from the others. Raises
    ValueError for a scene in which there is none.
    """
    spec = world.specs[env]
    first = spec.agent_start.position
    found, leaves = [first], open_leaves(spec.room)
    for number, build in enumerate(builds[1:], 1):
        cells = (np.argwhere(floor_of(spec, build.radius)) + 0.5) * FLOOR_CELL
        for place, other in zip(found, builds, strict=False):
            cells = cells[np.hypot(*(cells - place).T) >= build.radius + other.radius + APART]
        order = np.argsort(np.hypot(*(cells - first).T), kind="stable")
        sorted_cells = [(float(x), float(y)) for x, y in cells[order]]
        outside = (cell for cell in sorted_cells if not touches(leaves, cell, build.radius + clearance.MARGIN))
        clear = (cell for cell in outside if not clearance.obstacle(world, env, cell, build.radius))
        nearest = next(clear, None)
        if nearest is None:
            raise ValueError(f"robot_uids must be at most {number} robots in {spec.name}, got {len(builds)}")
        found.append(nearest)
    return found


def place_all(world: World, rows: Tensor, robots: Sequence[Any]) -> None:
    """Put all `robots` at their starts in the environments `rows` [R]. Raises ValueError as `starts` does."""
    builds = [robot.build for robot in robots]
    places = torch.tensor([starts(world, e, builds) for e in rows.tolist()])
    headings = torch.tensor([world.specs[e].agent_start.heading for e in rows.tolist()])
    for number, robot in enumerate(robots):
        robot.place(rows, places[:, number], headings)


def check_clear(world: World, env: int, place: tuple[float, float], robot: Robot, robots: Mapping[str, Robot]) -> None:
    """Check that a `robot` would touch no thing, no wall and no other one in scene `env` at `place` [m].

    `robots`: all of the scene, by name. Raises ValueError where it would.
    """
    radius = robot.build.radius
    others = {n: r.base_pose()[0][env, :2].tolist() for n, r in robots.items() if r is not robot}
    near = [n for n, at in others.items() if math.dist(place, at) < radius + robots[n].build.radius]
    touched = f"the robot {near[0]}" if near else clearance.obstacle(world, env, place, radius)
    if touched:
        x, y = place
        raise ValueError(
            f"the robot must start {radius} m clear of all things, got ({x:g}, {y:g}), too close to {touched}: "
            "hazard_ms.simulation.clearance.clear_points lists free places"
        )


def put(env: Any, robot: Any, rows: Tensor, place: tuple[float, float], heading: float) -> None:
    """Put a `robot` of `env`, a HazardEnv, at `place` [m] with `heading` [rad], in the environments `rows` [R]."""
    env.scene._reset_mask[:] = False
    env.scene._reset_mask[rows] = True
    robot.place(rows, torch.tensor([place]), torch.tensor([heading]))
    if env.gpu_sim_enabled:
        env.scene._gpu_apply_all()
        env.scene.px.gpu_update_articulation_kinematics()
        env.scene._gpu_fetch_all()
    robot.controller.reset()  # commands that go on from the last one go on from here
    env.scene._reset_mask[:] = True
