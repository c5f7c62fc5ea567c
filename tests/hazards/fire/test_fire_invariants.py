"""What holds for every fire: F-10, F-11 and F-27 of docs/physics.md, and that lattices do not overlap."""

from __future__ import annotations

import dataclasses

import torch
from hypothesis import Phase, given, settings
from hypothesis import strategies as st

from hazard_ms.hazards.fire.fire import BURNING, Fire, FireState
from hazard_ms.hazards.presets import fire
from hazard_ms.simulation.world import World
from tests.worlds.fire_worlds import ORIGINAL, begin, room_world

CATEGORIES = ("book", "apple", "pan", "phone", "box", "vase", "key")
coordinate = st.floats(1.0, 3.0, width=32)
place = st.tuples(coordinate, coordinate, st.sampled_from([0.0, 0.4, 0.9]))
things = st.lists(st.tuples(st.sampled_from(CATEGORIES), place), min_size=1, max_size=12)
fires = st.lists(st.tuples(coordinate, coordinate), min_size=0, max_size=3)
presets = st.sampled_from(ORIGINAL).map(fire)
AS_FOUND = (Phase.explicit, Phase.reuse, Phase.generate)  # whole episodes are too slow to look for the smallest failure
quick = settings(max_examples=40, deadline=None)


def updates(preset: Fire, state: FireState, world: World, count: int) -> None:
    for _ in range(count):
        world.chance.frame += 5
        preset.advance(state, world, 0.01)


@settings(max_examples=60, deadline=None)
@given(
    preset=presets,
    things=things,
    fires=fires,
    # in a heap the room counts for little, and the bounds are nearly reached
    spacing=st.sampled_from([0.02, 0.3, 1.0]),
    start=st.lists(st.sampled_from([-40.0, 20.0, 500.0, 600.0, 900.0]), min_size=1, max_size=2),
)
def test_no_temperature_leaves_the_range_of_those_around(
    preset: Fire, things: list, fires: list, spacing: float, start: list[float]
) -> None:
    """F-10 of docs/physics.md."""
    world = room_world(
        things, [(2.0 + spacing * (x - 2.0), 2.0 + spacing * (y - 2.0)) for x, y in fires], agent=(2.0, 2.0)
    )
    world.position[:] = 2.0 + spacing * (world.position - 2.0)
    state = begin(preset, world)
    state.temperature[0] = torch.tensor([start[k % len(start)] for k in range(len(things))])
    state.agent_temperature[:] = start[0]
    low, high = min(20.0, *start, 20.0), max(600.0 if fires else 20.0, *start, 20.0)
    for _ in range(40):
        updates(preset, state, world, 1)
        high = 600.0 if high < 600.0 and bool((state.status == BURNING).any()) else high
        every = torch.cat([state.temperature[0], state.agent_temperature[0]])
        assert low <= every.min().item() and every.max().item() <= high


@quick
@given(preset=presets, things=things, fires=fires, order=st.randoms(use_true_random=False))
def test_shuffling_things_shuffles_results(preset: Fire, things: list, fires: list, order) -> None:
    """F-11 of docs/physics.md."""
    shuffle = list(range(len(things)))
    order.shuffle(shuffle)
    world = room_world(things, fires, size=(4.0, 4.0))
    shuffled = room_world([things[k] for k in shuffle], fires, size=(4.0, 4.0))
    state, other = begin(preset, world), begin(preset, shuffled)
    state.threshold[:] = other.threshold[:] = torch.inf  # ignition is a step: round-off could tip it
    start = torch.linspace(20.0, 400.0, len(things))
    state.temperature[0], other.temperature[0] = start, start[shuffle]
    updates(preset, state, world, 20)
    updates(preset, other, shuffled, 20)
    assert torch.allclose(state.temperature[0, shuffle], other.temperature[0], rtol=1e-6, atol=0.0)


@settings(max_examples=25, deadline=None, phases=AS_FOUND)
@given(preset=presets, things=things, fires=fires, order=st.permutations(range(5)))
def test_shuffling_environments_shuffles_results(preset: Fire, things: list, fires: list, order: list[int]) -> None:
    """F-11: Seeds and positions differ between the environments; each must give what it gives in any other place of the
    batch.
    """
    worlds = [room_world(things, fires, size=(4.0, 4.0), copies=5) for _ in range(2)]
    shift = 0.1 * torch.arange(5.0)
    ranks = (torch.arange(5), torch.tensor(order))
    states = []
    for world, rank in zip(worlds, ranks, strict=True):
        world.position[:, :, 0] += shift[rank, None]
        world.chance.seed[:] = rank
        states.append(begin(preset, world))
        updates(preset, states[-1], world, 4)
        world.chance.frame[:] = 130  # past the growth of the first flames
        updates(preset, states[-1], world, 16)
    for name, value in states[0].save().items():
        assert torch.equal(value[ranks[1]], getattr(states[1], name)), name


@settings(max_examples=12, deadline=None, phases=AS_FOUND)
@given(
    preset=presets.map(lambda preset: dataclasses.replace(preset, max_frames=900)),
    fires=st.lists(st.tuples(coordinate, coordinate), min_size=1, max_size=3),
    seed=st.integers(0, 2**32 - 1),
    holes=st.floats(0.0, 0.6),
    hole_seed=st.integers(0, 1000),
)
def test_flames_are_on_free_cells_beside_earlier_ones(
    preset: Fire, fires: list, seed: int, holes: float, hole_seed: int
) -> None:
    """F-27 of docs/physics.md."""
    world = room_world([], fires, size=(4.0, 4.0), copies=4)
    world.chance.seed += seed
    state = begin(preset, world)
    chance = torch.rand(state.free.shape, generator=torch.Generator().manual_seed(hole_seed))
    state.free &= chance > holes
    before = state.flame_cell.clone()
    for _ in range(90):
        world.chance.frame += 10
        preset.advance(state, world, 0.01)
        kept = before >= 0
        assert torch.equal(state.flame_cell[kept], before[kept])  # what burns, burns on
        before = state.flame_cell.clone()
    for e in range(4):
        check_family(state, e, len(fires))
        check_footprints(state, e, len(fires))


def check_family(state: FireState, e: int, first: int) -> None:
    """Later flames are on free cells of their own, beside one that burned earlier; nobody has more than 4 children."""
    window = state.free.shape[-1]
    cells = [c for c in state.flame_cell[e].tolist() if c >= 0]
    births = state.flame_birth[e].tolist()
    assert len(set(cells)) == len(cells)
    place = {c: (c // window**2, c // window % window, c % window) for c in cells}
    born = {place[c]: b for c, b in zip(cells, births, strict=False)}
    used = [bin(u).count("1") for u in state.flame_used[e].tolist()]
    assert all(u <= 4 for u in used)
    assert len(cells) - first <= sum(used)  # every later flame took a success
    for c in cells[first:]:
        s, i, j = place[c]
        assert bool(state.free[e, s, i, j])
        beside = [(s, i + 1, j), (s, i - 1, j), (s, i, j + 1), (s, i, j - 1)]
        assert any(born.get(n, 10**9) < born[s, i, j] for n in beside)
        assert born[s, i, j] % 10 == 1  # a frame after the attempt


def check_footprints(state: FireState, e: int, first: int) -> None:
    """No later flame overlaps any other: footprints are squares of 0.2 m."""
    count = int((state.flame_cell[e] >= 0).sum())
    middle = state.flame_place[e, :count, :2].double()
    apart = (middle[:, None] - middle[None]).abs().amax(-1)
    later = torch.arange(count) >= first
    pairs = later[:, None] & ~torch.eye(count, dtype=torch.bool)
    assert (apart[pairs] >= 0.2 - 1e-5).all()


def test_nothing_changes_in_a_cold_room() -> None:
    """Without a fire everything stays at exactly 20 C."""
    world = room_world([("book", (2.0, 2.0, 0.0)), ("pan", (2.1, 2.0, 0.0))], [])
    for preset in (fire("paper"), fire("shipped")):
        state = begin(preset, world)
        updates(preset, state, world, 100)
        assert (state.temperature == 20.0).all() and (state.agent_temperature == 20.0).all()
        assert not (state.status == BURNING).any() and (state.flame_cell < 0).all()
