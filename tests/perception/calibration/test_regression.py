"""How looks at things are told from looks at clutter: weights that are learned from pictures."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pytest

from hazard_ms.perception.calibration.measuring import confusion_of
from hazard_ms.perception.calibration.observing import Observed, Told
from hazard_ms.sensing.detection.odds import odds
from hazard_ms.sensing.sighting import Sighting
from tests.perception.calibration.test_calibration import BOWL, MUG, NOTHING, told
from tests.worlds.wall import view


def carts(octaves: Sequence[float], thing: int) -> list[Told]:
    """Detections of a cart, or of what is taken for one, of so many octaves of size; all else of them is alike."""
    place = np.array(MUG if thing else NOTHING, np.float32)
    made = []
    for octave in octaves:
        seen = Sighting(place, 0.05, 1.0, 0, 64, size=2.0**octave)
        made.append(Told("cart", seen, thing, (0.5, 0.0), (1.0, 0.0, 6.0, octave, 0.0, 0.0)))
    return made


def test_how_carts_differ_from_clutter_is_learned() -> None:
    """Octaves of normal sizes, at 12 and at 8, both with a deviation of 1: the log-odds at x are 4 x - 40."""
    chance = np.random.default_rng(0)
    real, clutter = chance.normal(12.0, 1.0, 3000).tolist(), chance.normal(8.0, 1.0, 6000).tolist()
    looks = [Observed("one", view(2.0), (each,), {}, {1: "cart"}) for each in [*carts(real, 1), *carts(clutter, 0)]]
    made = confusion_of(looks, ("cart", "mug"), "", "").odds_of
    for octave, log in ((9.5, -2.0), (10.0, 0.0), (10.5, 2.0), (11.0, 4.0)):
        assert np.log(odds(made["cart"], carts([octave], 1)[0].shown or ())) == pytest.approx(log, abs=0.4), octave


def test_only_the_largest_part_of_a_cart_counts_and_nothing_that_can_be_carried() -> None:
    kinds = {1: "cart", 2: "mug"}
    (whole, part), (none,) = carts([11.0, 7.0], 1), carts([7.0], 0)
    apart, alone = [(part, whole, none, told("mug", BOWL, 2))] * 30, [(whole, none, told("mug", BOWL, 2))] * 30
    made, other = (
        confusion_of([Observed("one", view(2.0), each, {}, kinds) for each in found], ("cart", "mug"), "", "").odds_of
        for found in (apart, alone)
    )
    assert made == other and set(made) == {"cart"}
    few = [Observed("one", view(2.0), each, {}, kinds) for each in apart[:19]]
    assert confusion_of(few, ("cart", "mug"), "", "").odds_of == {}, "too few"


def things(octaves: Sequence[float], thing: int, category: str = "mug") -> list[Told]:
    """Detections of what can be carried, or of what is taken for it, of so many octaves of height."""
    place = np.array(MUG if thing else NOTHING, np.float32)
    numbers = [(1.0, 0.0, 6.0, 8.0, 0.0, 0.0, octave, 0.0, 0.0) for octave in octaves]
    return [Told(category, Sighting(place, 0.05, 1.0, 0, 64), thing, (0.5, 0.0), each) for each in numbers]


def test_all_that_can_be_carried_is_told_from_clutter_by_the_same_weights() -> None:
    """Octaves of normal heights, at 1 and at -1, both with a deviation of 1: the log-odds at x are 2 x."""
    chance = np.random.default_rng(0)
    real, clutter = chance.normal(1.0, 1.0, 3000).tolist(), chance.normal(-1.0, 1.0, 3000).tolist()
    every = [*things(real[:1500], 1), *things(real[1500:], 2, "bowl"), *things(clutter, 0)]
    looks = [Observed("one", view(2.0), (each,), {}, {1: "mug", 2: "bowl"}) for each in every]
    made = confusion_of(looks, ("bowl", "mug"), "", "").odds_of
    assert set(made) == {"bowl", "mug"} and made["bowl"] == made["mug"]
    for octave in (-1.0, 0.0, 1.0):
        log = np.log(odds(made["mug"], things([octave], 1)[0].shown or ()))
        assert log == pytest.approx(2.0 * octave, abs=0.3), octave
