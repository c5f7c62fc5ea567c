"""Finds what is wrong with a scene: things inside each other, targets out of reach, impossible sizes and masses.

It checks generated scenes and those that others wrote, indoors and in the open. Whether things stay where they are,
only the simulator knows: see `hazard_ms.simulation.rest_check`.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from hazard_ms.scenes import schema
from hazard_ms.scenes.assets.index import asset
from hazard_ms.scenes.boxes import Box, box_of
from hazard_ms.scenes.floor import (
    FLOOR_CELL,
    RUG_HEIGHT,
    Grid,
    boxes_of,
    cell_of,
    cells,
    connected,
    free_floor,
    free_for,
    halls,
    open_leaves,
    partitions,
    touches,
)
from hazard_ms.scenes.generate.scatter import MAX_TOP_HEIGHT, REACH_DISTANCE, ROBOT_RADIUS
from hazard_ms.scenes.solids import Corners, corners_of, gap
from hazard_ms.spec import Body, Fixture, SceneSpec
from hazard_ms.spec.catalogue import CATEGORIES

DEEP = 0.002  # how far boxes may reach into each other: what stands on a thing sinks in a little [m] [ours]
ON = 0.02  # between a surface and what stands on it [m] [ours]
BODY_SIZES = (0.002, 1.5)  # longest edge of things that move: shirt button, shopping bag on wheels [m] [ours]
BODY_MASSES = (0.0005, 60.0)  # shirt button, full suitcase [kg] [ours]
FIXTURE_SIZES = (0.05, 30.0)  # longest edge of things that do not move: switch, house [m] [ours]
# mass over the volume of the box, as a multiple of the category's density: hollow, cast [-] [ours]
DENSITIES = (0.02, 3.0)


def check(spec: SceneSpec) -> list[str]:
    """Everything that is wrong with a scene, in words; empty if nothing is."""
    try:
        schema.check(spec)
    except ValueError as error:
        return [str(error)]
    missing = list(_missing(spec))
    if missing:
        return missing
    return [*_sizes(spec), *_inside(spec), *_apart(spec), *in_leaves(spec), *_ways(spec), *_fires(spec)]


def _missing(spec: SceneSpec) -> Iterator[str]:
    """Models that do not exist."""
    for t in spec.things:
        try:
            asset(t.asset)
        except ValueError:
            yield f"asset of {t.name} must be one of the assets, got {t.asset!r}"


def _sizes(spec: SceneSpec) -> Iterator[str]:
    """Sizes and masses that no thing of its kind has."""
    for t in spec.things:
        kind = asset(t.asset)
        size = np.array(kind.extent) * t.scale
        low, high = BODY_SIZES if isinstance(t, Body) else FIXTURE_SIZES
        if not low <= size.max() <= high:
            yield f"length of {t.name} must be {low} to {high} m, got {size.max():.3f}"
        if isinstance(t, Body):
            mass = kind.mass * math.prod(t.scale) if t.mass is None else t.mass
            ratio = mass / float(size.prod()) / CATEGORIES[t.category].density
            if not BODY_MASSES[0] <= mass <= BODY_MASSES[1]:
                yield f"mass of {t.name} must be {BODY_MASSES[0]} to {BODY_MASSES[1]} kg, got {mass:.4f}"
            elif not DENSITIES[0] <= ratio <= DENSITIES[1]:
                low, high = DENSITIES
                yield f"mass of {t.name} must be {low} to {high} times the usual for its size, got {ratio:.3f} times"


def _inside(spec: SceneSpec) -> Iterator[str]:
    """Things that reach through the floor, the walls or the ceiling, or lie outside of the ground."""
    room = spec.room
    low = np.array([-room.beyond, -room.beyond, 0.0])
    high = np.array(
        [room.size[0] + room.beyond, room.size[1] + room.beyond, math.inf if room.open_air else room.height]
    )
    for t in spec.things:
        if room.open_air and isinstance(t, Fixture):
            continue  # houses and trees stand around the place
        corners = corners_of(t)
        if (corners.min(0) < low - DEEP).any() or (corners.max(0) > high + DEEP).any():
            yield f"{t.name} at {t.position} reaches out of the room"


def _apart(spec: SceneSpec) -> Iterator[str]:
    """Things that are inside each other. What stands on a surface of another, in a shelf say, may be inside its box."""
    things = [t for t in spec.things if not (isinstance(t, Fixture) and asset(t.asset).extent[2] < RUG_HEIGHT)]
    solid = [corners_of(t) for t in things]
    walls = [_corners(b) for b in partitions(spec.room)]
    middle = np.array([c.mean(0) for c in solid]).reshape(-1, 3)
    radius = np.array([np.linalg.norm(c[7] - c[0]) / 2 for c in solid])
    for i, a in enumerate(things):
        near = np.linalg.norm(middle[:i] - middle[i], axis=1) < radius[:i] + radius[i]
        for j in np.nonzero(near)[0]:
            b = things[j]
            if not _stands_on(a, b) and not _stands_on(b, a) and gap(solid[i], solid[j]) < -DEEP:
                yield f"{a.name} and {b.name} are inside each other by {-gap(solid[i], solid[j]):.3f} m"
        if any(gap(solid[i], wall) < -DEEP for wall in walls):
            yield f"{a.name} is inside a wall"


def in_leaves(spec: SceneSpec) -> Iterator[str]:
    """Robots and things in the way of leaves of doors that stand open at frame 0."""
    leaves = open_leaves(spec.room)
    if touches(leaves, spec.agent_start.position, ROBOT_RADIUS):
        yield f"the robot starts in a door's open leaf, at {spec.agent_start.position}"
    solid = [_corners(b) for b in leaves]
    for t in spec.bodies:
        if any(gap(corners_of(t), leaf) < -DEEP for leaf in solid):
            yield f"{t.name} is inside a door's open leaf"


def _stands_on(upper: Body | Fixture, lower: Body | Fixture) -> bool:
    """Whether `upper` stands on one of the surfaces of `lower`."""
    box, (x, y, z) = box_of(lower, asset(lower.asset).extent), upper.position
    u, v = box.local(np.array(x), np.array(y))
    for s in asset(lower.asset).supports:
        height = lower.position[2] + s.z * lower.scale[2]
        low, high = np.array(s.min) * lower.scale[:2], np.array(s.max) * lower.scale[:2]
        if abs(z - height) <= ON and low[0] - ON <= u <= high[0] + ON and low[1] - ON <= v <= high[1] + ON:
            return True
    return False


def _ways(spec: SceneSpec) -> Iterator[str]:
    """Whether the robot fits where it starts and gets near every target and container, at a height that it reaches."""
    reached = connected(free_floor(spec, ROBOT_RADIUS), spec.agent_start.position)
    if not reached.any():
        yield f"the robot does not fit where it starts, at {spec.agent_start.position}"
        return
    wanted: list[Body | Fixture] = [*spec.targets, *spec.containers]
    for t in wanted:
        box = box_of(t, asset(t.asset).extent)
        away = _away(spec, box, reached)
        if away > REACH_DISTANCE + FLOOR_CELL:
            yield f"the robot must get to within {REACH_DISTANCE} m of {t.name}, got {away:.2f}"
        elif isinstance(t, Body) and not -DEEP <= (box.low + box.high) / 2 <= MAX_TOP_HEIGHT + FLOOR_CELL:
            middle = (box.low + box.high) / 2
            yield f"height of {t.name} above the floor must be 0 to {MAX_TOP_HEIGHT} m, got {middle:.2f}"


def _away(spec: SceneSpec, box: Box, reached: Grid) -> float:
    """Distance of a box from the nearest place of the robot on the same side of all partitions [m]."""
    x, y = cells(spec.room.size)
    i, j = np.clip(cell_of((box.x, box.y)), 0, np.array(reached.shape) - 1)
    (hall,) = ((a, b) for a, b in halls(spec.room) if a.start <= i < a.stop and b.start <= j < b.stop)
    away = box.distance(x[hall[0]], y[:, hall[1]])
    return float(away.min(initial=math.inf, where=reached[hall]))


def _fires(spec: SceneSpec) -> Iterator[str]:
    """Fires under things or walls."""
    bare = free_for(spec.room, *boxes_of(spec), FLOOR_CELL)
    x, y = cells(spec.room.size)
    for fire in spec.fires:
        cell = np.unravel_index(np.argmin(np.hypot(x - fire[0], y - fire[1])), bare.shape)
        if not bare[cell]:
            yield f"something stands where it burns, at {fire}"


def _corners(box: Box) -> Corners:
    """The corners of an upright box, [8, 3], in the order of `corners_of`."""
    flat = [box.world(i * box.half_x, j * box.half_y) for i in (-1, 1) for j in (-1, 1)]
    return np.array([[x, y, z] for x, y in flat for z in (box.low, box.high)])
