"""Furniture that floats: the depth of water at which each piece leaves the floor.

    rho sum_k s A_k min(max(d - z_k, 0), h_k) = m        Archimedes; parts k with area A, lower side z, height h

s is the share of the parts' volume that keeps water out: m / (solid sum_k A_k h_k), at most 1, with the density `solid`
of what does. Boards and legs displace their wood; cupboards leak through the gaps of their doors as fast as the water
rises, so they displace their boards; refrigerators are sealed; upholstery does not soak within an episode, but its
frame is open below. All else stays: metal sinks, and kitchens, pictures and lamps are fixed or stand in them [ours].
What floats lies as deep as it began to, upright (`Float.volume`).
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from hazard_ms.scenes.solids import half_size, mass_of, parts_of
from hazard_ms.spec import Fixture, SceneSpec

WATER = 1000.0  # density [kg/m^3]
GAP = 0.05  # height of its base above the floor below which a piece stands on it [m] [ours]
WOOD, BOARD = 600.0, 650.0  # densities of wood and of particle board [kg/m^3] [M: USDA Wood Handbook]
SOLID = {  # density of what keeps water out, by category [kg/m^3]
    **dict.fromkeys(("table", "coffee_table", "chair", "stool", "shelf"), WOOD),
    "cabinet": BOARD,
    **dict.fromkeys(("sofa", "armchair", "bed"), 200.0),  # upholstery around a frame that is open below [ours]
    "fridge": 120.0,  # sealed by its gasket: mass over outer volume, as in the catalogue
    "bin": 950.0,  # polyethylene: it fills over its rim [M]
}


class Float(NamedTuple):
    """The depth in which a piece of furniture floats, and the box that stands for it in water."""

    depth: float  # depth of the water at which it leaves the floor [m]; infinite if it never does
    volume: float  # volume of water that it would displace wholly immersed, as a box that floats as deep [m^3]


def floating(thing: Fixture) -> Float:
    """The float of a piece; the depth is infinite for what sinks, is fixed, or does not stand on the floor."""
    mass, solid = mass_of(thing), SOLID.get(thing.category)
    if solid is None or thing.position[2] > GAP or mass <= 0.0:
        return Float(math.inf, 0.0)
    parts = parts_of(thing)
    area = np.array([4.0 * half[0] * half[1] for _, half in parts])
    low = np.array([middle[2] - half[2] - thing.position[2] for middle, half in parts])
    high = np.array([2.0 * half[2] for _, half in parts])
    share = min(1.0, mass / solid / float((area * high).sum()))
    depths = np.unique(np.concatenate([[0.0], low, low + high]))
    held = WATER * share * (area * (depths[:, None] - low).clip(0.0, high)).sum(-1)  # [kg]
    if held[-1] <= mass:
        return Float(math.inf, 0.0)
    depth = float(np.interp(mass, held, depths))
    return Float(depth, mass / WATER * 2.0 * float(half_size(thing)[2]) / depth)


def afloat_in(spec: SceneSpec, depth: float) -> frozenset[str]:
    """Names of the furniture of a scene that water up to `depth` [m] sets afloat."""
    return frozenset(thing.name for thing in spec.fixtures if floating(thing).depth < depth)
