"""Temperatures against the closed forms and tables of docs/physics.md 2.1, F-1 to F-9 and F-17."""

from __future__ import annotations

import math

import pytest
import torch

from hazard_ms.hazards.fire.fire import BURNING, NORMAL, Fire
from hazard_ms.hazards.fire.heat import Mean, Sources, exchange
from hazard_ms.hazards.presets import fire
from hazard_ms.simulation.walls import Walls
from tests.worlds.fire_worlds import (
    begin,
    begin_without_spread,
    one_source,
    repeat,
    room_world,
    run,
    updates,
)

SHIPPED_LEVELS = {0.05: 577.6923, 0.1: 577.6923, 0.22: 505.925, 0.25: 484.0, 0.3: 446.471, 0.5: 310.0, 0.75: 198.462}
FAR_LEVELS = {1.0: 136.0, 1.5: 78.0, 2.0: 54.1176, 3.0: 35.676}


def level(preset: Fire, distance: float) -> float:
    """Equilibrium beside one source [C]: F-1; F-2 where the paper clips the weight at 0.5 m."""
    return {**SHIPPED_LEVELS, **FAR_LEVELS}[max(distance, 0.5) if preset == fire("paper") else distance]


@pytest.mark.parametrize(
    "distances", [[0.05], [0.75], [*SHIPPED_LEVELS, *FAR_LEVELS], [*SHIPPED_LEVELS, *FAR_LEVELS] * 6]
)
def test_one_source_holds_a_thing_at_its_equilibrium(preset: Fire, distances: list[float]) -> None:
    """F-1, F-2 of docs/physics.md."""
    world = one_source(distances)
    state = begin_without_spread(preset, world)
    updates(preset, state, world, 350)
    expected = torch.tensor([level(preset, d) for d in distances])
    assert torch.allclose(state.temperature[:, 0], expected, rtol=1e-4)


def test_relaxation_is_exponential_in_the_updates(preset: Fire, copies: int) -> None:
    """F-3 of docs/physics.md."""
    world = one_source([1.0] * copies)
    state = begin_without_spread(preset, world)
    for count in range(1, 101):
        updates(preset, state, world, 1)
        assert torch.allclose(state.temperature, torch.tensor(136.0 + (20.0 - 136.0) * 0.97**count), rtol=1e-4)


def test_the_half_life_of_a_difference_in_temperature(preset: Fire) -> None:
    """F-3: The excess halves in 22.757 updates: between the 22nd and the 23rd."""
    world = one_source([1.0])
    state = begin_without_spread(preset, world)
    updates(preset, state, world, 22)
    assert state.temperature.item() < (20.0 + 136.0) / 2
    updates(preset, state, world, 1)
    assert state.temperature.item() > (20.0 + 136.0) / 2


def test_a_hot_thing_cools_in_an_empty_room(preset: Fire, copies: int) -> None:
    """F-4 of docs/physics.md."""
    world = room_world([("pan", (10.0, 10.0, 0.0))], copies=copies)
    state = begin(preset, world)
    state.temperature[:] = 200.0
    seen = [200.0]
    for _ in range(100):
        updates(preset, state, world, 1)
        assert state.temperature.max().item() < seen[-1]
        seen.append(state.temperature[-1, 0].item())
    assert [seen[n] for n in (1, 10, 50, 100)] == pytest.approx([194.6, 152.7363, 59.2518, 28.5595], rel=1e-4)
    assert min(seen) >= 20.0


@pytest.mark.parametrize(
    ("distance", "clip", "after_50"),
    [(0.5, 0.1, (99.7621, 71.7512)), (0.5, 0.5, (99.7621, 71.7512)), (0.1, 0.1, (158.895, 145.399))],
)
def test_two_passive_things_exchange_heat(
    copies: int, distance: float, clip: float, after_50: tuple[float, float]
) -> None:
    """F-5, F-6 of docs/physics.md."""
    world = room_world([("pan", (10.0, 10.0, 0.0)), ("pan", (10.0 + distance, 10.0, 0.0))], copies=copies)
    preset = Fire(nearest=clip)
    state = begin(preset, world)
    state.temperature[:, 0], state.temperature[:, 1] = 300.0, 20.0
    updates(preset, state, world, 50)
    assert torch.allclose(state.temperature, torch.tensor(after_50).expand(copies, 2), rtol=1e-4)


def pair_law(temperature: torch.Tensor, distance: float, room_weight: float, count: int) -> torch.Tensor:
    """`count` updates of two passive things, the room weighing `room_weight`."""
    points = torch.tensor([[[0.0, 0.0, 0.0], [distance, 0.0, 0.0]]])
    mean = Mean(20.0, room_weight, 0.5, 0.1)
    for _ in range(count):
        around = mean.at(points, Sources(points, temperature, torch.ones(1, 2, dtype=torch.bool)), Walls.none(1))
        temperature = exchange(temperature, around, torch.tensor(True), 0.03)
    return temperature


def test_an_isolated_pair_keeps_its_mean() -> None:
    """F-8 of docs/physics.md."""
    end = pair_law(torch.tensor([[300.0, 20.0]]), 0.5, 0.0, 200)
    assert end[0].tolist() == pytest.approx([160.00059, 159.99941], rel=1e-6)
    middle = pair_law(torch.tensor([[300.0, 20.0]]), 0.5, 0.0, 10)[0]
    assert (middle[0] - middle[1]).item() == pytest.approx(280.0 * 0.94**10, rel=1e-4)


@pytest.mark.parametrize("distance", [0.1, 0.2, 0.37, 0.5, 0.9, 2.0])
def test_two_things_follow_the_two_body_law(distance: float) -> None:
    """F-9 of docs/physics.md."""
    w = (0.5 / distance) ** 2
    end = pair_law(torch.tensor([[320.0, 120.0]]), distance, 1.0, 1)[0] - 20.0
    assert end.sum().item() / 400.0 == pytest.approx(1.0 - 0.03 / (1.0 + w), rel=1e-6)
    assert (end[0] - end[1]).item() / 200.0 == pytest.approx(1.0 - 0.03 * (1.0 + 2.0 * w) / (1.0 + w), rel=1e-5)


OBSERVED = {  # F-17: distance -> (room weight e^-1, clip 0.1)
    0.1: 591.589,
    0.5: 444.014,
    1.0: 254.674,
    2.0: 104.228,
    4.0: 43.631,
}


@pytest.mark.parametrize("distance", OBSERVED)
def test_observed_temperature_of_one_fire(distance: float, copies: int) -> None:
    """F-17 of docs/physics.md."""
    world = room_world([], [(10.0, 10.0)], copies=copies)
    point = torch.tensor([10.0, 10.0 + distance, 0.0]).expand(copies, 1, 3)
    shipped = fire("shipped")
    observed = shipped.image(begin(shipped, world), world, point)
    assert torch.allclose(observed, torch.tensor(OBSERVED[distance]), rtol=1e-4)
    paper = fire("paper")
    expected = {0.1: 310.0, 0.5: 310.0, 1.0: 136.0, 2.0: 54.1176, 4.0: 28.92308}[distance]  # room weight 1, clip at D
    assert torch.allclose(paper.image(begin(paper, world), world, point), torch.tensor(expected), rtol=1e-4)


def test_the_agent_takes_part_in_the_exchange(preset: Fire) -> None:
    """A thing of 300 C and the agent, 0.5 m apart: the pair of F-5."""
    world = room_world([("pan", (10.0, 10.0, 0.0))], agent=(10.5, 10.0))
    state = begin(preset, world)
    state.temperature[:] = 300.0
    updates(preset, state, world, 50)
    assert [state.temperature.item(), state.agent_temperature.item()] == pytest.approx([99.7621, 71.7512], rel=1e-4)


def test_what_is_safe_neither_gives_nor_takes_heat(preset: Fire) -> None:
    world = room_world([("book", (10.1, 10.0, 0.0)), ("pan", (10.1, 10.5, 0.0))], [(10.0, 10.0)])
    alone = room_world([("pan", (10.1, 10.5, 0.0))], [(10.0, 10.0)])
    state, reference = begin_without_spread(preset, world), begin_without_spread(preset, alone)
    world.safe[0, 0] = True
    state.temperature[0, 0] = 500.0  # far above what ignites a book
    updates(preset, state, world, 40)
    updates(preset, reference, alone, 40)
    assert state.temperature[0, 0].item() == 500.0 and state.status[0, 0].item() == NORMAL
    assert state.temperature[0, 1].item() == pytest.approx(reference.temperature[0, 0].item(), rel=1e-6)


def test_copies_agree_to_the_bit(preset: Fire) -> None:
    """The episode of an environment does not depend on its neighbours: 1 and 64 copies of seed 0."""
    things = [
        (("book", "pan", "apple", "phone")[k % 4], (8.0 + 0.3 * (k % 7), 8.0 + 0.4 * (k // 7), 0.0)) for k in range(24)
    ]
    single = room_world(things, [(8.5, 8.5), (9.5, 9.1)], agent=(8.0, 9.0))
    many = repeat(single, 64)
    one, batch = begin(preset, single), begin(preset, many)
    run(preset, one, single, 300)
    run(preset, batch, many, 300)
    for name, value in one.save().items():
        assert torch.equal(value[0], getattr(batch, name)[0]), name


def plain_update(places: list, temperature: list[float], sources: list[bool], clip: float) -> list[float]:
    """One update as docs/physics.md 1.1 words it: double precision, loops over pairs."""
    new = []
    for i, here in enumerate(places):
        weight, total = 1.0, 20.0
        for j, there in enumerate(places):
            if i != j:
                w = (0.5 / max(math.dist(here, there), clip)) ** 2
                weight, total = weight + w, total + w * temperature[j]
        new.append(temperature[i] if sources[i] else temperature[i] * 0.97 + 0.03 * total / weight)
    return new


def test_a_whole_room_against_plain_loops(preset: Fire) -> None:
    """20 things, the agent and 6 flames over 200 updates: same temperatures, same moments of ignition, chains
    included.
    """
    names = ["book", "burger", "pan", "phone", "box", "money"]
    generator = torch.Generator().manual_seed(5)
    bases = [tuple(p) for p in (torch.rand(20, 3, generator=generator) * torch.tensor([2.0, 2.0, 1.0])).tolist()]
    bases = [(5.0 + x, 5.0 + y, z) for x, y, z in bases]
    flames = [(5.1 + 0.3 * (k % 6), 5.2 + 0.4 * (k // 6)) for k in range(0, 24, 4)]
    world = room_world([(names[k % 6], base) for k, base in enumerate(bases)], flames, agent=(6.0, 5.2))
    state = begin_without_spread(preset, world)
    thresholds = state.threshold[0].tolist()
    places = [*bases, (6.0, 5.2, 0.0), *[(*flame, 0.0) for flame in flames]]
    temperature, source = [20.0] * 21 + [600.0] * 6, [False] * 21 + [True] * 6
    paper = preset == fire("paper")  # 0.5 m and "reaches"; the original's code: 0.1 m and "above"
    for _ in range(200):
        temperature = plain_update(places, temperature, source, 0.5 if paper else 0.1)
        for k, limit in enumerate(thresholds):
            if not source[k] and (temperature[k] > limit or (temperature[k] == limit and paper)):
                source[k], temperature[k] = True, 600.0
        updates(preset, state, world, 1)
        assert (state.status[0] == BURNING).tolist() == source[:20]
        assert [*state.temperature[0].tolist(), state.agent_temperature.item()] == pytest.approx(
            temperature[:21], rel=1e-4
        )
    assert 3 < sum(source[:20]) < 20
