"""Furniture that floats in whole episodes of the simulator: what stands, what goes, and what is put back."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import gymnasium as gym
import numpy as np
import pytest
import torch
from sapien.physx import PhysxRigidDynamicComponent, PhysxRigidStaticComponent

import hazard_ms  # noqa: F401 registers the environments
from hazard_ms.scenes.splits import scene
from hazard_ms.simulation import clearance
from hazard_ms.simulation.world import rotate
from hazard_ms.sketch.recording import record
from hazard_ms.tasks.flood import hazard_flood

SCENE = "kitchen_a/00"


def episode(physics: str, **more: Any) -> Any:
    made = gym.make("HazardFlood-v1", physics=physics, render_backend="none", obs_mode="none", **more)
    made.reset(seed=0, options={"scene": SCENE})
    return made


@pytest.fixture(scope="module")
def extreme() -> Iterator[Any]:
    made = episode("realistic", severity="extreme", reconfiguration_freq=0)
    yield made
    made.close()


def fixtures(env: Any) -> dict[str, Any]:
    base = env.unwrapped
    n = len(base.specs[0].bodies)
    return dict(zip(base.world.names[0][n:], base.actors[0][n:], strict=True))


def test_only_furniture_that_can_float_is_built_to_move(extreme: Any) -> None:
    world = extreme.unwrapped.world
    moving = {
        name for name, a in fixtures(extreme).items() if a._objs[0].find_component_by_type(PhysxRigidDynamicComponent)
    }
    assert moving == {world.names[0][b] for b in world.floats[0].nonzero().flatten().tolist()}
    assert {"sofa_1", "fridge_1", "table_1"} <= moving
    assert all(not name.startswith(("counter", "stove", "sink", "lamp", "picture")) for name in moving)


@pytest.mark.parametrize("physics", ["paper", "shipped"])
def test_nothing_floats_off_in_paper_and_shipped(physics: str) -> None:
    env = episode(physics)
    assert not env.unwrapped.world.floats.any()
    for actor in fixtures(env).values():
        assert actor._objs[0].find_component_by_type(PhysxRigidStaticComponent) is not None
    env.close()


def test_what_stands_stays_exactly_and_what_floats_lies_as_deep_as_its_weight(extreme: Any) -> None:
    extreme.reset(seed=0)
    base = extreme.unwrapped
    world, state = base.world, base.episode.states["flood"]
    start, built = world.position.clone(), world.floats[0].nonzero().flatten().tolist()
    for _ in range(500):
        *_, info = extreme.step(None)
    assert not bool(info["sim_error"])
    moved = (world.position - start)[0].norm(dim=-1)
    afloat = state.afloat[0]
    assert torch.equal(world.movable[0] & world.floats[0], afloat & world.floats[0])
    stands = [b for b in built if not afloat[b]]
    assert afloat.sum() >= 2 and stands and all(float(moved[b]) == 0.0 for b in stands)
    sofa = world.index(0, "sofa_1")
    assert bool(afloat[sofa]) and float(moved[sofa]) > 0.1
    lifted = float(state.volume[0, sofa] * state.fraction[0, sofa]) * 1000.0
    assert lifted == pytest.approx(float(world.mass[0, sofa]), rel=0.5)  # it carries pillows, and leans on things
    points = world.position[0, sofa, :2][None]
    assert bool(clearance.in_the_way(world, 0, points, 0.29)[0, sofa])
    before = start[0, sofa, :2][None] + (start[0, sofa, :2] - world.position[0, sofa, :2]) * 2.0
    assert not bool(clearance.in_the_way(world, 0, before, 0.29)[0, sofa])


def test_a_saved_state_goes_on_and_a_reset_puts_everything_back(extreme: Any) -> None:
    base = extreme.unwrapped
    world = base.world
    for _ in range(0 if base.episode.states["flood"].afloat.any() else 350):
        extreme.step(None)
    assert base.episode.states["flood"].afloat.any()
    saved = base.get_state_dict()

    there, loose = world.position.clone(), world.movable.clone()
    places = []
    for _ in range(2):
        base.set_state_dict(saved)
        assert float((world.position - there).abs().max()) < 1e-5 and torch.equal(world.movable, loose)
        extreme.step(None)
        places.append(world.position.clone())
    assert float((places[0] - places[1]).abs().max()) < 2e-3  # PhysX forgets the contacts of what is in motion
    extreme.reset(seed=0)
    assert not (world.movable & world.floats).any()
    for name, actor in fixtures(extreme).items():
        spec = next(f for f in base.specs[0].fixtures if f.name == name)
        assert actor._objs[0].pose.p.tolist() == pytest.approx(list(spec.position), abs=1e-6)
    start = world.position.clone()
    for _ in range(20):
        extreme.step(None)
    still = world.floats[0] & ~base.episode.states["flood"].afloat[0]
    assert still.any() and torch.equal(world.position[0, still], start[0, still])


def test_what_stands_on_a_piece_goes_with_it_or_falls(extreme: Any) -> None:
    """None hangs in the air where it was."""
    extreme.reset(seed=0)
    base = extreme.unwrapped
    world, state = base.world, base.episode.states["flood"]
    start = world.position[0].clone()
    pairs = []
    for piece in world.floats[0].nonzero().flatten().tolist():
        turn = world.rotation[0, piece].expand(world.num_bodies, 4)
        offset = rotate(turn, start - start[piece], back=True)
        half = 0.5 * world.extent[0, piece]
        on = (offset[:, :2].abs() < half[:2]).all(-1) & (offset[:, 2] > half[2]) & world.movable[0]
        pairs += [(piece, b) for b in on.nonzero().flatten().tolist()]
    for _ in range(700):
        extreme.step(None)
    moved = (world.position[0] - start).norm(dim=-1)
    gone = [(piece, b) for piece, b in pairs if bool(state.afloat[0, piece]) and float(moved[piece]) > 0.2]
    assert len(gone) >= 2
    assert all(float(moved[b]) > 0.05 for _, b in gone)


def test_the_same_seed_gives_the_same_episode() -> None:
    env, places = episode("realistic", severity="extreme"), []
    for _ in range(2):
        env.reset(seed=3, options={"scene": SCENE})
        for _ in range(300):
            env.step(None)
        places.append(env.unwrapped.world.position.clone())
    assert env.unwrapped.episode.states["flood"].afloat.any() and torch.equal(*places)
    env.close()


def test_recorded_floods_float_the_same_furniture() -> None:
    """Timelines, which the sketch and `hazard-ms danger` read, have the sofas of 0.1 to 0.2 m adrift."""
    task, spec = hazard_flood("realistic", "extreme"), scene("living_room_a/03")
    (line,) = record(task, "realistic", (spec,), (3,), 240)
    sofas = [k for k, thing in enumerate(spec.things) if thing.category == "sofa"]
    moved = np.linalg.norm(line.position_at(240) - line.position_at(0), axis=-1)
    assert moved[sofas].max() > 0.1
