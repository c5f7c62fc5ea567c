"""Features of decisions against numbers that can be worked out by hand."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from hazard_ms.skills.decision import EXPLORE, Action, Result
from hazard_ms.skills.options.feature_columns import FEATURES_VERSION
from hazard_ms.skills.options.features import Encoder
from hazard_ms.skills.options.options import Options
from tests.worlds.playground import Playground

FIRE = (20.0, 620.0)  # range of the level [C]
RADIUS = 0.3  # [m]
CELL = 0.15 * 62 / 500  # what the cells at both ends of a path, 0.1 m each, do to a walking time


def encoder() -> Encoder:
    return Encoder([FIRE], RADIUS)


def named(encoder: Encoder, vector: np.ndarray, table: str, row: int) -> dict[str, float]:
    """The numbers of one row by the names of its columns."""
    names = [column.name for column in encoder.tables[table][1]]
    return dict(zip(names, encoder.split(vector)[table][row].tolist(), strict=True))


def ground() -> Playground:
    made = Playground(
        {"mug": (2.0, 0.0), "book": (0.0, 9.0), "cart_1": (0.0, -2.0)}, {"mug": 1.0, "book": 5.0}, carts=("cart_1",)
    )
    made.look()
    return made


def test_the_layout_is_pinned() -> None:
    """A change of the layout changes FEATURES_VERSION, and then these numbers."""
    made = encoder()
    shapes = {table: (rows, len(columns)) for table, (rows, columns) in made.tables.items()}
    assert shapes == {"targets": (32, 15), "carts": (3, 5), "landmarks": (8, 5), "global": (1, 10)}
    assert made.size == 32 * 15 + 3 * 5 + 8 * 5 + 10 == made.space().shape[0]
    assert [c.name for c in made.tables["targets"][1]] == (
        "known held rescued ahead left walk value flammable waterproof ignition damaged level_0 rise_0 unseen failures"
    ).split()
    assert Encoder([FIRE, FIRE], RADIUS).size == made.size + 32 * 2 + 1  # level and rise of each target, one front
    assert FEATURES_VERSION == 1
    space = made.space()
    assert np.isfinite(space.low).all() and np.isfinite(space.high).all() and (space.low < space.high).all()


def test_a_target_that_was_seen() -> None:
    """2 m ahead: seen from 0.6 m, so 1.4 m of walking, 87 frames."""
    decision = ground().decision()
    vector = encoder().encode(decision, Options().menu(decision))
    row = named(encoder(), vector, "targets", 0)
    assert row.pop("walk") == pytest.approx(1.4 * 62 / 500, abs=CELL)
    want = dict.fromkeys(row, 0.0) | {"known": 1.0, "ahead": 0.4, "value": 0.2, "flammable": 1.0, "ignition": 1.0}
    assert row == pytest.approx(want, abs=1e-6)
    assert vector.dtype == np.float32 and encoder().space().contains(vector)


def test_a_target_that_was_not_seen_has_properties_but_no_place() -> None:
    decision = ground().decision()
    row = named(encoder(), encoder().encode(decision, Options().menu(decision)), "targets", 1)
    want = dict.fromkeys(row, 0.0) | {"value": 1.0, "flammable": 1.0, "ignition": 1.0}
    assert row == pytest.approx(want)


def test_empty_slots_are_zeros() -> None:
    decision = ground().decision()
    parts = encoder().split(encoder().encode(decision, Options().menu(decision)))
    assert not parts["targets"][2:].any() and not parts["carts"][1:].any()


@pytest.mark.parametrize(("heading", "ahead", "left"), [(np.pi / 2, 0.0, -0.4), (np.pi, -0.4, 0.0), (0.0, 0.4, 0.0)])
def test_places_are_in_the_agent_s_frame(heading: float, ahead: float, left: float) -> None:
    """A thing in the east lies to the right of one who faces north."""
    decision = dataclasses.replace(ground().decision(), agent_heading=heading)
    row = named(encoder(), encoder().encode(decision, Options().menu(decision)), "targets", 0)
    assert (row["ahead"], row["left"]) == pytest.approx((ahead, left), abs=1e-6)


def test_levels_are_told_in_their_range_with_their_rise() -> None:
    """320 C is half way from 20 C to 620 C; 60 C more in 50 frames is 120 C, a fifth of the range, in 100."""
    made = ground()
    sighting = dataclasses.replace(
        made.map.objects[0], levels=(320.0,), history=((0, (260.0,)), (50, (320.0,))), frame=50
    )
    made.map.objects[0] = sighting
    made.frame = 200
    decision = made.decision()
    row = named(encoder(), encoder().encode(decision, Options().menu(decision)), "targets", 0)
    assert (row["level_0"], row["rise_0"], row["unseen"]) == pytest.approx((0.5, 0.2, 150 / 1500))


def test_carts_and_the_whole() -> None:
    """Two targets, one of them seen; a cart 2 m to the right; 300 of 1500 frames are over; the last action failed."""
    made = ground()
    made.frame, made.last = 300, (Action(EXPLORE), Result(False, "blocked", 3))
    decision = made.decision()
    vector = encoder().encode(decision, Options().menu(decision))
    cart = named(encoder(), vector, "carts", 0)
    assert cart.pop("walk") == pytest.approx(1.4 * 62 / 500, abs=CELL)
    assert cart == pytest.approx({"known": 1.0, "ahead": 0.0, "left": -0.4, "failures": 0.0}, abs=1e-6)
    whole = named(encoder(), vector, "global", 0)
    assert whole.pop("explored") == pytest.approx(np.pi * 9.0 / 100.0, rel=0.02)
    want = {"elapsed": 0.2, "remaining": 0.8, "holding": 0, "carts": 1, "open": 1 / 32, "unknown": 1 / 32, "rescued": 0}
    assert whole == pytest.approx(want | {"front_0": 2.0, "failed": 1.0})


def test_the_front_is_where_the_level_passes_the_middle_of_its_range() -> None:
    made = ground()
    y, x = made.map.cell_of((0.0, 2.55))
    made.map.levels[0, y, x] = 400.0
    made.map.levels[0, y - 10, x] = 100.0  # nearer, but no front
    decision = made.decision()
    whole = named(encoder(), encoder().encode(decision, Options().menu(decision)), "global", 0)
    assert whole["front_0"] == pytest.approx(2.55 / 5.0, abs=0.02)


def test_a_wall_around_a_target_leaves_no_way() -> None:
    """A ring around it, 1.3 to 1.7 m from it, 0.5 m high: too high for the robot, and too far from the target."""
    made = ground()
    y, x = np.mgrid[0:256, 0:256]
    far = np.hypot(made.map.origin[0] + (x + 0.5) * 0.1 - 2.0, made.map.origin[1] + (y + 0.5) * 0.1)
    ring = (far > 1.3) & (far < 1.7)
    made.map._firm[ring], made.map.explored[ring] = 0.5, True
    decision = made.decision()
    row = named(encoder(), encoder().encode(decision, Options().menu(decision)), "targets", 0)
    assert row["walk"] == 2.0 and row["known"] == 1.0


def test_landmarks_are_told_with_the_edge_around_them() -> None:
    """The border of a disc of 3 m within 2 m of a point 2.5 m from its middle: an arc, worked out by hand."""
    made = Playground({"sofa": (2.5, 0.0)}, {})
    made.look()
    decision = made.decision()
    row = named(encoder(), encoder().encode(decision, Options().menu(decision)), "landmarks", 0)
    angle = 2 * np.arccos((3.0**2 + 2.5**2 - 2.0**2) / (2 * 3.0 * 2.5))  # cosine rule
    cells = 3.0 * angle  # a border of 0.1 m cells counts between 0.9 and 1.3 cells per 0.1 m of arc
    assert cells * 0.8 / 10 < row["edge"] < cells * 1.3 / 10
    assert row["ahead"] == pytest.approx(0.5) and row["visits"] == 0.0
