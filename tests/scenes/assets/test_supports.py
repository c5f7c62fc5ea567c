"""Surfaces of models made of boxes: how far they reach, and how much air is above them."""

from __future__ import annotations

import pytest
import trimesh

from hazard_ms.scenes.assets.intake.supports import supports


def box(low: tuple[float, float, float], high: tuple[float, float, float]) -> trimesh.Trimesh:
    return trimesh.creation.box(bounds=[low, high])


def test_a_surface_ends_where_a_board_hangs_just_above_it() -> None:
    """A table top of 1 m x 0.6 m; over its right half lies a board, 5 cm above it."""
    top = box((0.0, 0.0, 0.68), (1.0, 0.6, 0.7))
    board = box((0.5, 0.0, 0.75), (1.0, 0.6, 0.77))
    found = {s["z"]: s for s in supports(trimesh.util.concatenate([top, board]))}
    assert set(found) == {0.7, 0.77}
    assert found[0.7]["min"] == pytest.approx([0.01, 0.01], abs=0.02)
    assert found[0.7]["max"] == pytest.approx([0.49, 0.59], abs=0.02)
    assert found[0.77]["min"] == pytest.approx([0.51, 0.01], abs=0.02)
    assert found[0.77]["clearance"] == 2.0  # nothing is above it


def test_a_shelf_knows_the_height_of_its_compartments() -> None:
    boards = [box((0.0, 0.0, z - 0.02), (0.8, 0.3, z)) for z in (0.3, 0.6, 1.0)]
    found = {s["z"]: s["clearance"] for s in supports(trimesh.util.concatenate(boards))}
    assert found == pytest.approx({0.3: 0.28, 0.6: 0.38, 1.0: 2.0}, abs=0.01)
