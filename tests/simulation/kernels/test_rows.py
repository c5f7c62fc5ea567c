"""Numbers of rows without gaps: read and set where they belong, and states of hazards are such rows."""

from __future__ import annotations

import numpy as np
import pytest
import torch
import warp as wp

import hazard_ms  # noqa: F401 registers the environments
from hazard_ms.simulation.kernels.launch import OPTIONS
from hazard_ms.simulation.kernels.rows import at, put
from hazard_ms.tasks import task_of
from tests.worlds.flood_worlds import Thing, begin, room

wp.set_module_options(OPTIONS)


@wp.kernel
def _turn_round(rows: wp.array2d(dtype=float), turned: wp.array2d(dtype=float)):
    row = wp.tid()
    last = rows.shape[1] - 1
    for k in range(rows.shape[1]):
        put(turned, row, last - k, at(rows, row, k))


@pytest.mark.parametrize("first", [0, 2])
def test_numbers_are_read_and_set_where_they_are(first: int) -> None:
    """Of whole arrays, and of every second row of one."""
    held = torch.arange(60, dtype=torch.float32).view(6, 10)
    rows = held[first::2]
    turned = torch.full_like(rows, -1.0)
    wp.launch(_turn_round, dim=len(rows), inputs=[wp.from_torch(rows), wp.from_torch(turned)], device="cpu")
    assert np.array_equal(turned.numpy(), rows.numpy()[:, ::-1])


def test_rows_of_water_have_no_gaps() -> None:
    hazard = task_of("HazardFlood-v1", "realistic").hazards[0]
    state = begin(hazard, room([Thing((0.1,) * 3, at=(0.5, 0.5, 0.5))], "south", (3.0, 3.0), 2, (1.0, 1.0)))
    grids = [value for value in vars(state).values() if isinstance(value, torch.Tensor) and value.ndim == 2]
    assert len(grids) >= 10 and all(grid.stride(1) == 1 for grid in grids)
