"""Pictures of others: their pixels are counted before any is decoded."""

from __future__ import annotations

import io
import warnings
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from hazard_ms.spec.foreign.files import printable

FORMATS = ("PNG", "JPEG")
LARGEST_FILE = 64_000_000  # [bytes] [ours]
MOST_PIXELS = 4096 * 4096  # [ours]


def decoded(content: bytes, what: str, most_pixels: int = MOST_PIXELS) -> NDArray[Any]:
    """The pixels of a PNG or JPEG file as stored, [H, W] or [H, W, 3 or 4] (red first), 8 or 16 bits each.

    `content` is what the file holds. Raises ValueError, which calls it `what`, for other files, for more than
    `most_pixels`, and for pictures that cannot be decoded.
    """
    import cv2

    shown = printable(what)
    width, height = size_of(content, what)
    if width * height > most_pixels:
        raise ValueError(f"{shown} must have at most {most_pixels} pixels, got {width} x {height}")
    try:
        found = cv2.imdecode(np.frombuffer(content, np.uint8), cv2.IMREAD_UNCHANGED)
    except cv2.error as error:
        raise ValueError(f"{shown} must be a picture, got one that cannot be decoded: {error!s:.100}") from None
    if found is None or found.shape[:2] != (height, width):
        raise ValueError(f"{shown} must be a picture, got one that cannot be decoded")
    return found if found.ndim == 2 else np.ascontiguousarray(found[..., _order(found.shape[2])])


def size_of(content: bytes, what: str) -> tuple[int, int]:
    """Width and height of a PNG or JPEG picture [pixels]; nothing of it is decoded.

    Raises ValueError, which calls it `what`, for anything else.
    """
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", Image.DecompressionBombWarning)
            with Image.open(io.BytesIO(content), formats=FORMATS) as picture:
                return picture.size
    except Exception:  # of whatever kind PIL raises for broken files
        raise ValueError(
            f"{printable(what)} must be a PNG or JPEG picture, got one that begins {content[:8]!r}"
        ) from None


def _order(channels: int) -> list[int]:
    """The channels red first, where OpenCV has blue first."""
    return [2, 1, 0, 3][:channels]
