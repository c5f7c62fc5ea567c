"""Pictures and masks of a dataset that somebody else may have made: sizes are compared before anything is decoded."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hazard_ms.perception.coco import tools
from hazard_ms.spec.foreign.files import inside, printable, read_foreign
from hazard_ms.spec.foreign.pictures import LARGEST_FILE, decoded, size_of
from hazard_ms.spec.foreign.plain import Limits, made

FIRST, DIGIT, MORE, SIGN = (
    48,
    5,
    0x20,
    0x10,
)  # of a run's characters: the first, bits of each, marks (maskApi.c of COCO)
LONGEST_RUN = 6  # [characters]: 30 bits, of which a picture's runs need 25
REACH = 1e5  # of the corners of polygons [pixels] [ours]
LONGEST_WAY = 1e6  # around all polygons of a mask [pixels] [ours]


def pixels_of(dataset: Path, image: Mapping[str, Any], key: str) -> NDArray[Any]:
    """The picture that `image` names under `key`, as it is stored, [H, W] or [H, W, C], red first.

    Raises ValueError for a file outside `dataset`, for a file that is not a picture, and for one of another size.
    """
    path = inside(dataset, image.get(key), f"{key} of picture {image['id']}")
    content = read_foreign(path, LARGEST_FILE)
    size = size_of(content, str(path))
    if size != (image["width"], image["height"]):
        wanted = f"{image['width']} x {image['height']} pixels, as its row says"
        raise ValueError(f"{printable(str(path))} must have {wanted}, got {size[0]} x {size[1]}")
    return decoded(content, str(path))


def colours_of(dataset: Path, image: Mapping[str, Any]) -> NDArray[np.uint8]:
    """The colours of a picture, [H, W, 3]; grey ones become equal colours. Raises ValueError as `pixels_of` does."""
    found = pixels_of(dataset, image, "file_name")
    if found.dtype == np.uint16:
        found = (found >> 8).astype(np.uint8)
    if found.ndim == 2:
        found = np.repeat(found[..., None], 3, -1)
    return np.ascontiguousarray(found[..., :3])


def mask_of(run_lengths: Any, size: tuple[int, int], where: str) -> NDArray[np.uint8]:
    """The mask, [H, W], 0 or 1, of compressed run lengths for a picture of `size` (H, W).

    Raises ValueError, which says `where`, for other run lengths; nothing is allocated before.
    """
    check_runs(run_lengths, size, where)
    found: NDArray[np.uint8] = tools().decode(run_lengths)
    return found


def check_runs(run_lengths: Any, size: tuple[int, int], where: str) -> None:
    """Check compressed run lengths against a picture of `size` (H, W). Raises ValueError, which says `where`."""
    if not isinstance(run_lengths, dict) or run_lengths.get("size") != list(size):
        raise ValueError(
            f"segmentation must be run lengths of size {list(size)}, got {_shown(run_lengths)}, in {where}"
        )
    counts = run_lengths.get("counts")
    if not isinstance(counts, str) or not counts.isascii() or any(type(n) is not int for n in run_lengths["size"]):
        raise ValueError(f"counts of a segmentation must be text in ASCII, got {_shown(counts)}, in {where}")
    fault = _fault(np.frombuffer(counts.encode("ascii"), np.uint8).astype(np.int64) - FIRST, size[0] * size[1])
    if fault:
        raise ValueError(f"runs of a segmentation must cover {size[0]} x {size[1]} pixels, got {fault}, in {where}")


def _fault(characters: NDArray[np.int64], pixels: int) -> str:
    """What is wrong with the characters of runs, [N], of a mask of so many `pixels`; empty if nothing is."""
    if (
        not len(characters)
        or len(characters) > LONGEST_RUN * (pixels + 1)
        or ((characters < 0) | (characters > 63)).any()
    ):
        return "characters that are none of runs"
    ends = np.flatnonzero((characters & MORE) == 0)
    starts = np.concatenate([[0], ends[:-1] + 1])
    if not len(ends) or ends[-1] != len(characters) - 1 or (ends - starts).max() >= LONGEST_RUN:
        return "a run that does not end"
    places = np.arange(len(characters)) - np.repeat(starts, ends - starts + 1)
    runs = np.add.reduceat((characters & 31) << (DIGIT * places), starts)
    runs -= np.where(characters[ends] & SIGN, np.int64(1) << (DIGIT * (ends - starts + 1)), 0)
    runs[1::2] = np.cumsum(runs[1::2])  # each run but the first three is told as the difference to the last but one
    runs[2::2] = np.cumsum(runs[2::2])
    if (runs < 0).any() or (runs > pixels).any():
        return "a run of less than 0 or of too many pixels"
    return "" if int(runs.sum()) == pixels else f"{int(runs.sum())} in all"


def check_shape(shape: Any, size: tuple[int, int], where: str) -> None:
    """Check a segmentation in any of COCO's forms: run lengths, also as a list of numbers, or polygons.

    Raises ValueError, which says `where`.
    """
    if isinstance(shape, list):
        polygons = made(tuple[tuple[float, ...], ...], shape, f"segmentation in {where}", Limits(farthest=REACH))
        if not polygons or any(len(p) < 6 or len(p) % 2 for p in polygons):
            raise ValueError(f"polygons must have at least three corners of two numbers each, got others in {where}")
        corners = [np.reshape(p, (-1, 2)) for p in polygons]
        if sum(np.abs(np.diff(c, axis=0, append=c[:1])).max(1).sum() for c in corners) > LONGEST_WAY:
            raise ValueError(
                f"outlines of a segmentation must be at most {LONGEST_WAY:g} pixels long in all, got more in {where}"
            )
    elif isinstance(shape, dict) and isinstance(shape.get("counts"), list):
        runs = made(tuple[int, ...], shape["counts"], f"counts in {where}", Limits(most_entries=size[0] * size[1] + 1))
        if shape.get("size") != list(size) or min(runs, default=-1) < 0 or sum(runs) != size[0] * size[1]:
            raise ValueError(
                f"segmentation must be run lengths of size {list(size)}, got another size or sum in {where}"
            )
    else:
        check_runs(shape, size, where)


def _shown(value: Any) -> str:
    told = {"size": value.get("size")} if isinstance(value, dict) else value
    return printable(f"{told!r:.100}")
