"""The page and the sheet of a dataset."""

from __future__ import annotations

import json
from pathlib import Path

import cv2
import numpy as np
import pytest

from hazard_ms.perception import layout
from hazard_ms.perception.closeups import CELL, COLOURS, TEXT, state_of
from hazard_ms.perception.show import COLUMNS, EDGE, OF_THINGS, drawn, show

pytestmark = pytest.mark.render


def test_the_page_has_pictures_and_numbers(dataset: Path, tmp_path: Path) -> None:
    page = show(dataset, tmp_path / "page.html", 5).read_text()
    assert page.count("data:image/jpeg;base64,") == 5
    assert "<th>pictures</th><td>12</td>" in page and "burning" in page


def test_the_sheet_has_its_pictures_side_by_side(dataset: Path, tmp_path: Path) -> None:
    sheet = cv2.imread(str(show(dataset, tmp_path / "sheet.png", 6)))
    assert sheet is not None
    assert sheet.shape == (2 * EDGE, COLUMNS * EDGE, 3)
    assert not sheet[EDGE:, 2 * EDGE :].any(), "the last places stay empty"


def test_things_are_shown_one_by_one_with_the_colour_of_their_state(dataset: Path, tmp_path: Path) -> None:
    """The outline of a thing has its state's colour; black cells fill the last row."""
    sheet = cv2.imread(str(show(dataset, tmp_path / "things.png", 1, things=OF_THINGS + 3)))
    assert sheet is not None
    assert sheet.shape == (2 * (CELL + TEXT), OF_THINGS * CELL, 3)
    assert not sheet[CELL + TEXT :, 3 * CELL :].any()
    colours = np.array([*COLOURS.values()])[:, ::-1]
    for row, column in [*((0, k) for k in range(OF_THINGS)), *((1, k) for k in range(3))]:
        cell = sheet[row * (CELL + TEXT) :, column * CELL : (column + 1) * CELL][:CELL].reshape(-1, 3)
        assert (cell[:, None] == colours).all(-1).any(0).sum() >= 1, "an outline has one of the colours"


def test_a_page_shows_things_below_its_pictures(dataset: Path, tmp_path: Path) -> None:
    assert show(dataset, tmp_path / "page.html", 5, things=4).read_text().count("data:image/jpeg;base64,") == 6


def test_masks_are_drawn_where_things_are(dataset: Path) -> None:
    rows = json.loads((dataset / layout.instances("train")).read_text())
    largest = max(rows["annotations"], key=lambda row: row["area"])
    image = next(image for image in rows["images"] if image["id"] == largest["image_id"])
    plain, over = drawn(dataset, image, []), drawn(dataset, image, [largest])
    changed = (plain != over).any(-1).mean()
    assert changed == pytest.approx(largest["area"] / (image["width"] * image["height"]), abs=0.05)


def test_what_says_most_about_a_thing_gives_its_colour() -> None:
    plain = {"status": "normal", "submerged": 0.0, "speed_mps": 0.0, "target": False}
    assert state_of(plain) == "other" and state_of(plain | {"target": True}) == "target"
    assert state_of(plain | {"submerged": 0.1, "target": True}) == "under water"
    assert state_of(plain | {"submerged": 0.1, "status": "burnt"}) == "burnt"


@pytest.mark.parametrize("name", ["page.txt", "page"])
def test_other_endings_are_refused(dataset: Path, tmp_path: Path, name: str) -> None:
    with pytest.raises(ValueError, match="output must end in"):
        show(dataset, tmp_path / name, 5)


def test_a_file_that_is_no_picture_is_refused(tmp_path: Path) -> None:
    np.save(tmp_path / "picture.npy", np.zeros(3))
    with pytest.raises(ValueError, match="must be a PNG or JPEG picture"):
        drawn(tmp_path, {"id": 1, "width": 3, "height": 1, "file_name": "picture.npy"}, [])
