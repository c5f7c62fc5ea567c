"""Temperatures, ignition and burning against the closed forms and tables of physics.md 2.1, F-1 to F-18, in both presets."""

from __future__ import annotations

import math

import pytest
import torch
from fire_worlds import ORIGINAL, begin, begin_without_spread, one_source, repeat, room_world, run, updates

from hazard_ms.hazards.fire import BURNING, BURNT, NORMAL, Fire
from hazard_ms.hazards.heat import Mean, Sources, exchange
from hazard_ms.hazards.presets import fire


@pytest.fixture(params=ORIGINAL)
def preset(request: pytest.FixtureRequest) -> Fire:
    return fire(request.param)


@pytest.fixture(params=[1, 64])
def copies(request: pytest.FixtureRequest) -> int:
    return request.param


SHIPPED_LEVELS = {0.05: 577.6923, 0.1: 577.6923, 0.22: 505.925, 0.25: 484.0, 0.3: 446.471, 0.5: 310.0, 0.75: 198.462}
FAR_LEVELS = {1.0: 136.0, 1.5: 78.0, 2.0: 54.1176, 3.0: 35.676}


def level(preset: Fire, distance: float) -> float:
    """Equilibrium beside one source [C]: F-1; F-2 where the paper clips the weight at 0.5 m."""
    return {**SHIPPED_LEVELS, **FAR_LEVELS}[max(distance, 0.5) if preset.nearest == 0.5 else distance]


@pytest.mark.parametrize("distances", [[0.05], [0.75], [*SHIPPED_LEVELS, *FAR_LEVELS], [*SHIPPED_LEVELS, *FAR_LEVELS] * 6])
def test_f1_f2_one_source_holds_a_thing_at_its_equilibrium(preset: Fire, distances: list[float]) -> None:
    world = one_source(distances)
    state = begin_without_spread(preset, world)
    updates(preset, state, world, 350)
    expected = torch.tensor([level(preset, d) for d in distances])
    assert torch.allclose(state.temperature[:, 0], expected, rtol=1e-4)


def test_f3_relaxation_is_exponential_in_the_updates(preset: Fire, copies: int) -> None:
    world = one_source([1.0] * copies)
    state = begin_without_spread(preset, world)
    for count in range(1, 101):
        updates(preset, state, world, 1)
        assert torch.allclose(state.temperature, torch.tensor(136.0 + (20.0 - 136.0) * 0.97**count), rtol=1e-4)


def test_f3_half_life(preset: Fire) -> None:
    """The excess halves in 22.757 updates: between the 22nd and the 23rd."""
    world = one_source([1.0])
    state = begin_without_spread(preset, world)
    updates(preset, state, world, 22)
    assert state.temperature.item() < (20.0 + 136.0) / 2
    updates(preset, state, world, 1)
    assert state.temperature.item() > (20.0 + 136.0) / 2


def test_f4_a_hot_thing_cools_in_an_empty_room(preset: Fire, copies: int) -> None:
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
def test_f5_f6_two_passive_things(copies: int, distance: float, clip: float, after_50: tuple[float, float]) -> None:
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
        around = mean.at(points, Sources(points, temperature, torch.ones(1, 2, dtype=torch.bool)), apart=True)
        temperature = exchange(temperature, around, torch.tensor(True), 0.03)
    return temperature


def test_f8_an_isolated_pair_keeps_its_mean() -> None:
    end = pair_law(torch.tensor([[300.0, 20.0]]), 0.5, 0.0, 200)
    assert end[0].tolist() == pytest.approx([160.00059, 159.99941], rel=1e-6)
    middle = pair_law(torch.tensor([[300.0, 20.0]]), 0.5, 0.0, 10)[0]
    assert (middle[0] - middle[1]).item() == pytest.approx(280.0 * 0.94**10, rel=1e-4)


@pytest.mark.parametrize("distance", [0.1, 0.2, 0.37, 0.5, 0.9, 2.0])
def test_f9_the_two_body_law(distance: float) -> None:
    w = (0.5 / distance) ** 2
    end = pair_law(torch.tensor([[320.0, 120.0]]), distance, 1.0, 1)[0] - 20.0
    assert end.sum().item() / 400.0 == pytest.approx(1.0 - 0.03 / (1.0 + w), rel=1e-6)
    assert (end[0] - end[1]).item() / 200.0 == pytest.approx(1.0 - 0.03 * (1.0 + 2.0 * w) / (1.0 + w), rel=1e-5)


IGNITION_DISTANCES = {60: 1.8371, 100: 1.25, 200: 0.7454, 300: 0.5175, 400: 0.3627, 500: 0.2282, 560: 0.1361}


@pytest.mark.parametrize("sources", [1, 2, 4])
def test_f12_ignition_distance(preset: Fire, sources: int) -> None:
    """Just inside it a thing ignites, just outside never. The closed form holds where the weight is not clipped."""
    cases = [
        (threshold, share * limit * math.sqrt(sources), share < 1.0)
        for threshold, limit in IGNITION_DISTANCES.items()
        for share in (0.99, 1.01)
        if share * limit * math.sqrt(sources) > preset.nearest
    ]
    assert len(cases) >= 8
    world = one_source([distance for _, distance, _ in cases], sources)
    state = begin_without_spread(preset, world)
    state.threshold[:, 0] = torch.tensor([float(t) for t, _, _ in cases])
    updates(preset, state, world, 500)
    assert (state.status[:, 0] != NORMAL).tolist() == [burns for _, _, burns in cases]


IGNITION_UPDATES = {  # F-13: threshold -> distance -> updates, None: never
    60: {0.1: 3, 0.22: 3, 0.3: 4, 0.5: 5, 0.7: 8},
    100: {0.1: 6, 0.22: 6, 0.3: 7, 0.5: 11, 0.7: 18},
    200: {0.1: 13, 0.22: 16, 0.3: 19, 0.5: 32, 0.7: 83},
    300: {0.1: 23, 0.22: 29, 0.3: 36, 0.5: 111, 0.7: None},
    400: {0.1: 38, 0.22: 51, 0.3: 73, 0.5: None, 0.7: None},
    500: {0.1: 65, 0.22: 145, 0.3: None, 0.5: None, 0.7: None},
}


def ignition_updates(preset: Fire, thresholds: list[float], distances: list[float]) -> list[int | None]:
    """The update at which a thing ignites, per environment, None if not within 300."""
    world = one_source(distances)
    state = begin_without_spread(preset, world)
    state.threshold[:, 0] = torch.tensor(thresholds)
    seen: list[int | None] = [None] * len(distances)
    for update in range(1, 301):
        updates(preset, state, world, 1)
        for e in (state.status[:, 0] == BURNING).nonzero().flatten().tolist():
            seen[e] = seen[e] or update
    return seen


@pytest.mark.parametrize("repeats", [1, 3])
def test_f13_updates_to_ignition(preset: Fire, repeats: int) -> None:
    cases = [(t, d) for t, row in IGNITION_UPDATES.items() for d in row] * repeats
    expected = [IGNITION_UPDATES[t][max(d, preset.nearest)] for t, d in cases]
    assert ignition_updates(preset, [float(t) for t, _ in cases], [d for _, d in cases]) == expected


def test_f13_of_one_environment_alone(preset: Fire) -> None:
    assert ignition_updates(preset, [200.0], [0.7]) == [83]
    assert ignition_updates(preset, [300.0], [0.5]) == [111]


@pytest.mark.parametrize(("name", "ignites"), [("paper", True), ("shipped", False)])
def test_ignition_exactly_at_the_threshold_is_for_paper_only(name: str, ignites: bool) -> None:
    world = room_world([("pan", (10.0, 10.0, 0.0))])
    preset = fire(name)
    state = begin(preset, world)
    state.threshold[:] = 20.0  # an unheated thing is at exactly 20 C
    updates(preset, state, world, 1)
    assert (state.status.item() == BURNING) == ignites


def test_f14_thresholds_of_600_and_above_never_ignite(preset: Fire) -> None:
    world = one_source([0.05], sources=60)
    state = begin_without_spread(preset, world)
    state.threshold[:] = 600.0
    updates(preset, state, world, 400)
    assert state.status.item() == NORMAL
    assert 590.0 < state.temperature.item() < 600.0


def test_f16_burning_lasts_300_updates(preset: Fire, copies: int) -> None:
    world = room_world([("book", (10.0, 10.0, 0.0))], copies=copies)
    state = begin(preset, world)
    state.temperature[:] = 300.0
    updates(preset, state, world, 1)
    assert (state.status == BURNING).all() and (state.temperature == 600.0).all()
    run(preset, state, world, 1499)
    assert (state.status == BURNING).all() and (state.temperature == 600.0).all()
    run(preset, state, world, 1)
    assert (state.status == BURNT).all()
    updates(preset, state, world, 10)
    afterwards = 600.0 if preset.embers else 20.0 + 580.0 * 0.97**10  # R3: paper cools, shipped stays a source
    assert torch.allclose(state.temperature, torch.tensor(afterwards), rtol=1e-4)
    updates(preset, state, world, 300)
    assert (state.status == BURNT).all()  # nothing burns twice


OBSERVED = {  # F-17: distance -> (room weight e^-1, clip 0.1)
    0.1: 591.589,
    0.5: 444.014,
    1.0: 254.674,
    2.0: 104.228,
    4.0: 43.631,
}


@pytest.mark.parametrize("distance", OBSERVED)
def test_f17_observed_temperature_of_one_fire(distance: float, copies: int) -> None:
    world = room_world([], [(10.0, 10.0)], copies=copies)
    point = torch.tensor([10.0, 10.0 + distance, 0.0]).expand(copies, 1, 3)
    shipped = fire("shipped")
    observed = shipped.image(begin(shipped, world), world, point)
    assert torch.allclose(observed, torch.tensor(OBSERVED[distance]), rtol=1e-4)
    paper = fire("paper")
    expected = {0.1: 310.0, 0.5: 310.0, 1.0: 136.0, 2.0: 54.1176, 4.0: 28.92308}[distance]  # room weight 1, clip at D
    assert torch.allclose(paper.image(begin(paper, world), world, point), torch.tensor(expected), rtol=1e-4)


@pytest.mark.parametrize(("distance", "update"), [(0.5, 5), (1.0, 14), (1.5, 39), (2.0, None)])
def test_f18_when_the_agent_is_overheated(preset: Fire, copies: int, distance: float, update: int | None) -> None:
    world = room_world([], [(10.0, 10.0)], copies=copies, agent=(10.0 + distance, 10.0))
    state = begin_without_spread(preset, world)
    hot = []
    for n in range(1, 101):
        updates(preset, state, world, 1)
        if preset.agent_info(state, world)["agent_overheated"].all():
            hot.append(n)
    assert (hot[0] if hot else None) == update


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


def test_heat_comes_from_a_burning_neighbour(preset: Fire) -> None:
    """A burning book 1 m away is a source of 600 C: F-1 at 1 m."""
    world = room_world([("book", (10.0, 10.0, 0.0)), ("pan", (11.0, 10.0, 0.0))])
    state = begin(preset, world)
    state.temperature[0, 0] = 300.0
    updates(preset, state, world, 1)
    start = state.temperature[0, 1].item()
    updates(preset, state, world, 60)
    assert state.temperature[0, 1].item() == pytest.approx(136.0 + (start - 136.0) * 0.97**60, rel=1e-4)


def test_copies_agree_to_the_bit(preset: Fire) -> None:
    """The episode of an environment does not depend on its neighbours: 1 and 64 copies of seed 0."""
    things = [(("book", "pan", "apple", "phone")[k % 4], (8.0 + 0.3 * (k % 7), 8.0 + 0.4 * (k // 7), 0.0)) for k in range(24)]
    single = room_world(things, [(8.5, 8.5), (9.5, 9.1)], agent=(8.0, 9.0))
    many = repeat(single, 64)
    one, batch = begin(preset, single), begin(preset, many)
    run(preset, one, single, 300)
    run(preset, batch, many, 300)
    for name, value in one.save().items():
        assert torch.equal(value[0], getattr(batch, name)[0]), name


def plain_update(places: list, temperature: list[float], sources: list[bool], clip: float) -> list[float]:
    """One update as physics.md 1.1 words it: double precision, loops over pairs."""
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
    """20 things, the agent and 6 flames over 200 updates: same temperatures, same moments of ignition, chains included."""
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
    for _ in range(200):
        temperature = plain_update(places, temperature, source, preset.nearest)
        for k, limit in enumerate(thresholds):
            if not source[k] and (temperature[k] > limit or (temperature[k] == limit and not preset.strict)):
                source[k], temperature[k] = True, 600.0
        updates(preset, state, world, 1)
        assert (state.status[0] == BURNING).tolist() == source[:20]
        assert [*state.temperature[0].tolist(), state.agent_temperature.item()] == pytest.approx(temperature[:21], rel=1e-4)
    assert 3 < sum(source[:20]) < 20
