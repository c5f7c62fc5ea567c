"""The contract of hazards, for every hazard and preset there is: the three verbs keep to what hazards.base says of
them.
"""

from __future__ import annotations

import dataclasses
from typing import Any

import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st

from hazard_ms.hazards import presets
from hazard_ms.hazards.base import DTYPES, Hazard, State, quantity, summed
from hazard_ms.robots.fetch import HazardFetch
from hazard_ms.simulation.world import World
from hazard_ms.spec.registry import HAZARDS
from hazard_ms.tasks.episode.grasp import Hand
from hazard_ms.tasks.episode.records import Damage, Rescue
from tests.worlds.fire_worlds import room_world

EVERY = [(name, preset) for name in HAZARDS for preset in presets.PRESETS]
ENVIRONMENTS = 4


@pytest.fixture(params=EVERY, ids=["-".join(p) for p in EVERY])
def hazard(request: pytest.FixtureRequest) -> Hazard:
    name, preset = request.param
    return presets.hazard(name, preset)


def scene(copies: int = ENVIRONMENTS) -> World:
    things = [
        (c, (1.6 + 0.2 * k, 1.8 + 0.1 * k, 0.0)) for k, c in enumerate(["book", "pan", "apple", "phone", "vase", "box"])
    ]
    table = ((2.6, 2.6, 0.0), (0.6, 0.6, 0.7), 0.3)
    world = room_world(things, [(1.5, 1.5), (2.4, 1.9)], [table], (4.0, 4.0), copies, (2.0, 1.6))
    world.agent_build = HazardFetch.build
    return world


def begin(hazard: Hazard, world: World) -> Any:
    state = hazard.state_type.allocate(
        {"E": world.num_envs, "B": world.num_bodies, **hazard.sizes(world)}, world.device
    )
    hazard.reset(state, world, torch.arange(world.num_envs))
    return state


def run(hazard: Hazard, state: Any, world: World, frames: int) -> None:
    for _ in range(frames):
        world.chance.tick()
        hazard.advance(state, world, 1 / 30)


def tensors(world: World) -> dict[str, torch.Tensor]:
    made = {
        f.name: getattr(world, f.name)
        for f in dataclasses.fields(world)
        if isinstance(getattr(world, f.name), torch.Tensor)
    }
    return {k: v.clone() for k, v in made.items()} | {
        "seed": world.chance.seed.clone(),
        "frame": world.chance.frame.clone(),
    }


def assert_same(a: dict[str, torch.Tensor], b: dict[str, torch.Tensor]) -> None:
    assert a.keys() == b.keys()
    for name in a:
        assert torch.equal(a[name], b[name]), name


def test_every_quantity_is_declared(hazard: Hazard) -> None:
    world = scene()
    state = begin(hazard, world)
    sizes = {"E": ENVIRONMENTS, "B": world.num_bodies, **hazard.sizes(world)}
    for f in dataclasses.fields(state):
        assert f.metadata["meaning"], f.name
        shape = [int(a) if a.isdigit() else sizes[a] for a in f.metadata["shape"]]
        assert list(getattr(state, f.name).shape) == shape, f.name
        assert getattr(state, f.name).dtype == DTYPES[f.metadata["dtype"]], f.name


def test_parameters_are_frozen(hazard: Hazard) -> None:
    with pytest.raises(dataclasses.FrozenInstanceError):
        hazard.name_of_nothing = 1  # type: ignore[attr-defined]


def test_something_happens(hazard: Hazard) -> None:
    """Else the tests below would show nothing."""
    world = scene()
    state = begin(hazard, world)
    before = state.save()
    run(hazard, state, world, 300)
    assert any(not torch.equal(before[k], v) for k, v in state.save().items())
    assert hazard.damaged(state, world).any() == (hazard.name != "wind")  # wind damages nothing


def test_looking_changes_nothing_and_advancing_only_its_state(hazard: Hazard) -> None:
    world = scene()
    state = begin(hazard, world)
    run(hazard, state, world, 150)
    around, own = tensors(world), state.save()
    hazard.force(state, world, 0.01)
    hazard.damaged(state, world)
    points = torch.rand(ENVIRONMENTS, 5, 3)
    assert hazard.image(state, world, points).shape == (ENVIRONMENTS, 5)
    assert hazard.forbids(state, world, points).shape == (ENVIRONMENTS, 5)
    assert all(v.shape == (ENVIRONMENTS,) for v in hazard.agent_info(state, world).values())
    assert_same(state.save(), own)
    hazard.advance(state, world, 1 / 30)
    assert_same(tensors(world), around)


def test_a_reset_of_some_rows_touches_no_other(hazard: Hazard) -> None:
    world = scene()
    state, fresh = begin(hazard, world), begin(hazard, scene()).save()
    run(hazard, state, world, 203)  # not a whole number of any hazard's updates
    before, rows, others = state.save(), torch.tensor([1, 3]), torch.tensor([0, 2])
    world.chance.restart(rows, torch.tensor([1, 3]))
    state.clear(rows)
    hazard.reset(state, world, rows)
    for name, value in state.save().items():
        assert torch.equal(value[others], before[name][others]), name
        assert torch.equal(value[rows], fresh[name][rows]), name
    run(hazard, state, world, 180)  # environments at different frames go on as they would alone
    assert_rows_as_alone(hazard, state, rows, 180)
    assert_rows_as_alone(hazard, state, others, 383)


def assert_rows_as_alone(hazard: Hazard, state: Any, rows: torch.Tensor, frames: int) -> None:
    """That `rows` are as in a batch where nothing was ever reset, after `frames`."""
    world = scene()
    undisturbed = begin(hazard, world)
    run(hazard, undisturbed, world, frames)
    for name, value in undisturbed.save().items():
        assert torch.equal(value[rows], getattr(state, name)[rows]), name


def test_restoring_a_state_restores_the_future(hazard: Hazard) -> None:
    world = scene()
    state = begin(hazard, world)
    run(hazard, state, world, 160)
    saved, frame = state.save(), world.chance.frame.clone()
    run(hazard, state, world, 200)
    first = state.save()
    state.restore(saved)
    world.chance.frame[:] = frame
    run(hazard, state, world, 200)
    assert_same(state.save(), first)


@settings(max_examples=10, deadline=None)
@given(seeds=st.lists(st.integers(0, 2**32 - 1), min_size=2, max_size=5, unique=True), choice=st.sampled_from(EVERY))
def test_an_episode_is_the_same_alone_and_in_a_batch(seeds: list[int], choice: tuple[str, str]) -> None:
    hazard = presets.hazard(*choice)
    together = scene(len(seeds))
    together.chance.seed[:] = torch.tensor(seeds)
    state = begin(hazard, together)
    run(hazard, state, together, 200)
    alone = scene(1)
    alone.chance.seed[:] = seeds[-1]
    single = begin(hazard, alone)
    run(hazard, single, alone, 200)
    for name, value in single.save().items():
        assert torch.equal(value[0], getattr(state, name)[-1]), name


@pytest.mark.parametrize("name", HAZARDS)
@pytest.mark.parametrize("bad", ["realistic_", "", "PAPER"])
def test_an_unknown_preset_is_refused_by_name(name: str, bad: str) -> None:
    with pytest.raises(ValueError, match="paper, shipped") as error:
        presets.hazard(name, bad)
    assert repr(bad) in str(error.value)


def test_presets_differ_in_parameters_only() -> None:
    """But for the realistic fire, which shares no law with the original's."""
    for name in HAZARDS:
        paper, shipped = (presets.hazard(name, preset) for preset in ("paper", "shipped"))
        assert type(paper) is type(shipped) and paper != shipped


@pytest.mark.parametrize("kind", [Damage, Rescue, Hand])
def test_records_clear_save_and_restore(kind: type[State]) -> None:
    state = kind.allocate({"E": 3, "B": 2}, "cpu")
    fresh = state.save()
    for f in dataclasses.fields(state):
        getattr(state, f.name)[:] = 1
    saved = state.save()
    state.clear(torch.tensor([0, 2]))
    for name, value in state.save().items():
        assert torch.equal(value[[0, 2]], fresh[name][[0, 2]]) and torch.equal(value[1], saved[name][1])
    state.restore({k: v[[0]] for k, v in saved.items()}, torch.tensor([2]))
    assert torch.equal(getattr(state, next(iter(saved)))[2], saved[next(iter(saved))][0])


def test_a_wrong_declaration_is_refused() -> None:
    with pytest.raises(ValueError, match="must begin with the axis E, got 'B 3'"):
        quantity("B 3", "m", "place")
    with pytest.raises(ValueError, match="must be one of float, int, bool, got 'double'"):
        quantity("E", "m", "place", dtype="double")
    with pytest.raises(ValueError, match="'extra'"):
        Damage.allocate({"E": 1, "B": 1}, "cpu").restore({"extra": torch.zeros(1)})


@pytest.mark.parametrize(
    ("field", "value"),
    [
        ("decay", 0.0),
        ("decay", 1.0),
        ("reach", -1.0),
        ("nearest", 0.0),
        ("image_room_weight", 0.0),
        ("heat_every", 0),
        ("heat_every", 4),
        ("max_frames", 0),
    ],
)
def test_impossible_parameters_are_refused_by_name(field: str, value: float) -> None:
    with pytest.raises(ValueError, match=f"{field} must be .*, got {value}"):
        dataclasses.replace(presets.fire("paper"), **{field: value})


def test_one_push_on_all_bodies_is_not_copied_and_any_other_is() -> None:
    like = torch.zeros(2, 3, 3)
    alone = torch.rand(2, 3, 3)
    assert summed([alone], like) is alone
    for other in (torch.rand(1, 3, 3), alone.double(), torch.rand(2, 3, 6)[..., ::2], alone.clone().requires_grad_()):
        made = summed([other], like)
        assert made is not other and made.is_contiguous() and not made.requires_grad
        assert made.dtype == like.dtype and torch.equal(made, other.detach().float().expand_as(like))
    assert torch.equal(summed([alone, like + 1.0], like), alone + 1.0)
