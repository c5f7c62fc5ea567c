"""Laws of the realistic fire beyond the published numbers, which test_validate.py checks."""

from __future__ import annotations

import dataclasses
import math

import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st

from hazard_ms.hazards.fire.realistic import burning, fuels, radiation, smoke, tenability
from hazard_ms.hazards.fire.realistic.blaze import Blaze
from hazard_ms.hazards.presets import fire
from hazard_ms.spec import Opening, Room
from hazard_ms.spec.catalogue import CATEGORIES

positive = st.floats(0.1, 1000.0)


def number(*values: float) -> torch.Tensor:
    return torch.tensor([float(v) for v in values])


@settings(max_examples=60, deadline=None)
@given(growth=st.floats(1e-3, 0.2), peak=positive, energy=st.floats(10.0, 1e6))
def test_a_fire_gives_off_its_energy_and_no_more_than_its_peak(growth: float, peak: float, energy: float) -> None:
    course = burning.course(number(growth), number(peak), number(energy))
    age = torch.linspace(0.0, float(course.end), 20_001)
    seen = burning.release(burning.Course(*(v.expand(age.shape) for v in course)), age).double()
    assert float(seen.mean() * course.end) == pytest.approx(energy, rel=2e-3)
    assert float(seen.max()) <= peak * (1 + 1e-5)
    early = age < float(course.decline) * 0.999
    assert torch.allclose(seen[early], torch.minimum(growth * age[early] ** 2, course.peak).double(), rtol=1e-4)
    assert float(burning.release(course, course.end * 1.001)) == 0.0


def test_measured_curves_go_through_their_knots_and_straight_between() -> None:
    for row, curve in enumerate(fuels.CURVES.values()):
        for (t0, q0), (t1, q1) in zip(curve.knots, curve.knots[1:], strict=False):
            seen = burning.measured(torch.full((2,), row), number(t0, (t0 + t1) / 2))
            assert seen.tolist() == pytest.approx([q0, (q0 + q1) / 2], rel=1e-4, abs=1e-3)
        last = curve.knots[-1][0]
        assert burning.measured(torch.full((2,), row), number(last + 1, -1.0)).tolist() == [0.0, 0.0]
        assert float(burning.lasting(torch.tensor(row))) == last
        assert float(burning.radiant(torch.tensor(row), 0.2)) == pytest.approx(curve.radiant)
    assert float(burning.radiant(torch.tensor(-1), 0.2)) == pytest.approx(0.2)


def test_every_category_has_a_material_and_every_table_names_categories() -> None:
    for name in CATEGORIES:
        made = fuels.material(name)
        assert (made.inertia > 0) != (made.sheet > 0) and made.critical > 0 and 200 <= made.ignition <= 700
    listed = {n for names in fuels._OF.values() for n in names} | set(fuels.CURVE_OF) | set(fuels.MEASURED)
    assert (
        listed <= set(CATEGORIES)
        and set(fuels.CURVE_OF.values()) <= set(fuels.CURVES)
        and set(fuels._OF) <= set(fuels.MATERIALS)
    )


def test_fluxes_add_fall_with_the_square_and_do_not_exceed_a_flames() -> None:
    place = torch.tensor([[[0.0, 0.0, 0.0], [50.0, 0.0, 0.0]]])
    fires = radiation.Fires(place, number(100.0, 0.0)[None], torch.full((1, 2), 0.35), torch.full((1, 2), 0.34))
    points = torch.tensor([[[4.0, 0.0, 0.0], [8.0, 0.0, 0.0], [0.0, 0.0, 0.3], [46.0, 0.0, 0.0]]])
    one = radiation.flux(fires, points, number(50.0))[0]
    lift = (float(radiation.flame_length(number(100.0), number(0.34))) / 3) ** 2
    assert float(one[0] / one[1]) == pytest.approx((64 + lift) / (16 + lift), rel=1e-4)
    assert float(one[2]) == radiation.FLAME_FLUX
    both = radiation.flux(fires._replace(power=number(100.0, 100.0)[None]), points, number(50.0))[0]
    assert float(both[0] - one[0]) == pytest.approx(0.35 * 100 / (4 * math.pi * (46**2 + lift)), rel=1e-3)


def test_a_batch_gives_what_one_gives(monkeypatch: pytest.MonkeyPatch) -> None:
    generator = torch.Generator().manual_seed(1)
    place, points = (5 * torch.rand(6, n, 3, generator=generator) for n in (9, 7))
    fires = radiation.Fires(
        place, 200 * torch.rand(6, 9, generator=generator), torch.full((6, 9), 0.35), torch.full((6, 9), 0.3)
    )
    whole = radiation.flux(fires, points, torch.full((6,), 2.6))
    monkeypatch.setattr(radiation, "_BLOCK", 100)
    assert torch.equal(whole, radiation.flux(fires, points, torch.full((6,), 2.6)))


SURFACES = st.sampled_from(
    [
        radiation.Solid(number(390.0), number(16.0), number(0.5), number(0.0)),
        radiation.Solid(number(300.0), number(10.0), number(0.0), number(0.4)),
    ]
)


@settings(max_examples=60, deadline=None)
@given(
    solid=SURFACES,
    flux=st.floats(0.0, 60.0),
    start=st.floats(20.0, 800.0),
    parts=st.integers(2, 30),
    span=st.floats(0.1, 300.0),
)
def test_surfaces_do_not_know_the_length_of_a_step(
    solid: radiation.Solid, flux: float, start: float, parts: int, span: float
) -> None:
    once = radiation.warm(number(start), number(flux), solid, 20.0, span)
    many = number(start)
    for _ in range(parts):
        many = radiation.warm(many, number(flux), solid, 20.0, span / parts)
    assert float(many) == pytest.approx(float(once), rel=1e-3, abs=0.05)
    limit = 20.0 + flux * (float(solid.ignition) - 20.0) / float(solid.critical)
    assert min(start, limit) - 0.05 <= float(once) <= max(start, limit) + 0.05


@settings(max_examples=60, deadline=None)
@given(flux=st.floats(0.0, 80.0), gas=st.floats(20.0, 820.0))
def test_a_plate_thermometer_neither_gains_nor_loses_heat(flux: float, gas: float) -> None:
    surface = float(
        radiation.adiabatic(torch.tensor(flux, dtype=torch.float64), torch.tensor(gas, dtype=torch.float64), 20.0)
    )
    gain = 0.9 * (flux + 5.670e-11 * (293.15**4 - (surface + 273.15) ** 4)) + 0.01 * (gas - surface)
    assert abs(gain) < 0.01 * max(flux, 1.0)
    assert surface >= 20.0 - 1e-6


def test_heat_and_soot_are_conserved_in_a_tight_room_without_losses(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(smoke, "WALLS", 0.0)
    walls = smoke.Walls(number(400.0), number(5.0), number(80.0))
    layer, source = (
        smoke.Layer(*(torch.zeros(1) for _ in range(3))),
        smoke.Source(number(300.0), number(200.0), number(0.2), number(0.001)),
    )
    for _ in range(300):
        layer = smoke.fill(layer, walls, torch.zeros(1, 1, 3), source, 20.0, 820.0, 0.1)
    assert float(layer.energy) == pytest.approx(200.0 * 30, rel=1e-4) and float(layer.soot) == pytest.approx(
        0.03, rel=1e-4
    )
    assert 0 < float(smoke.interface(layer.volume, walls)) < 5.0
    hot = float(smoke.temperature(layer, 20.0)) + 273.15
    # mass times rise, 1 kJ/kg K
    assert 353 / hot * float(layer.volume) * (hot - 293.15) == pytest.approx(6000.0, rel=1e-3)


def test_smoke_leaves_through_gaps_above_its_face_only() -> None:
    door = Room(
        size=(4.0, 5.0),
        openings=(Opening("door", "south", 2.0, 0.9, 2.0), Opening("window", "east", 2.0, 1.0, 1.2, 0.9)),
    )
    assert smoke.gaps(door) == [(0.02, 0.0, 2.0), (0.02, 0.9, 2.1)]
    vents = torch.tensor([[(0.9, 0.0, 2.0)]])
    assert float(smoke.leak(vents, number(2.1), number(200.0), 20.0)) == 0.0
    assert float(smoke.leak(vents, number(1.0), number(20.0), 20.0)) == 0.0
    rho, air = 353 / 473.15, 353 / 293.15
    # velocity head of each height, by the pressure above the face
    layers = torch.linspace(1.0, 2.0, 20_001, dtype=torch.float64)
    want = 0.7 * 0.9 * float((2 * rho * 9.81 * (air - rho) * (layers - 1.0)).sqrt().mean())
    assert float(smoke.leak(vents, number(1.0), number(200.0), 20.0)) == pytest.approx(want, rel=1e-3)


@settings(max_examples=30, deadline=None)
@given(power=st.floats(1.0, 20000.0), dt=st.floats(0.01, 5.0), width=st.floats(0.0, 3.0))
def test_a_layer_stays_in_its_room_and_below_the_heat_of_flames(power: float, dt: float, width: float) -> None:
    walls, vents = smoke.Walls(number(12.0), number(2.4), number(14.0)), torch.tensor([[(width, 0.0, 2.0)]])
    layer = smoke.Layer(*(torch.zeros(1) for _ in range(3)))
    for step in range(150):
        now = power if step < 100 else 0.0
        layer = smoke.fill(
            layer,
            walls,
            vents,
            smoke.Source(number(now), number(0.65 * now), number(0.0), number(1e-3)),
            20.0,
            820.0,
            dt,
        )
        assert 0.0 <= float(smoke.interface(layer.volume, walls)) <= 2.4 + 1e-6
        assert 19.99 <= float(smoke.temperature(layer, 20.0)) <= 820.1 and float(layer.soot) >= 0.0


def test_thermal_classes_of_robots() -> None:
    seen = tenability.thermal_class(number(20, 80, 140, 200, 300, 20, 20, 20), number(0, 0, 0, 0, 0, 1.5, 5, 12))
    assert seen.tolist() == [0, 1, 2, 3, 4, 2, 3, 4]


REAL = Blaze()


def test_the_preset_is_this_fire() -> None:
    assert fire("realistic") == REAL and REAL.name == "fire"


@pytest.mark.parametrize(
    ("field", "value"),
    [
        ("time_scale", 0.0),
        ("first_release", -1.0),
        ("horizon", math.inf),
        ("radiant", 1.0),
        ("agent_bound", 0.0),
        ("flame_temperature", 20.0),
    ],
)
def test_impossible_parameters_are_refused_by_name(field: str, value: float) -> None:
    with pytest.raises(ValueError, match=f"{field} must be .*, got {value}"):
        dataclasses.replace(REAL, **{field: value})
