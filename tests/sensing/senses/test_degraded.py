"""Smoke, rain and water before cameras, against their stated laws and lines that are summed up by sampling."""

from __future__ import annotations

import math
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import torch

from hazard_ms.sensing.senses import degraded, of_fire, of_others
from hazard_ms.sensing.senses.signals import Murk


def murk(depth: float, colour: tuple[float, float, float] = (0.2, 0.2, 0.2), size: tuple[int, int] = (1, 1)) -> Murk:
    tau = torch.full((1, *size), depth)
    return Murk(tau, tau, tau, tau, colour)


def test_colours_follow_koschmieder_in_linear_light() -> None:
    """Half of the light is left, half is the smoke's."""
    rgb = torch.tensor([[[[200, 100, 0]]]], dtype=torch.uint8)
    found = degraded.colours(rgb, [murk(math.log(2.0), (0.3, 0.2, 0.1))])[0, 0, 0].tolist()
    linear = [0.5 * (v / 255.0) ** 2.2 + 0.5 * a for v, a in zip((200, 100, 0), (0.3, 0.2, 0.1), strict=True)]
    assert found == [round(255.0 * v ** (1 / 2.2)) for v in linear]


def test_behind_thick_smoke_there_is_its_own_light_and_in_clear_air_nothing_changes() -> None:
    rgb = torch.arange(12, dtype=torch.uint8).reshape(1, 2, 2, 3) * 20
    thick = degraded.colours(rgb, [murk(50.0, (1.0, 0.5, 0.0), (2, 2))])
    assert (thick.float() - torch.tensor([255.0, 255.0 * 0.5 ** (1 / 2.2), 0.0])).abs().max() <= 0.5
    assert torch.equal(degraded.colours(rgb, [murk(0.0, size=(2, 2))]), rgb)
    depth = torch.tensor([[[1.0, 4.0], [0.0, 60.0]]])
    noise = torch.ones(1, 2, 2)
    assert torch.equal(degraded.depths(depth, [murk(0.0, size=(2, 2))], noise), depth)
    assert torch.equal(degraded.depths(depth, [], noise), depth)


def test_two_kinds_of_murk_add_up_by_their_optical_depths() -> None:
    rgb = torch.full((1, 1, 1, 3), 255, dtype=torch.uint8)
    found = degraded.colours(rgb, [murk(0.3, (0.0, 0.0, 0.0)), murk(0.1, (0.8, 0.8, 0.8))])
    kept = math.exp(-0.4)
    assert found[0, 0, 0, 0] == round(255.0 * (kept + (1 - kept) * 0.2) ** (1 / 2.2))


def test_depth_is_missing_beyond_the_visible_range() -> None:
    """Jin: one sees as far as 3 over the extinction. With 1.5 per metre that is 2 m."""
    for metres, there in ((1.99, True), (2.01, False)):
        found = degraded.depths(torch.tensor([[[metres]]]), [murk(1.5 * metres)], torch.zeros(1, 1, 1))
        assert bool(found > 0) is there


def test_depth_noise_grows_as_contrast_falls() -> None:
    """At 3 m and optical depth 1: 0.08 px / (447 px x 0.095 m) x 9 m^2 x sqrt(e^2 - 1) = 4.3 cm."""
    noise = torch.randn(1, 200, 200, generator=torch.Generator().manual_seed(1))
    found = degraded.depths(torch.full((1, 200, 200), 3.0), [murk(1.0, size=(200, 200))], noise)
    assert float(found.std()) == pytest.approx(0.0433, rel=0.02)
    assert float(found.mean()) == pytest.approx(3.0, abs=1e-3)


def test_drops_are_discs_of_the_stated_sizes() -> None:
    draw = torch.ones(1, degraded.DROPS, 4)  # no drop
    assert not degraded.drops(draw, 100, 200).any()
    draw[0, 3] = torch.tensor([0.1, 0.5, 0.5, 1.0])
    behind = degraded.drops(draw, 100, 200)[0]
    assert int(behind.sum()) == pytest.approx(math.pi * 8.0**2, rel=0.05)
    assert behind[50, 100] and behind[50, 107] and not behind[50, 109]
    rgb = torch.randint(0, 255, (1, 100, 200, 3), generator=torch.Generator().manual_seed(0), dtype=torch.uint8)
    smeared = degraded.smeared(rgb, behind[None])
    assert torch.equal(smeared[0][~behind], rgb[0][~behind])
    assert smeared[0][behind].float().std() < 0.5 * rgb[0][behind].float().std()


def house() -> tuple[Any, Any]:
    """The state of the smoke in three houses: rooms along x, along y, and in a grid of four; and their world."""
    far = torch.inf
    none = [far] * 4
    state = SimpleNamespace(
        zone_columns=torch.tensor([2, 1, 2]),
        zone_end_x=torch.tensor([[3.0, far, far, far], none, [2.0, far, far, far]]),
        zone_end_y=torch.tensor([none, [2.0, far, far, far], [3.0, far, far, far]]),
        zone_area=torch.tensor([[12.0, 12.0, 0.0, 0.0], [8.0, 12.0, 0.0, 0.0], [6.0, 9.0, 4.0, 6.0]]),
        zone_height=torch.tensor([[1.0, 2.0, 0.0, 0.0], [1.5, 0.4, 0.0, 0.0], [1.0, 2.0, 1.5, 0.4]]),
        zone_density=torch.tensor([[2.0, 0.5, 9.0, 9.0], [1.0, 3.0, 9.0, 9.0], [2.0, 0.5, 1.0, 3.0]]),
        zone_low_density=torch.tensor([[0.1, 0.0, 9.0, 9.0], [0.0, 0.3, 9.0, 9.0], [0.1, 0.0, 0.0, 0.3]]),
        zone_temperature=torch.tensor([[300.0, 80.0, 9.0, 9.0], [150.0, 500.0, 9.0, 9.0], [300.0, 80.0, 150.0, 500.0]]),
        zone_low_temperature=torch.tensor([[40.0, 20.0, 9.0, 9.0], [20.0, 60.0, 9.0, 9.0], [40.0, 20.0, 20.0, 60.0]]),
    )
    return state, SimpleNamespace(room=torch.tensor([[6.0, 4.0], [4.0, 5.0], [5.0, 5.0]]))


def summed(state: Any, world: Any, e: int, eye: np.ndarray, point: np.ndarray) -> tuple[float, float]:
    """Optical depth and mean temperature of the smoke, from 40,000 places along a line."""
    t = (np.arange(40000) + 0.5) / 40000
    places = eye + (point - eye) * t[:, None]
    east, north = (places[:, k] > float(end[e, 0]) for k, end in enumerate((state.zone_end_x, state.zone_end_y)))
    room = east.astype(int) + int(state.zone_columns[e]) * north.astype(int)
    high = places[:, 2] > state.zone_height[e].numpy()[room]
    thick = np.where(high, state.zone_density[e].numpy()[room], state.zone_low_density[e].numpy()[room])
    warm = np.where(high, state.zone_temperature[e].numpy()[room], state.zone_low_temperature[e].numpy()[room])
    size = world.room[e].numpy()
    thick = thick * ((places[:, :2] >= 0) & (places[:, :2] <= size)).all(1)
    return float(thick.mean() * np.linalg.norm(point - eye)), float((thick * warm).sum() / max(thick.sum(), 1e-12))


def test_smoke_along_a_line_is_what_sampling_sums_up() -> None:
    """Lines in one room, through two, along the face of the layer, and out of the house."""
    state, world = house()
    rng = np.random.default_rng(0)
    eye = np.array([[1.0, 1.2, 1.1], [1.0, 1.2, 1.6], [1.0, 1.2, 1.3]])
    points = np.stack([np.column_stack([rng.uniform(-3, 9, (60, 2)), rng.uniform(0, 2.6, 60)]) for _ in range(3)])
    points[:, 0] = [5.0, 1.2, 1.1]
    made = of_fire.BlazeSignals(SimpleNamespace(room_temperature=20.0)).murk(
        state, world, torch.tensor(eye, dtype=torch.float32), torch.tensor(points, dtype=torch.float32)
    )
    for e in range(3):
        for p in range(60):
            depth, warm = summed(state, world, e, eye[e], points[e, p])
            assert float(made.sight[e, p]) == pytest.approx(depth, abs=2e-3)
            if depth > 0.01:
                assert float(made.temperature[e, p]) == pytest.approx(warm, abs=1.0)
    assert float(made.sight.max()) > 2.0


def test_smoke_is_nearly_clear_in_thermal_infrared() -> None:
    """Rayleigh absorption at 10 um, c f / wavelength with c = 4.49, over 8.7 m^2/g of 1.8 g/cm^3 in visible light."""
    state, world = house()
    made = of_fire.BlazeSignals(SimpleNamespace(room_temperature=20.0)).murk(
        state, world, torch.tensor([[1.0, 1.0, 2.0]] * 3), torch.tensor([[[2.0, 3.0, 2.1]]] * 3)
    )
    share = (4.49 / 10e-6) / (8700.0 * 1800.0)
    assert (made.far / made.sight).flatten().tolist() == pytest.approx([share] * 3, rel=5e-3)
    assert 0.02 < share < 0.04


def test_depth_cameras_see_through_a_decimetre_of_water_not_through_a_metre() -> None:
    """From 1.2 m to the floor 3 m away, under 0.4 m of water: a third of the line, 4.3 per metre."""
    hazard = SimpleNamespace(image=lambda state, world, points: torch.full_like(points[..., 0], 0.4))
    eye, points = torch.tensor([[0.0, 0.0, 1.2]]), torch.tensor([[[3.0, 0.0, 0.0], [3.0, 0.0, 0.8], [3.0, 0.0, 1.2]]])
    made = of_others.FloodSignals(hazard).murk(None, None, eye, points)  # type: ignore[arg-type]
    assert made.near[0].tolist() == pytest.approx([4.3 * math.hypot(3.0, 1.2) / 3.0, 0.0, 0.0])
    assert float(made.sight.abs().max()) == float(made.far.abs().max()) == 0.0
    below = of_others.FloodSignals(hazard).murk(None, None, eye * 0.25, points[:, :1])  # type: ignore[arg-type]
    assert float(below.near[0, 0]) == pytest.approx(4.3 * math.hypot(3.0, 0.3))


def test_rain_of_50_mm_an_hour_dims_light_by_15_db_a_kilometre() -> None:
    made = of_others.WindSignals(None).murk(
        None,
        None,
        torch.zeros(1, 3),
        torch.tensor([[[0.0, 1000.0, 0.0]]]),  # type: ignore[arg-type]
    )
    assert 10.0 * float(made.sight[0, 0]) / math.log(10.0) == pytest.approx(1.076 * 50.0**0.67, rel=1e-4)
    assert 1.076 * 50.0**0.67 == pytest.approx(14.8, abs=0.05)
