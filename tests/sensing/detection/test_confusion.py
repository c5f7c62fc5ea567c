"""What looks tell by the errors of a detector: posteriors worked out by hand, and beliefs that are so."""

from __future__ import annotations

import json
from collections import Counter
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from hazard_ms.sensing.detection.confusion import Confusion, Look, within_count

TABLE = Confusion(
    classes=("mug", "bowl", "book"),
    pixels=(0, 100),
    found=(0.5, 0.8),
    right=(0.6, 0.9),
    taken={"bowl": {"mug": 2.0}},
    clutter={"mug": 1.0},
    again=0.25,
    steady=0.8,
    seen=0.5,
)
ONE_MUG = {"mug": 1, "bowl": 0, "book": 0}


@pytest.mark.parametrize(
    ("looks", "mug"),
    [
        # one look at few pixels: 0.5 x 1 x 0.6 for the mug that there is, 1 place of clutter
        ([Look("mug", 50)], 0.3 / 1.3),
        # seen again with many: times 0.8 x 0.9, and times 0.25 x 0.8
        ([Look("mug", 50), Look("mug", 200)], 0.216 / (0.216 + 0.2)),
        # and missed then: times 1 - 0.8, and times 1 - 0.25
        ([Look("mug", 50), Look("mug", 200), Look(None, 200)], 0.0432 / (0.0432 + 0.15)),
        # missed with few pixels, which says little: times 1 - 0.5, and times 1 - 0.25
        ([Look("mug", 50), Look(None, 99)], 0.15 / (0.15 + 0.75)),
        # a bucket begins with its least pixels
        ([Look("mug", 50), Look(None, 100)], 0.06 / (0.06 + 0.75)),
        # told otherwise, as half of the errors at a mug: times 0.8 x 0.1 x 1/2, and times 0.25 x 0.2 / 2
        ([Look("mug", 50), Look("bowl", 200)], 0.012 / (0.012 + 0.025)),
    ],
)
def test_the_posterior_is_that_by_hand(looks: list[Look], mug: float) -> None:
    chances = TABLE.posterior(looks, ONE_MUG, 0.0)
    assert chances.tolist() == pytest.approx([mug, 0.0, 0.0, 1.0 - mug], abs=1e-12)


def test_a_detectors_own_chances_share_out_what_all_categories_have_together() -> None:
    """Told a mug by few pixels: 0.6 + 0.4 (2.5 / 3 + 1 / 2) together, shared out by squares 4 : 1 : 0, and evenly."""
    table = replace(TABLE, clutter={}, sharpness=2.0, even=0.1)
    together = 0.6 + 0.4 * (2.5 / 3.0 + 0.5)
    shares = np.array([0.9 * 0.8 + 0.1 / 3, 0.9 * 0.2 + 0.1 / 3, 0.1 / 3])
    weights = np.append(0.5 * np.array([1, 3, 2]) * together * shares, 1e-3)
    look = Look("mug", 50, (0.4, 0.2, 0.0))
    chances = table.posterior([look], {"mug": 1, "bowl": 3, "book": 2}, 0.0)
    assert chances.tolist() == pytest.approx((weights / weights.sum()).tolist(), abs=1e-8)
    assert table.posterior([Look("mug", 50)], ONE_MUG, 0.0)[0] == pytest.approx(0.3 / 0.301), "none were told"


def test_a_surer_look_tells_more_against_clutter() -> None:
    """0.3 for the mug times 0.7 of surer looks at things; for clutter 0.1 of them, later ones, too."""
    table = replace(TABLE, sharpness=0.0, surer=(0.0, 0.5), real=(0.3, 0.7), false=(0.9, 0.1))
    sure, unsure = (Look("mug", 50, (chance, 0.0, 0.0)) for chance in (0.5, 0.49))
    for looks, mug, clutter in (
        ([sure], 0.3 * 0.7, 0.1),
        ([unsure], 0.3 * 0.3, 0.9),
        ([sure, unsure], 0.3 * 0.7 * 0.5 * 0.6 * 0.3, 0.1 * 0.25 * 0.8 * 0.9),
    ):
        assert table.posterior(looks, ONE_MUG, 0.0)[0] == pytest.approx(mug / (mug + clutter))


def test_clutter_that_looks_like_one_category_again_and_again_has_shares_of_its_own() -> None:
    """Fences are taken for carts by every look; what is first told another category keeps the shares of all."""
    table = replace(TABLE, surer=(0.0, 0.5), real=(0.3, 0.7), false=(0.9, 0.1))
    own = replace(table, again_of={"mug": 0.9}, steady_of={"mug": 0.95}, false_of={"mug": (0.4, 0.6)})
    looks = [Look("mug", 50, (0.5, 0.0, 0.0)), Look("mug", 200, (0.5, 0.0, 0.0))]
    mug, clutter = 0.3 * 0.7 * 0.8 * 0.9 * 0.7, 0.6 * 0.9 * 0.95 * 0.6
    assert own.posterior(looks, ONE_MUG, 0.0)[0] == pytest.approx(mug / (mug + clutter))
    missed = [looks[0], Look(None, 200)]
    mug, clutter = 0.3 * 0.7 * 0.2, 0.6 * 0.1
    assert own.posterior(missed, ONE_MUG, 0.0)[0] == pytest.approx(mug / (mug + clutter))
    other = replace(own, again_of={"bowl": 0.9}, steady_of={"bowl": 0.95}, false_of={"bowl": (0.4, 0.6)})
    assert other.posterior(looks, ONE_MUG, 0.0).tolist() == table.posterior(looks, ONE_MUG, 0.0).tolist()


def test_looks_after_the_first_count_as_much_as_is_measured() -> None:
    table = replace(TABLE, repeated=0.5)
    mug, clutter = 0.3 * (0.8 * 0.9) ** 0.5, (0.25 * 0.8) ** 0.5
    looks = [Look("mug", 50), Look("mug", 200)]
    assert table.posterior(looks, ONE_MUG, 0.0)[0] == pytest.approx(mug / (mug + clutter))
    assert table.posterior(looks[:1], ONE_MUG, 0.0)[0] == pytest.approx(0.3 / 1.3)


def test_what_is_often_taken_for_another_is_believed_to_be_it() -> None:
    """Two of two errors at a bowl told a mug; smoothed by half a look each: 2.5 of 3. No clutter but the least."""
    table = replace(TABLE, clutter={})
    weights = np.array([0.5 * 1 * 0.6, 0.5 * 3 * 0.4 * 2.5 / 3.0, 0.5 * 2 * 0.4 * 0.5, 1e-3])
    chances = table.posterior([Look("mug", 50)], {"mug": 1, "bowl": 3, "book": 2}, 0.0)
    assert chances.tolist() == pytest.approx((weights / weights.sum()).tolist())


def test_more_of_a_kind_than_there_are_share_what_there_is() -> None:
    assert within_count([0.5, 0.5], 1.0) == [0.5, 0.5]
    assert within_count([0.5, 0.5], 0.5) == pytest.approx([0.25, 0.25])
    # odds of 4 and 1, both halved: 2 / 3 and 1 / 3, which is 1 in all
    assert within_count([0.8, 0.5], 1.0) == pytest.approx([2 / 3, 1 / 3])
    assert within_count([0.8, 0.5], 0.0) == [0.0, 0.0] and within_count([], 1.0) == []


def test_beliefs_by_a_known_detector_are_so() -> None:
    """Of 20,000 places whose looks are drawn from the table, those believed with a chance are right as often."""
    chance, k = np.random.default_rng(0), len(TABLE.classes)
    expected = {"mug": 2, "bowl": 1, "book": 1}
    off = {"mug": (0, 0.5, 0.5), "bowl": (2.5 / 3, 0, 0.5 / 3), "book": (0.5, 0.5, 0)}
    found: list[tuple[float, bool]] = []
    # first looks with few pixels: of things told as anything, and of clutter told as a mug
    things = [0.5 * expected[name] for name in TABLE.classes]
    kinds = np.array([*things, 1.0]) / (sum(things) + 1.0)

    def told(kind: int, pixels: int) -> str:
        right = (0.6, 0.9)[pixels >= 100]
        if chance.random() < right:
            return TABLE.classes[kind]
        return TABLE.classes[int(chance.choice(k, p=off[TABLE.classes[kind]]))]

    for _ in range(20_000):
        kind = int(chance.choice(k + 1, p=kinds))
        looks = [Look("mug" if kind == k else told(kind, 50), 50)]
        for _ in range(int(chance.integers(0, 5))):
            pixels = int(chance.choice([50, 200]))
            if kind == k:
                again = chance.random() < 0.25
                name = "mug" if chance.random() < 0.8 else str(chance.choice(["bowl", "book"]))
            else:
                again, name = chance.random() < (0.5, 0.8)[pixels >= 100], told(kind, pixels)
            looks.append(Look(name if again else None, pixels))
        chances = replace(TABLE, clutter={"mug": 1.0, "bowl": 1e-3, "book": 1e-3}).posterior(looks, expected, 0.0)
        found += [(float(chances[n]), n == kind) for n in range(k)]
    beliefs, right = np.array([b for b, _ in found]), np.array([r for _, r in found])
    for low in np.arange(0.0, 1.0, 0.1):
        mine = (beliefs >= low) & (beliefs < low + 0.1)
        if mine.sum() > 300:  # three standard deviations of the share that is right
            error = 3.0 * 0.5 / np.sqrt(mine.sum())
            assert beliefs[mine].mean() == pytest.approx(right[mine].mean(), abs=error), low
    assert Counter(np.floor(beliefs * 10).tolist())[9.0] > 1000, "many looks make it sure"


@pytest.mark.parametrize(
    ("change", "told"),
    [
        ({"pixels": (0, 100, 50)}, "found and right must have 3 buckets"),
        ({"pixels": (0, 0)}, "pixels must increase from 0"),
        ({"pixels": (1, 2)}, "pixels must increase from 0"),
        ({"clutter": {"cup": 1.0}}, "a category of the table must be one of its classes, got 'cup'"),
        ({"taken": {"mug": {"cup": 1.0}}}, "must be one of its classes, got 'cup'"),
        ({"again_of": {"cup": 1.0}}, "must be one of its classes, got 'cup'"),
        ({"surer": (0.0, 0.5), "real": (0.3, 0.7), "false": (1.0,)}, "real, false and false_of must have 2 buckets"),
        ({"false_of": {"mug": (1.0,)}}, "real, false and false_of must have 0 buckets"),
        ({"classes": ("mug", "bowl", "book", "mug")}, "classes must be distinct"),
        ({"again": 1.5}, "confusion.again must be a number from 0 to 1, got 1.5"),
        ({"found": (0.5, "much")}, r"confusion.found\[1\] must be a number"),
        ({"more": 1}, "key of confusion"),
    ],
)
def test_a_table_that_cannot_be_is_refused(tmp_path: Path, change: dict[str, object], told: str) -> None:
    good = {name: getattr(TABLE, name) for name in TABLE.__dataclass_fields__}
    path = tmp_path / "small_confusion.json"
    path.write_text(json.dumps(good))
    assert Confusion.read(path) == TABLE
    path.write_text(json.dumps({**good, **change}))
    with pytest.raises(ValueError, match=told):
        Confusion.read(path)
