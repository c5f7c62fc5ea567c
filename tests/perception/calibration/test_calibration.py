"""The errors that are counted in what a detector told, by hand, and what is said of beliefs."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from hazard_ms.perception.calibration.measuring import confusion_of
from hazard_ms.perception.calibration.observing import Observed, Told, observed
from hazard_ms.perception.calibration.reliability import crossed, ece, outcomes, table, weight_of_repeats
from hazard_ms.perception.calibration.thinned import Thinned
from hazard_ms.perception.detectors.small import CONFUSION, SHIPPED, Small
from hazard_ms.perception.training.pictures import Picture
from hazard_ms.sensing.detection.confusion import Confusion
from hazard_ms.sensing.detection.detector import Detection, Detector, box_of
from hazard_ms.sensing.detection.eyes import Eyes
from hazard_ms.sensing.sighting import Sighting
from tests.worlds.wall import view

CLASSES = ("mug", "bowl", "book")
KINDS = {1: "mug", 2: "bowl"}
MUG, BOWL, NOTHING = (2.0, 0.0, 1.0), (2.0, 1.0, 1.0), (2.0, -1.0, 1.0)


def told(category: str, place: tuple[float, ...], thing: int = 0) -> Told:
    return Told(category, Sighting(np.array(place, np.float32), 0.05, 1.0, 0, 50), thing)


def picture(*found: Told, scene: str = "one", visible: dict[int, int] | None = None, wall: float = 2.0) -> Observed:
    return Observed(scene, view(wall), found, {1: 50, 2: 200} if visible is None else visible, KINDS)


def test_the_errors_are_those_by_hand() -> None:
    looks = [
        picture(told("mug", MUG, 1), told("bowl", BOWL, 2), told("book", NOTHING)),
        picture(told("bowl", MUG, 1), told("book", (2.0, -1.1, 1.0))),  # the same place, and the bowl is missed
        picture(),  # all is missed
        picture(visible={}, wall=1.0),  # nothing is to be seen
    ]
    made = confusion_of(looks, CLASSES, "100/90", "by hand")
    assert made.pixels == (0, 16, 32, 64, 128, 256)
    # after one hit and one miss: the mug, 50 pixels, is found twice and missed once. Each look at it is of a thing that
    # another look found. The bowl, 200 pixels, is missed twice; the look that found it was the only one
    assert made.found == (0.5, 0.5, pytest.approx(3 / 5), 0.5, pytest.approx(1 / 4), 0.5)
    # the mug is told right once and wrong once, the bowl right
    assert made.right == (0.5, 0.5, 0.5, 0.5, pytest.approx(2 / 3, abs=1e-4), 0.5)
    assert made.taken == {"mug": {"bowl": 1.0}}
    assert made.clutter == {"book": 1.0}
    # the place of none is told once more, and missed once where the wall at 2 m is seen
    assert made.again == 0.5 and made.steady == pytest.approx(2 / 3, abs=1e-4)
    assert made.seen == 0.75  # both things
    assert (made.eyes, made.command) == ("100/90", "by hand")


def test_clutter_of_each_category_counts_beside_ten_looks_of_all() -> None:
    """The book that is none is told three times more, the last time a mug; the bowl that is none is missed by all."""
    other = (2.0, 1.5, 1.0)
    looks = [picture(told("book", NOTHING), told("bowl", other))]
    looks += [picture(told(category, NOTHING)) for category in ("book", "book", "mug")]
    made = confusion_of(looks, CLASSES, "", "")
    assert (made.again, made.steady) == (0.5, 0.6)  # 1 + 3 of 2 + 6; 1 + 2 of 2 + 3
    # 1 + 3 of 2 + 3 looks and 5 of 10; 1 + 0 of 2 + 3 and 5 of 10
    assert made.again_of == {"book": pytest.approx(9 / 15, abs=1e-4), "bowl": pytest.approx(6 / 15, abs=1e-4)}
    # 1 + 2 of 2 + 3 and 6 of 10; none but the 1 of 2
    assert made.steady_of == {"book": pytest.approx(9 / 15, abs=1e-4), "bowl": pytest.approx(7 / 12, abs=1e-4)}


def places(lies: Sequence[int], truths: Sequence[int]) -> list[Observed]:
    """Pictures from four places of each of eight scenes: in so many of them nothing is told a mug, and the mug is."""
    made = []
    for scene in range(8):
        for place in range(4):
            found = [told("mug", MUG, 1)] if place < truths[scene % len(truths)] else []
            found += [told("mug", NOTHING)] if place < lies[scene % len(lies)] else []
            pose = view().cam2world.copy()
            pose[0, 3] = -0.6 * place  # farther apart than looks that count as one
            seen = replace(view(2.0 + 0.6 * place), cam2world=pose)
            made.append(Observed(str(scene), seen, tuple(found), {1: 50, 2: 200}, KINDS))
    return made


def test_looks_that_err_alike_count_less() -> None:
    """In some scenes nothing is told a mug in every look, and in the others hardly; else looks err each in its way."""
    assert weight_of_repeats(places(lies=(4, 4, 1, 1), truths=(2, 1)), CLASSES) == 0.3
    assert weight_of_repeats(places(lies=(1,), truths=(4,)), CLASSES) == 1.0


def test_clutter_is_counted_by_scene() -> None:
    looks = [picture(told("book", NOTHING)), picture(told("book", NOTHING), scene="two"), picture(scene="three")]
    assert confusion_of(looks, CLASSES, "", "").clutter == {"book": pytest.approx(2 / 3, abs=1e-4)}


def test_a_belief_is_right_for_the_surest_track_of_a_thing_of_its_category() -> None:
    """The mug, told twice at places that are too far apart for one track, and a book that is none."""
    table_ = confusion_of([picture(told("mug", MUG, 1))], CLASSES, "", "")
    found = outcomes([picture(told("mug", MUG, 1), told("mug", BOWL, 1), told("book", NOTHING))], table_)
    assert sorted(right for _, right in found) == [False, False, True]


def test_each_half_of_the_scenes_is_judged_by_the_other() -> None:
    """In one half the mug is always told right, in the other never: both are believed wrongly."""
    good = [picture(told("mug", MUG, 1), scene=s, visible={1: 50}) for s in ("a", "c") for _ in range(9)]
    bad = [picture(told("mug", NOTHING), scene=s, visible={}) for s in ("b", "d") for _ in range(9)]
    looks = [look for pair in zip(good, bad, strict=True) for look in pair]
    looks.sort(key=lambda look: look.scene)
    by_halves = crossed(looks, CLASSES)
    whole = outcomes(looks, confusion_of(looks, CLASSES, "", ""))
    assert len(by_halves) == len(whole) == 4 and ece(by_halves) > ece(whole)


def test_the_calibration_error_is_that_by_hand() -> None:
    """Two tracks of 0.95, of which one is right, and two of 0.1: (2 x 0.45 + 2 x 0.1) / 4."""
    found = [(0.95, True), (0.95, False), (0.1, False), (0.1, False)]
    assert ece(found) == pytest.approx(0.275)
    assert "| 0.9 to 1.0 | 2 | 0.950 | 0.500 |" in table(found) and "ECE 0.275 of 4 tracks" in table(found)
    assert ece([]) == 0.0 and ece([(1.0, True)]) == 0.0


class Drawn(Picture):
    """A picture that is not in a file."""

    def ids(self) -> np.ndarray:
        made = np.zeros((8, 8), np.uint16)
        made[2:5, 4:7] = 3
        made[1, 1] = 4
        return made

    def intrinsic(self) -> np.ndarray:
        return np.array([[4.0, 0, 4], [0, 4.0, 4], [0, 0, 1]], np.float32)


def test_a_thinned_picture_shows_the_same_with_fewer_pixels() -> None:
    rows = ({"instance": 2, "category_id": 5, "attributes": {"distance_m": 1.0}}, {"instance": 3, "attributes": {}})
    thin = Thinned(Drawn(Path("."), {"scene": "x"}, rows), 2)
    assert np.argwhere(thin.ids()).tolist() == [[1, 2], [1, 3], [2, 2], [2, 3]]
    (row,) = thin.annotations(7, 1)
    assert (row["area"], row["bbox"], row["attributes"]) == (4, [2.0, 1.0, 2.0, 2.0], {"distance_m": 1.0, "pixels": 4})
    # the middle of the pixel (2, 1) is what was that of (4, 2): (4.5 - 4) / 4 to the right
    matrix = thin.intrinsic()
    assert (2.5 - matrix[0, 2]) / matrix[0, 0] == pytest.approx((4.5 - 4) / 4)
    assert (1.5 - matrix[1, 2]) / matrix[1, 1] == pytest.approx((2.5 - 4) / 4)


class Shown(Drawn):
    """The same, seen from one place before a wall 2 m away."""

    def rgb(self) -> np.ndarray:
        return np.zeros((8, 8, 3), np.uint8)

    def depth(self) -> np.ndarray:
        return np.full((8, 8), 2.0, np.float32)

    def cam2world(self) -> np.ndarray:
        return np.eye(4, dtype=np.float32)

    def categories(self) -> dict[int, str]:
        return {3: "mug", 4: "bowl"}


class TellsOne(Detector):
    """Finds one mug in every picture, with one row of pixels more than it has."""

    def detect(self, rgb: np.ndarray, depth: np.ndarray) -> list[Detection]:
        mask = np.zeros((8, 8), bool)
        mask[1:5, 4:7] = True
        return [Detection("mug", 0.9, box_of(mask), mask)]


def test_looks_are_numbered_within_each_scene() -> None:
    """Else the tracks of all but the first scene would be those of things that were last seen in the future."""
    pictures = [Thinned(Shown(Path("x"), {"scene": name}, ())) for name in ("one", "one", "two", "one")]
    looks = observed(TellsOne(), pictures, CLASSES)
    assert [look.told[0].sighting.frame for look in looks] == [0, 1, 0, 2]
    assert [look.scene for look in looks] == ["x/one", "x/one", "x/two", "x/one"]
    assert [each.thing for each in looks[0].told] == [3] and looks[0].visible == {3: 9}
    (tracked,) = outcomes(looks[:2], confusion_of(looks, CLASSES, "", ""))
    assert tracked[1], "one track of the mug, whose second look is the newer one"


def test_the_shipped_detector_knows_its_errors() -> None:
    """Larger things are found again more often, and rather than what is none."""
    path = SHIPPED.with_name(f"{SHIPPED.stem}{CONFUSION}")
    made = Small().confusion
    assert made == Confusion.read(path) and made is not None
    counted, own = Eyes.of(made.eyes), Eyes.of(Small.eyes)  # in square pictures
    assert list(made.classes) == list(Small().classes)
    assert (counted.width, counted.degrees) == (own.width, own.degrees)
    assert made.found[0] < 0.5 < made.found[-1] and made.again < made.found[-1]
    assert json.loads(path.read_text())["command"].startswith("hazard-ms perception calibrate")


def test_what_a_detectors_own_chances_are_worth_is_found_again() -> None:
    """Things told by chances that are too flat: their squares are right; looks at things are surer than at clutter."""
    chance, looks = np.random.default_rng(0), []
    for scene in range(300):
        true = chance.dirichlet((0.6, 0.6, 0.6))  # what the detector should tell
        category = int(chance.choice(3, p=true))
        flat = np.sqrt(true) / np.sqrt(true).sum()
        mug = replace(told(CLASSES[int(flat.argmax())], MUG, 1), chances=tuple(flat.tolist()))
        none = replace(told("book", NOTHING), chances=(0.1, 0.1, 0.3))
        looks.append(Observed(str(scene), view(2.0), (mug, none), {1: 50}, {1: CLASSES[category]}))
    made = confusion_of(looks, CLASSES, "", "")
    assert made.sharpness == 2.0 and made.even <= 0.02
    assert made.surer == (0.0, 0.35, 0.5, 0.65, 0.8)
    # 300 looks at clutter and one more in each bucket
    assert made.false == (pytest.approx(301 / 305, abs=1e-4), *[pytest.approx(1 / 305, abs=1e-4)] * 4)
    surest = np.array([max(look.told[0].chances or ()) for look in looks])
    assert made.real[0] == pytest.approx((1 + (surest < 0.35).sum()) / 305, abs=1e-4)
    assert made.real[4] == pytest.approx((1 + (surest >= 0.8).sum()) / 305, abs=1e-4)


def test_a_detector_that_tells_no_chances_has_none_that_count() -> None:
    made = confusion_of([picture(told("mug", MUG, 1))], CLASSES, "", "")
    assert (made.sharpness, made.surer) == (0.0, ())
