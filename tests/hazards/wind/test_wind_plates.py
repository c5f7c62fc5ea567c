"""Flat things in the wind of `realistic`: forces by the angle of the air [Holmes, Letchford & Lin 2006]."""

from __future__ import annotations

import dataclasses
import math

import pytest
import torch

from hazard_ms.hazards.presets import wind
from tests.worlds.wind_worlds import Thing, begin, push, street

# a profile that is the same at all heights of a plate
LAW = dataclasses.replace(
    wind("realistic"),
    by_split=False,
    scale=1.0,
    gust_intensity=0.0,
    sheltered=False,
    roughness=1e-9,
    pavement=0.0,
    lift=0.0,
)
SIDE, HEAVY, HIGH = 0.4, 1e9, 9.8  # a plate's edge [m], mass [kg] and height [m]
# Force on a square plate over that on one across the wind: 1.71 a / 40 up to 40 degrees, 1.15 beyond, over 1.15
NORMAL = {10: 0.3717, 20: 0.7435, 35: 1.3011, 50: 1.0, 90: 1.0}
# Place of the force in edges upwind of the middle: 0.3 - 0.22 a / 38, 0.08 cos 2 (a - 38), 0
PLACE = {10: 0.2421, 20: 0.1842, 35: 0.0974, 50: 0.0731, 90: 0.0}


def plate(angle: float, mass: float = HEAVY, thick: float = 0.002) -> Thing:
    """A plate whose upwind edge is raised by `angle` [degrees] in a wind along x."""
    half = math.radians(angle) / 2
    return Thing((SIDE, SIDE, thick), mass, (8.0, 8.0, HIGH), (math.cos(half), 0.0, math.sin(half), 0.0), 0.0, "plate")


@pytest.mark.parametrize("angle", NORMAL)
def test_the_force_is_normal_to_the_face_and_acts_upwind_of_its_middle(angle: int) -> None:
    got = push(LAW, street([plate(angle)], (20.0, 0.0)))
    assert got.torque is not None
    size = 0.5 * 1.225 * 1.17 * SIDE**2 * 20.0**2 * NORMAL[angle]
    sine, cosine = math.sin(math.radians(angle)), math.cos(math.radians(angle))
    rim = 0.5 * 1.225 * 1.17 * SIDE * 0.002 * 20.0**2 * cosine
    assert got.force[0, 0].tolist() == pytest.approx([size * sine + rim, 0.0, size * cosine], rel=0.01, abs=0.02)
    # the raised edge lies upwind: a force there turns it further up, about +y
    assert float(got.torque[0, 0, 1]) == pytest.approx(size * PLACE[angle] * SIDE, rel=0.03, abs=0.05)


def test_what_is_thick_and_what_lies_flat_feel_drag_alone() -> None:
    things = [plate(0.0), plate(25.0, thick=0.3), Thing((0.3, 0.3, 0.3), HEAVY, (8.0, 8.0, HIGH))]
    for thing in things:
        world = street([thing], (20.0, 0.0))
        with_faces, without = (push(dataclasses.replace(LAW, plates=on), world) for on in (True, False))
        assert torch.allclose(with_faces.force, without.force, rtol=1e-6, atol=1e-5)
        assert with_faces.torque is not None and without.torque is not None
        assert torch.allclose(with_faces.torque, without.torque, rtol=1e-6, atol=1e-5)


@pytest.mark.parametrize("mass", [1e-4, 1e-3, 0.05])
def test_no_step_makes_a_light_plate_faster_against_the_air(mass: float) -> None:
    """However light it is and however it lies: the wind takes from its slip, it never adds to it."""
    things = [plate(angle, mass) for angle in range(-90, 91, 7)]
    world = street(things, (30.0, 0.0))
    world.velocity[0, :, 2] = torch.linspace(-20.0, 20.0, len(things))
    state = begin(LAW, world)
    after = world.velocity + LAW.force(state, world, 1 / 120).force / mass / 120
    air = torch.tensor([30.0 * 1.0, 0.0, 0.0])
    assert ((after - air).norm(dim=-1) <= (world.velocity - air).norm(dim=-1) * 1.002).all()
