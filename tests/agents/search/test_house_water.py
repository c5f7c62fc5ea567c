"""Water in two rooms against its law: level(p, t) = rise t - tan(1 degree) way(p), and nothing behind a shut door."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from hazard_ms.agents.search.floor_plan import FloorPlan
from hazard_ms.agents.search.house_water import HouseWater, floats_at, soaked_at
from hazard_ms.sensing.door_memory import KnownOpening
from hazard_ms.sensing.semantic_map import SemanticMap
from hazard_ms.sensing.sighting import Sighting
from hazard_ms.sensing.target_table import Target
from hazard_ms.spec.catalogue import CATEGORIES
from tests.agents.search.test_floor_plan import DOOR, two_rooms

RISE, SLOPE, WEST = 0.01 / 60, math.tan(math.radians(1.0)), -4.0  # 1 cm in 60 frames, from the wall at x = -4 m


def flooded(frame: int) -> SemanticMap:
    """The two rooms as seen at `frame` by one who stands in the western one: water comes from the west wall."""
    seen = two_rooms()
    y, x = np.nonzero(seen.explored)
    points = seen.centre_of(y, x)
    here = points[:, 0] < 1.5
    y, x, way = y[here], x[here], points[here, 0] - WEST
    seen.levels[0, y, x] = np.maximum(RISE * frame - SLOPE * way, 0.0)
    seen.told_at[y, x] = frame
    return seen


def test_water_rises_and_goes_on_by_its_law() -> None:
    """Seen at frame 400, when it has come 3.8 m far; at (4, 0), 8 m from the wall, it is wet from frame 838 on."""
    seen = flooded(400)
    water = HouseWater(seen, 0, FloorPlan(seen))
    assert water.rise == pytest.approx(RISE, rel=0.03)
    frames = np.array([400.0, 800.0, 1600.0, 2400.0])
    level = water.at([(-2.0, 0.0), (4.0, 0.0)], frames)
    truth = np.stack([RISE * frames - SLOPE * 2.0, RISE * frames - SLOPE * 8.0], axis=-1).clip(min=0.0)
    assert np.abs(level - truth).max() < 0.03


def test_behind_a_shut_door_it_stays_dry() -> None:
    seen = flooded(800)
    water = HouseWater(seen, 0, FloorPlan(seen, (DOOR,)))
    level = water.at([(4.0, 0.0), (-2.0, 0.0)], np.array([3000.0]))
    assert level[0, 0] == 0.0 and level[0, 1] > 0.4


def test_before_any_water_was_seen_none_is_foreseen() -> None:
    seen = flooded(0)
    assert HouseWater(seen, 0, FloorPlan(seen)).at([(-2.0, 0.0)], np.array([3000.0])).max() == 0.0


def thing(kind: str, height: float = 0.1) -> tuple[Target, Sighting]:
    row = CATEGORIES[kind]
    made = Target(0, f"{kind}_1", kind, 1.0, bool(row.flammable), bool(row.waterproof), row.ignition_temperature)
    return made, Sighting(np.array([0.0, 0.0, height / 2], np.float32), 0.1, height, 0, 50)


def test_a_thing_is_soaked_when_it_is_half_under_water() -> None:
    """A phone is soaked at half its height; a banana and a key are waterproof."""
    assert soaked_at(*thing("phone")) == pytest.approx(0.05)
    assert soaked_at(*thing("banana")) == soaked_at(*thing("key")) == math.inf


def test_a_thing_is_carried_away_when_it_floats() -> None:
    """A banana floats at 0.95 of its height, a pillow at once, a phone and a key never."""
    assert floats_at(*thing("banana")) == pytest.approx(0.095)
    assert floats_at(*thing("throw_pillow")) == pytest.approx(0.01)
    assert floats_at(*thing("phone")) == floats_at(*thing("key")) == math.inf


def test_boards_hold_the_water_as_it_was_when_they_were_set() -> None:
    """In both doors: at (-2, 0), 2 m from the wall, as high as at frame 600 for good; not where one was never seen."""
    seen = flooded(400)
    west = KnownOpening("door_1", 1, "door", (WEST, 0.0, 1.0), 0.9, 1.0, False, 0, outer=True)
    east = KnownOpening("door_2", 2, "door", (4.0, 0.0, 1.0), 0.9, 1.0, False, 0, outer=True)
    boarded = [replace(door, boarded=600) for door in (west, east)]
    frames, at = np.array([400.0, 600.0, 1600.0, 2400.0]), [(-2.0, 0.0)]
    for doors in ([], [west, east], boarded[:1]):
        rising = HouseWater(seen, 0, FloorPlan(seen), doors).at(at, frames)[:, 0]
        assert rising == pytest.approx(RISE * frames - SLOPE * 2.0, abs=0.01)
    held = HouseWater(seen, 0, FloorPlan(seen), boarded).at(at, frames)[:, 0]
    assert held == pytest.approx(RISE * np.minimum(frames, 600.0) - SLOPE * 2.0, abs=0.01)


def test_water_rises_on_from_a_door_without_a_board() -> None:
    """From a door at (4, 0), 6 m away, from where a board in the west has been since frame 600."""
    seen = flooded(400)
    west = KnownOpening("door_1", 1, "door", (WEST, 0.0, 1.0), 0.9, 1.0, False, 0, outer=True, boarded=600)
    east = KnownOpening("door_2", 2, "door", (4.0, 0.0, 1.0), 0.9, 1.0, False, 0, outer=True)
    water = HouseWater(seen, 0, FloorPlan(seen), [west, east])
    frames = np.array([600.0, 2400.0])
    found = water.at([(-2.0, 0.0), (4.0, 0.0)], frames)
    assert found[0, 0] == pytest.approx(RISE * 600.0 - SLOPE * 2.0, abs=0.01)
    assert found[1] == pytest.approx([RISE * 2400.0 - SLOPE * 5.55, RISE * 2400.0], abs=0.012)
