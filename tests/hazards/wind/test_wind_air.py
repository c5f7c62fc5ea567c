"""Gusts, profile and lee: W-20 to W-22 of docs/physics.md 2.3, and a shelter map against rays traced one by one."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest
import torch
from scipy.special import erf

from hazard_ms.hazards.presets import wind
from tests.worlds.fire_worlds import about_z
from tests.worlds.wind_worlds import Block, Thing, begin, push, run, street

REAL = dataclasses.replace(wind("realistic"), by_split=False)
# The lee of docs/physics.md 3.3: the share that is gone close behind, the cells of its map [m], the least height of
# what has one [m], and what lets part of the wind through
DEEPEST, CELL, LOWEST, SOLID = 0.75, 0.5, 0.5, {"hedge": 0.8}


@pytest.mark.parametrize(("dt", "time"), [(0.01, 5.0), (1 / 30, 5.0), (1.0, 5.0), (0.5, 2.0)])
def test_gusts_are_an_ornstein_uhlenbeck_process(dt: float, time: float) -> None:
    """W-20: Mean 0, variance 1 from the start and for ever, autocorrelation exp(-dt / T), whatever dt is."""
    law = dataclasses.replace(REAL, gust_time=time, sheltered=False)
    world = street([Thing()], copies=20000)
    state = begin(law, world)
    series = [state.gust.clone()]
    for _ in range(8):
        run(law, state, world, 1, dt)
        series.append(state.gust.clone())
    got = torch.stack(series)
    tolerance = 4 * math.sqrt(2 / 20000)
    assert got.mean(1).abs().max() < tolerance
    assert (got.var(1) - 1.0).abs().max() < 1.3 * tolerance
    kept = math.exp(-dt / time)
    step = got[1:] - kept * got[:-1]  # what is new is independent of what was, and of variance 1 - kept^2
    assert float(step.var() / (1 - kept**2)) == pytest.approx(1.0, abs=tolerance)
    assert abs(float((step * got[:-1]).mean()) / math.sqrt(1 - kept**2)) < tolerance


def test_the_wind_has_the_intensity_of_its_roughness() -> None:
    """W-20 of docs/physics.md."""
    assert REAL.gust_intensity == pytest.approx(1 / math.log(10 / REAL.roughness), rel=0.003)
    law, world = dataclasses.replace(REAL, sheltered=False), street([Thing()], copies=20000)
    state = begin(law, world)
    seen = law.image(state, world, torch.tensor([[[8.0, 8.0, 10.0]]]).expand(20000, 1, 3))[:, 0]
    assert float(seen.std() / seen.mean()) == pytest.approx(0.172, rel=0.03)


@pytest.mark.parametrize(("height", "intensity"), [(10.0, 0.172), (5.0, 0.1955), (2.0, 0.238), (1.0, 0.285)])
def test_gusts_are_as_strong_at_all_heights_so_the_intensity_grows_downwards(height: float, intensity: float) -> None:
    """W-30: 1 / ln(z / z0). Over the pavement, below 1 m, it stays as it is, and the air never turns round."""
    law, world = dataclasses.replace(REAL, sheltered=False), street([Thing()], copies=20000)
    points = torch.tensor([[[8.0, 8.0, z] for z in (height, 1.0, 0.3, 0.0)]]).expand(20000, 4, 3)
    seen = law.speed_at(begin(law, world), world, points)
    deviation, mean = seen.std(0), seen.mean(0)
    assert float(deviation[0] / mean[0]) == pytest.approx(intensity, rel=0.03)
    assert (deviation / mean)[1:].tolist() == pytest.approx([0.285] * 3, rel=0.03)
    assert float(seen.min()) >= 0.0
    lull = begin(law, world)
    lull.gust[:] = -6.0
    assert (law.speed_at(lull, world, points)[:, 1:] == 0.0).all()


def series(time: float, intensity: float, runs: int = 200, seconds: float = 600.0, dt: float = 0.2) -> np.ndarray:
    """Wind at 10 m over the mean one, [N, runs], by the hazard's own steps."""
    law = dataclasses.replace(REAL, scale=1.0, gust_time=time, gust_intensity=intensity, sheltered=False)
    world, made = street([Thing()], (1.0, 0.0), copies=runs), []
    state, point = begin(law, world), torch.tensor([[[8.0, 8.0, 10.0]]]).expand(runs, 1, 3)
    for _ in range(round(seconds / dt)):
        run(law, state, world, 1, dt)
        made.append(law.speed_at(state, world, point)[:, 0].numpy())
    return np.array(made)


@pytest.mark.parametrize(
    ("time", "intensity", "factor"),
    [(5.0, 0.1, 1.25), (5.0, 0.2, 1.51), (5.0, 0.3, 1.76), (2.0, 0.2, 1.47), (10.0, 0.2, 1.50)],
)
def test_three_second_means_and_gust_factors(time: float, intensity: float, factor: float) -> None:
    """W-20, W-21: E[max 3-s mean / 600-s mean] over 200 runs, to 0.03 and the runs' own scatter; variance of the 3-s
    mean of the process.
    """
    got = series(time, intensity)
    total = np.cumsum(np.vstack([np.zeros((1, 200)), got]), axis=0)
    means = (total[15:] - total[:-15]) / 3 * 0.2
    want = 2 * (time / 3) ** 2 * (3 / time - 1 + math.exp(-3 / time))
    assert means.var() == pytest.approx(intensity**2 * want, rel=0.05)
    assert (means.max(axis=0) / got.mean(axis=0)).mean() == pytest.approx(factor, abs=0.03)


W22 = {0.005: (0.394, 0.539, 0.606, 0.697, 0.788), 0.03: (0.207, 0.396, 0.484, 0.604, 0.723)}
W22_ROUGH = {0.1: (0.239, 0.349, 0.500, 0.651)}


@pytest.mark.parametrize("roughness", [*W22, *W22_ROUGH])
def test_the_wind_follows_the_logarithmic_profile(roughness: float) -> None:
    """W-22 of docs/physics.md."""
    heights = (0.1, 0.3, 0.5, 1.0, 2.0)[-len({**W22, **W22_ROUGH}[roughness]) :]
    want = {**W22, **W22_ROUGH}[roughness]
    law = dataclasses.replace(REAL, roughness=roughness, pavement=0.0, gust_intensity=0.0, sheltered=False)
    world = street([Thing()], (5.0, 0.0))
    points = torch.tensor([[[8.0, 8.0, z] for z in (*heights, -1.0, 0.0, roughness, 10.0)]])
    shares = (law.image(begin(law, world), world, points)[0] / (5.0 * law.scale)).tolist()
    assert shares[: len(heights)] == pytest.approx(want, abs=1e-3)
    assert shares[len(heights) :] == pytest.approx([0.0, 0.0, 0.0, 1.0], abs=1e-6)


def taylor_salmon(far: np.ndarray, high: float, coefficient: float, left: float, right: float) -> np.ndarray:
    """Loss of wind at a quarter of the height of an obstacle, `far` behind it [m], its ends `left` and `right` [m]."""
    u = [math.log((z + 0.03) / 0.03) for z in (high, high / 4)]  # z0 0.03 m
    rise = (u[0] / (2 * 0.4**2)) ** (7 / 15)
    eta = rise * 0.25 * (far / high) ** (-7 / 15)
    deviation = 0.5 * high * np.sqrt(far / high)
    covered = 0.5 * (erf(left / deviation / math.sqrt(2)) + erf(right / deviation / math.sqrt(2)))
    return 12.1875 * coefficient * high / far * eta * np.exp(-0.67 * eta**1.5) * covered * u[0] / u[1]


def traced(point: tuple[float, float, float], heading: float, blocks: list[Block]) -> float:
    """Share of the wind at `point`: a ray upwind in steps of 1 cm against the blocks themselves, grown by half
    a cell.
    """
    x, y, z = point
    deepest = 0.0
    for b in blocks:
        solid, high = SOLID.get(b.category, 1.0), b.at[2] + b.extent[2]
        turn = 2 * math.atan2(b.rotation[3], b.rotation[0])
        d = np.arange(0.25, 40.0, 0.01)
        dx, dy = x - d * math.cos(heading) - b.at[0], y - d * math.sin(heading) - b.at[1]
        over = (np.abs(math.cos(turn) * dx + math.sin(turn) * dy) < (b.extent[0] + CELL) / 2) & (
            np.abs(math.cos(turn) * dy - math.sin(turn) * dx) < (b.extent[1] + CELL) / 2
        )
        if over.any() and high >= LOWEST:
            across = (y - b.at[1]) * math.cos(heading) - (x - b.at[0]) * math.sin(heading)
            half = sum(0.5 * e * abs(f(turn - heading)) for e, f in zip(b.extent, (math.sin, math.cos), strict=False))
            thick = min(max((min(b.extent[:2]) / high - 0.3) / 0.7, 0.0), 1.0)
            coefficient = solid * (0.8 - 0.5 * thick)
            loss = float(taylor_salmon(d[over].min(), high, coefficient, half - across, half + across))
            deepest = max(deepest, min(loss, DEEPEST * solid) * min(max(2 - 2 * z / high, 0.0), 1.0))
    return 1 - deepest


HOUSE = Block("house", (5.0, 8.0, 0.0), (3.0, 4.0, 3.0))
HEDGE = Block("hedge", (12.0, 5.0, 0.0), (0.6, 5.0, 1.4), about_z(0.5))
CART = Block("cart", (9.0, 12.0, 0.0), (0.53, 0.93, 1.03))
LOW = Block("bench", (9.0, 2.0, 0.0), (0.5, 1.5, 0.45))


@pytest.mark.parametrize("heading", [0.0, 0.8, 2.5, -1.9])
@pytest.mark.parametrize("block", [HOUSE, HEDGE])
def test_the_lee_is_that_of_traced_rays(heading: float, block: Block) -> None:
    """Where a cell is no edge of the lee: two cells to every side agree. Within what a cell's length matters."""
    law = dataclasses.replace(REAL, scale=1.0, roughness=0.0, gust_intensity=0.0)
    world = street([Thing()], (4 * math.cos(heading), 4 * math.sin(heading)), [block])
    state = begin(law, world)
    along, aside, high = np.random.default_rng(3).uniform((3.5, -6, 0.05), (11, 6, 1.2), (240, 3)).T
    c, s = math.cos(heading), math.sin(heading)
    points = np.stack([block.at[0] + along * c - aside * s, block.at[1] + along * s + aside * c, high], 1)
    points = points[((points[:, :2] > -3) & (points[:, :2] < 19)).all(1)]
    got = law.image(state, world, torch.tensor(points, dtype=torch.float32)[None])[0] / 4
    want = [
        [traced((x + i, y + j, z), heading, [block]) for i in (0, -0.7, 0.7) for j in (0, -0.7, 0.7)]
        for x, y, z in points
    ]
    inner = np.ptp(want, axis=1) < 0.09
    shares = np.array(want)[inner, 0]
    assert got.numpy()[inner] == pytest.approx(shares, abs=0.09)
    assert (shares < 0.95).sum() > 3 and (shares == 1.0).sum() > 5


@pytest.mark.parametrize(("deep", "coefficient"), [(3.0, 0.3), (1.95, 0.55), (0.5, 0.8)])
def test_a_block_takes_less_of_the_wind_than_a_fence_of_its_size(deep: float, coefficient: float) -> None:
    """3 m wide and high, 12 m behind it: air comes down again on the roof of what is deep."""
    law = dataclasses.replace(REAL, scale=1.0, roughness=0.0, gust_intensity=0.0)
    world = street([Thing()], (4.0, 0.0), [Block("house", (3.0 - deep / 2, 8.0, 0.0), (deep, 3.0, 3.0))])
    left = float(law.image(begin(law, world), world, torch.tensor([[[15.0, 8.1, 0.1]]]))) / 4.0
    want = taylor_salmon(np.array(12.0), 3.0, coefficient, 1.5, 1.5)
    assert left == pytest.approx(1.0 - float(want), abs=0.05)


@pytest.mark.parametrize("turn", [0.0, 0.6])
def test_pieces_of_a_hedge_shelter_as_one_and_more_than_one_piece(turn: float) -> None:
    """Ten pieces of 1.6 m, also where the wind meets them slantwise; the lee of what is narrow is short."""
    c, s, law = math.cos(turn), math.sin(turn), dataclasses.replace(REAL, scale=1.0, gust_intensity=0.0)

    def hedge(at: float, long: float) -> Block:
        return Block("hedge", (8.0 - s * at, 8.0 + c * at, 0.0), (0.6, long, 1.0), about_z(turn))

    def left_behind(blocks: list[Block]) -> float:
        world = street([Thing()], (4.0, 0.0), blocks)
        return 1.0 - float(begin(law, world).loss[0, 24, 34])  # 5 m behind the middle of the hedge

    whole, pieces = [hedge(0.0, 16.0)], [hedge(1.6 * (k - 4.5), 1.6) for k in range(10)]
    assert left_behind(pieces) == pytest.approx(left_behind(whole), abs=0.01)
    assert left_behind(whole) < 0.5 < 0.6 < left_behind([hedge(0.0, 1.6)])


def test_carts_and_low_things_shelter_nothing_and_a_lee_ends() -> None:
    law = dataclasses.replace(REAL, scale=1.0, roughness=0.0, gust_intensity=0.0)
    world = street([Thing()], (4.0, 0.0), [CART, LOW, HOUSE])
    state = begin(law, world)
    points = [
        (10.0, 12.0, 0.1),
        (10.0, 2.0, 0.1),
        (7.5, 8.0, 0.1),
        (7.5, 8.0, 3.5),
        (2.0, 8.0, 0.1),
        (7.5, 14.0, 0.1),
        (90.0, 8.0, 0.1),
    ]
    seen = (law.image(state, world, torch.tensor([points])) / 4)[0].tolist()
    assert seen[0] == seen[1] == seen[3] == seen[4] == seen[5] == seen[6] == 1.0
    assert 0.25 <= seen[2] < 0.35


def test_what_lies_behind_a_house_feels_a_sixteenth_of_the_force() -> None:
    things = [Thing((0.2, 0.2, 0.2), 1e9, (7.2, 8.0, 0.0)), Thing((0.2, 0.2, 0.2), 1e9, (7.2, 14.0, 0.0))]
    force = push(dataclasses.replace(REAL, gust_intensity=0.0), street(things, (4.0, 0.0), [HOUSE])).force[0, :, 0]
    assert 1 / 16 <= float(force[0] / force[1]) < 1 / 10


def test_the_lee_of_each_environment_is_its_own() -> None:
    """Eight headings in one batch as each alone."""
    law = dataclasses.replace(REAL, gust_intensity=0.0)
    world = street([Thing()], (0.0, 0.0), [HOUSE, HEDGE], copies=8)
    state = begin(law, world)
    assert float(state.loss.max()) > 0.6
    for e in range(8):
        alone = street([Thing()], (0.0, 0.0), [HOUSE, HEDGE])
        alone.chance.seed[:] = e
        assert torch.equal(begin(law, alone).loss[0], state.loss[e])
    assert not torch.equal(state.loss[0], state.loss[1])
