"""Odds that a look is at a thing, and not at what only looks like one: the foot of a lamp, or a fence like a cart.

The logarithm of these odds is linear in what a look shows. What can be carried is no part of what goes on above it and
beside it, and is as high, wide and long as such things are. A cart stands apart: left and right of its mask there is
hardly anything as near and as high as a cart, where a fence goes on. It is as deep as it is wide, and as large as carts
are. Masks of carts hold what is seen through the wire, too, which is left out first.
"""

from __future__ import annotations

import math
from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from hazard_ms.sensing.sighting import Sighting
from hazard_ms.sensing.view import View
from hazard_ms.spec.catalogue import CATEGORIES
from hazard_ms.spec.foreign.plain import Within

FRONT, DEEP = 20.0, 1.1  # percentile of its depths at which a cart begins, and how deep it can be [m] [ours]
BESIDE = 0.6  # width of what counts beside a mask, as a share of its own [ours]
LEAST_BESIDE = 2  # pixels of that, where the picture ends [ours]
WITHIN, LOW, HIGH = 1.6, 0.2, 1.3  # how near to a cart, and how high above the floor, what counts there is [m] [ours]
SHOWN = 6  # numbers that `shown` tells of a cart
OF_THING = 9  # numbers that `shown_of_thing` tells
AROUND = 1.2  # radii of a thing within which what is about it counts [ours]
LEAST_AROUND, MOST_AROUND = 0.25, 0.5  # the least and the greatest distance that this may be [m] [ours]
ABOVE = 0.03  # how far below the upper end of a thing what is above it begins: its edge [m] [ours]
ENDS = (5.0, 95.0)  # percentiles of its points between which a thing lies: those at its edge may be behind it [ours]
LEAST = 1e-3  # no chance counts as smaller, nor as larger than 1 less this [ours]
LEAST_SHARE, LEAST_WIDTH = 0.02, 0.01  # by which shares, and widths [m], are larger before their logarithm [ours]
FARTHEST = 7.0  # most that a look changes the logarithm of the odds [ours]
Weights = Annotated[tuple[Annotated[float, Within(-1e3, 1e3)], ...], Within(SHOWN, OF_THING)]


def length_of(category: str) -> int:
    """The number of weights for looks at what is taken for a `category`."""
    return OF_THING if CATEGORIES[category].kind == "object" else SHOWN


def in_front(mask: NDArray[np.bool_], depth: NDArray[np.float32]) -> NDArray[np.bool_]:
    """The pixels of a cart's `mask`, [H, W], that are of the cart by their `depth` [m], [H, W]."""
    far = depth[mask & (depth > 0.0)]
    if not len(far):
        return mask
    made: NDArray[np.bool_] = mask & (depth > 0.0) & (depth <= np.percentile(far, FRONT) + DEEP)
    return made


def shown(view: View, mask: NDArray[np.bool_], seen: Sighting, chance: float) -> tuple[float, ...]:
    """The numbers, [SHOWN], that tell of a cart with a `mask`, [H, W], which was `seen` with a detector's `chance`.

    1; the log-odds of the chance; octaves of its pixels, and of those that it would have 1 m before the middle of the
    picture; the logarithms of the share of what is beside it that is as near and as high, and of its width [m].
    """
    rows, columns = np.nonzero(mask)
    flat = view.points(rows, columns)[:, :2].astype(np.float64)
    flat -= flat.mean(0)
    wide = 4.0 * math.sqrt(max(float(np.linalg.eigvalsh(flat.T @ flat / len(flat))[0]), 0.0))
    near = _beside(view, (int(rows.min()), int(rows.max()) + 1), (int(columns.min()), int(columns.max()) + 1), seen)
    told = (1.0, _log_odds(chance), math.log2(seen.pixels), math.log2(max(seen.size, 1.0)))
    return (*told, math.log(near + LEAST_SHARE), math.log2(wide + LEAST_WIDTH))


def shown_of_thing(view: View, mask: NDArray[np.bool_], seen: Sighting, chance: float) -> tuple[float, ...]:
    """The numbers, [OF_THING], that tell of what can be carried, with a `mask`, [H, W], `seen` with a `chance`.

    1; the log-odds of the chance; octaves of its pixels, and of those that it would have 1 m before the middle of the
    picture; the logarithms of the shares of what is above it and beside it, as high and as wide as its mask, that is as
    near; octaves of its height, width and length [m].
    """
    rows, columns = np.nonzero(mask)
    points = view.points(rows, columns).astype(np.float64)
    low, high = np.percentile(points[:, 2], ENDS)
    flat = points[:, :2] - points[:, :2].mean(0)
    wide, long = 4.0 * np.sqrt(np.linalg.eigvalsh(flat.T @ flat / len(flat)).clip(0.0))
    (top, left), (bottom, right) = (int(rows.min()), int(columns.min())), (int(rows.max()) + 1, int(columns.max()) + 1)
    tall, broad = max(bottom - top, LEAST_BESIDE), max(right - left, LEAST_BESIDE)
    near = min(max(AROUND * seen.radius, LEAST_AROUND), MOST_AROUND)
    above = _share(view, mask, (top - tall, top, left, right), seen, near, high - ABOVE)
    sides = ((top, bottom, left - broad, left), (top, bottom, right, right + broad))
    beside = sum(_share(view, mask, side, seen, near + LEAST_AROUND, low + LEAST_AROUND) for side in sides) / 2.0
    sizes = (math.log2(each + LEAST_WIDTH) for each in (float(high - low), float(wide), float(long)))
    return (
        1.0,
        _log_odds(chance),
        math.log2(seen.pixels),
        math.log2(max(seen.size, 1.0)),
        math.log(above + LEAST_SHARE),
        math.log(beside + LEAST_SHARE),
        *sizes,
    )


def _share(
    view: View, mask: NDArray[np.bool_], part: tuple[int, int, int, int], seen: Sighting, near: float, low: float
) -> float:
    """The share of the pixels beside a `mask` that is as `near` as what was `seen` and higher than `low` [m].

    `part`: first and last row and column of the pixels. 0 where the picture has none there.
    """
    (height, width), (top, bottom, left, right) = view.depth.shape, part
    inside = np.mgrid[max(top, 0) : min(bottom, height), max(left, 0) : min(right, width)]
    row, column = inside.reshape(2, -1)
    other = ~mask[row, column]
    row, column = row[other], column[other]
    if not len(row):
        return 0.0
    points = view.points(row, column)
    away = np.linalg.norm(points[:, :2] - seen.position[:2], axis=-1)
    return float(((view.depth[row, column] > 0.0) & (away < near) & (points[:, 2] > low)).mean())


def _log_odds(chance: float) -> float:
    chance = min(max(chance, LEAST), 1.0 - LEAST)
    return math.log(chance / (1.0 - chance))


def _beside(view: View, rows: tuple[int, int], columns: tuple[int, int], seen: Sighting) -> float:
    """The mean share, left and right of these `rows` and `columns` of a picture, of pixels of what is near and high."""
    (top, bottom), (left, right), width = rows, columns, view.depth.shape[1]
    reach = max(int(BESIDE * (right - left)), LEAST_BESIDE)
    shares = []
    for first, end in ((max(left - reach, 0), left), (right, min(right + reach, width))):
        if end - first < LEAST_BESIDE:
            continue
        row, column = (part.ravel() for part in np.mgrid[top:bottom, first:end])
        points = view.points(row, column)
        away = np.linalg.norm(points[:, :2] - seen.position[:2], axis=-1)
        high = (points[:, 2] > LOW) & (points[:, 2] < HIGH)
        shares.append(float(((view.depth[row, column] > 0.0) & high & (away < WITHIN)).mean()))
    return sum(shares) / len(shares) if shares else 0.0


def odds(weights: Weights, told: tuple[float, ...]) -> float:
    """The odds that a look is at a thing and not at something else, by what is `told` of it and `weights`."""
    return math.exp(min(max(float(np.dot(told, weights)), -FARTHEST), FARTHEST))
