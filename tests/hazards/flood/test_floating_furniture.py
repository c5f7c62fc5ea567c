"""Furniture of `realistic` that floats off and dams openings: L-63 to L-66 of docs/physics.md 2.2."""

from __future__ import annotations

import dataclasses
import math
from typing import Any

import numpy as np
import pytest
import torch

from hazard_ms.hazards.flood.realistic import buoyant
from hazard_ms.hazards.flood.realistic.floor_plan import CELL
from hazard_ms.hazards.presets import flood
from hazard_ms.scenes.assets.index import asset
from hazard_ms.simulation.building import make_world
from hazard_ms.simulation.world import World
from hazard_ms.spec import AgentStart, Body, Fixture, Opening, Partition, Room, SceneSpec
from tests.worlds.flood_worlds import begin

LAW = dataclasses.replace(flood("realistic"), outside=1.0, roughness=0.0)
WATER = 1000.0  # [kg/m^3]
DOOR = Opening("door", "south", 3.05, 0.9, 2.0)
INNER = (Partition("wall", "y", 3.0),), (Opening("doorway", "wall", 2.0, 0.9, 2.0),)
CLOSED = Opening("door", "south", 3.0, 0.9, 0.0)


def piece(name: str, at: tuple[float, float, float] = (3.0, 3.0, 0.0)) -> Fixture:
    return Fixture(name, asset(name).category, name, at)


def flooded(
    *pieces: Fixture, depth: float = 0.0, openings: tuple[Opening, ...] = (), walls: Any = ()
) -> tuple[Any, World]:
    """A room 6 m square with furniture, filled to `depth` [m] wherever floor is."""
    spec = SceneSpec(
        "test/furniture",
        Room((6.0, 6.0), partitions=walls, openings=openings),
        pieces,
        (Body("book_1", "book", "book_1", (0.3, 5.7, 0.0)),),
        ("book",),
        (),
        AgentStart((5.0, 5.0)),
        flood_side="south",
    )
    world = make_world((spec,), torch.device("cpu"), (LAW.loosens(spec),))
    state = begin(LAW, world)
    if not openings:
        state.inlet[:] = -1
    floor = state.bed == 0.0
    state.depth[:] = torch.where(floor, depth, 0.0)
    state.surface[:] = torch.where(floor & (state.depth > 0), depth, -1.0)
    return state, world


def run(state: Any, world: World, frames: int) -> None:
    for _ in range(frames):
        world.chance.tick()
        LAW.advance(state, world, 1 / 30)


def volume(state: Any) -> float:
    return float((state.depth + state.depth_rest).double().sum()) * CELL**2


@pytest.mark.parametrize(
    ("name", "depth"),
    [
        ("fridge_1", 0.12 * 1.72),  # sealed: 120 kg/m^3 of its outer volume is under water, of 1.72 m
        ("cabinet_8", 0.65 * 0.90),  # boards of 650 kg/m^3, spread over its height of 0.9 m
        ("cabinet_1", 0.65 * 1.50),
        ("bin_2", 0.95 * 0.74),  # polyethylene of 950 kg/m^3
    ],
)
def test_what_is_alike_all_the_way_up_floats_at_its_density(name: str, depth: float) -> None:
    assert buoyant.floating(piece(name)).depth == pytest.approx(depth, rel=0.01)


@pytest.mark.parametrize("name", ["table_1", "chair_1", "sofa_1", "coffee_table_2", "shelf_5"])
def test_at_its_depth_a_piece_displaces_its_own_weight(name: str) -> None:
    """Archimedes, summed over 20,000 slices of its parts; what keeps water out is m / solid of their volume."""
    kind = asset(name)
    solid = 200.0 if kind.category == "sofa" else 600.0
    parts = np.array(kind.boxes)
    share = min(1.0, kind.mass / solid / float((8.0 * parts[:, 3:].prod(1)).sum()))
    found = buoyant.floating(piece(name))
    z = (np.arange(20_000) + 0.5) * found.depth / 20_000
    inside = np.abs(z[:, None] - parts[:, 2]) < parts[:, 5]
    held = WATER * share * float((inside * 4.0 * parts[:, 3] * parts[:, 4]).sum()) * found.depth / 20_000
    assert held == pytest.approx(kind.mass, rel=2e-3)
    assert found.volume * found.depth / kind.extent[2] * WATER == pytest.approx(kind.mass)


def test_metal_and_what_is_fixed_or_stands_on_a_counter_stays() -> None:
    for name in ("stove_1", "counter_1", "sink_1", "lamp_1", "microwave_1", "picture_1", "rug_1"):
        assert buoyant.floating(piece(name)).depth == math.inf
    assert buoyant.floating(piece("cabinet_7", (3.0, 3.0, 0.9))).depth == math.inf
    assert buoyant.floating(piece("cabinet_7", (3.0, 3.0, 0.0))).depth < 1.0


def test_only_what_the_water_outside_can_lift_is_ever_loose() -> None:
    state, world = flooded(piece("fridge_1"), piece("table_1", (1.0, 1.0, 0.0)), piece("stove_1", (1.0, 5.0, 0.0)))
    spec = world.specs[0]
    assert LAW.loosens(spec) == {"fridge_1", "table_1"}
    assert dataclasses.replace(LAW, outside=0.3).loosens(spec) == {"fridge_1"}
    assert dataclasses.replace(LAW, outside=0.2).loosens(spec) == frozenset()
    assert torch.isinf(state.float_depth[0, world.index(0, "stove_1")])


@pytest.mark.parametrize(("depth", "floats"), [(0.19, False), (0.22, True)])
def test_a_fridge_leaves_the_floor_where_the_water_is_deep_enough(depth: float, floats: bool) -> None:
    """At 0.206 m. Its ground becomes floor, as full as the water around, and the water in its place is told."""
    state, world = flooded(piece("fridge_1"), depth=depth)
    ground, before = int((state.bed[state.bed < 50] > 0).sum()), volume(state)
    assert ground == 64  # cells whose middles lie in 0.78 by 0.74 m: 8 by 8
    run(state, world, 3)
    b = world.index(0, "fridge_1")
    assert bool(state.afloat[0, b]) == floats and LAW.loose(state, world).sum() == int(floats)
    if floats:
        assert int((state.bed[state.bed < 50] > 0).sum()) == 0
        assert float(state.displaced[0]) == pytest.approx(64 * CELL**2 * depth, rel=0.02)
    assert volume(state) - float(state.displaced[0]) == pytest.approx(before, abs=1e-5)
    run(state, world, 30)
    assert volume(state) - float(state.displaced[0]) == pytest.approx(before, abs=1e-5)


def test_a_jet_against_one_side_does_not_lift_it() -> None:
    state, world = flooded(piece("fridge_1"))
    grid = state.depth[0].view(62, 62)
    grid[1:23, 1:61] = torch.where(state.bed[0].view(62, 62)[1:23, 1:61] == 0.0, 0.6, 0.0)
    grid[23:27, 20:40] = torch.where(state.bed[0].view(62, 62)[23:27, 20:40] == 0.0, 0.6, 0.0)
    state.surface[0].view(62, 62)[:] = torch.where(grid > 0, 0.6, -1.0)
    run(state, world, 1)
    assert not state.afloat.any()


def test_a_piece_afloat_drifts_as_fast_as_the_current_and_no_faster() -> None:
    """A coffee table, integrated here step by step from the law's force, in a stream of 0.8 m/s."""
    state, world = flooded(piece("coffee_table_2"), depth=0.6)
    run(state, world, 1)
    b, speed, dt = world.index(0, "coffee_table_2"), 0.8, 1 / 120
    assert bool(state.afloat[0, b])
    world.loosen(LAW.loose(state, world))
    world.position[0, b, 2] += 0.6 - float(state.float_depth[0, b])
    state.velocity_x[:], state.velocity_y[:] = speed, 0.0
    speeds = []
    for _ in range(int(20 / dt)):
        push = LAW.force(state, world, dt)
        world.velocity[0, b, :2] += push.force[0, b, :2] / world.mass[0, b] * dt
        speeds.append(float(world.velocity[0, b, 0]))
    assert speeds == sorted(speeds) and 0.97 * speed < speeds[-1] <= speed
    assert float(world.velocity[0, b, 1]) == pytest.approx(0.0, abs=1e-6)
    lift = float(push.force[0, b, 2])
    assert lift == pytest.approx(float(world.mass[0, b]) * 9.81, rel=0.01)  # it lies as deep as it began to float


@pytest.mark.parametrize("aside", [0.0, 0.6, -0.5, 2.0])
def test_a_piece_in_a_doorway_covers_its_share_of_the_wetted_area(aside: float) -> None:
    """A fridge, 0.78 m wide, floats 0.206 m deep in 1 m of water before a door of 0.9 m."""
    fridge = asset("fridge_1").extent
    state, world = flooded(piece("fridge_1", (3.0 + aside, 3.0, 0.0)), depth=0.9, openings=(DOOR,))
    run(state, world, 1)
    assert float(state.dammed.max()) == 0.0  # 2 m from the door
    b = world.index(0, "fridge_1")
    world.position[0, b, 1], world.position[0, b, 2] = 0.5 * fridge[1], 0.794 + 0.5 * fridge[2]
    run(state, world, 1)
    wide = max(0.0, min(3.5, 3.0 + aside + fridge[0] / 2) - max(2.6, 3.0 + aside - fridge[0] / 2))
    share = (state.dammed * state.inlet_width).sum() / 0.9
    assert float(share) == pytest.approx(wide / 0.9 * 0.206, abs=2e-3)
    assert float(state.dammed.max()) <= 0.2061


@pytest.mark.parametrize("covered", [0.0, 0.4, 1.0])
def test_a_dammed_door_lets_through_what_is_left_of_it(covered: float) -> None:
    """A free weir, 0.4 b sqrt(2 g) h^1.5, of what is left of its 0.9 m."""
    state, world = flooded(openings=(DOOR,))
    state.dammed[:] = covered
    run(state, world, 6)
    before, begun = float(state.inflow[0]), float(state.time[0] + state.ahead[0])
    run(state, world, 6)
    rate = (float(state.inflow[0]) - before) / (float(state.time[0] + state.ahead[0]) - begun)
    assert rate == pytest.approx(0.4 * 0.9 * (1 - covered) * math.sqrt(2 * 9.81), rel=0.03, abs=1e-6)


@pytest.mark.parametrize("covered", [0.5, 1.0])
def test_a_dammed_inner_doorway_holds_water_back(covered: float) -> None:
    passed = []
    for share in (0.0, covered):
        state, world = flooded(walls=INNER[0], openings=INNER[1])
        state.inlet[:] = -1
        state.depth[0].view(62, 62)[1:31, 1:61] = 0.5
        state.signal[:] = 4.0
        state.door_dammed[:] = share
        run(state, world, 15)
        passed.append(float(state.depth[0].view(62, 62)[31:61].sum()))
    assert passed[0] > 1.0
    assert passed[1] == pytest.approx((1 - covered) * passed[0], rel=0.15, abs=1e-6)


def test_what_floats_in_an_inner_doorway_dams_it() -> None:
    state, world = flooded(piece("sofa_1", (1.2, 1.5, 0.0)), depth=0.5, walls=INNER[0], openings=INNER[1])
    state.inlet[:] = -1
    run(state, world, 1)
    assert (state.door >= 0).sum() == 9 and float(state.door_dammed.max()) == 0.0
    world.position[0, world.index(0, "sofa_1"), :2] = torch.tensor([3.0, 2.0])
    run(state, world, 1)
    held = state.door_dammed[state.door >= 0]
    assert (held > 0).all() and (held <= 1).all()
