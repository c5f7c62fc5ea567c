"""The temperatures that a fire's images tell, and the flames that its updates look at."""

from __future__ import annotations

import pytest
import torch

from hazard_ms.hazards.fire.fire import Fire
from hazard_ms.hazards.fire.fire_state import some_flames
from hazard_ms.simulation.world import World
from tests.worlds.fire_worlds import begin, repeat, room_world, run


def crowded(copies: int = 1) -> World:
    """A room of 24 things with two fires."""
    things = [
        (("book", "pan", "apple", "phone")[k % 4], (8.0 + 0.3 * (k % 7), 8.0 + 0.4 * (k // 7), 0.0)) for k in range(24)
    ]
    return repeat(room_world(things, [(8.5, 8.5), (9.5, 9.1)], agent=(8.0, 9.0)), copies)


def test_images_are_means_of_all_sources_weighted_by_distance(preset: Fire) -> None:
    """Worked out in double precision, 400 frames into a fire, for an apple that is safe and a box that leans over."""
    world = crowded(2)
    state = begin(preset, world)
    run(preset, state, world, 400)
    world.safe[:, 2] = True
    world.rotation[1, 3] = torch.tensor([0.8, 0.6, 0.0, 0.0])
    points = torch.rand(2, 50, 3, generator=torch.Generator().manual_seed(0)) * 3.0 + torch.tensor([8.0, 8.0, 0.0])
    seen = preset.image(state, world, points).double()
    for e in range(2):
        burns = ((state.flame_cell[e] >= 0) & (state.flame_birth[e] <= world.frame[e])).nonzero()[:, 0]
        there = (world.exists[e] & ~world.safe[e]).nonzero()[:, 0]
        base = world.base_of(world.position[e], world.rotation[e], world.extent[e])
        place = torch.cat([base[there], world.agent_position[e][None], state.flame_place[e, burns]]).double()
        heat = [*state.temperature[e, there].tolist(), float(state.agent_temperature[e]), *[600.0] * len(burns)]
        apart = (points[e].double()[:, None] - place).norm(dim=-1)
        weight = (preset.reach / apart.clamp(min=preset.nearest)) ** 2
        room = preset.image_room_weight
        wanted = (weight @ torch.tensor(heat).double() + room * 20.0) / (weight.sum(1) + room)
        assert len(burns) > 4 and torch.allclose(seen[e], wanted, rtol=1e-5)


def test_the_rest_of_the_roster_changes_no_bit(preset: Fire, monkeypatch: pytest.MonkeyPatch) -> None:
    one, other = crowded(), crowded()
    states = []
    for world, count in ((one, some_flames), (other, lambda state: state.flame_cell.shape[1])):
        monkeypatch.setattr("hazard_ms.hazards.fire.fire.some_flames", count)
        state = begin(preset, world)
        run(preset, state, world, 600)
        states.append(state)
    short, whole = states
    assert some_flames(short) < short.flame_cell.shape[1] - 3 and int((short.flame_cell >= 0).sum()) > 6
    for name, value in short.save().items():
        assert torch.equal(value, getattr(whole, name)), name


def test_an_image_stays_when_another_is_made(preset: Fire) -> None:
    world = crowded()
    state = begin(preset, world)
    near, far = torch.tensor([[[8.5, 8.5, 0.3]]]), torch.tensor([[[1.0, 1.0, 0.3]]])
    first = preset.image(state, world, near)
    kept = float(first)
    assert float(preset.image(state, world, far)) < kept == float(first)
