"""The thermal camera against Planck's law, geometry worked out by hand, and lengths found by sampling."""

from __future__ import annotations

import math

import numpy as np
import pytest
import torch
from numpy.typing import NDArray

from hazard_ms.sensing.senses import planck, thermal
from hazard_ms.sensing.senses.crossing import through
from hazard_ms.sensing.senses.signals import Flames
from tests.sensing.test_sensing import small_world

HC_K = 0.014387769  # [m K], CODATA 2018
BAND = 10e-6  # [m]


def law(celsius: float) -> float:
    """Planck's law at 10 um, in its own unit."""
    return 1.0 / math.expm1(HC_K / (BAND * (celsius + 273.15)))


def inverse(radiance: float) -> float:
    return HC_K / (BAND * math.log1p(1.0 / radiance)) - 273.15


@pytest.mark.parametrize("celsius", [-20.0, 20.0, 37.0, 200.0, 820.0])
def test_radiance_is_planck_s_and_temperature_its_inverse(celsius: float) -> None:
    found = planck.radiance(torch.tensor(celsius, dtype=torch.float64))
    assert float(found) == pytest.approx(law(celsius), rel=1e-6)
    assert float(planck.temperature(found)) == pytest.approx(celsius, abs=1e-6)
    assert planck.slope(celsius) == pytest.approx((law(celsius + 0.01) - law(celsius - 0.01)) / 0.02, rel=1e-5)


def seen(surface: float, way: float = 0.0, flame: float = 600.0, dims: float = 0.0, murk: float = 20.0) -> float:
    one = torch.ones(1, 1)
    heat = thermal.Heat(one * surface, one * way, flame, one * dims, one * murk, 20.0)
    return float(planck.temperature(thermal.arriving(heat)))


def test_a_room_of_one_temperature_looks_like_it() -> None:
    assert seen(20.0) == pytest.approx(20.0, abs=1e-3)


def test_a_hot_wall_looks_colder_by_what_it_does_not_emit() -> None:
    """5 % of what arrives is the room's."""
    assert seen(400.0) == pytest.approx(inverse(0.95 * law(400.0) + 0.05 * law(20.0)), abs=0.05)


def test_flames_and_smoke_are_mixed_with_what_is_behind_them() -> None:
    """A metre of flame lets exp(-1.13) through, smoke of optical depth ln 2 a half."""
    wall = 0.95 * law(100.0) + 0.05 * law(20.0)
    burning = math.exp(-1.13) * wall + (1.0 - math.exp(-1.13)) * law(600.0)
    assert seen(100.0, way=1.0) == pytest.approx(inverse(burning), abs=0.05)
    dimmed = 0.5 * burning + 0.5 * law(150.0)
    assert seen(100.0, way=1.0, dims=math.log(2.0), murk=150.0) == pytest.approx(inverse(dimmed), abs=0.05)


def test_noise_is_a_quarter_of_a_kelvin_at_30_degrees_and_less_where_it_is_hot() -> None:
    """Equal in radiance, so in temperature it falls as the slope of Planck's law rises."""
    noise = torch.randn(1, 200, 200, generator=torch.Generator().manual_seed(0))
    for celsius in (30.0, 300.0):
        image = planck.radiance(torch.full((1, 200, 200), celsius))
        told = thermal.reading(image, noise)
        rise = (law(celsius + 0.5) - law(celsius - 0.5)) / (law(30.5) - law(29.5))
        assert float(told.std()) == pytest.approx(0.25 / rise, rel=0.02)
        assert float(told.mean()) == pytest.approx(celsius, abs=0.01)


def test_the_camera_ends_at_its_range() -> None:
    image = planck.radiance(torch.tensor([[[-60.0, 20.0, 900.0]]]))
    assert thermal.reading(image, torch.zeros(1, 1, 3))[0, 0].tolist() == pytest.approx([-20.0, 20.0, 650.0], abs=1e-2)


def test_optics_spread_a_point_over_its_neighbours_and_lose_nothing() -> None:
    image = torch.zeros(1, 21, 21, dtype=torch.float64)
    image[0, 10, 10] = 1.0
    made = thermal.blurred(image)[0]
    assert float(made.sum()) == pytest.approx(1.0)
    apart = torch.arange(21, dtype=torch.float64) - 10.0
    for axis in (0, 1):
        assert float((made.sum(axis) * apart.square()).sum().sqrt()) == pytest.approx(0.7, abs=0.01)
    assert torch.allclose(thermal.blurred(torch.full((2, 5, 7), 3.0)), torch.tensor(3.0))


@pytest.mark.parametrize(("height", "width", "step"), [(256, 256, 1), (240, 320, 1), (512, 512, 2), (480, 641, 3)])
def test_a_camera_has_320_columns(height: int, width: int, step: int) -> None:
    assert thermal.stride(height, width) == step


def flames(*rows: tuple[float, float, float, float, float]) -> Flames:
    """x, y, z of the base, width and height [m] of each."""
    table = torch.tensor([rows])
    return Flames(table[..., :3].clone(), table[..., 3].clone(), table[..., 4].clone(), 600.0)


def test_lines_through_a_flame_have_the_lengths_of_geometry() -> None:
    """Across its middle, along its axis, past it, above it, and from within."""
    world, one = small_world(), flames((2.0, 0.0, 0.0, 0.4, 1.0))
    both = Flames(*(v.expand(2, *v.shape[1:]) if isinstance(v, torch.Tensor) else v for v in one))
    for eye, point, expected in (
        ((0.0, 0.0, 0.5), (4.0, 0.0, 0.5), 0.4),
        ((2.0, 0.0, 3.0), (2.0, 0.0, 0.0), 1.0),
        ((0.0, 0.3, 0.5), (4.0, 0.3, 0.5), 0.0),
        ((0.0, 0.0, 1.5), (4.0, 0.0, 1.5), 0.0),
        ((2.0, 0.0, 0.5), (4.0, 0.0, 0.5), 0.2),
        ((0.0, 0.0, 0.5), (2.0, 0.0, 0.5), 0.2),
        ((0.0, 0.1, 0.5), (4.0, 0.1, 0.5), 2.0 * math.sqrt(0.2**2 - 0.1**2)),
    ):
        found = through(world, both, torch.tensor([eye] * 2), torch.tensor([[point]] * 2))
        assert found.flatten().tolist() == pytest.approx([expected] * 2, abs=1e-5)


def sampled(eye: NDArray[np.float64], point: NDArray[np.float64], rows: NDArray[np.float64], count: int) -> float:
    """The length in flames, by asking `count` places along the line."""
    places = eye + (point - eye) * ((np.arange(count) + 0.5) / count)[:, None]
    total = 0.0
    for x, y, z, width, height in rows:
        near = np.hypot(places[:, 0] - x, places[:, 1] - y) < width / 2
        total += float((near & (places[:, 2] > z) & (places[:, 2] < z + height)).mean())
    return total * float(np.linalg.norm(point - eye))


def test_lengths_in_many_flames_are_those_that_sampling_finds() -> None:
    rng = np.random.default_rng(0)
    rows = np.column_stack([rng.uniform(0, 4, (9, 2)), rng.uniform(0, 0.5, 9), rng.uniform(0.5, 2.0, (9, 2))])
    eye, points = rng.uniform(0, 2, 3), rng.uniform(0, 4, (40, 3)) * (1, 1, 0.5)
    shown = Flames(*(torch.tensor(v, dtype=torch.float32)[None] for v in (rows[:, :3], rows[:, 3], rows[:, 4])), 600.0)
    both = Flames(*(v.expand(2, *v.shape[1:]) if isinstance(v, torch.Tensor) else v for v in shown))
    given = torch.tensor(points, dtype=torch.float32).expand(2, -1, -1)
    found = through(small_world(), both, torch.tensor(eye, dtype=torch.float32).expand(2, -1), given)[1]
    expected = [sampled(eye, point, rows, 20000) for point in points]
    assert max(expected) > 0.5 and found.tolist() == pytest.approx(expected, abs=2e-3)
