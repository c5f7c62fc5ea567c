"""Lift and drag alone: L-18 to L-22 and L-25 of docs/physics.md, against clipped polyhedra and exact laws."""

from __future__ import annotations

import dataclasses
import re

import numpy as np
import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from hazard_ms.hazards.flood.buoyancy import BALL, BOX, CYLINDER
from hazard_ms.hazards.presets import flood
from hazard_ms.validation import kernel_costs as kernels
from hazard_ms.validation.experiments.probes import Immersion, drag, immersion, spin_drag
from tests.worlds import polyhedra
from tests.worlds.flood_worlds import Thing, begin, room

G, RHO = 9.81, 1000.0
edge = st.floats(0.02, 0.5)
unit = st.floats(-1.0, 1.0)


def tensor(values: object) -> torch.Tensor:
    return torch.as_tensor(np.asarray(values), dtype=torch.float32)


def wet(
    half: np.ndarray, quaternion: np.ndarray, height: float, slope: tuple[float, float] = (0.0, 0.0), shape: int = BOX
) -> Immersion:
    """Of one body whose centre the surface is `height` above."""
    return immersion(tensor([height]), tensor([slope]), tensor([quaternion]), 2 * tensor([half]), torch.tensor([shape]))


def quaternion(vector: np.ndarray) -> np.ndarray:
    return np.roll(Rotation.from_rotvec(vector).as_quat(), 1)


@settings(max_examples=150, deadline=None)
@given(
    half=st.tuples(edge, edge, edge), turn=st.tuples(unit, unit, unit, unit), height=unit, slope=st.tuples(unit, unit)
)
@pytest.mark.parametrize("shape", [BOX, CYLINDER])
def test_any_body_in_any_attitude(shape: int, half: tuple, turn: tuple, height: float, slope: tuple) -> None:
    """docs/physics.md 4.1 promises a volume within 0.016 of the box's, so the middle within that share of its size."""
    a, q = np.array(half), np.array(turn) + [1e-3, 0, 0, 0]
    if shape == CYLINDER:
        a[1] = a[0]
    q /= np.linalg.norm(q)
    tilt, size = 0.05 * np.array(slope), float(np.linalg.norm(a))
    corners = polyhedra.turned(polyhedra.box(a) if shape == BOX else polyhedra.cylinder(a), q, np.zeros(3))
    volume, middle = polyhedra.below(corners, 0.7 * height * size, tuple(tilt))
    share = volume / polyhedra.solid(corners)[0]
    found = wet(a, q, 0.7 * height * size, tuple(tilt), shape)
    assert float(found.fraction[0]) == pytest.approx(share, abs=0.02)
    if share > 0.1:  # the less is wet, the more an error in volume shifts its middle
        assert np.abs(found.arm[0].numpy() - middle).max() < max(0.06, 0.012 / share) * size


@settings(max_examples=100, deadline=None)
@given(half=st.tuples(edge, edge, edge), turn=st.tuples(unit, unit, unit, unit), height=unit)
def test_an_ellipsoid_is_exact(half: tuple, turn: tuple, height: float) -> None:
    """Against slices along the vertical: sections of an ellipsoid scale with 1 - s^2, and their middles lie on
    a line.
    """
    a, q = np.array(half), np.array(turn) + [1e-3, 0, 0, 0]
    q /= np.linalg.norm(q)
    up = Rotation.from_quat(np.roll(q, -1)).inv().apply([0.0, 0.0, 1.0])
    reach = float(np.linalg.norm(a * up))
    level = height * 1.2 * reach
    s = np.linspace(-1, min(max(level / reach, -1), 1), 4001)
    s = (s[1:] + s[:-1]) / 2
    section = 1 - s * s
    width = (min(max(level / reach, -1), 1) + 1) / 4000
    found = wet(a, q, level, shape=BALL)
    assert float(found.fraction[0]) == pytest.approx(section.sum() * width * 0.75, abs=2e-5)
    if section.sum() * width > 0.05:
        middle = (section * s).sum() / section.sum() * reach
        assert float(found.arm[0, 2]) == pytest.approx(middle, abs=2e-4 * reach + 1e-6)


@pytest.mark.parametrize(
    ("degrees", "fraction", "middle"),
    [
        (0, 0.3, None),
        (10, 0.29691, (0.0210, -0.0131, -0.0168)),
        (30, 0.32125, None),
        (60, 0.37978, None),
        (90, 0.39555, (0.0318, 0.0096, -0.0452)),
    ],
)
def test_the_immersed_part_of_a_tilted_box(
    degrees: float, fraction: float, middle: tuple[float, float, float] | None
) -> None:
    """L-20: Half edges (.2, .1, .05), centre 2 cm above the water, turned about (1, .3, 0); places are given relative
    to the water's plane.
    """
    half, axis = np.array([0.2, 0.1, 0.05]), np.array([1.0, 0.3, 0.0])
    q = quaternion(axis / np.linalg.norm(axis) * np.radians(degrees))
    found = wet(half, q, -0.02)
    assert float(found.fraction[0]) == pytest.approx(fraction, abs=5e-3 if degrees else 1e-5)
    volume, exact = polyhedra.below(polyhedra.turned(polyhedra.box(half), q, np.array([0.0, 0.0, 0.02])), 0.0)
    assert volume / 0.008 == pytest.approx(fraction, abs=2e-4)  # the reference itself gives the numbers of the table
    assert np.abs(found.arm[0].numpy() + [0, 0, 0.02] - exact).max() < 2e-3
    if middle is not None:
        assert exact == pytest.approx(middle, abs=2e-4)


@pytest.mark.parametrize(
    ("degrees", "want"), [(2, 0.002911), (5, 0.007307), (10, 0.014831), (15, 0.022807), (20, 0.031522)]
)
def test_righting_arm_of_a_wall_sided_beam(degrees: float, want: float) -> None:
    """L-22: A beam .4 wide, .2 high, .6 long, of half the density of water: its centre stays in the surface."""
    found = wet(np.array([0.2, 0.3, 0.1]), quaternion(np.array([0.0, np.radians(degrees), 0.0])), 0.0)
    assert float(found.fraction[0]) == pytest.approx(0.5, abs=1e-5)
    assert abs(float(found.arm[0, 0])) == pytest.approx(want, abs=1e-5)
    width, high = 0.4, 0.2
    metacentre, radius = width**2 / 12 / (high / 2) - high / 4, width**2 / 12 / (high / 2)
    theta = np.radians(degrees)
    assert want == pytest.approx(np.sin(theta) * (metacentre + 0.5 * radius * np.tan(theta) ** 2), abs=2e-6)


@pytest.mark.parametrize("s", [0.1, 0.35, 0.5, 0.8])
@pytest.mark.parametrize("edges", [(0.4, 0.6, 0.2), (0.15, 0.1, 0.05), (1.2, 0.3, 0.3)])
@pytest.mark.parametrize("degrees", [1.0, 4.0, 9.0])
def test_wall_sided_beams_of_other_sizes_and_densities(
    s: float, edges: tuple[float, float, float], degrees: float
) -> None:
    width, _, high = edges
    theta = np.radians(degrees)
    immersed = s * high
    if np.tan(theta) * width / 2 > min(immersed, high - immersed):
        pytest.skip("a corner of the deck or the bottom crosses the water")
    # to the surface, along the beam's own upright the immersed part is what it was
    depth = (immersed - high / 2) / np.cos(theta)
    found = wet(np.array(edges) / 2, quaternion(np.array([0.0, theta, 0.0])), depth * np.cos(theta) ** 2)
    assert float(found.fraction[0]) == pytest.approx(s, abs=1e-5)
    radius = width**2 / 12 / immersed
    metacentre = radius - (high - immersed) / 2
    assert abs(float(found.arm[0, 0])) == pytest.approx(
        abs(np.sin(theta) * (metacentre + 0.5 * radius * np.tan(theta) ** 2)), abs=1e-5
    )


def test_a_level_symmetric_body_is_not_turned_and_not_pushed_aside() -> None:
    """L-25: A box of .2 m and half the density of water at rest, its centre 3 cm under still water."""
    law, world = (
        dataclasses.replace(flood("paper"), gain=0.0),
        room([Thing((0.2, 0.2, 0.2), 500.0, (10.0, 10.0, 0.97))]),
    )
    state = begin(law, world)
    state.level[:], state.surface_slope[:] = 1.0, 0.0
    made = law.force(state, world, 0.01)
    assert made is not None and made.torque is not None
    assert made.torque.abs().max() < 1e-6 and made.force[0, 0, :2].abs().max() < 1e-6
    assert float(made.force[0, 0, 2]) == pytest.approx(RHO * G * 0.04 * 0.13, rel=1e-5)


def push(slip: np.ndarray, q: np.ndarray, edges: np.ndarray, mass: float, dt: float, ball: bool = False) -> np.ndarray:
    areas = [edges[1] * edges[2], edges[0] * edges[2], edges[0] * edges[1]]
    made = drag(
        tensor([slip]), tensor([q]), 0.5 * RHO * 1.05 * tensor([areas]), tensor([mass]), torch.tensor([ball]), dt
    )
    return made[0].numpy().astype(float)


@settings(max_examples=60, deadline=None)
@given(
    v=st.tuples(unit, unit, unit),
    turn=st.tuples(unit, unit, unit),
    edges=st.tuples(edge, edge, edge),
    ball=st.booleans(),
)
def test_drag_is_odd_quadratic_and_along_the_faces(v: tuple, turn: tuple, edges: tuple, ball: bool) -> None:
    """L-18, L-19 of docs/physics.md."""
    slip, q, size = np.array(v), quaternion(np.array(turn)), np.array(edges)
    small = 1e-7  # a step so short that the force is that of the moment [s]
    force = push(slip, q, size, 1.0, small, ball)
    turned = Rotation.from_rotvec(turn)
    own = turned.inv().apply(slip)
    speed = np.linalg.norm(own) if ball else np.abs(own)
    areas = np.array([size[1] * size[2], size[0] * size[2], size[0] * size[1]])
    assert force == pytest.approx(turned.apply(0.5 * RHO * 1.05 * areas * speed * own), rel=2e-3, abs=1e-3)
    assert push(-slip, q, size, 1.0, small, ball) == pytest.approx(-force, rel=1e-5, abs=1e-6)
    assert push(2 * slip, q, size, 1.0, small, ball) == pytest.approx(4 * force, rel=2e-3, abs=1e-3)
    assert push(0 * slip, q, size, 1.0, small, ball) == pytest.approx(np.zeros(3))


@settings(max_examples=60, deadline=None)
@given(
    v=st.tuples(unit, unit, unit),
    turn=st.tuples(unit, unit, unit),
    mass=st.floats(1e-4, 10.0),
    dt=st.floats(1e-3, 10.0),
    ball=st.booleans(),
)
def test_drag_never_reverses_the_slip(v: tuple, turn: tuple, mass: float, dt: float, ball: bool) -> None:
    slip = 30 * np.array(v)
    left = slip - push(slip, quaternion(np.array(turn)), np.array([0.3, 0.2, 0.1]), mass, dt, ball) * dt / mass
    own = Rotation.from_rotvec(turn).inv()
    before, after = own.apply(slip), own.apply(left)
    assert (np.abs(after) <= np.abs(before) + 1e-3).all() and (after * before >= -1e-3).all()


@pytest.mark.parametrize("dt", [0.001, 0.01, 0.1])
def test_drag_is_exact_over_a_step_of_any_length(dt: float) -> None:
    """dv/dt = -k v |v| from v0: v0 / (1 + k v0 t)."""
    v0, mass, size = 3.0, 2.0, np.array([0.2, 0.3, 0.1])
    k = RHO * 1.05 * size[1] * size[2] / (2 * mass)
    left = v0 - float(push(np.array([v0, 0, 0]), np.array([1.0, 0, 0, 0]), size, mass, dt)[0]) * dt / mass
    assert left == pytest.approx(v0 / (1 + k * v0 * dt), rel=1e-4)


@settings(max_examples=40, deadline=None)
@given(w=st.tuples(unit, unit, unit), turn=st.tuples(unit, unit, unit), dt=st.floats(1e-3, 5.0))
def test_turning_is_slowed_and_never_reversed(w: tuple, turn: tuple, dt: float) -> None:
    spin, size, mass = 40 * np.array(w), np.array([0.3, 0.2, 0.1]), 0.5
    q = quaternion(np.array(turn))
    torque = spin_drag(tensor([spin]), tensor([q]), tensor([size]), tensor([mass]), RHO, dt)[0].numpy()
    own = Rotation.from_rotvec(turn).inv()
    squared = size**2
    inertia = mass / 12 * (squared.sum() - squared)
    before = own.apply(spin)
    after = before + own.apply(torque.astype(float)) * dt / inertia
    assert (np.abs(after) <= np.abs(before) + 1e-3).all() and (after * before >= -1e-3).all()


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_turning_has_the_drag_of_mujocos_boxes(axis: int) -> None:
    """About an axis of edge a, with edges b and c across: density a (b^4 + c^4) w^2 / 64 (MuJoCo's fluid forces)."""
    size, spin = np.array([0.3, 0.2, 0.1]), np.zeros(3)
    spin[axis] = 4.0
    torque = spin_drag(tensor([spin]), tensor([[1.0, 0, 0, 0]]), tensor([size]), tensor([0.5]), RHO, 1e-7)[0].numpy()
    others = np.delete(size, axis)
    assert -torque[axis] == pytest.approx(RHO * size[axis] * (others**4).sum() * 4.0**2 / 64, rel=1e-4)
    assert np.delete(torque, axis) == pytest.approx([0.0, 0.0], abs=1e-9)


def test_the_table_of_costs_names_every_kernel_and_refuses_nonsense() -> None:
    table = kernels.report(3, 5, 1).splitlines()
    assert table[0].startswith("3 environments of 5 bodies") and len(table) > 5
    for line in table[1:]:
        spent, grows = re.fullmatch(r"  \w.*: .* +(\S+) ms, each (\S+) times", line).groups()  # type: ignore[union-attr]
        assert float(spent) >= 0 and float(grows) > 0
    with pytest.raises(ValueError, match="bodies must be positive, got 0"):
        kernels.report(3, 0)
