"""Shapes that need no model fill their cube, and are hollow where their names say."""

from __future__ import annotations

import numpy as np
import pytest

from hazard_ms.scenes.assets import primitives
from hazard_ms.scenes.assets.index import asset
from hazard_ms.spec.catalogue import CATEGORIES


def test_plain_shapes_fill_their_cube() -> None:
    name = primitives.name_of("case", [(0.1, 0.5), (0.52, 0.98)])
    assert name == "plain_case_100-500_520-980"
    boxes = np.array(asset(name).boxes).reshape(-1, 2, 3)
    assert (boxes[:, 0] - boxes[:, 1]).min(0) == pytest.approx([-0.5, -0.5, 0.0])
    assert (boxes[:, 0] + boxes[:, 1]).max(0) == pytest.approx([0.5, 0.5, 1.0])
    for at, solid in {
        (0, 0, 0.05): 1,
        (0, 0, 0.3): 0,
        (0, -0.49, 0.3): 0,
        (0, 0.499, 0.3): 1,
        (0.499, 0, 0.7): 1,
        (0, 0, 0.51): 1,
    }.items():
        assert (np.abs(boxes[:, 0] - at) < boxes[:, 1]).all(1).sum() == solid, at
    assert len(asset("plain_box").boxes) == 1
    for bad in ("plain_sphere", "plain_case", "plain_case_5-3", "plain_case_0-1001", "plain_case_1-2_2-3"):
        with pytest.raises(ValueError, match="a shape must look like|must rise"):
            asset(bad)
    assert all(0.0 <= v <= 1.0 for c in CATEGORIES for v in primitives.colour(c))
