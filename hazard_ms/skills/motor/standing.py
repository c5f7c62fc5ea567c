"""Another place to stand for a pick-up, where the arm would meet too much on its way from where the base is."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from hazard_ms.skills.context import Stage
from hazard_ms.skills.motor.motion import turned, wrap
from hazard_ms.skills.motor.navigation import Path, Ways
from hazard_ms.skills.motor.reaching import LEAST, STAND_OFF, aims, routes
from hazard_ms.skills.motor.surface import Surface, place_of

DIRECTIONS = 12  # around the thing from which a place to stand is looked for [ours]
SHARES = (STAND_OFF, 0.65)  # of the arm's span: how far from the thing these places are [ours]
MOST = 16  # places that are weighed, the nearest ones by the way there [ours]


class Move(NamedTuple):
    """A path to another place, and the frames to get there and face the thing."""

    path: Path
    turn: float  # between the heading now and there [rad]
    frames: float


def better_place(stage: Stage, index: int, worth: float, hits: int, apart: float = 0.0) -> Path | None:
    """The path to where a pick-up of the thing `index` costs least, the way there included.

    None where no place at least `apart` [m] from here makes it cost less than `worth` [frames] with at most `hits`
    checked points of the arm's way in something.
    """
    place = place_of(stage, index)
    x, y, _ = stage.robot.base()
    best: Path | None = None
    for move in sorted(_moves(stage, place.middle), key=lambda move: move.frames)[:MOST]:
        if move.frames + LEAST >= worth:
            break
        at = move.path.points[-1]
        if float(np.hypot(*(at - (x, y)))) < apart:
            continue
        surface = Surface(stage, place, move.turn, at)
        # where the thing would be before a base that stayed where it is
        seen = turned(place.middle + np.array([x - at[0], y - at[1], 0.0]), (x, y), -move.turn)
        for aim in aims(stage, seen, index, surface.outward):
            for _, route in routes(stage, aim, surface, 0.0):
                if route.hits <= hits and move.frames + route.cost < worth:
                    best, worth = move.path, move.frames + route.cost
    return best


def _moves(stage: Stage, thing: NDArray[np.float64]) -> Iterator[Move]:
    """The paths to places from which the arm is long enough for the `thing` [m], [3]."""
    x, y, heading = stage.robot.base()
    build, seen = stage.robot.build, stage.seen
    nearest, farthest = build.span(float(thing[2]))
    angles = np.arange(DIRECTIONS) * 2.0 * np.pi / DIRECTIONS
    around = np.stack([np.cos(angles), np.sin(angles)], -1)
    spots = np.concatenate([thing[:2] + max(nearest, share * farthest) * around for share in SHARES])
    goals = [(float(a), float(b)) for a, b in spots]
    ways = Ways(stage.obstacles(), seen.explored, seen.cell, seen.origin, (x, y), goals, build.radius)
    for goal in goals:
        path = ways.path(goal, 0.0, seen.cell)
        if path is None or path.short > seen.cell or not len(path.points):
            continue
        legs = np.diff(np.vstack([[x, y], path.points, thing[:2]]), axis=0)
        headings = np.concatenate([[heading], np.arctan2(legs[:, 1], legs[:, 0])])
        turns = [abs(wrap(float(turn))) for turn in np.diff(headings)]
        frames = path.length / build.forward_step + sum(turns) / build.turn_step
        yield Move(path, wrap(float(headings[-1]) - heading), frames)
