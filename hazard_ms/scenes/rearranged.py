"""Scenes in which other things than targets lie elsewhere, or the robot starts elsewhere, by an episode's seed.

What is moved is as it was in all else, and so are fires, water and wind: they act on things where those are now.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from hazard_ms.scenes import boxes
from hazard_ms.scenes.assets.index import asset
from hazard_ms.scenes.boxes import Box, box_of, free_of, turned, yaw_of
from hazard_ms.scenes.floor import cell_of, connected, doorways, free_floor, open_leaves, partitions, touches
from hazard_ms.scenes.generate.arrangement import MIN_GAP
from hazard_ms.scenes.generate.draw import Draw
from hazard_ms.scenes.generate.scatter import EDGE_MARGIN, ROBOT_RADIUS
from hazard_ms.scenes.generate.support_surfaces import Surface, surfaces_of
from hazard_ms.spec import AgentStart, Body, SceneSpec, Vec2
from hazard_ms.spec.perturbation import Perturbation, amount

# most by level, 0 to 3
MOVES = (0.0, 0.1, 0.2, 0.4)  # of a thing on its surface [m] [ours]
STEPS = (0.0, 0.25, 0.5, 1.0)  # of the robot's start [m] [ours]
TURNS = (0.0, math.radians(15.0), math.radians(45.0), math.radians(90.0))  # of its heading [rad] [ours]
TRIES = 40  # directions that are drawn before a thing stays where it is [ours]
ON = 0.02  # between a surface and what stands on it [m] [ours], as in hazard_ms.scenes.check
FIRE_DISTANCE = 1.0  # of the robot's start from fires, if it was as far before [m] [ours]
SAMPLES = 20  # of the way to another start, which must be free [ours]


def rearranged(spec: SceneSpec, seed: int, perturbation: Perturbation) -> SceneSpec:
    """The scene of `spec` as the episode of `seed` has it under a `perturbation` of objects and start."""
    if perturbation.objects:
        spec = replace(spec, bodies=_moved(spec, seed, perturbation.objects))
    if perturbation.start:
        spec = replace(spec, agent_start=_started(spec, seed, perturbation.start))
    return spec


def _moved(spec: SceneSpec, seed: int, level: int) -> tuple[Body, ...]:
    """The bodies of a scene, of which those that stand on furniture and are no targets lie elsewhere on it.

    What finds no place, is tilted or carries other things stays, and so does what is on the floor: ways stay free.
    """
    fixtures = [box_of(f, asset(f.asset).extent) for f in spec.fixtures]
    surfaces = [
        (k, s)
        for k, (f, b) in enumerate(zip(spec.fixtures, fixtures, strict=True))
        for s in surfaces_of(f.name, asset(f.asset), f.scale, b)
    ]
    made = [box_of(b, asset(b.asset).extent) for b in spec.bodies]
    rows = boxes.rows([*fixtures, *made, *partitions(spec.room), *doorways(spec.room)])
    bodies = list(spec.bodies)
    for i, body in enumerate(spec.bodies):
        upright = max(abs(body.rotation[1]), abs(body.rotation[2])) < 1e-4
        owner, surface = next(((k, s) for k, s in surfaces if _stands_on(made[i], s)), (-1, None))
        if body.category in spec.target_categories or not upright or surface is None or _carries(made, i):
            continue
        others = np.delete(rows, [owner, len(fixtures) + i], axis=0)
        draw = Draw("perturbed objects", f"{seed}|{body.name}")
        for _ in range(TRIES):
            way, yaw = _step(draw, MOVES[level]), draw.uniform(-math.pi, math.pi)
            x, y = (round(at + step, 4) for at, step in zip(body.position, way, strict=False))
            there = replace(body, position=(x, y, body.position[2]), rotation=turned(yaw_of(body.rotation) + yaw))
            box = box_of(there, asset(body.asset).extent)
            if surface.holds(box, EDGE_MARGIN) and free_of(box, others, MIN_GAP):
                bodies[i], made[i], rows[len(fixtures) + i] = there, box, box.row
                break
    return tuple(bodies)


def _stands_on(box: Box, surface: Surface) -> bool:
    u, v = surface.box.local(np.array(box.x), np.array(box.y))
    inside = abs(u - surface.middle[0]) <= surface.half[0] and abs(v - surface.middle[1]) <= surface.half[1]
    return bool(inside) and abs(box.low - surface.z) <= ON


def _carries(made: list[Box], i: int) -> bool:
    """Whether the middle of another thing is above the thing `i`, close to its top."""
    below = made[i]
    near = [b for k, b in enumerate(made) if k != i and abs(b.low - below.high) <= ON]
    return any(float(below.distance(np.array(b.x), np.array(b.y))) == 0.0 for b in near)


def _started(spec: SceneSpec, seed: int, level: int) -> AgentStart:
    """The start of the robot moved straight over free floor, and turned; it stays where no place is free."""
    start, draw = spec.agent_start, Draw("perturbed start", str(seed))
    sign = 1.0 if draw.uniform() < 0.5 else -1.0
    heading = round(start.heading + sign * amount(TURNS[level], draw.uniform()), 4)
    free = connected(free_floor(spec, ROBOT_RADIUS), start.position)
    gaps = [min(FIRE_DISTANCE, math.dist(start.position, fire)) for fire in spec.fires]
    leaves = open_leaves(spec.room)
    for _ in range(TRIES):
        x, y = _step(draw, STEPS[level])
        there = (round(start.position[0] + x, 4), round(start.position[1] + y, 4))
        way = [(start.position[0] + k / SAMPLES * x, start.position[1] + k / SAMPLES * y) for k in range(SAMPLES + 1)]
        safe = all(math.dist(there, fire) >= gap for fire, gap in zip(spec.fires, gaps, strict=True))
        if safe and not touches(leaves, there, ROBOT_RADIUS) and all(_is_free(free, point) for point in way):
            return AgentStart(there, heading)
    return replace(start, heading=heading)


def _step(draw: Draw, most: float) -> Vec2:
    """A step in any direction [m], of an amount of at most `most`."""
    angle, length = draw.uniform(-math.pi, math.pi), amount(most, draw.uniform())
    return length * math.cos(angle), length * math.sin(angle)


def _is_free(free: np.ndarray, point: Vec2) -> bool:
    i, j = cell_of(point)
    return 0 <= i < free.shape[0] and 0 <= j < free.shape[1] and bool(free[i, j])
