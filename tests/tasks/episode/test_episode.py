"""Episodes without a simulator: beginning, pushing, damage, rescue and faults; calls that a simulator would get."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
import torch

from hazard_ms.hazards.base import Hazard, Push, State
from hazard_ms.hazards.fire.fire import Fire
from hazard_ms.simulation.world import World
from hazard_ms.tasks.episode.episode import Episode
from hazard_ms.tasks.episode.safe_places import CART
from tests.worlds.fire_worlds import room_world
from tests.worlds.lifting import Lift, Simulator, Sink

FRAME = 1 / 30  # [s]
HERE = (torch.zeros(1, 3), torch.tensor([[1.0, 0.0, 0.0, 0.0]]))  # a gripper that is away from everything
QPOS = torch.zeros(2, 15)


def books(copies: int = 1) -> World:
    """Three books on the floor, 2 m apart, and a table. Books are the targets."""
    places = [("book", (10.0 + 2.0 * k, 10.0, 0.0)) for k in range(3)]
    return room_world(places, (), [((10.0, 14.0, 0.0), (1.0, 1.0, 0.7), 0.0)], copies=copies)


def begun(world: World, *hazards: Hazard, handles: Simulator | None = None) -> Episode:
    world.handles = handles
    episode = Episode(world, hazards)
    rows = torch.arange(world.num_envs)
    episode.begin(rows, rows + 7)
    episode.begin_hazards(rows)
    return episode


def test_every_record_is_a_part() -> None:
    """Snapshots save `parts`: a record that is missing there is lost."""
    episode = begun(books(), Fire(), Lift())
    assert set(episode.parts) == {"fire", "lift", "damage", "rescue", "hand"}
    held = {id(v) for v in vars(episode).values() if isinstance(v, State)} | {id(s) for s in episode.states.values()}
    assert held == {id(part) for part in episode.parts.values()}


def test_begin_clears_its_rows_and_no_other() -> None:
    world = books(copies=3)
    episode = begun(world, Fire(), Lift(hits=0))
    start = world.position.clone()
    for _ in range(4):
        episode.advance(FRAME)
    world.position += 1.0
    world.velocity += 2.0
    world.held[:, 1] = world.safe[:, 2] = world.away[:, 2] = True
    episode.sim_error[:] = True
    for part in episode.parts.values():
        for value in vars(part).values():
            value[:] = 1
    episode.begin(torch.tensor([1]), torch.tensor([99]))
    episode.begin_hazards(torch.tensor([1]))
    assert world.chance.seed.tolist() == [7, 99, 9] and world.frame.tolist() == [4, 0, 4]
    assert episode.sim_error.tolist() == [True, False, True]
    assert world.held.any(1).tolist() == world.safe.any(1).tolist() == world.away.any(1).tolist() == [True, False, True]
    assert torch.equal(world.position[1], start[1]) and torch.equal(world.position[::2], start[::2] + 1.0)
    assert (world.velocity[1] == 0.0).all() and (world.velocity[::2] == 2.0).all()
    fresh = begun(books(copies=3), Fire(), Lift(hits=0))
    for name, part in episode.parts.items():
        for key, value in vars(part).items():
            assert torch.equal(value[1], vars(fresh.parts[name])[key][1]), (name, key)
            assert (value[::2] == 1).all(), (name, key)


def test_forces_add_up_and_are_sent_once_to_what_is_free() -> None:
    """3 N and -1 N make 2 N on every body; the held book, the safe one and the table get none."""
    world, simulator = books(), Simulator()
    episode = begun(world, Lift(3.0, torque=0.5), Sink(-1.0), handles=simulator)
    world.held[0, 0] = world.safe[0, 1] = True
    simulator.told.clear()
    episode.push(1 / 120)
    assert [name for name, _ in simulator.told] == ["read", "push"]
    force, torque = simulator.of("push")[0]
    assert force[0].tolist() == [[0.0] * 3, [0.0] * 3, [0.0, 0.0, 2.0], [0.0] * 3]
    assert torque[0].tolist() == [[0.0] * 3, [0.0] * 3, [0.0, 0.0, 0.5], [0.0] * 3]


@pytest.mark.parametrize("shape", [(1, 1, 3), (3, 1, 3), (1, 4, 3), (4, 3)])
@pytest.mark.parametrize("dtype", [torch.float32, torch.float64])
def test_a_push_may_have_fewer_numbers_that_hold_for_all(shape: tuple[int, ...], dtype: torch.dtype) -> None:
    """1 N on every body of three environments, by a hazard that says so once."""

    class Shove(Lift):
        def force(self, state: State, world: World, dt: float) -> Push:
            return Push(torch.ones(shape, dtype=dtype), 2 * torch.ones(shape, dtype=dtype))

    world, simulator = books(copies=3), Simulator()
    episode = begun(world, Shove(), handles=simulator)
    world.held[:, 0] = True
    episode.push(1 / 120)
    force, torque = simulator.of("push")[-1]
    free = world.movable & ~world.held
    assert torch.equal(force, free[..., None].expand(3, 4, 3).float()) and torch.equal(torque, 2 * force)


def test_hazards_without_forces_cost_no_reading() -> None:
    simulator = Simulator()
    episode = begun(books(), Fire(), handles=simulator)
    simulator.told.clear()
    episode.push(1 / 120)
    assert simulator.told == []


def test_advance_ticks_before_the_hazards_and_keeps_the_first_damage() -> None:
    episode = begun(books(), Lift(hits=1), Sink(hits=2))
    for frame in (1, 2, 3):
        episode.advance(FRAME)
        assert episode.states["lift"].advanced_at.tolist() == [frame] == episode.states["sink"].advanced_at.tolist()
    assert episode.damage.damaged[0].tolist() == [False, True, True, False]
    assert episode.damage.frame[0].tolist() == [-1, 1, 1, -1]


def test_fire_damages_at_the_frame_of_ignition() -> None:
    """Near a flame a book warms towards (20 + 600) / 2 = 310 C: 310 - 290 * 0.97^n is 200 C at n = 32, frame 160."""
    world = room_world([("book", (10.0, 10.0, 0.0)), ("pan", (1000.0, 10.0, 0.0))], [(10.5, 10.0)])
    episode = begun(world, Fire())
    episode.states["fire"].flame_used[:] = 15  # it stays alone
    for _ in range(200):
        episode.advance(FRAME)
    assert episode.damage.frame[0].tolist() == [160, -1]


@pytest.mark.parametrize(("rescue_at", "damaged"), [(1, False), (2, True)])
def test_a_rescue_is_worth_what_was_left_of_it(rescue_at: int, damaged: bool) -> None:
    """Book 0 is damaged in frame 2; a rescue before that keeps it whole for ever."""
    world = books()
    episode = begun(world, Lift(hits=0))
    episode.hand.held[0], episode.hand.closed[0], world.held[0, 0] = 0, True, True
    episode.states["lift"].advanced_at[:] = 0
    for frame in (1, 2, 3):
        if frame == 1:
            world.chance.tick()  # a frame in which nothing is damaged yet
        else:
            episode.advance(FRAME)
        episode.use_hand(HERE, torch.tensor([frame < rescue_at]), lambda: HERE[0])
    assert episode.rescue.frame[0, 0] == rescue_at and bool(episode.rescue.damaged[0, 0]) == damaged
    assert bool(episode.damage.damaged[0, 0]) == damaged and world.safe[0].tolist() == [True, False, False, False]


def test_the_simulator_is_told_what_to_keep_in_place_and_when_no_more() -> None:
    world, simulator = books(), Simulator()
    episode = begun(world, handles=simulator)
    gripper = (torch.tensor([[10.0, 10.0, 0.01]]), HERE[1])
    away = torch.full((1, 3), 50.0)
    for shut, want in ((False, []), (True, [[0]]), (True, [[0]]), (False, [[]]), (False, [])):
        simulator.told.clear()
        episode.use_hand(gripper, torch.tensor([shut]), lambda: away)
        assert [frozen[0].nonzero().flatten().tolist() for frozen, _ in simulator.of("freeze")] == want


def test_a_new_episode_frees_what_was_held_or_safe() -> None:
    """The simulator learns that nothing is frozen, then where everything is; the rescued book is back in its place."""
    world, simulator = books(), Simulator()
    episode = begun(world, handles=simulator)
    world.safe[0, 1] = world.away[0, 1] = True
    episode.freeze(HERE)
    assert simulator.of("freeze")[-1][1][0, 1].tolist() == pytest.approx([12.0, 10.0, -10.0])
    world.position[0, 1, 2] = -9.99
    simulator.told.clear()
    episode.begin(torch.arange(1), torch.arange(1))
    assert [name for name, _ in simulator.told] == ["freeze", "place"]
    assert not simulator.of("freeze")[0][0].any()
    assert simulator.of("place")[0][0, 1].tolist() == pytest.approx([12.0, 10.0, 0.0], abs=1e-6)


def test_what_lies_in_a_cart_is_rescued_and_stays_in_the_scene() -> None:
    """The books are 2 m apart; a cart stands around the middle one. A held one over the basket is not rescued yet."""
    world, simulator = books(), Simulator()
    spec = world.specs[0]
    world.specs = (replace(spec, fixtures=(replace(spec.fixtures[0], category="cart"),)),)
    world.position[0, 3], world.extent[0, 3] = torch.tensor([12.0, 10.0, 0.0]), torch.tensor([0.6, 0.9, 1.0])
    world.handles = simulator
    episode = Episode(world, (), CART)
    episode.begin(torch.arange(1), torch.arange(1))
    world.position[0, 3], world.extent[0, 3] = torch.tensor([12.0, 10.0, 0.0]), torch.tensor([0.6, 0.9, 1.0])
    world.held[0, 1] = True
    episode.hand.held[:] = 1
    episode.hand.closed[:] = True
    gripper = (world.position[:, 1].clone(), HERE[1])
    episode.use_hand(gripper, torch.tensor([True]), lambda: HERE[0])
    assert not episode.rescue.safe.any()
    episode.use_hand(gripper, torch.tensor([False]), lambda: HERE[0])
    assert episode.rescue.safe[0].tolist() == world.safe[0].tolist() == [False, True, False, False]
    assert not world.away.any() and not simulator.of("freeze")[-1][0].any()


def nan(world: World) -> None:
    world.position[1, 0, 1] = torch.nan


def fast(world: World) -> None:
    world.velocity[1, 2] = torch.tensor([0.0, 51.0, 0.0])


def lost(world: World) -> None:
    world.position[1, 1, 0] = 25.5  # the room is 20 m long, 5 m more are tolerated


@pytest.mark.parametrize("breach", [nan, fast, lost])
def test_a_breach_is_noted_for_its_own_row_and_dumped_once(
    breach: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("HAZARD_MS_DUMPS", str(tmp_path))
    world = books(copies=2)
    episode = begun(world, Lift())
    episode.watch(QPOS)
    assert not episode.sim_error.any() and not list(tmp_path.iterdir())
    breach(world)
    episode.watch(QPOS)
    episode.watch(QPOS)
    assert episode.sim_error.tolist() == [False, True]
    (dump,) = tmp_path.iterdir()
    told = json.loads(dump.read_text())
    assert told["seed"] == 8 and len(told["states"]) == 2 and told["names"] == list(world.names[1])


def test_a_broken_robot_is_a_breach_but_what_waits_below_is_none(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("HAZARD_MS_DUMPS", str(tmp_path))
    world = books(copies=2)
    episode = begun(world, Lift())
    world.away[0, 0], world.held[0, 1] = True, True
    world.position[0, :2, 2] = -10.0
    qpos = QPOS.clone()
    qpos[1, 4] = torch.nan
    episode.watch(qpos)
    assert episode.sim_error.tolist() == [False, True]


def test_forbidden_is_what_any_hazard_forbids() -> None:
    episode = begun(books(), Lift(edge=2.0), Sink(edge=5.0))
    points = torch.tensor([[[1.0, 0.0, 0.0], [3.0, 0.0, 0.0], [6.0, 0.0, 0.0]]])
    assert episode.forbidden(points).tolist() == [[False, True, True]]
