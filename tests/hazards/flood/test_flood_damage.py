"""What floods do to things and agents: L-5, L-6 and L-30 of docs/physics.md, damage by preset, wading, and batches."""

from __future__ import annotations

import dataclasses
import math

import pytest
import torch

from hazard_ms.hazards.flood import wading
from hazard_ms.hazards.flood.flood import Flood, FloodState
from hazard_ms.hazards.presets import flood
from hazard_ms.robots.fetch import HazardFetch
from hazard_ms.simulation.world import World
from hazard_ms.spec import Opening, Partition
from hazard_ms.tasks.episode.records import Damage
from tests.worlds.flood_worlds import Tank, Thing, begin, frames, on_a_plane, room

EVERY = ["paper", "shipped", "realistic"]


def level(state: FloodState, height: float) -> None:
    """Still, flat water of this level [m]."""
    state.level[:], state.surface_slope[:] = height, 0.0


def in_water(
    preset: Flood, things: list[Thing], height: float, steps: int = 1, dt: float = 0.01
) -> tuple[World, FloodState]:
    """A world after `steps` under flat water; the level stands still because its advance starts from the frame."""
    steady = dataclasses.replace(preset, rise=height, cap=height, every=1, slope=1e-4)
    world = room(things)
    state = begin(steady, world)
    frames(steady, state, world, steps, dt)
    return world, state


@pytest.mark.parametrize(("area", "mass", "frame"), [(0.01, 1.0, 50), (0.06, 1.0, 8), (0.12, 1.0, 4), (0.06, 5.0, 42)])
def test_the_shipped_current_carries_things_off_in_so_many_frames(area: float, mass: float, frame: int) -> None:
    """L-5: v_n = u (1 - (1 - 2 A / m)^n); 1 - 1 / e of u at the frame told. A: across the flow, which is along x."""
    width = math.sqrt(area)
    tank = Tank(flood("shipped"), [Thing((3 * width, width, width), at=(12.0, 10.0, 50.0), mass=mass)], level=100.0)
    for n in range(1, 2 * frame):
        tank.run(0.01)
        want = 0.9540568 * (1 - (1 - 2 * area / mass) ** n)
        assert -float(tank.world.velocity[0, 0, 0]) == pytest.approx(want, rel=1e-3)
        assert (want > (1 - math.exp(-1)) * 0.9540568) == (n >= frame)


@pytest.mark.parametrize(
    ("size", "fraction"),
    [((0.35, 0.3, 0.15), 0.159), ((0.46, 0.46, 0.3), 0.039), ((0.2, 0.2, 0.09), 0.694), ((0.1, 0.1, 0.1), None)],
)
def test_shipped_things_float_on_0_4_of_waters_density(
    size: tuple[float, float, float], fraction: float | None
) -> None:
    """L-6 of docs/physics.md."""
    tank = Tank(flood("shipped"), [Thing(size, at=(15.0, 10.0, 0.9), mass=1.0)], floor=True)
    seen = [float(1.0 - at[0, 2] + size[2] / 2) / size[2] for at in tank.run(8.0)]
    if fraction is None:
        assert float(tank.world.position[0, 0, 2]) < 0.06
    else:
        assert sum(seen[-400:]) / 400 == pytest.approx(fraction, rel=0.03, abs=2e-3)


@pytest.mark.parametrize(("x", "frame"), [(0.5, 30), (1.0, 60), (2.0, 110), (3.0, 160), (4.0, 210), (4.74, 250)])
def test_shipped_damage_begins_with_the_first_contact(x: float, frame: int) -> None:
    """L-30 of docs/physics.md."""
    world = room([Thing((0.1, 0.1, 0.2), at=(20.0 - x, 10.0, 0.1), category="apple")])
    made = flood("shipped")
    state = begin(made, world)
    frames(made, state, world, frame - 1)
    assert not made.damaged(state, world).any()
    frames(made, state, world, 1)
    assert made.damaged(state, world).all()


@pytest.mark.parametrize(("fraction", "damaged"), [(0.4, False), (0.49, False), (0.51, True), (1.5, True)])
@pytest.mark.parametrize("degrees", [0.0, 90.0])
def test_paper_damages_what_is_half_under_water(fraction: float, damaged: bool, degrees: float) -> None:
    high = 0.2 if degrees == 0 else 0.3
    books = Thing((0.1, 0.3, 0.2), 800.0, (10.0, 10.0, high / 2), (math.radians(degrees), 0.0, 0.0), category="book")
    keys = dataclasses.replace(books, category="key", at=(12.0, 10.0, high / 2))
    world, state = in_water(flood("paper"), [books, keys], fraction * high)
    assert flood("paper").damaged(state, world)[0].tolist() == [damaged, False]  # keys are waterproof


@pytest.mark.parametrize(("category", "seconds"), [("book", 1.0), ("phone", 0.1), ("key", math.inf)])
@pytest.mark.parametrize("dt", [0.01, 1 / 30, 0.05])
def test_realistic_damage_takes_time(category: str, seconds: float, dt: float) -> None:
    preset = on_a_plane(flood("realistic"))
    for steps in (1, 2, 3, 4, 9, 10, 20, 29, 30, 99, 100):
        world, state = in_water(
            preset, [Thing((0.2, 0.2, 0.2), at=(10.0, 10.0, 0.1), category=category)], 0.15, steps, dt
        )
        assert bool(preset.damaged(state, world)[0, 0]) == (steps * dt >= seconds - 1e-3)


@pytest.mark.parametrize("preset", EVERY)
def test_held_and_rescued_things_are_not_damaged(preset: str) -> None:
    book = Thing((0.2, 0.2, 0.2), at=(10.0, 10.0, 0.1), category="book")
    world, state = in_water(on_a_plane(flood(preset)), [book, book, book], 0.5, 150)
    world.held[0, 0] = world.safe[0, 1] = True
    record = Damage.allocate({"E": 1, "B": 3}, "cpu")
    record.add(on_a_plane(flood(preset)).damaged(state, world), world)
    assert record.damaged[0].tolist() == [False, False, True]


def test_porous_things_soak_and_sink() -> None:
    """A cushion of 50 kg/m3, of fibres of 1,380, ends up heavier than the water that it displaces; an apple does not
    soak.
    """
    preset = on_a_plane(flood("realistic"))
    cushion = Thing((0.4, 0.4, 0.15), 50.0, (10.0, 10.0, 0.1), category="throw_pillow")
    world, state = in_water(preset, [cushion, dataclasses.replace(cushion, category="apple")], 1.0, 400, 1.0)
    left = state.volume * (1 - state.pores * state.soaked)
    assert float(left[0, 0] / state.volume[0, 0]) == pytest.approx(50.0 / 1380.0, rel=2e-3)
    assert 1000 * float(left[0, 0]) < float(world.mass[0, 0])
    assert float(left[0, 1]) == float(state.volume[0, 1])
    push, weight = preset.force(state, world, 1e-4), 9.81 * world.mass[0]
    assert push is not None
    assert float(push.force[0, 0, 2]) < float(weight[0]) and float(push.force[0, 1, 2]) > float(weight[1])


@pytest.mark.parametrize("dt", [0.03, 0.1, 1.0])
def test_soaking_does_not_depend_on_the_step(dt: float) -> None:
    _, state = in_water(
        on_a_plane(flood("realistic")), [Thing((0.4, 0.4, 0.15), 50.0, (10.0, 10.0, 0.1))], 1.0, round(30 / dt), dt
    )
    assert float(state.soaked[0, 0]) == pytest.approx(1 - math.exp(-1), rel=1e-3)


def test_catalogue_densities_decide_what_floats() -> None:
    """A knife's box is mostly air; what it displaces is its mass over steel's density."""
    things = [
        Thing((0.035, 0.263, 0.021), mass=0.18, category="knife"),
        Thing((0.08,) * 3, mass=0.18, category="apple"),
    ]
    state = begin(flood("paper"), room(things))
    assert state.volume[0].tolist() == pytest.approx([0.18 / 4000.0, 0.18 / 830.0], rel=1e-5)
    assert state.shape[0].tolist() == [0, 2]


@pytest.mark.parametrize(
    ("depth", "speed", "want"),
    [
        (0.0, 1.0, 0),
        (0.1, 0.5, 1),
        (0.2, 1.9, 2),
        (0.35, 0.1, 2),
        (0.6, 0.1, 3),
        (0.4, 1.6, 4),
        (1.3, 0.1, 4),
        (0.6, 1.8, 5),
        (0.01, 2.1, 5),
    ]
    + [(2.1, 0.0, 5), (1.5, 3.0, 6), (4.1, 0.0, 6), (0.1, 4.5, 6), (1.4, 0.954, 5)],
)
def test_hazard_classes(depth: float, speed: float, want: int) -> None:
    assert int(wading.hazard_class(torch.tensor(depth), torch.tensor(speed))) == want


@pytest.mark.parametrize(("depth", "slides"), [(0.1, 4.33), (0.2, 2.58), (0.3, 1.62), (0.4, 0.79)])
def test_the_robot_begins_to_slide_where_the_specification_says(depth: float, slides: float) -> None:
    """docs/physics.md 3.2, within its rounding of the base (.51 m): grip is 0 above that speed, and more below."""
    robot, deep = HazardFetch.build, torch.tensor(depth)
    assert float(wading.grip(deep, slides * 1.06, robot, 1000.0, 9.81)) == 0.0
    assert 0.0 < float(wading.grip(deep, slides * 0.94, robot, 1000.0, 9.81)) < 0.2


@pytest.mark.parametrize("preset", EVERY)
def test_the_agent_is_slowed_against_the_flow_and_carried_no_faster_than_it(preset: str) -> None:
    made, world = on_a_plane(flood(preset)), room([Thing((0.1,) * 3)], "east", copies=3)
    world.agent_build = HazardFetch.build
    state = begin(made, world)
    dry = made.slow(state, world)
    assert torch.equal(dry, torch.tensor([[1.0, 0.0, 0.0]] * 3))
    world.agent_position[:, 0] = torch.tensor([18.0, 10.0, 1.0])
    state.level[:] = 0.8
    kept, drift = made.slow(state, world)[:, 0], made.slow(state, world)[:, 1:]
    assert (kept >= made.least_grip).all() and (kept <= 1.0).all() and kept[0] < 1.0 and kept[2] == 1.0
    assert (
        (drift[:, 1] == 0).all()
        and (drift[:, 0] <= 0).all()
        and (drift.norm(dim=-1) <= (1 - kept) * made.speed + 1e-6).all()
    )
    info = made.agent_info(state, world)
    assert info["water_depth"].tolist() == pytest.approx(
        [0.8 - 0.0524078 * d if d < 12 else 0.0 for d in (2, 10, 19)], abs=1e-5
    )
    assert info["flow_speed"].tolist() == pytest.approx([made.speed, made.speed, 0.0])
    assert info["hazard_class"][2] == 0 and info["agent_traction"].tolist() == [
        0.0,
        float(info["agent_traction"][1]),
        1.0,
    ]


WALLS = ((Partition("a", "y", 9.0),), (Opening("doorway", "a", 9.0, 0.9, 2.0),))
MANY = [
    Thing((0.1 + 0.02 * k, 0.2, 0.15), 90.0 * (k + 1), (2.0 + 1.5 * k, 8.0, 0.1 * k), (0.3 * k, 0.1, 0.2), category=c)
    for k, c in enumerate(
        ("book", "apple", "bottle", "throw_pillow", "box", "phone", "bottle", "key", "orange", "vase")
    )
]


@pytest.mark.parametrize("preset", EVERY)
@pytest.mark.parametrize("count", [1, 3, 10])
def test_one_environment_and_sixty_four_give_the_same_bits(preset: str, count: int) -> None:
    made, results = on_a_plane(flood(preset)), []
    for copies in (1, 64):
        world = room(MANY[:count], "east", copies=copies, partitions=WALLS[0], openings=WALLS[1])
        world.velocity[:] = torch.linspace(-1, 1, 3 * count).reshape(count, 3)
        world.angular_velocity[:] = torch.linspace(2, -2, 3 * count).reshape(count, 3)
        state = begin(made, world)
        state.level[:] = 0.9
        push = made.force(state, world, 1 / 120)
        assert push is not None
        world.chance.frame[:] = 899
        state.time[:] = 30.0
        frames(made, state, world, 3, 1 / 30)
        points = torch.rand(1, 50, 3, generator=torch.Generator().manual_seed(3)).expand(copies, -1, -1) * 20
        out = [
            push.force,
            push.torque,
            made.image(state, world, points),
            made.damaged(state, world),
            *state.save().values(),
        ]
        results.append([o for o in out if o is not None])
    for one, many in zip(*results, strict=True):
        assert torch.equal(one.expand_as(many), many)
