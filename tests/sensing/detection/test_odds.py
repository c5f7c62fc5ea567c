"""What a look shows of a thing tells it from clutter: parts of hedges that are taken for carts are small, or unsure."""

from __future__ import annotations

import json
import math
from dataclasses import asdict, replace
from pathlib import Path

import numpy as np
import pytest

from hazard_ms.sensing.detection.confusion import Confusion, Look
from hazard_ms.sensing.detection.odds import odds, shown
from tests.sensing.detection.test_confusion import ONE_MUG, TABLE

WEIGHTS = (-2.0, 1.0, 0.0, 0.2, 0.0)  # by hand: sureness and size count
FLAT = {"surer": (0.0, 0.5), "real": (0.5, 0.5), "false": (0.5, 0.5)}
TOLD = replace(TABLE, odds_of={"mug": WEIGHTS}, **FLAT)
HALF, SURE = (0.5, 0.0, 0.0), (math.e / (1.0 + math.e), 0.0, 0.0)  # log-odds of 0 and 1


def test_a_look_shows_sureness_pixels_and_size() -> None:
    assert shown(0.5, 64.0, 1024.0).tolist() == [1.0, 0.0, 6.0, 10.0, 100.0]
    assert shown(1.0, 0.5, 0.0).tolist() == [1.0, pytest.approx(math.log(999.0)), 0.0, 0.0, 0.0]


def test_odds_are_the_exponential_of_what_is_shown() -> None:
    assert odds(WEIGHTS, 0.5, 64.0, 1024.0) == pytest.approx(1.0)
    assert odds(WEIGHTS, HALF[0], 64.0, 32.0) == pytest.approx(math.exp(-1.0))
    assert odds((0.0, 0.0, 0.0, 0.0, 1.0), 0.5, 64.0, 1024.0) == pytest.approx(math.exp(7.0)), "no look settles it"
    assert odds((0.0, 0.0, 0.0, 0.0, -1.0), 0.5, 64.0, 1024.0) == pytest.approx(math.exp(-7.0))


def test_each_look_counts_by_its_odds() -> None:
    """0.3 for the mug, 1 for clutter; the odds are e^-1 and then e. What is missed shows nothing."""
    small, large = Look("mug", 50, HALF, 32.0), Look("mug", 200, SURE, 1024.0)
    mug = 0.3 * math.exp(-1.0)
    assert TOLD.posterior([small], ONE_MUG, 0.0)[0] == pytest.approx(mug / (mug + 1.0))
    mug, clutter = mug * 0.8 * 0.9 * math.e, 0.25 * 0.8
    assert TOLD.posterior([small, large], ONE_MUG, 0.0)[0] == pytest.approx(mug / (mug + clutter))
    mug, clutter = 0.3 * math.exp(-1.0) * 0.2, 0.75
    assert TOLD.posterior([small, Look(None, 200)], ONE_MUG, 0.0)[0] == pytest.approx(mug / (mug + clutter))


def test_where_none_is_expected_or_nothing_is_shown_the_table_counts() -> None:
    plain, seen = replace(TABLE, **FLAT), Look("mug", 50, HALF, 32.0)
    none = {"mug": 0, "bowl": 1, "book": 1}
    np.testing.assert_array_equal(TOLD.posterior([seen], none, 0.2), plain.posterior([seen], none, 0.2))
    unknown = Look("mug", 50, HALF)
    np.testing.assert_array_equal(TOLD.posterior([unknown], ONE_MUG, 0.2), plain.posterior([unknown], ONE_MUG, 0.2))


def test_odds_are_read_with_the_table(tmp_path: Path) -> None:
    path, table = tmp_path / "small_confusion.json", asdict(TOLD)
    path.write_text(json.dumps(table))
    assert Confusion.read(path) == TOLD
    for change, told in (
        ({"mug": WEIGHTS[1:]}, r"confusion.odds_of.* must be of length 5 to 5"),
        ({"mug": (0.0, 0.0, 0.0, 0.0, 1e4)}, r"confusion.odds_of.* must be a number from -1000 to 1000"),
        ({"cup": WEIGHTS}, "a category of the table must be one of its classes, got 'cup'"),
    ):
        path.write_text(json.dumps({**table, "odds_of": change}))
        with pytest.raises(ValueError, match=told):
            Confusion.read(path)
