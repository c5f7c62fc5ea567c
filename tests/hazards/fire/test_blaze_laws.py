"""Laws of the realistic fire beyond the published numbers, which test_validate.py checks."""

from __future__ import annotations

import dataclasses
import math

import pytest
import torch
import warp as wp
from hypothesis import given, settings
from hypothesis import strategies as st

from hazard_ms.hazards.fire.realistic import burning, fuels, radiation, tenability, thermometer
from hazard_ms.hazards.fire.realistic.blaze import Blaze
from hazard_ms.hazards.presets import fire
from hazard_ms.simulation.kernels.launch import OPTIONS, Launches
from hazard_ms.simulation.walls import Walls
from hazard_ms.spec.catalogue import CATEGORIES

wp.set_module_options(OPTIONS)

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
    one = radiation.flux(fires, Walls.none(1), points, number(50.0))[0]
    lift = (float(radiation.flame_length(number(100.0), number(0.34))) / 3) ** 2
    assert float(one[0] / one[1]) == pytest.approx((64 + lift) / (16 + lift), rel=1e-4)
    assert float(one[2]) == 40.0  # kW/m^2: the most that small flames give
    both = radiation.flux(fires._replace(power=number(100.0, 100.0)[None]), Walls.none(1), points, number(50.0))[0]
    assert float(both[0] - one[0]) == pytest.approx(0.35 * 100 / (4 * math.pi * (46**2 + lift)), rel=1e-3)


def test_a_batch_gives_what_one_gives(monkeypatch: pytest.MonkeyPatch) -> None:
    generator = torch.Generator().manual_seed(1)
    place, points = (5 * torch.rand(6, n, 3, generator=generator) for n in (9, 7))
    fires = radiation.Fires(
        place, 200 * torch.rand(6, 9, generator=generator), torch.full((6, 9), 0.35), torch.full((6, 9), 0.3)
    )
    whole = radiation.flux(fires, Walls.none(6), points, torch.full((6,), 2.6))
    monkeypatch.setattr(radiation, "_BLOCK", 100)
    assert torch.equal(whole, radiation.flux(fires, Walls.none(6), points, torch.full((6,), 2.6)))


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


@wp.kernel
def plate(flux: wp.array(dtype=float), gas: wp.array(dtype=float), surface: wp.array(dtype=float)):  # type: ignore
    """The temperature [C] of a plate in a room of 20 C."""
    n = wp.tid()
    surface[n] = thermometer.adiabatic(flux[n], gas[n], 20.0)


@settings(max_examples=60, deadline=None)
@given(flux=st.floats(0.0, 80.0), gas=st.floats(20.0, 820.0))
def test_a_plate_thermometer_neither_gains_nor_loses_heat(flux: float, gas: float) -> None:
    surface = torch.zeros(1)
    Launches().run(plate, (1,), torch.tensor([flux]), torch.tensor([gas]), surface)
    gain = 0.9 * (flux + 5.670e-11 * (293.15**4 - (float(surface) + 273.15) ** 4)) + 0.01 * (gas - float(surface))
    assert abs(gain) < 0.01 * max(flux, 1.0)
    assert float(surface) >= 20.0 - 1e-3


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
