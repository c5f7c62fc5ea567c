"""Writes pictures and films to files."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

import cv2

from hazard_ms.effects.raytracing.still import Image
from hazard_ms.evaluation.video import FINE, Video
from hazard_ms.spec.storage.files import drafts, write

QUALITY = 82  # of a JPEG, of 100


def encoded(picture: Image, ending: str, quality: int = QUALITY) -> bytes:
    """The content of a file that holds a picture, [H, W, 3], RGB; `ending`: .png, .jpg or .jpeg."""
    settings = [] if ending.lower() == ".png" else [cv2.IMWRITE_JPEG_QUALITY, quality, cv2.IMWRITE_JPEG_OPTIMIZE, 1]
    return cv2.imencode(ending.lower(), picture[..., ::-1], settings)[1].tobytes()


def save(path: Path, picture: Image, quality: int = QUALITY) -> None:
    """Write a picture, [H, W, 3], RGB. Raises ValueError when the file cannot be written."""
    write(path, encoded(picture, path.suffix, quality))


def film(path: Path, pictures: Iterable[Image], size: tuple[int, int], rate: float) -> None:
    """Write pictures, [H, W, 3], RGB, of `size` (width, height) as an mp4 that browsers play, `rate` per second.

    Odd edges lose a pixel. Raises ValueError when the file cannot be written.
    """
    wide, high = size[0] // 2 * 2, size[1] // 2 * 2  # H.264 in yuv420p knows even sizes only
    with drafts(path) as (draft,), Video(draft, (wide, high), rate, FINE) as video:
        for picture in pictures:
            video.add(picture[:high, :wide])
