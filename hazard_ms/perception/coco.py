"""COCO annotations of a picture, from its labels: compressed run lengths, tight boxes, areas and states."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hazard_ms.perception.eye import Shot
from hazard_ms.perception.layout import category_ids

LEAST_PIXELS = 16  # of a thing that is annotated; smaller ones are only in the ids [ours]
ANNOTATIONS_EACH = 1000  # ids of annotations that each picture has at its disposal


def run_lengths(mask: NDArray[np.bool_]) -> dict[str, Any]:
    """A mask, [H, W], as COCO's compressed run lengths, ready for JSON. Raises ValueError without pycocotools."""
    found = tools().encode(np.asfortranarray(mask.astype(np.uint8)))
    return {"size": [int(n) for n in found["size"]], "counts": found["counts"].decode("ascii")}


def tools() -> Any:
    """The module `pycocotools.mask`. Raises ValueError where it is missing."""
    try:
        from pycocotools import mask
    except ImportError:
        raise ValueError(
            "COCO data needs the package pycocotools, which is not installed: pip install 'hazard_ms[perception]'"
        ) from None
    return mask


def box_of(mask: NDArray[np.bool_]) -> list[int]:
    """The tight box of a mask, [H, W], that is not empty: left, top, width, height [pixels]."""
    rows, columns = np.flatnonzero(mask.any(1)), np.flatnonzero(mask.any(0))
    return [
        int(columns[0]),
        int(rows[0]),
        int(columns[-1] - columns[0] + 1),
        int(rows[-1] - rows[0] + 1),
    ]


def ids_of(labels: NDArray[np.int64]) -> NDArray[np.uint16]:
    """An ids picture, [H, W], holds 1 + the index of a thing along B; 0 for walls, floor and nothing."""
    return np.where(labels >= 0, labels + 1, 0).astype(np.uint16)


def annotations_of(
    shot: Shot,
    image_id: int,
    things: Sequence[Any],
    states: Sequence[Mapping[str, Any]],
    positions: NDArray[np.float64],
) -> list[dict[str, Any]]:
    """One annotation for each thing with LEAST_PIXELS in `shot`.

    `things`, their `states` and their `positions` [m], [B, 3], stand in the order of B.
    """
    numbers = category_ids()
    counts = np.bincount(shot.labels[shot.labels >= 0], minlength=len(things))
    made = []
    for b in np.flatnonzero(counts >= LEAST_PIXELS).tolist():
        mask = shot.labels == b
        x, y, width, height = box_of(mask)
        far = float(np.linalg.norm(positions[b] - shot.cam2world[:3, 3]))
        edge = x == 0 or y == 0 or x + width == mask.shape[1] or y + height == mask.shape[0]
        pixels = int(counts[b])
        made.append(
            {
                "id": image_id * ANNOTATIONS_EACH + b + 1,
                "image_id": image_id,
                "category_id": numbers[things[b].category],
                "segmentation": run_lengths(mask),
                "area": pixels,
                "bbox": [x, y, width, height],
                "iscrowd": 0,
                "instance": b,
                "name": things[b].name,
                "attributes": {**states[b], "distance_m": round(far, 3), "truncated": edge, "pixels": pixels},
            }
        )
    return made


def add_amodal(annotation: dict[str, Any], mask: NDArray[np.bool_]) -> None:
    """Add to `annotation` the mask that its thing would have with nothing before it, [H, W], and the visible share."""
    annotation["amodal_segmentation"] = run_lengths(mask)
    whole = max(int(mask.sum()), annotation["area"])
    annotation["attributes"]["visible"] = round(annotation["area"] / whole, 4)
