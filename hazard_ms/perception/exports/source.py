"""The dataset that is exported, which somebody else may have made: split by split, and one picture at a time."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hazard_ms.perception import layout
from hazard_ms.perception.coco import box_of, run_lengths, tools
from hazard_ms.perception.reading import check_shape, mask_of
from hazard_ms.perception.rows import Attributes, Image, Needs, by_image, check_unique, typed
from hazard_ms.spec.foreign.files import inside, printable, read_foreign
from hazard_ms.spec.foreign.pictures import LARGEST_FILE, size_of

NEEDS = Needs(("file_name",), ("segmentation",))
SPLIT = re.compile(r"\w+")  # that a name of a folder, a key of YAML and a split of Hugging Face's can be
NAME = re.compile(r"[\w .()/&'+-]{1,100}")  # of a category, as it may stand between quotes in YAML
PNG = b"\x89PNG"  # how such files begin
MOMENT = ("scene", "room", "seed", "frame", "lighting", "effects", "hazard_visible", "degraded", "transmission")


@dataclass(frozen=True)
class Thing:
    """One annotated thing in a picture."""

    id: int
    category: int  # id of its category
    mask: NDArray[np.uint8]  # [H, W], 0 or 1
    crowd: bool  # of several things, which nobody has told apart
    state: Mapping[str, Any]  # the known ones of its attributes

    @property
    def area(self) -> int:
        """The area of the mask [pixels]."""
        return int(self.mask.sum())

    @property
    def box(self) -> list[int]:
        """The tight box of the mask: left, top, width, height [pixels]."""
        return box_of(self.mask.astype(bool))

    @property
    def runs(self) -> dict[str, Any]:
        """The mask as COCO's compressed run lengths."""
        return run_lengths(self.mask.astype(bool))


@dataclass(frozen=True)
class Picture:
    """One picture of a split, with its things."""

    id: int
    content: bytes  # of its file, unchanged
    ending: str  # ".jpg" or ".png"
    width: int  # [pixels]
    height: int  # [pixels]
    moment: Mapping[str, Any]  # the known ones of MOMENT
    things: tuple[Thing, ...]  # masks without a pixel are left out

    @property
    def name(self) -> str:
        """A name for its file that no other picture of the split has."""
        return f"{self.id:012d}{self.ending}"


class Split:
    """One split of a dataset: the rows of its COCO file, and pictures that are read when they are asked for."""

    def __init__(self, dataset: Path, path: Path) -> None:
        """Read the COCO file at `path`. Raises ValueError for one that cannot be read or exported."""
        self.name = path.stem.removeprefix("instances_")
        shown = printable(path.name)
        if not SPLIT.fullmatch(self.name):
            raise ValueError(f"the name of a split must have only letters, digits and _, got {shown}")
        self._dataset, self._file = dataset, shown
        self._rows = layout.read_instances(path, NEEDS)
        check_unique(self._rows["images"], f"images of {shown}")
        check_unique(self._rows["annotations"], f"annotations of {shown}")
        check_unique(self._rows["categories"], f"categories of {shown}")
        self._of_image = by_image(self._rows, shown)
        self.categories = {row["id"]: row["name"] for row in self._rows["categories"]}
        for name in self.categories.values():
            if not NAME.fullmatch(name):
                raise ValueError(f"the name of a category must be plain text, got {printable(name)[:100]!r} in {shown}")

    def __len__(self) -> int:
        return len(self._rows["images"])

    def pictures(self) -> Iterator[Picture]:
        """All pictures, one at a time, in the order of the file. Raises ValueError for files and masks that are bad."""
        for row in self._rows["images"]:
            path = inside(self._dataset, row["file_name"], f"file_name of picture {row['id']}")
            content = read_foreign(path, LARGEST_FILE)
            size = size_of(content, str(path))
            if size != (row["width"], row["height"]):
                wanted = f"{row['width']} x {row['height']} pixels, as its row says"
                raise ValueError(f"{printable(str(path))} must have {wanted}, got {size[0]} x {size[1]}")
            things = tuple(
                thing
                for annotation in self._of_image[row["id"]]
                if (thing := self._thing(annotation, (size[1], size[0]))).mask.any()
            )
            moment = typed(Image, row, f"picture {row['id']}")
            known = {key: value for key in MOMENT if (value := getattr(moment, key)) is not None}
            yield Picture(row["id"], content, ".png" if content.startswith(PNG) else ".jpg", *size, known, things)

    def _thing(self, row: Mapping[str, Any], size: tuple[int, int]) -> Thing:
        where = f"annotation {row['id']} of {self._file}"
        if row["category_id"] not in self.categories:
            raise ValueError(f"category_id must be one of the file's categories, got {row['category_id']} in {where}")
        state = typed(Attributes, row.get("attributes") or {}, where)
        known = {key: value for key, value in vars(state).items() if value is not None}
        return Thing(
            row["id"], row["category_id"], mask(row["segmentation"], size, where), bool(row.get("iscrowd")), known
        )


class Source:
    """A dataset whose splits have the same categories."""

    def __init__(self, dataset: Path) -> None:
        """Raises ValueError for a folder of no dataset, and for splits whose categories contradict each other."""
        self.dataset = dataset
        self.paths = layout.splits_of(dataset)
        self.categories: dict[int, str] = {}
        self.counts: dict[str, int] = {}
        for path in self.paths:
            split = Split(dataset, path)
            self.counts[split.name] = len(split)
            for number, name in split.categories.items():
                if self.categories.setdefault(number, name) != name:
                    raise ValueError(
                        f"category {number} must have one name, got {self.categories[number]!r} and {name!r}"
                    )
        self.categories = dict(sorted(self.categories.items()))

    def splits(self) -> Iterator[Split]:
        """The splits, of which one at a time is in memory."""
        for path in self.paths:
            yield Split(self.dataset, path)


def mask(shape: Any, size: tuple[int, int], where: str) -> NDArray[np.uint8]:
    """The mask, [H, W], 0 or 1, of a segmentation in any of COCO's forms, for a picture of `size` (H, W).

    Raises ValueError, which says `where`, for other ones.
    """
    if isinstance(shape, dict) and isinstance(shape.get("counts"), str):
        return mask_of(shape, size, where)
    check_shape(shape, size, where)
    runs = tools().frPyObjects(shape, *size)
    found: NDArray[np.uint8] = tools().decode(tools().merge(runs) if isinstance(shape, list) else runs)
    return found
