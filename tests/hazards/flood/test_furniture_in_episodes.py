"""Furniture that floats in whole episodes of the simulator: what stands, what goes, and what is put back."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import gymnasium as gym
import pytest
import torch
from sapien.physx import PhysxRigidDynamicComponent, PhysxRigidStaticComponent

import hazard_ms  # noqa: F401 registers the environments
from hazard_ms.simulation import clearance
from hazard_ms.simulation.world import rotate

SCENE = "kitchen_a/00"


def episode(physics: str, **more: str) -> Any:
    made = gym.make("HazardFlood-v1", physics=physics, render_backend="none", obs_mode="none", **more)
    made.reset(seed=0, options={"scene": SCENE})
    return made


@pytest.fixture(scope="module")
def extreme() -> Iterator[Any]:
    made = episode("realistic", severity="extreme")
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
    extreme.reset(seed=0, options={"scene": SCENE})
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


def test_a_saved_state_replays_and_a_reset_puts_everything_back(extreme: Any) -> None:
    base = extreme.unwrapped
    world = base.world
    if not base.episode.states["flood"].afloat.any():
        pytest.fail("the test before leaves furniture afloat")
    saved = base.get_state_dict()

    def play() -> tuple[torch.Tensor, torch.Tensor]:
        for _ in range(30):
            extreme.step(None)
        return world.position.clone(), world.movable.clone()

    base.set_state_dict(saved)
    one = play()
    base.set_state_dict(saved)
    two = play()
    assert torch.equal(one[1], two[1])
    assert float((one[0] - two[0]).abs().max()) < 2e-3
    extreme.reset(seed=0, options={"scene": SCENE})
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
    """The pillows of the sofa: none hangs in the air where it was."""
    extreme.reset(seed=0, options={"scene": SCENE})
    base = extreme.unwrapped
    world, state = base.world, base.episode.states["flood"]
    sofa = world.index(0, "sofa_1")
    offset = rotate(world.rotation[0, sofa], world.position[0] - world.position[0, sofa], back=True)
    half = 0.5 * world.extent[0, sofa]
    on = (offset[:, :2].abs() < half[:2]).all(-1) & (offset[:, 2] > 0.0) & world.movable[0] & world.exists[0]
    on = on.nonzero().flatten().tolist()
    assert on
    start = world.position[0, on].clone()
    for _ in range(500):
        extreme.step(None)
    assert bool(state.afloat[0, sofa])
    assert ((world.position[0, on] - start).norm(dim=-1) > 0.02).all()
