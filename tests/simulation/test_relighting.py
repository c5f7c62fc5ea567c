"""Light under a perturbation: brighter or darker, warmer or cooler, the sun from elsewhere."""

from __future__ import annotations

import math

import numpy as np
import pytest

from hazard_ms.simulation.drawing import relighting
from hazard_ms.simulation.drawing.moods import INDOORS
from hazard_ms.spec.perturbation import MOST_LEVEL


def test_light_is_farther_from_training_with_each_level() -> None:
    rows = np.random.default_rng(0).random((20, relighting.DRAWS)).tolist()
    day = INDOORS["day"]
    white = [[relighting.drawn(level, row) for row in rows] for level in range(1, MOST_LEVEL + 1)]
    amounts = np.abs(np.array(white))  # [levels, rows, stops and mireds and turns]
    assert (amounts[1:].min(1) > amounts[:-1].max(1)).all()
    for change in white[2]:
        lit = relighting.relit(day, change)
        assert (lit.lamp[0] / lit.lamp[2] > day.lamp[0] / day.lamp[2]) == (change.mireds > 0.0)  # redder is warmer
        assert math.hypot(*lit.toward[:2]) == pytest.approx(math.hypot(*day.toward[:2]))
        assert lit.toward[2] == day.toward[2]  # the sun stays as high
    grey = day._replace(lamp=(1.0, 1.0, 1.0))
    luminance = np.array(relighting.relit(grey, relighting.Change(1.0, 80.0, 0.0)).lamp) @ (0.2126, 0.7152, 0.0722)
    assert luminance == pytest.approx(2.0)  # a stop, whatever its colour
