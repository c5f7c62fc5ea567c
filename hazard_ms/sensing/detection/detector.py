"""The contract of detectors: the picture of the head camera in, things with their categories and masks out."""

from __future__ import annotations

import abc
from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from hazard_ms.sensing.detection.confusion import Confusion
from hazard_ms.sensing.detection.eyes import EYES

Box = tuple[float, float, float, float]  # left, top, right, bottom [pixels]; the last two just outside


@dataclass(frozen=True)
class Detection:
    """One thing that a detector has found in a picture of H x W pixels."""

    category: str  # as the catalogue names it
    score: float  # from 0 to 1: how sure the detector is
    box: Box
    mask: NDArray[np.bool_]  # [H, W]
    # chance of each of the detector's `classes`, [L], which sum to at most 1; None where it tells only the likeliest
    chances: tuple[float, ...] | None = None


class Detector(abc.ABC):
    """Finds things in pictures.

    Parameters of `__init__` that are annotated as int, float, bool or str can be given with the detector's name; one
    called `path` takes the file or folder that follows it.
    """

    eyes: ClassVar[str] = EYES  # with which agents look for it, unless others are asked for
    classes: Sequence[str] = ()  # the categories that it tells, where it says so
    confusion: Confusion | None = None  # its errors, where they were measured: tracks are fused by them

    @abc.abstractmethod
    def detect(self, rgb: NDArray[np.uint8], depth: NDArray[np.float32]) -> list[Detection]:
        """The things in the colours `rgb`, [H, W, 3], and the `depth` along the optical axis, [H, W] [m]; 0: nothing.

        Each detection has a mask of the size of the picture.
        """

    def aim(self, intrinsic: NDArray[np.floating], cam2world: NDArray[np.floating]) -> None:  # noqa: B027 as below
        """Tell where the camera of the next picture is: `intrinsic`, [3, 3] [pixels], and `cam2world`, [4, 4] [m].

        The camera looks along its -z axis with y up.
        """

    def begin(self, categories: tuple[str, ...]) -> None:  # noqa: B027 most detectors need not be told
        """Begin an episode in which things of `categories` matter: targets, carts and the catalogue's furniture."""


@dataclass(frozen=True)
class Truth:
    """The truth about a picture, which only the simulator knows."""

    labels: NDArray[np.int64]  # [H, W], indices along B; below 0: see `hazard_ms.sensing.camera`
    categories: tuple[str, ...]  # of the things, in the order of B
    seed: int  # of the episode
    frame: int  # of the episode


class PrivilegedDetector(Detector):
    """A detector that is shown the truth of each picture before it is asked: for studies, not for scores."""

    truth: Truth


def box_of(mask: NDArray[np.bool_]) -> Box:
    """The tight box of a mask, [H, W], that is not empty [pixels]."""
    rows, columns = np.flatnonzero(mask.any(1)), np.flatnonzero(mask.any(0))
    return float(columns[0]), float(rows[0]), float(columns[-1] + 1), float(rows[-1] + 1)


def overlap(one: Box, other: Box) -> float:
    """The area that two boxes share as a share of the area that they cover together, 0 to 1."""
    width = min(one[2], other[2]) - max(one[0], other[0])
    height = min(one[3], other[3]) - max(one[1], other[1])
    if width <= 0.0 or height <= 0.0:
        return 0.0
    areas = [(right - left) * (bottom - top) for left, top, right, bottom in (one, other)]
    return width * height / (sum(areas) - width * height)
