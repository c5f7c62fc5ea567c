"""The pictures of captured datasets, as trainings and their validation read them."""

from __future__ import annotations

import functools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hazard_ms.perception import layout
from hazard_ms.perception.reading import colours_of, pixels_of
from hazard_ms.perception.rows import LEARNT, by_image, read_json
from hazard_ms.spec.catalogue import CATEGORIES
from hazard_ms.spec.checks import one_of

MOST_NUMBER = 65535  # in a picture of ids, which has 16 bits


@dataclass(frozen=True)
class Picture:
    """One picture of a dataset, whose files are read when they are asked for."""

    dataset: Path
    row: dict[str, Any]  # of `images`
    things: tuple[dict[str, Any], ...]  # its annotations

    def rgb(self) -> NDArray[np.uint8]:
        """Colours, [H, W, 3]."""
        return colours_of(self.dataset, self.row)

    def depth(self) -> NDArray[np.float32]:
        """Depth along the optical axis [m], [H, W]; 0: nothing."""
        return self._plane("depth_file").astype(np.float32) * 1e-3

    def ids(self) -> NDArray[np.uint16]:
        """Index of the thing that is seen, plus 1, [H, W]; 0: floor, walls, sky."""
        return self._plane("ids_file")

    def intrinsic(self) -> NDArray[np.float32]:
        """The camera's matrix [pixels], [3, 3]."""
        return np.asarray(self._camera()["intrinsic"], np.float32)

    def cam2world(self) -> NDArray[np.float32]:
        """The camera's pose [m], [4, 4]; it looks along its -z axis with y up."""
        return np.asarray(self._camera()["cam2world"], np.float32)

    def categories(self) -> dict[int, str]:
        """The category of every number in `ids` but 0. Raises ValueError where the dataset does not name its things."""
        scenes = _table(self.dataset)
        if self.row["scene"] not in scenes:
            raise ValueError(
                f"{self.dataset / layout.TABLE} must name the things of {self.row['scene']!r:.100}, got none"
            )
        return scenes[self.row["scene"]]

    def _plane(self, key: str) -> NDArray[np.uint16]:
        """One number of 16 bits for each pixel, [H, W]. Raises ValueError for another picture."""
        found = pixels_of(self.dataset, self.row, key)
        if found.ndim != 2 or found.dtype != np.uint16:
            raise ValueError(f"{key} of picture {self.row['id']} must have one 16-bit channel, got {found.dtype}")
        return found

    def _camera(self) -> dict[str, Any]:
        if self.row.get("camera") is None:
            raise ValueError(f"picture {self.row['id']} in {self.dataset} must have a camera, got none")
        camera: dict[str, Any] = self.row["camera"]
        return camera


def read(datasets: Sequence[Path], split: str) -> list[Picture]:
    """All pictures of a split of some datasets. Raises ValueError for a folder or a split that is not there."""
    found: list[Picture] = []
    for dataset in datasets:
        path = dataset / layout.instances(split)
        if not path.is_file():
            splits = ", ".join(p.stem.removeprefix("instances_") for p in layout.splits_of(dataset))
            raise ValueError(f"split must be one of {splits} in {dataset}, got {split!r}")
        rows = layout.read_instances(path, LEARNT)
        things = by_image(rows, str(path))
        known = set(layout.category_ids().values())
        if bad := next((t for t in rows["annotations"] if t["category_id"] not in known), None):
            raise ValueError(f"category_id must be a category of the catalogue, got {bad['category_id']} in {path}")
        found += [Picture(dataset, image, tuple(things[image["id"]])) for image in rows["images"]]
    return found


def truth_of(pictures: Sequence[Picture], classes: Sequence[str]) -> dict[str, Any]:
    """COCO data of `pictures`, numbered anew from 1 in their order, with the things of `classes` alone."""
    numbers = layout.category_ids()
    wanted = {numbers[name] for name in classes}
    images: list[dict[str, Any]] = []
    rows: list[dict[str, Any]] = []
    for number, picture in enumerate(pictures, start=1):
        images.append({**picture.row, "id": number})
        mine = [thing for thing in picture.things if thing["category_id"] in wanted]
        rows += [{**thing, "image_id": number, "id": len(rows) + k} for k, thing in enumerate(mine, start=1)]
    return {"images": images, "annotations": rows, "categories": layout.categories()}


def names_of(pictures: Sequence[Picture]) -> list[str]:
    """The categories of all annotated things, in the order of the catalogue's ids."""
    names = {number: name for name, number in layout.category_ids().items()}
    return [names[number] for number in sorted({t["category_id"] for picture in pictures for t in picture.things})]


def classes_of(found: list[str], recipe: Mapping[str, Any] | None) -> list[str]:
    """The classes that a network learns: those that were `found` in pictures, or those of the `recipe` it began with.

    Raises ValueError if nothing was found, and for what the recipe does not have.
    """
    if not found:
        raise ValueError("DATA must hold annotated things of the categories that the model knows, got none")
    classes = found if recipe is None else list(recipe["classes"])
    if new := sorted(set(found) - set(classes)):
        raise ValueError(
            f"DATA must hold only the categories that the training began with, got {', '.join(new)} as well"
        )
    return classes


@functools.lru_cache(maxsize=64)
def _table(dataset: Path) -> dict[str, dict[int, str]]:
    """The categories of the numbers in the ids pictures of a dataset, by scene."""
    path = dataset / layout.TABLE
    try:
        scenes = read_json(path)["scenes"]
        return {scene: {_number(k): _category(row) for k, row in rows.items()} for scene, rows in scenes.items()}
    except (ValueError, KeyError, TypeError, AttributeError) as error:
        raise ValueError(f"{path} must name the things of every scene, got {error!r:.200}") from None


def _number(text: str) -> int:
    """A number of an ids picture. Raises ValueError for another text."""
    if not (text.isascii() and text.isdigit() and int(text) <= MOST_NUMBER):
        raise ValueError(f"the number of a thing must be from 0 to {MOST_NUMBER}, got {text!r:.100}")
    return int(text)


def _category(row: Any) -> str:
    return one_of(row["category"], CATEGORIES, "a category")
