"""Pictures as eyes with fewer pixels would take them: every n-th pixel both ways of a captured one."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hazard_ms.perception.coco import run_lengths
from hazard_ms.perception.training.pictures import Picture
from hazard_ms.sensing.detection.detector import box_of


@dataclass(frozen=True)
class Thinned:
    """One picture, of which only the first of `every` x `every` pixels is left."""

    picture: Picture
    every: int = 1

    @property
    def scene(self) -> str:
        """The name of its scene."""
        return str(self.picture.row["scene"])

    def rgb(self) -> NDArray[np.uint8]:
        """Colours, [H, W, 3]."""
        return np.ascontiguousarray(self.picture.rgb()[:: self.every, :: self.every])

    def depth(self) -> NDArray[np.float32]:
        """Depth along the optical axis [m], [H, W]; 0: nothing."""
        return np.ascontiguousarray(self.picture.depth()[:: self.every, :: self.every])

    def ids(self) -> NDArray[np.uint16]:
        """Index of the thing that is seen, plus 1, [H, W]; 0: floor, walls, sky."""
        return np.ascontiguousarray(self.picture.ids()[:: self.every, :: self.every])

    def intrinsic(self) -> NDArray[np.float32]:
        """The camera's matrix [pixels], [3, 3]; the middle of the first pixel stays where it was."""
        made = self.picture.intrinsic().copy()
        made[:2, 2] -= 0.5
        made[:2] /= self.every
        made[:2, 2] += 0.5
        return made

    def cam2world(self) -> NDArray[np.float32]:
        """The camera's pose [m], [4, 4]; it looks along its -z axis with y up."""
        return self.picture.cam2world()

    def masks(self) -> dict[int, NDArray[np.bool_]]:
        """The pixels, [H, W], of each annotated thing that has any left, by its index along B."""
        ids = self.ids()
        found = {int(thing["instance"]): ids == thing["instance"] + 1 for thing in self.picture.things}
        return {index: mask for index, mask in found.items() if mask.any()}

    def annotations(self, image: int, first: int) -> list[dict[str, Any]]:
        """The rows of its things in COCO's form for the picture numbered `image`, with ids from `first` on."""
        masks = self.masks()
        rows: list[dict[str, Any]] = []
        for thing in self.picture.things:
            mask = masks.get(int(thing["instance"]))
            if mask is not None:
                left, top, right, bottom = box_of(mask)
                pixels = int(mask.sum())
                row = {"image_id": image, "id": first + len(rows), "area": pixels, "segmentation": run_lengths(mask)}
                row |= {"bbox": [left, top, right - left, bottom - top]}
                rows.append({**thing, **row, "attributes": {**thing["attributes"], "pixels": pixels}})
        return rows
