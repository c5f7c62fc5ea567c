"""Annotated things one by one: each cut out of its picture, with the outline of its mask, its name and its state."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from hazard_ms.perception import layout
from hazard_ms.perception.reading import colours_of, mask_of
from hazard_ms.perception.rows import SHOWN, by_image
from hazard_ms.perception.states import MOVING

CELL, TEXT = 112, 24  # edge of a cut-out and height of the two lines below it [pixels] [ours]
AROUND = 1.7  # edge of what is cut out, as a multiple of the thing's box [ours]
LEAST = 32  # edge of what is cut out, at least [pixels] [ours]
FONT, LETTERS = cv2.FONT_HERSHEY_SIMPLEX, 0.32  # [ours]

COLOURS = {  # red, green, blue of a thing by its state [ours]
    "burning": (255, 90, 40),
    "burnt": (150, 90, 200),
    "under water": (60, 150, 255),
    "moving": (255, 220, 60),
    "target": (90, 220, 120),
    "other": (170, 170, 170),
}


def state_of(attributes: Mapping[str, Any]) -> str:
    """The one of COLOURS that says most about a thing."""
    if attributes["status"] != "normal":
        return str(attributes["status"])
    if attributes["submerged"] > 0.0:
        return "under water"
    if attributes["speed_mps"] > MOVING:
        return "moving"
    return "target" if attributes["target"] else "other"


def closeups(dataset: Path, path: Path, count: int) -> list[NDArray[np.uint8]]:
    """`count` things of the COCO file `path`, drawn at random, as pictures [CELL + TEXT, CELL, 3], RGB.

    Raises ValueError for a file that is not a picture.
    """
    rows = layout.read_instances(path, SHOWN)
    by_image(rows, path.name)
    images = {image["id"]: image for image in rows["images"]}
    things = rows["annotations"]
    chosen = np.random.default_rng(0).permutation(len(things))[:count]
    made = []
    for k in chosen.tolist():
        made.append(_closeup(colours_of(dataset, images[things[k]["image_id"]]), things[k]))
    return made


def _closeup(picture: NDArray[np.uint8], thing: Mapping[str, Any]) -> NDArray[np.uint8]:
    """One thing of a picture, [H, W, 3]."""
    state = state_of(thing["attributes"])
    x, y, width, height = thing["bbox"]
    edge = min(max(round(AROUND * max(width, height)), LEAST), *picture.shape[:2])
    left, top = (
        int(np.clip(round(low + size / 2 - edge / 2), 0, most - edge))
        for low, size, most in ((x, width, picture.shape[1]), (y, height, picture.shape[0]))
    )
    window = slice(top, top + edge), slice(left, left + edge)
    mask = mask_of(thing["segmentation"], picture.shape[:2], f"annotation {thing['id']}")[window]
    cut = cv2.resize(np.ascontiguousarray(picture[window]), (CELL, CELL), interpolation=cv2.INTER_LINEAR)
    large = cv2.resize(mask, (CELL, CELL), interpolation=cv2.INTER_NEAREST)
    outlines, _ = cv2.findContours(large, cv2.RETR_LIST, cv2.CHAIN_APPROX_NONE)
    cv2.drawContours(cut, outlines, -1, COLOURS[state], 1)
    cell = np.zeros((CELL + TEXT, CELL, 3), np.uint8)
    cell[:CELL] = cut
    cv2.putText(cell, thing["name"], (2, CELL + 10), FONT, LETTERS, (255, 255, 255), 1, cv2.LINE_AA)
    cv2.putText(cell, state, (2, CELL + 21), FONT, LETTERS, COLOURS[state], 1, cv2.LINE_AA)
    return cell
