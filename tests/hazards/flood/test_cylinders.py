"""Cylinders in the water of `realistic`: against segments of circles (L-12) and clipped polyhedra."""

from __future__ import annotations

import math

import numpy as np
import pytest
import torch
from scipy.optimize import brentq
from scipy.spatial.transform import Rotation

from hazard_ms.hazards.flood.buoyancy import BALL, BOX, CYLINDER
from hazard_ms.validation.experiments.basin import lying
from hazard_ms.validation.experiments.probes import Immersion, immersion
from tests.worlds import polyhedra


def tensor(values: object) -> torch.Tensor:
    return torch.as_tensor(np.asarray(values), dtype=torch.float32)


def wet(
    half: np.ndarray, quaternion: np.ndarray, height: float, slope: tuple[float, float], shape: int, discs: bool = True
) -> Immersion:
    """Of one body whose centre the surface is `height` above."""
    kind = torch.tensor([shape])
    return immersion(tensor([height]), tensor([slope]), tensor([quaternion]), 2 * tensor([half]), kind, discs)


def quaternion(vector: tuple[float, float, float]) -> np.ndarray:
    return np.roll(Rotation.from_rotvec(vector).as_quat(), 1)


@pytest.mark.parametrize(("density", "draught"), [(0.2, 0.25407), (0.5, 0.5), (0.9, 0.84352)])
def test_a_log_that_lies_floats_as_deep_as_its_segment(density: float, draught: float) -> None:
    angle = brentq(lambda a: (a - math.sin(a) * math.cos(a)) / math.pi - density, 0.0, math.pi)
    assert (1.0 - math.cos(angle)) / 2.0 == pytest.approx(draught, abs=1e-5)
    assert lying(density) == pytest.approx((1.0 - math.cos(angle)) / 2.0, abs=1e-5)


@pytest.mark.parametrize("roll", [0.0, 0.4, math.pi / 4])
@pytest.mark.parametrize("level", [-0.8, -0.3, 0.0, 0.5, 0.95])
def test_volume_middle_and_waterline_of_a_log_are_those_of_its_segment(level: float, roll: float) -> None:
    """The area under a chord, its middle and its width, summed over thin strips; however the log is rolled."""
    radius, long = 0.15, 0.4
    across = (Rotation.from_rotvec([math.pi / 2, 0, 0]) * Rotation.from_rotvec([0, 0, roll])).as_quat()
    found = wet(np.array([radius, radius, long]), np.roll(across, 1), level * radius, (0.0, 0.0), CYLINDER)
    at = np.linspace(-1.0, level, 200001)
    middles, strip = 0.5 * (at[1:] + at[:-1]), at[1] - at[0]
    widths = 2.0 * np.sqrt(1.0 - middles**2)
    area = float(widths.sum() * strip)
    assert float(found.fraction[0]) == pytest.approx(area / math.pi, abs=2e-6)
    lowest = float((widths * middles).sum() * strip) / area * radius
    assert found.arm[0].numpy() == pytest.approx([0.0, 0.0, lowest], abs=2e-6)
    width = 2.0 * math.sqrt(1.0 - level**2) / (math.pi * radius)  # share of the volume per metre of rise
    assert float(found.waterline[0]) == pytest.approx(width, rel=1e-4)
    assert float(found.steepest[0]) == pytest.approx(2.0 / (math.pi * radius), rel=1e-5)


def test_cylinders_in_any_attitude() -> None:
    """Within 0.012 of the volume and 0.03 of the size, of which columns alone are 0.018 and 0.042 wrong."""
    chance = np.random.default_rng(0)
    for _ in range(300):
        half = chance.uniform(0.02, 0.5, 3)
        half[1] = half[0]
        turn = chance.normal(size=4)
        turn /= np.linalg.norm(turn)
        slope = tuple(0.05 * chance.uniform(-1, 1, 2))
        size = float(np.linalg.norm(half))
        level = 0.7 * size * chance.uniform(-1, 1)
        corners = polyhedra.turned(polyhedra.cylinder(half, 96), turn, np.zeros(3))
        volume, middle = polyhedra.below(corners, level, slope)
        whole, _ = polyhedra.solid(corners)
        found = wet(half, turn, level, slope, CYLINDER)
        assert float(found.fraction[0]) == pytest.approx(volume / whole, abs=0.012)
        if volume > 0.1 * whole:
            assert np.abs(found.arm[0].numpy() - middle).max() < 0.03 * size


@pytest.mark.parametrize("shape", [BOX, CYLINDER, BALL])
def test_what_is_no_lying_cylinder_is_as_in_all_floods(shape: int) -> None:
    """Also upright cylinders, which columns have exactly right."""
    for turn in ((0.0, 0.0, 0.3), (0.2, 0.1, 0.0), (0.5, 0.2, 0.1)):
        half, tilt = np.array([0.1, 0.1, 0.3]), (0.01, -0.02)
        ours, theirs = (wet(half, quaternion(turn), 0.05, tilt, shape, discs) for discs in (True, False))
        for one, other in zip(ours, theirs, strict=True):
            assert torch.equal(one, other)
