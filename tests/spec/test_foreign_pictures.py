"""Pictures of others: counted before they are decoded, and of two formats only."""

from __future__ import annotations

import io
import struct
import zlib

import numpy as np
import pytest
from PIL import Image

from hazard_ms.spec.foreign import pictures


def encoded(picture: np.ndarray, kind: str) -> bytes:
    made = io.BytesIO()
    Image.fromarray(picture).save(made, kind)
    return made.getvalue()


def chunk(kind: bytes, data: bytes) -> bytes:
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))


def announced(width: int, height: int) -> bytes:
    """A PNG file that says how large it is and has no pixels."""
    header = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(b"")) + chunk(b"IEND", b"")


def test_pixels_are_those_that_were_stored() -> None:
    random = np.random.default_rng(0)
    colour = random.integers(0, 255, (5, 7, 3), np.uint8)
    ids = random.integers(0, 60_000, (5, 7), np.uint16)
    np.testing.assert_array_equal(pictures.decoded(encoded(colour, "PNG"), "it"), colour)
    np.testing.assert_array_equal(pictures.decoded(encoded(ids, "PNG"), "it"), ids)
    red = np.zeros((16, 16, 3), np.uint8)
    red[..., 0] = 255
    assert np.abs(pictures.decoded(encoded(red, "JPEG"), "it").astype(int) - red).max() < 3


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (announced(30_000, 30_000), "picture"),
        (announced(5000, 5000), "at most 16777216 pixels, got 5000 x 5000"),
        (announced(10, 10), "cannot be decoded"),
        (encoded(np.zeros((4, 4, 3), np.uint8), "BMP"), "be a PNG or JPEG picture"),
        (encoded(np.zeros((4, 4, 3), np.uint8), "TIFF"), "be a PNG or JPEG picture"),
        (b"%!PS-Adobe-3.0 EPSF-3.0\n", "be a PNG or JPEG picture"),
        (b"", "be a PNG or JPEG picture"),
    ],
)
def test_what_is_not_such_a_picture_is_refused(content: bytes, words: str) -> None:
    with pytest.raises(ValueError, match=f"the picture must .*{words}"):
        pictures.decoded(content, "the picture")


def test_a_picture_is_whole() -> None:
    with pytest.raises(ValueError, match="a.png must be a"):
        pictures.decoded(encoded(np.zeros((50, 50, 3), np.uint8), "PNG")[:-30], "a.png")
