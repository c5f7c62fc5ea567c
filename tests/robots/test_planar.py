"""Geometry of robots that stand on a floor."""

from __future__ import annotations

import math

import pytest
import torch

from hazard_ms.robots.planar import turned


def test_what_a_robot_carries_turns_with_it_anticlockwise() -> None:
    ahead = torch.tensor([[1.0, 0.0, 0.7], [1.0, 0.0, 0.7], [0.0, 2.0, -1.0]])
    headings = torch.tensor([math.pi / 2, -math.pi / 6, math.pi])
    expected = [[0.0, 1.0, 0.7], [math.sqrt(0.75), -0.5, 0.7], [0.0, -2.0, -1.0]]
    for row, wanted in zip(turned(ahead, headings).tolist(), expected, strict=True):
        assert row == pytest.approx(wanted, abs=1e-6)
