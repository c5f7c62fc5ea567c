"""What `./run gpu-check` tells of two pictures of one scene."""

from __future__ import annotations

import numpy as np

from results.gpu.looks import compare, looks_row, looks_table
from tests.results.test_gpu_check import cells


def test_pictures_are_compared_pixel_by_pixel_and_beyond_outlines() -> None:
    """Of 64 labels two change: one at an outline, where its neighbour has it, and one in the middle of a thing."""
    shape = (8, 8, 1)
    labels, depth, colours = np.ones(shape, np.int16), np.full(shape, 1500, np.int16), np.zeros((8, 8, 3), np.uint8)
    labels[:, 4:] = 2
    a = {"4/rgb": colours, "4/depth": depth, "4/segmentation": labels}
    b = {name: numbers.copy() for name, numbers in a.items()}
    b["4/segmentation"][2, 4], b["4/segmentation"][6, 1] = 1, 9
    b["4/depth"][0, :2, 0] = (1502, 1503)  # 2 mm do not count
    b["4/rgb"][0, 0] = 192
    found = compare(4, a, b)
    assert (found.labels, found.beyond, found.depths, found.colour) == (2 / 64, 1 / 64, 1 / 64, 192 / 64)
    below, above = ({**a, "4/depth": np.full(shape, mm, np.int16)} for mm in (32_767, 32_768 - 65_536))
    assert compare(4, below, above).depths == 0.0  # 32.767 m and 32.768 m
    assert cells(looks_table([looks_row("HazardFire-v1", 4, 0.01, 0.02, found)]))[0][1:] == [
        *("4", "10.0", "20.0"),
        *("3.125", "1.562", "1.562", "3.00"),
    ]
    assert cells(looks_table([looks_row("HazardFire-v1", 4, 0.01, None, None)]))[0][3:] == ["none"] * 5
