"""Spreading over the floor: the distributions of physics.md 2.1 (F-20 to F-26), geometry against independent computations."""

from __future__ import annotations

import itertools
import math

import pytest
import torch
from fire_worlds import FAR, ORIGINAL, begin, room_world, run

from hazard_ms.hazards import floor, spread
from hazard_ms.hazards.fire import Fire, body_flames, floor_flames
from hazard_ms.hazards.presets import fire
from hazard_ms.world import rotate

CELLS = 10_000  # independent ones
SMALL = Fire(max_frames=141)  # a window of 3 x 3 cells is enough for first successes


def linear(update: int) -> float:
    """p(T) as physics.md 1.1 states it."""
    return 0.02 if update <= 30 else min(1.0, 0.02 + 0.049 * (update - 30))


def first_success(ages: list[int]) -> dict[int, float]:
    """Probability of the first success at each of the attempts made at `ages` [frames]."""
    pmf, alive = {}, 1.0
    for age in ages:
        pmf[age] = alive * linear(age // 5)
        alive -= pmf[age]
    return {age: p for age, p in pmf.items() if p > 0.0}


def ages_at_success(birth: int, last: int, start: int) -> torch.Tensor:
    """Ages [frames since `last`] at which 10,000 flames born at `birth` next succeed."""
    world = room_world([], [(10.0, 10.0)], copies=CELLS)
    state = begin(SMALL, world)
    state.flame_birth[:, 0], state.flame_last[:, 0] = birth, last
    world.chance.frame[:] = start
    age = torch.full((CELLS,), -1)
    while (age < 0).any():
        world.chance.frame += 10
        SMALL.advance(state, world, 0.01)
        new = (age < 0) & (state.flame_last[:, 0] != last)
        age[new] = world.frame[new] - last
        assert int(world.frame[0]) < start + 400
    return age


@pytest.mark.parametrize(
    ("birth", "last", "start", "ages", "mean", "sd", "median", "greatest"),
    [
        (0, 0, 100, range(140, 251, 10), 183.761, 18.546, 180, 250),  # F-20: a first fire
        (1, 1, 100, range(149, 260, 10), 187.804, 18.326, 189, 259),  # F-21: a later fire
        (0, 200, 200, range(10, 251, 10), 156.832, 54.783, 180, 250),  # F-22: each further success
    ],
)
def test_f20_f21_f22_age_at_success(
    birth: int, last: int, start: int, ages: range, mean: float, sd: float, median: int, greatest: int
) -> None:
    seen = ages_at_success(birth, last, start)
    assert abs(seen.double().mean().item() - mean) < 4 * sd / math.sqrt(CELLS)
    assert seen.double().std().item() == pytest.approx(sd, rel=4 / math.sqrt(CELLS))
    assert ages[0] <= int(seen.min()) and int(seen.max()) <= greatest
    pmf = first_success(list(ages))
    assert sum(pmf.values()) == pytest.approx(1.0)
    assert sum(p for age, p in pmf.items() if age < median) < 0.5 < sum(p for age, p in pmf.items() if age <= median)
    likely = {age: p for age, p in pmf.items() if p * CELLS >= 5}
    chi2 = sum((int((seen == age).sum()) - CELLS * p) ** 2 / (CELLS * p) for age, p in likely.items())
    freedom = len(likely) - 1
    assert chi2 < freedom + 5 * math.sqrt(2 * freedom)


def test_probability_of_an_attempt() -> None:
    expected = {30: 0.02, 31: 0.069, 35: 0.265, 40: 0.51, 45: 0.755, 49: 0.951}
    ages = torch.tensor([5 * t for t in expected])
    assert spread.probability(ages).tolist() == pytest.approx(list(expected.values()), rel=1e-5)
    assert spread.probability(torch.tensor([0, 154, 250, 254, 10**6])).tolist()[:2] == pytest.approx([0.02, 0.02])
    assert (spread.probability(torch.tensor([250, 254, 10**6])) >= 1.0).all()  # certain: a draw is below 1


def test_f23_one_draw_per_update() -> None:
    p = spread.probability(5 * torch.arange(1, 51)).double()
    pmf = p * torch.cat([torch.ones(1, dtype=torch.float64), torch.cumprod(1.0 - p, 0)[:-1]])
    update = torch.arange(1, 51).double()
    mean = (pmf * update).sum()
    assert mean.item() == pytest.approx(25.459, abs=1e-3)
    assert ((pmf * update**2).sum() - mean**2).sqrt().item() == pytest.approx(12.105, abs=1e-3)
    assert pmf[:30].sum().item() == pytest.approx(0.454516, abs=1e-6)


def test_directions_are_drawn_evenly() -> None:
    world = room_world([], [(10.0, 10.0)], copies=CELLS)
    state = begin(SMALL, world)
    world.chance.frame[:] = 250  # an age at which an attempt is certain
    SMALL.advance(state, world, 0.01)
    for bit in (1, 2, 4, 8):
        share = (state.flame_used[:, 0] == bit).double().mean().item()
        assert abs(share - 0.25) < 4 * math.sqrt(0.25 * 0.75 / CELLS)
    offset = ((state.flame_place[:, 1] - state.flame_place[:, 0]) / 0.22).round().long()
    assert {tuple(o) for o in offset.tolist()} == {(1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0)}


def test_f26_open_floor() -> None:
    """Burning cells of one fire, and the farthest of them, as 400 Monte-Carlo runs of the original's rules had it."""
    expected = {
        200: (1.77, 0.49),
        300: (2.23, 0.48),
        400: (3.70, 0.89),
        500: (4.62, 1.13),
        750: (10.27, 2.07),
        1000: (18.39, 2.93),
        1250: (28.29, 4.13),
        1500: (41.47, 5.28),
    }
    runs = 120
    preset = fire("paper")
    world = room_world([], [(10.0, 10.0)], copies=runs)
    state = begin(preset, world)
    for _ in range(150):
        world.chance.frame += 10
        preset.advance(state, world, 0.01)
        frame = int(world.frame[0])
        for at in (at for at in expected if frame - 10 < at <= frame):
            mean, sd = expected[at]
            count = ((state.flame_cell >= 0) & (state.flame_birth <= at)).sum(1).double()
            assert abs(count.mean().item() - mean) < 4 * sd * math.sqrt(1 / 400 + 1 / runs) + 0.005, at
            assert count.std().item() == pytest.approx(sd, rel=0.3), at
    offset = (state.flame_place - state.flame_place[:, :1])[..., :2].abs().amax(-1) / 0.22
    farthest = torch.where(state.flame_cell >= 0, offset, 0.0).amax(1)
    assert farthest.mean().item() == pytest.approx(4.48, abs=0.25)
    assert int((state.flame_cell >= 0).sum(1).max()) < state.flame_cell.shape[1]  # the roster was long enough


def test_the_window_holds_the_fastest_fire() -> None:
    """Every attempt succeeds, always straight ahead, counted by hand: first attempt 14 steps of growth after the birth."""
    for frames in (100, 140, 141, 290, 291, 1500, 3000):
        birth, cells = 0, 0
        while True:
            growth = [f for f in range(birth, birth + 200) if f % 10 == 0][:14]
            birth = growth[-1] + 10 + 1
            if birth > frames:
                break
            cells += 1
        assert spread.lattice_reach(frames) == cells


def test_the_roster_is_five_standard_deviations_long() -> None:
    for lattices in (1, 2, 3):
        assert spread.roster_length(1500, lattices) >= 41.47 * lattices + 5 * 5.28 * math.sqrt(lattices)


@pytest.mark.parametrize("birth", [0, 1, 151])
def test_flames_grow_in_14_steps_of_10_frames(birth: int) -> None:
    """0.1 at birth, 0.05 more at each multiple of 10, 0.8 at last (a fire of frame 0 has grown once when the episode begins)."""
    world = room_world([], [(10.0, 10.0)])
    state = begin(SMALL, world)
    state.flame_birth[:, 0] = birth
    for frame in range(birth, birth + 160):
        steps = min(14, sum(1 for f in range(birth, frame + 1) if f % 10 == 0))
        _, scale = floor_flames(state, torch.tensor([frame]))
        assert scale[0, 0].item() == pytest.approx(0.1 + 0.05 * steps)
        assert (scale[0, 1:] == 0.0).all()
    _, scale = floor_flames(state, torch.tensor([birth - 1]))
    assert scale[0, 0].item() == 0.0  # not born yet


def test_flames_on_things_grow_alike() -> None:
    world = room_world([("book", (10.0, 10.0, 0.0)), ("pan", (10.0, 12.0, 0.0))])
    preset = fire("shipped")
    state = begin(preset, world)
    state.temperature[0, 0] = 400.0
    run(preset, state, world, 5)
    assert body_flames(state)[0].tolist() == pytest.approx([0.1, 0.0])
    run(preset, state, world, 70)
    assert body_flames(state)[0].tolist() == pytest.approx([0.1 + 7 * 0.05, 0.0])
    run(preset, state, world, 140)
    assert body_flames(state)[0].tolist() == pytest.approx([0.8, 0.0])


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
def test_rugs_and_hung_fixtures_do_not_keep_fire_out(base: tuple[float, float, float], height: float, blocks: bool) -> None:
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
