"""Spreading over the floor: distributions of docs/physics.md 2.1, F-20 to F-26; geometry, computed independently."""

from __future__ import annotations

import math

import pytest
import torch

from hazard_ms.hazards.fire import spread
from hazard_ms.hazards.fire.fire import Fire, body_flames, floor_flames
from hazard_ms.hazards.presets import fire
from tests.worlds.fire_worlds import begin, room_world, run

CELLS = 10_000  # independent ones
SMALL = Fire(max_frames=141)  # a window of 3 x 3 cells is enough for first successes


def linear(update: int) -> float:
    """p(T) as docs/physics.md 1.1 states it."""
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
def test_flames_spread_at_the_ages_of_their_distribution(
    birth: int, last: int, start: int, ages: range, mean: float, sd: float, median: int, greatest: int
) -> None:
    """F-20, F-21, F-22 of docs/physics.md."""
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


def test_one_draw_per_update_gives_the_mean_age() -> None:
    """F-23 of docs/physics.md."""
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


def test_as_many_cells_burn_on_an_open_floor_as_in_the_original() -> None:
    """F-26: Burning cells of one fire, and the farthest of them, as 400 Monte-Carlo runs of the original's rules had
    it.
    """
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
    """Every attempt succeeds, always straight ahead, counted by hand: first attempt 14 steps of growth after
    the birth.
    """
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
    """0.1 at birth, 0.05 more at each multiple of 10, 0.8 at last (a fire of frame 0 has grown once when the episode
    begins).
    """
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
