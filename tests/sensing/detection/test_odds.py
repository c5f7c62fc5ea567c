"""What a look shows of a cart tells it from fences, hedges and cars, and what is seen through its wire is left out."""

from __future__ import annotations

import json
import math
from dataclasses import asdict, replace
from pathlib import Path

import numpy as np
import pytest

from hazard_ms.sensing.detection.confusion import Confusion, Look
from hazard_ms.sensing.detection.odds import in_front, odds, shown, shown_of_thing
from hazard_ms.sensing.sighting import sightings
from hazard_ms.sensing.view import View
from tests.sensing.detection.test_confusion import ONE_MUG, TABLE
from tests.worlds.wall import view as wall

WEIGHTS = (-2.0, 1.0, 0.0, 0.2, 0.0, 0.0, 0.0, 0.0, 0.0)  # by hand: sureness and size count
FLAT = {"surer": (0.0, 0.5), "real": (0.5, 0.5), "false": (0.5, 0.5)}
TOLD = replace(TABLE, odds_of={"mug": WEIGHTS}, **FLAT)
NONE = (0.0,) * 5
CHANCES, EVEN, SURE = (0.9, 0.0, 0.0), (1.0, 0.0, 6.0, 10.0, *NONE), (1.0, 1.0, 6.0, 10.0, *NONE)
ROWS, COLUMNS = slice(40, 70), slice(40, 60)  # of a mask in a picture of 100 x 100 that looks along +x from 1 m


def standing(*beside: slice) -> View:
    """A thing 2 m away before a wall at 6 m, and more of the same height in the columns `beside` it."""
    made = wall(6.0)
    depth, labels = np.full((100, 100), 6.0, np.float32), np.full((100, 100), -1, np.int64)
    for columns in (COLUMNS, *beside):
        depth[ROWS, columns] = 2.0
    labels[ROWS, COLUMNS] = 0
    return replace(made, depth=depth, labels=labels)


def told(view: View, chance: float = 0.5) -> tuple[float, ...]:
    assert view.labels is not None
    return shown(view, view.labels == 0, sightings(view, 0, 1, frozenset(), None)[0], chance)


def test_what_is_shown_is_that_by_hand() -> None:
    """600 pixels 2 m ahead at 50 pixels to a radian: 0.8 m wide across the view, and flat; nothing beside it."""
    one, sure, pixels, size, beside, wide = told(standing(), math.e / (1.0 + math.e))
    assert (one, sure, pixels) == (1.0, pytest.approx(1.0), pytest.approx(math.log2(600.0)))
    assert size == pytest.approx(math.log2(600.0 * 4.0), abs=0.05), "hardly beside the middle of the picture"
    assert beside == pytest.approx(math.log(0.02)) and wide == pytest.approx(math.log2(0.01))
    assert told(standing(), 1.0)[1] == pytest.approx(math.log(999.0)), "no detector is surer than that"


def test_its_width_is_the_lesser_one() -> None:
    """Half of it is 0.4 m farther away: points at 0 and 0.4 m along the view, 0.2 m from their middle on average."""
    view = standing()
    view.depth[ROWS.start : 55, COLUMNS] = 2.4
    assert told(view)[5] == pytest.approx(math.log2(4.0 * 0.2 + 0.01), abs=0.05)


def test_what_goes_on_beside_it_counts() -> None:
    """12 columns on each side, 0.6 times its 20: of 30 rows at 2 m the last 27 show 0.2 to 1.3 m above the floor."""
    for beside, share in (
        ((slice(28, 40), slice(60, 72)), 0.9),
        ((slice(28, 40),), 0.45),
        ((slice(34, 40),), 0.225),
        ((slice(0, 25),), 0.0),
    ):
        assert told(standing(*beside))[4] == pytest.approx(math.log(0.02 + share)), beside
    low = standing(slice(28, 40), slice(60, 72))
    low = replace(low, cam2world=low.cam2world.copy())
    low.cam2world[2, 3] -= 0.8  # the camera, 0.2 m high, sees what is above it in the first ten rows
    assert told(low)[4] == pytest.approx(math.log(0.02 + 10.0 / 30.0)), "most of it is lower than a cart"


def test_what_is_seen_through_the_wire_is_left_out() -> None:
    """A third of the mask shows the wall 4 m behind, and some pixels nothing at all; a thing is 1.1 m deep at most."""
    view = standing()
    mask = np.zeros((100, 100), bool)
    mask[ROWS, COLUMNS] = True
    view.depth[ROWS, 40:46] = 6.0
    view.depth[ROWS, 46] = 0.0
    view.depth[ROWS, 47] = 3.0
    view.depth[ROWS, 48] = 3.2
    left = in_front(mask, view.depth)
    assert np.flatnonzero(left[50]).tolist() == [47, *range(49, 60)]
    assert in_front(mask, np.zeros((100, 100), np.float32)).sum() == mask.sum(), "nothing is known of it"


def test_odds_are_the_exponential_of_what_is_shown() -> None:
    assert odds(WEIGHTS, EVEN) == pytest.approx(1.0)
    assert odds(WEIGHTS, (1.0, 0.0, 6.0, 5.0, *NONE)) == pytest.approx(math.exp(-1.0))
    for sign in (1.0, -1.0):
        assert odds((9.0 * sign, *[0.0] * 8), EVEN) == pytest.approx(math.exp(7.0 * sign)), "no look settles it"


def test_each_look_counts_by_its_odds() -> None:
    """0.3 for the mug, 1 for clutter; the odds are 1 / e and then e. What is missed shows nothing."""
    small, sure = Look("mug", 50, CHANCES, (1.0, 0.0, 6.0, 5.0, *NONE)), Look("mug", 200, CHANCES, SURE)
    mug = 0.3 * math.exp(-1.0)
    assert TOLD.posterior([small], ONE_MUG, 0.0)[0] == pytest.approx(mug / (mug + 1.0))
    mug, clutter = mug * 0.8 * 0.9 * math.e, 0.25 * 0.8
    assert TOLD.posterior([small, sure], ONE_MUG, 0.0)[0] == pytest.approx(mug / (mug + clutter))
    mug, clutter = 0.3 * math.exp(-1.0) * 0.2, 0.75
    assert TOLD.posterior([small, Look(None, 200)], ONE_MUG, 0.0)[0] == pytest.approx(mug / (mug + clutter))


def test_where_none_is_expected_or_nothing_is_shown_the_table_counts() -> None:
    plain, seen, blind = replace(TABLE, **FLAT), Look("mug", 50, CHANCES, SURE), Look("mug", 50, CHANCES)
    none = {"mug": 0, "bowl": 1, "book": 1}
    np.testing.assert_array_equal(TOLD.posterior([seen], none, 0.2), plain.posterior([seen], none, 0.2))
    np.testing.assert_array_equal(TOLD.posterior([blind], ONE_MUG, 0.2), plain.posterior([blind], ONE_MUG, 0.2))


def test_odds_are_read_with_the_table(tmp_path: Path) -> None:
    path, table = tmp_path / "small_confusion.json", asdict(TOLD)
    path.write_text(json.dumps(table))
    assert Confusion.read(path) == TOLD
    for change, words in (
        ({"mug": WEIGHTS[4:]}, r"confusion.odds_of.* must be of length 6 to 9"),
        ({"mug": WEIGHTS[1:]}, "odds_of mug must have 9 weights, got 8"),
        ({"mug": (*WEIGHTS[1:], 1e4)}, r"confusion.odds_of.* must be a number from -1000 to 1000"),
        ({"cup": WEIGHTS}, "a category of the table must be one of its classes, got 'cup'"),
    ):
        path.write_text(json.dumps({**table, "odds_of": change}))
        with pytest.raises(ValueError, match=words):
            Confusion.read(path)


def about(view: View) -> tuple[float, ...]:
    assert view.labels is not None
    return shown_of_thing(view, view.labels == 0, sightings(view, 0, 1, frozenset(), None)[0], 0.5)


def test_what_is_shown_of_a_thing_is_that_by_hand() -> None:
    """30 rows and 20 columns 2 m ahead, 0.04 m each: 1.2 m high, 0.8 m long across the view, and flat."""
    one, sure, pixels, size, above, beside, high, wide, long = about(standing())
    assert (one, sure, pixels) == (1.0, 0.0, pytest.approx(math.log2(600.0)))
    assert size == pytest.approx(math.log2(600.0 * 4.0), abs=0.05)
    assert above == beside == pytest.approx(math.log(0.02)), "nothing is about it"
    assert high == pytest.approx(math.log2(27 * 0.04 + 0.01), abs=1e-4), (
        "a twentieth at each end, 1.5 rows, is left out"
    )
    assert wide == pytest.approx(math.log2(0.01))
    # the standard deviation of 20 even steps of 0.04 m, four times
    assert long == pytest.approx(math.log2(4.0 * 0.04 * math.sqrt((20**2 - 1) / 12) + 0.01), abs=1e-4)


def test_a_foot_of_something_higher_has_it_above_it() -> None:
    """12 of its 20 columns go on for 30 rows above it, as many as its own."""
    pole = standing()
    pole.depth[10:40, 44:56] = 2.0
    assert about(pole)[4] == pytest.approx(math.log(0.6 + 0.02))
    assert about(standing())[5] == about(pole)[5], "what is above is not beside"


def test_what_goes_on_beside_a_thing_counts_and_what_is_farther_behind_does_not() -> None:
    row, behind = standing(slice(20, 40), slice(60, 80)), standing(slice(20, 40), slice(60, 80))
    for columns in (slice(20, 40), slice(60, 80)):
        behind.depth[ROWS, columns] = 3.0
    assert about(row)[5] > math.log(0.3) and about(behind)[5] == pytest.approx(math.log(0.02))


def test_at_the_edge_of_the_picture_nothing_is_known_to_be_about_a_thing() -> None:
    made = standing()
    labels = np.full((100, 100), -1, np.int64)
    labels[0:10, 0:10] = 0
    made.depth[0:10, 0:10] = 2.0
    assert about(replace(made, labels=labels))[4] == pytest.approx(math.log(0.02))
