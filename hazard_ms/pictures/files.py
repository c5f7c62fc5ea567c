"""Writes pictures and films to files."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

import cv2
import imageio_ffmpeg
import numpy as np

from hazard_ms.effects.raytracing.still import Image

QUALITY = 82  # of a JPEG, of 100


def save(path: Path, picture: Image, quality: int = QUALITY) -> None:
    """Write a picture, [H, W, 3], RGB. Raises ValueError when the file cannot be written."""
    settings = (
        [] if path.suffix.lower() == ".png" else [cv2.IMWRITE_JPEG_QUALITY, quality, cv2.IMWRITE_JPEG_OPTIMIZE, 1]
    )
    if not cv2.imwrite(str(path), picture[..., ::-1], settings):
        raise ValueError(f"output must be a file that can be written, got {path}")


def film(path: Path, pictures: Iterable[Image], size: tuple[int, int], rate: float) -> None:
    """Write pictures, [H, W, 3], RGB, of `size` (width, height) as an mp4 that browsers play, `rate` per second.

    Odd edges lose a pixel.
    """
    wide, high = size[0] // 2 * 2, size[1] // 2 * 2  # H.264 in yuv420p knows even sizes only
    pipe = imageio_ffmpeg.write_frames(
        str(path),
        (wide, high),
        fps=rate,
        codec="libx264",
        pix_fmt_out="yuv420p",
        macro_block_size=2,
        quality=None,
        output_params=["-crf", "20", "-movflags", "+faststart"],
        ffmpeg_log_level="error",
    )
    pipe.send(None)
    try:
        for picture in pictures:
            pipe.send(np.ascontiguousarray(picture[:high, :wide]))
    finally:
        pipe.close()
