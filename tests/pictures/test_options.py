"""Sizes of pictures as text."""

from __future__ import annotations

import pytest

from hazard_ms.pictures.options import RenderOptions


def test_a_size_is_width_and_height_or_one_for_both() -> None:
    assert RenderOptions(size="1024x768").pixels() == (1024, 768)
    assert RenderOptions(size="640X480").pixels() == (640, 480)
    assert RenderOptions(size="512").pixels() == (512, 512)
    assert RenderOptions(size="8192x16").pixels() == (8192, 16)


@pytest.mark.parametrize("size", ["", "x", "64x", "1x2x3", "-64", "64 x 64", "6.4", "8193", "64x15"])
def test_other_sizes_are_refused(size: str) -> None:
    with pytest.raises(ValueError, match="must be"):
        RenderOptions(size=size).pixels()
