"""One scene as the sketch needs it: small arrays of places, ways, sight and fate; and many scenes as one stack.

A site is a place where something stands or comes to be: the start, targets, carts, landmarks. T targets, C carts and
L landmarks are its things, J = T + C + L, in this order. A stand is a place where the robot can be, from which ways to
all sites begin: there is one for each cell of a coarse grid over the floor.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hazard_ms.skills.options.landmarks import AROUND
from hazard_ms.skills.options.options import CART_SLOTS, TARGET_SLOTS

GOLDEN = np.pi * (3.0 - np.sqrt(5.0))  # turn from one spot around a landmark to the next, for even spacing [rad]
SPOTS = 16  # places on the floor around a landmark, whose sight counts as the share explored there: bits of uint16
# of a target: 1 if it can burn, 1 if water does not damage it, and the temperature at which it catches fire [C]
TRAITS = ("flammable", "waterproof", "ignition")
LOOKS = 4  # looks on each way, Q: the robot looks once a metre, and ways are about so long [ours]

Ints = NDArray[np.int64]
Floats = NDArray[np.float64]
Bools = NDArray[np.bool_]


def _none(shape: int | tuple[int, ...], kind: type) -> Any:
    """An empty array of this shape, for scenes without what it is about."""
    return field(default_factory=lambda: np.zeros(shape, kind))


@dataclass(frozen=True)
class SketchScene:
    """One scene with S sites, P stands, G = Y X cells, H hazards, and K samples over time.

    Raises ValueError for arrays that do not fit each other.
    """

    name: str
    max_frames: int
    heading: float  # of the robot at the start, which is site 0 [rad]
    position: Floats  # of the sites [m], [S, 2]
    stand: Floats  # places from which ways begin and looks are taken [m], [P, 2]
    stand_of: Ints  # number of the nearest stand of each cell, [G]
    grid_origin: tuple[float, float]  # south-west corner of the cells [m]
    grid_cell: float  # edge of a cell [m]
    grid_shape: tuple[int, int]  # Y, X
    travel: Floats  # from facing the way at a stand to facing a site [frames], [P, S]; infinite where there is no way
    first: Floats  # heading in which each of these ways begins [rad], [P, S]
    last: Floats  # heading in which it ends, facing the site [rad], [P, S]
    way: Floats  # places on it, evenly spaced, the last at its end [m], [P, S, Q, 2]
    pixels: NDArray[np.float16]  # of a thing at a site in a look straight at it from a stand, [P, S]
    spots: NDArray[np.uint16]  # floor around each landmark that is seen from a stand, one bit each, [P, L]
    target_site: Ints  # of each target at every sample, [K, T]; one sample if nothing moves
    cart_site: Ints  # [C]
    landmark_site: Ints  # [L]
    value: Floats  # of each target, [T]
    height: Floats  # of each target's middle above the floor [m], [T]
    clearance: Floats  # from each target to where the robot can stand [m], [T]
    damaged_at: Ints  # frame in which each target is damaged if nobody takes it away, [T]; -1: never
    safe_at: Ints  # frame in which each target becomes safe by itself, [T]; -1: never
    level: Floats  # of each hazard at each target at every sample, in its unit, [K, T, H]
    limit: Floats  # level from which each target is damaged, in the hazard's unit, [T, H]; infinite: none
    traits: Floats  # of each target, as agents are told of it: see TRAITS, [T, 3]
    # of tasks with measures: F fires that can be put out (hazard_ms.sketch.fires.alone), and E extinguishers
    fire_site: Ints = _none(0, np.int64)  # where each is fought from, [F]
    fire_place: Floats = _none((0, 2), np.float64)  # where it is [m], [F, 2]
    fire_seen: Bools = _none((0, 0), np.bool_)  # whether each is in sight of a stand, [P, F]
    hit_at: Ints = _none((0, 0), np.int64)  # frame in which each alone damages each target, [F, T]; -1: never
    fire_level: NDArray[np.float16] = _none((0, 0, 0), np.float16)  # at each target with each alone [C], [K, F, T]
    flames: Ints = _none((0, 0), np.int64)  # of each fire at each sample, [K, F]
    tool_site: Ints = _none(0, np.int64)  # where each extinguisher is at the start, [E]
    tool_charge: Floats = _none(0, np.float64)  # frames that it lasts, [E]

    def __post_init__(self) -> None:
        sites, targets, marks = len(self.position), len(self.value), len(self.landmark_site)
        stands, hazards = len(self.stand), self.limit.shape[-1]
        wanted = {
            "stand_of": (self.grid_shape[0] * self.grid_shape[1],),
            "travel": (stands, sites),
            "first": (stands, sites),
            "last": (stands, sites),
            "way": (stands, sites, LOOKS, 2),
            "height": (targets,),
            "clearance": (targets,),
            "damaged_at": (targets,),
            "safe_at": (targets,),
            "limit": (targets, hazards),
            "traits": (targets, len(TRAITS)),
            "pixels": (stands, sites),
            "spots": (stands, marks),
        }
        for name, shape in wanted.items():
            if getattr(self, name).shape != shape:
                raise ValueError(f"{name} of {self.name} must have shape {shape}, got {getattr(self, name).shape}")
        ends = {"target_site": sites, "cart_site": sites, "landmark_site": sites, "stand_of": stands}
        for name, end in ends.items():
            found = getattr(self, name)
            if found.size and not 0 <= found.min() <= found.max() < end:
                raise ValueError(f"{name} of {self.name} must be numbers from 0 to {end - 1}, got {found.max()}")
        for name, count, most in (("targets", targets, TARGET_SLOTS), ("carts", len(self.cart_site), CART_SLOTS)):
            if count > most:
                raise ValueError(f"{self.name} must have at most {most} {name}, got {count}")
        if self.target_site.shape[-1] != targets or self.level.shape[1:] != (targets, hazards):
            shapes = (self.target_site.shape, self.level.shape)
            raise ValueError(f"target_site and level of {self.name} must have {targets} targets, got shapes {shapes}")


class Stack:
    """W scenes as arrays with an axis W in front, smaller scenes filled up with sites and things that are not there."""

    def __init__(self, scenes: Sequence[SketchScene]) -> None:
        """Stack `scenes`. Raises ValueError for none, and for scenes with different numbers of hazards."""
        if not scenes or len({scene.limit.shape[1] for scene in scenes}) != 1:
            raise ValueError(
                f"scenes must hold at least one scene, all with the same number of hazards, got {len(scenes)} scenes"
            )
        self.names = tuple(scene.name for scene in scenes)
        self.max_frames = np.array([scene.max_frames for scene in scenes])
        self.heading = np.array([scene.heading for scene in scenes])
        self.position, self.first, self.last, self.way = (
            _stacked([getattr(s, n) for s in scenes], 0.0) for n in ("position", "first", "last", "way")
        )
        self.travel = _stacked([s.travel for s in scenes], np.inf)
        self.value, self.height, self.clearance, self.traits = (
            _stacked([getattr(s, n) for s in scenes], 0.0) for n in ("value", "height", "clearance", "traits")
        )
        self.there = _stacked([np.ones(len(s.value), bool) for s in scenes], False)
        self.damaged_at = _stacked([s.damaged_at for s in scenes], -1)
        self.safe_at = _stacked([s.safe_at for s in scenes], -1)
        self.limit = _stacked([s.limit for s in scenes], np.inf)
        self.target_site = _stacked(_lasting([s.target_site for s in scenes]), 0)
        self.level = _stacked(_lasting([s.level for s in scenes]), 0.0)
        self.cart_there = _stacked([np.ones(len(s.cart_site), bool) for s in scenes], False)
        self.mark_there = _stacked([np.ones(len(s.landmark_site), bool) for s in scenes], False)
        self.cart_site = _stacked([s.cart_site for s in scenes], 0)
        self.landmark_site = _stacked([s.landmark_site for s in scenes], 0)
        self.grid_origin = np.array([s.grid_origin for s in scenes])
        self.grid_cell = np.array([s.grid_cell for s in scenes])
        self.grid_shape = np.array([s.grid_shape for s in scenes])
        self.stand, self.stand_of = _stacked([s.stand for s in scenes], 0.0), _stacked([s.stand_of for s in scenes], 0)
        self.pixels = _stacked([s.pixels for s in scenes], 0.0)
        self.spots = _stacked([s.spots for s in scenes], 0)
        self.measures = any(len(s.fire_site) for s in scenes)  # whether there is anything to put out
        self.fire_there = _stacked([np.ones(len(s.fire_site), bool) for s in scenes], False)
        self.tool_there = _stacked([np.ones(len(s.tool_site), bool) for s in scenes], False)
        self.fire_site, self.tool_site, self.tool_charge, self.fire_seen = (
            _stacked([getattr(s, n) for s in scenes], 0) for n in ("fire_site", "tool_site", "tool_charge", "fire_seen")
        )
        self.fire_place = _stacked([s.fire_place for s in scenes], 0.0)
        self.hit_at = _stacked([s.hit_at for s in scenes], -1)
        self.fire_level, self.flames = (
            _stacked(_lasting([getattr(s, n) for s in scenes]) if self.measures else [getattr(s, n) for s in scenes], 0)
            for n in ("fire_level", "flames")
        )
        # all floor around each landmark that is ever seen, [W, L]: the rest counts for nothing
        self.all_spots = np.bitwise_or.reduce(self.spots, axis=1)


def spot_offsets() -> Floats:
    """Offsets of the SPOTS from their landmark [m], [SPOTS, 2]."""
    number = np.arange(SPOTS)
    out = AROUND * np.sqrt((number + 0.5) / SPOTS)
    return np.stack([np.cos(GOLDEN * number), np.sin(GOLDEN * number)], axis=-1) * out[:, None]


def _stacked(arrays: list[NDArray], fill: float) -> NDArray:
    shape = np.max([array.shape for array in arrays], axis=0)
    made = np.full((len(arrays), *shape), fill, arrays[0].dtype)
    for row, array in zip(made, arrays, strict=True):
        row[tuple(slice(n) for n in array.shape)] = array
    return made


def _lasting(arrays: list[NDArray]) -> list[NDArray]:
    """Arrays [K, ...] with the same K: the last sample lasts."""
    longest = max(len(array) for array in arrays)
    return [array[np.minimum(np.arange(longest), len(array) - 1)] for array in arrays]
