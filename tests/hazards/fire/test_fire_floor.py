"""The floor that a fire can spread to, and where the agent must not go."""

from __future__ import annotations

import itertools
import math

import pytest
import torch

from hazard_ms.hazards.fire import floor
from hazard_ms.hazards.fire.fire import Fire
from hazard_ms.hazards.presets import fire
from hazard_ms.simulation.world import rotate
from tests.worlds.fire_worlds import FAR, ORIGINAL, begin, room_world


def test_a_fire_in_the_corner_stays_in_the_room() -> None:
    world = room_world([], [(0.15, 0.15)], size=(0.6, 0.6), copies=50)
    preset = fire("paper")
    state = begin(preset, world)
    for _ in range(150):
        world.chance.frame += 10
        preset.advance(state, world, 0.01)
    burning = state.flame_cell >= 0
    assert (burning.sum(1) == 4).all()  # 0.15 and 0.37 along each axis; 0.59 + 0.1 lies beyond the wall
    assert (state.flame_place[burning][:, :2] <= 0.5).all() and (state.flame_place[burning][:, :2] >= 0.1).all()


def samples_in_box(centre: tuple[float, float], angle: float, extent: tuple[float, float], x: float, y: float) -> bool:
    """Whether any of 41 x 41 points of the cell at (x, y) lies in the box, by turning each point into its frame."""
    edge = [0.1 * (k / 20 - 1) for k in range(41)]
    for dx, dy in itertools.product(edge, edge):
        px, py = x + dx - centre[0], y + dy - centre[1]
        u, v = px * math.cos(angle) + py * math.sin(angle), py * math.cos(angle) - px * math.sin(angle)
        if abs(u) < extent[0] / 2 and abs(v) < extent[1] / 2:
            return True
    return False


@pytest.mark.parametrize("angle", [0.0, 0.4, 1.2])
def test_fixtures_on_the_floor_keep_fire_out(angle: float) -> None:
    """Paper; in `shipped` a single thing does not."""
    table = ((2.4, 2.3, 0.0), (0.7, 0.3, 0.8), angle)
    world = room_world([], [(2.0, 2.0)], [table], size=(4.0, 4.0))
    preset = Fire(max_frames=600)
    state = begin(preset, world)
    window = state.free.shape[-1]
    disagreements = 0
    for i, j in itertools.product(range(window), repeat=2):
        x, y = 2.0 + 0.22 * (i - window // 2), 2.0 + 0.22 * (j - window // 2)
        blocked = samples_in_box((2.4, 2.3), angle, (0.7, 0.3), x, y)
        disagreements += int(bool(state.free[0, 0, i, j]) == blocked)
    assert disagreements <= 1  # a corner may slip between the samples
    assert 5 < int((~state.free).sum()) < 40
    assert begin(Fire(max_frames=600, fixtures_block=False), world).free.all()


@pytest.mark.parametrize(
    ("base", "height", "blocks"),
    [((2.22, 2.0, 0.0), 0.8, True), ((2.22, 2.0, 0.0), 0.02, False), ((2.22, 2.0, 0.35), 0.4, False)],
)
def test_rugs_and_hung_fixtures_do_not_keep_fire_out(
    base: tuple[float, float, float], height: float, blocks: bool
) -> None:
    world = room_world([], [(2.0, 2.0)], [(base, (0.1, 0.1, height), 0.0)], size=(4.0, 4.0))
    state = begin(Fire(), world)
    assert bool(state.free[0, 0, 11, 10]) == (not blocks)


@pytest.mark.parametrize(("count", "ignites"), [(2, True), (3, False)])
@pytest.mark.parametrize("name", ORIGINAL)
def test_three_things_on_a_cell_keep_fire_out(name: str, count: int, ignites: bool) -> None:
    """All four neighbours hold `count` pans; the fire tries each of them within 1,100 frames."""
    around = [(0.22, 0.0), (-0.22, 0.0), (0.0, 0.22), (0.0, -0.22)]
    pans = [("pan", (5.0 + dx + 0.03 * k, 5.0 + dy, 0.0)) for dx, dy in around for k in range(count)]
    world = room_world(pans, [(5.0, 5.0)])
    preset = fire(name)
    state = begin(preset, world)
    for _ in range(110):
        world.chance.frame += 10
        preset.advance(state, world, 0.01)
    assert int(state.flame_used[0, 0]) == 15
    assert (int((state.flame_cell >= 0).sum()) > 1) == ignites


def test_things_above_the_floor_are_no_crowd() -> None:
    world = room_world([("pan", (5.22 + 0.02 * k, 5.0, 0.8)) for k in range(5)])
    places = torch.tensor([[[5.22, 5.0, 0.0], [5.0, 5.0, 0.0]]])
    assert floor.crowd(world, places).tolist() == [[0, 0]]
    world.position[0, :4, 2] = 0.01
    assert floor.crowd(world, places).tolist() == [[4, 0]]
    world.safe[0, 0] = True
    assert floor.crowd(world, places).tolist() == [[3, 0]]


def test_half_spans_hold_all_corners() -> None:
    """Against the eight corners of each box, turned one by one."""
    rotation = torch.nn.functional.normalize(torch.randn(50, 4, generator=torch.Generator().manual_seed(2)), dim=-1)
    extent = torch.rand(50, 3, generator=torch.Generator().manual_seed(3))
    corners = torch.tensor(list(itertools.product((-0.5, 0.5), repeat=3)))
    turned = rotate(rotation[:, None].expand(50, 8, 4), extent[:, None] * corners)
    assert torch.allclose(floor.half_spans(rotation, extent), turned.amax(1), atol=1e-6)


def test_only_so_many_flames_are_on_the_roster() -> None:
    """A roster that is too short stops the fire; it neither overwrites flames nor fails."""
    preset = fire("paper")
    world = room_world([], [(10.0, 10.0)], copies=3)
    state = begin(preset, world)
    for name in ("flame_cell", "flame_place", "flame_birth", "flame_last", "flame_used"):
        setattr(state, name, getattr(state, name)[:, :7].clone())
    for _ in range(100):
        world.chance.frame += 10
        preset.advance(state, world, 0.01)
    assert (state.flame_cell >= 0).all() and (state.flame_cell.sort(1).values.diff(dim=1) > 0).all()


def test_where_the_agent_must_not_go() -> None:
    """Over a burning cell; in air hotter than the bound; not 0.2 m beside a single young fire in `paper`."""
    world = room_world([], [(5.0, 5.0)], agent=FAR)
    paper, shipped = fire("paper"), fire("shipped")
    points = torch.tensor([[[5.0, 5.0, 0.0], [5.1, 4.9, 0.0], [5.2, 5.0, 0.0], [6.0, 5.0, 0.0]]])
    assert paper.forbids(begin(paper, world), world, points).tolist() == [[True, True, False, False]]
    # shipped, 0.2 m: (20 e^-1 + 600 * 6.25) / (e^-1 + 6.25) = 567.8 C
    assert shipped.forbids(begin(shipped, world), world, points).tolist() == [[True, True, True, False]]
