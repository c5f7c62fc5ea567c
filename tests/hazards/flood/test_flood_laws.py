"""Friction of the floor and flow through doors, in numbers that anyone can work out."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest
import torch

from hazard_ms.hazards.flood.realistic.floors import MANNING, USUAL, friction_of
from hazard_ms.hazards.flood.realistic.inundation import Inundation
from hazard_ms.hazards.flood.realistic.openings import discharge
from hazard_ms.scenes.materials import MATERIALS
from hazard_ms.spec import Opening, Partition
from hazard_ms.validation.experiments import channel, flume
from hazard_ms.validation.experiments.basin import Basin, door
from tests.worlds.flood_worlds import Thing, begin, room


def test_water_slows_down_on_a_level_floor_as_manning_says() -> None:
    """u0 / (1 + g n^2 u0 t / h^(4/3)), with n = 0.012, 0.1 m of water and 5 s."""
    assert channel.slowed() == pytest.approx(1.0 / (1.0 + 9.81 * 0.012**2 * 5.0 / 0.1 ** (4 / 3)), rel=1e-3)


@pytest.mark.parametrize(("depth", "slope"), [(0.01, 0.01), (0.1, 0.005)])
def test_uniform_flow_runs_at_the_speed_of_manning(depth: float, slope: float) -> None:
    assert channel.uniform((depth, slope)) == pytest.approx(depth ** (2 / 3) * slope**0.5 / 0.012, rel=0.01)


def test_each_floor_has_its_own_friction() -> None:
    world = room([Thing((0.1,) * 3)])
    plain = world.specs[0]
    wood, carpet, other = (
        dataclasses.replace(plain, room=dataclasses.replace(plain.room, floor=floor))
        for floor in ("wood", "carpet", "of a third party")
    )
    assert set(MANNING) <= set(MATERIALS)
    assert friction_of(wood) == pytest.approx(9.81 * 0.012**2) == friction_of(other) and USUAL == 0.012
    assert friction_of(carpet) == pytest.approx(9.81 * 0.017**2)
    assert float(begin(Inundation(), world).friction) == pytest.approx(friction_of(plain))
    assert float(begin(Inundation(roughness=0.03), world).friction) == pytest.approx(9.81 * 0.03**2)


@pytest.mark.parametrize("outside", [0.3, 0.5, 1.0])
def test_a_door_lets_in_as_much_as_a_free_weir_as_long_as_the_room_is_nearly_dry(outside: float) -> None:
    assert flume.steady(outside) == pytest.approx(0.4 * 0.9 * (2 * 9.81) ** 0.5 * outside**1.5, rel=0.02)


@pytest.mark.parametrize("part", [0.5, 0.8])
def test_water_in_the_room_drowns_the_weir(part: float) -> None:
    assert flume.submerged(part) == pytest.approx((1.0 - part**1.5) ** 0.385, rel=0.05)


def test_the_level_of_the_room_is_read_beside_the_door() -> None:
    """The fifth cell of floor from the nearer jamb, along the wall; what lies behind a wall does not count."""
    cells, pitch = list(range(20, 29)), 62  # of the door; numbers of cells count a ring around them

    def read(partitions: tuple[Partition, ...] = ()) -> list[int]:
        basin = Basin((6.4, 6.0), openings=(door(),), partitions=partitions)
        assert [int(c) // pitch - 1 for c in basin.state.inlet[0]] == cells
        return [int(c) // pitch - 1 for c in basin.state.inlet_beside[0]]

    assert read() == [15] * 5 + [33] * 4
    assert read(partitions=(Partition("near", "y", 1.8),)) == [33] * 9


def test_a_lobby_behind_the_door_is_not_filled_above_the_street() -> None:
    """A lobby of one row of cells behind the door: it fills up to the level outside and no higher."""
    ground = np.zeros((64, 60))
    ground[:, 1:] = 3.0
    ground[:20], ground[29:] = 3.0, 3.0
    basin = Basin((6.4, 6.0), ground, law=Inundation(outside=0.5), openings=(door(),))
    basin.state.inlet_beside[:] = basin.state.inlet
    for _ in range(30):
        basin.run(1 / 30)
        assert basin.get("depth")[20:29, 0].max() <= 0.5 + 1e-5
    assert basin.get("depth")[20:29, 0] == pytest.approx(np.full(9, 0.5), abs=1e-3)


@pytest.mark.parametrize("mirrored", [False, True])
def test_a_stream_on_the_floor_does_not_carry_the_film_on_a_step(mirrored: bool) -> None:
    """A stream runs askew past the corner of a block; a millimetre of water at rest on it only begins to fall."""
    ground = np.zeros((20, 10))
    ground[10:, :5] = 0.5
    basin = Basin((2.0, 1.0), ground[:, ::-1] if mirrored else ground)
    basin.put("depth", np.where(basin.get("bed") > 0, 0.001, 0.4))
    streams = np.where(basin.get("bed") > 0, 0.0, 1.0)
    basin.put("velocity_x", streams)
    basin.put("discharge_x", 0.4 * streams)
    across = np.full((20, 10), -0.5 if mirrored else 0.5)
    across[10:] = 0.0
    basin.put("velocity_y", across)
    basin.run(1 / 120, 1 / 120)
    edge = basin.get("velocity_y")[10, 5] * (-1.0 if mirrored else 1.0)
    assert 0.0 < edge < 0.02


def test_a_film_gets_no_faster_than_the_wave_that_runs_onto_it() -> None:
    """Water 0.2 m deep comes at 1.5 m/s towards a millimetre at the edge of a plateau: no more comes in than all."""
    i = np.arange(40)
    basin = Basin((4.0, 0.1), np.where(i < 20, 0.5, 0.0)[:, None], np.where(i < 19, 0.2, 0.001 * (i < 20))[:, None])
    basin.put("velocity_x", np.where(i < 20, 1.5, 0.0)[:, None])
    basin.put("discharge_x", np.where(i < 20, 0.3, 0.0)[:, None])
    basin.run(1 / 120, 1 / 120)
    assert 1.2 < basin.get("velocity_x")[20, 0] < 1.6


def test_a_doorway_between_rooms_lets_through_what_an_outer_door_does() -> None:
    assert flume.doorway() == pytest.approx(0.5638, rel=0.10)


def test_openings_are_weirs_and_under_water_orifices() -> None:
    """A door of 0.9 m: free, drowned, with a sill; and a gap of 0.02 m under water on one side, and on both."""
    before = [0.5, 0.5, 0.8, 0.5, 0.5, 0.2, 0.3, 0.5]
    behind = [0.0, 0.25, 0.3, 0.0, 0.3, 0.5, 0.3, 0.0]
    height = [2.0, 2.0, 2.0, 0.02, 0.02, 0.02, 2.0, 2.0]
    sill = [0.0, 0.0, 0.4, 0.0, 0.0, 0.0, 0.0, 0.6]
    free, jet = 0.4 * 0.9 * (2 * 9.81) ** 0.5, 0.611 * 0.9 * 0.02 * (2 * 9.81) ** 0.5
    want = [free * 0.5**1.5, free * 0.5**1.5 * (1 - 0.5**1.5) ** 0.385, free * 0.4**1.5]
    want += [jet * 0.5**0.5, jet * 0.2**0.5, -jet * 0.3**0.5, 0.0, 0.0]
    rows = [torch.tensor([row]) for row in (before, behind, [0.9] * 8, height, sill)]
    assert discharge(*rows)[0].tolist() == pytest.approx(want, rel=1e-5)
    turned = discharge(rows[1], rows[0], *rows[2:])[0]
    assert turned.tolist() == pytest.approx([-q for q in want], rel=1e-5)
    with pytest.raises(ValueError, match=r"one shape \[E, O\]"):
        discharge(rows[0], rows[1][:, :3], *rows[2:])


def test_a_room_fills_through_a_gap_as_through_an_orifice() -> None:
    """L-27: Z (1 - (1 - t / t_f)^2), t_f = 2 A sqrt(Z) / (Cd a sqrt(2 g)), the gap drowned."""
    depth, gap, dt = torch.zeros(1, 1), [torch.full((1, 1), of) for of in (0.9, 0.02, 0.0)], 0.05
    full = 2 * 20.0 * math.sqrt(0.5) / (0.611 * 0.018 * math.sqrt(2 * 9.81))
    for _ in range(round(300 / dt)):
        depth += discharge(torch.full((1, 1), 0.5), depth, *gap) * dt / 20.0
    assert float(depth) == pytest.approx(0.5 * (1 - (1 - 300 / full) ** 2), rel=1e-3)


def test_a_closed_door_between_rooms_leaks_through_its_gap() -> None:
    """0.611 a sqrt(2 g H) at first, less for what has left and for the jet behind; a wall without a door is dry."""
    wall, shut = Partition("middle", "y", 3.0), Opening("door", "middle", 2.0, 0.9, 2.0)
    full = torch.zeros(60, 40)
    full[:30] = 0.5
    for doors in ((shut,), ()):
        basin = Basin((6.0, 4.0), depth=full.numpy(), partitions=(wall,), openings=doors)
        basin.state.inlet[:] = -1
        basin.run(5.0)
        leaked = float(basin.get("depth")[30:].sum()) * 0.01 / basin.now
        assert leaked == pytest.approx(0.611 * 0.018 * math.sqrt(2 * 9.81 * 0.5) if doors else 0.0, rel=0.08)
