"""Wind with a gust front: where and when it blows how, against the steady wind, and what it carries off."""

from __future__ import annotations

import math

import pytest
import torch
from torch import Tensor

from hazard_ms.hazards.presets import PRESETS, gale, wind
from hazard_ms.hazards.wind.gale import GUST_RATIO, TURN, Gale
from hazard_ms.hazards.wind.gale_state import GaleState
from hazard_ms.hazards.wind.wind import Wind
from hazard_ms.simulation.world import World
from tests.worlds.wind_worlds import STILL, Block, Thing, begin, street

SCENE = 4.0, 0.0  # wind of the scene [m/s]
FAST = 1.2  # 0.3 of it, in paper [m/s]
LAW = Gale(**STILL)
HOUSE = Block("house", (10.0, 8.0, 0.0), (2.0, 6.0, 3.0))
PLACES = torch.tensor([[[8.0, 8.0, 0.1], [3.0, 5.0, 0.1], [12.0, 13.0, 0.1], [8.0, 2.0, 0.1]]])


def started(law: Gale = LAW, things: tuple[Thing, ...] = (Thing(),), **more: object) -> tuple[GaleState, World]:
    world = street(things, SCENE, **more)  # type: ignore[arg-type]
    state = begin(law, world)
    assert isinstance(state, GaleState)
    return state, world


def angle(vector: Tensor) -> float:
    return math.atan2(float(vector[1]), float(vector[0]))


def test_it_doubles_and_turns_at_the_front() -> None:
    """Long before, 0.6 m/s along the scene's wind; long after, 1.2 m/s at 45 degrees or more from it."""
    state, world = started()
    before = LAW.velocity_at(state, world, PLACES)[0]
    assert torch.allclose(before, torch.tensor([[FAST / 2, 0.0]]).expand(4, 2), atol=1e-6)
    state.time += 1000.0
    after = LAW.velocity_at(state, world, PLACES)[0]
    assert torch.allclose(after.norm(dim=-1), torch.full((4,), FAST), atol=1e-6)
    assert torch.allclose(after, after[:1].expand(4, 2), atol=1e-6)
    assert TURN[0] - 1e-6 <= abs(angle(after[0])) <= TURN[1] + 1e-6


def test_the_front_is_a_line_that_moves_as_the_wind_behind_it_blows() -> None:
    """It is at the middle of the scene at its onset, and d metres farther on d / (1.2 m/s / 1.44) later."""
    state, world = started()
    way, pace = state.way[0], FAST / GUST_RATIO
    assert float(state.pace[0]) == pytest.approx(pace)
    across = torch.tensor([-float(way[1]), float(way[0])])
    for ahead, aside in ((0.0, 0.0), (3.0, 2.0), (-4.0, -5.0)):
        x, y = (8.0 + ahead * way + aside * across).tolist()
        point = torch.tensor([[[x, y, 0.1]]])
        for late, risen in ((-0.1, 0.0), (1.5, 0.5), (3.0, 1.0)):  # the wind rises in 3 s
            state.time[:] = state.onset + ahead / pace + late
            share = LAW.shares(state, world, point)[0, 0]
            assert float(share.sum()) == pytest.approx(1.0)
            assert float(share[0]) == pytest.approx(1.0 - risen, abs=1e-3)
        state.time[:] = state.onset + ahead / pace + 3.0 + 20.0  # half of 40 s in which it turns on
        assert LAW.shares(state, world, point)[0, 0].tolist() == pytest.approx([0.0, 0.5, 0.5], abs=1e-3)


def test_half_of_the_turn_comes_at_the_front() -> None:
    state, _ = started()
    first, middle, last = (angle(getattr(state, f"{name}_heading")[0]) for name in ("first", "middle", "last"))
    assert math.remainder(2.0 * (middle - first) - (last - first), 2.0 * math.pi) == pytest.approx(0.0, abs=1e-5)


@pytest.mark.parametrize("preset", PRESETS)
def test_before_and_after_it_pushes_as_a_steady_wind_does(preset: str) -> None:
    """A steady wind of half the speed, and one of the same speed from where it blows in the end."""
    law = gale(preset)
    things = (Thing(at=(7.0, 8.0, 0.0)), Thing(at=(12.5, 8.0, 0.0), extent=(0.1, 0.2, 0.02)))
    state, world = started(law, things, blocks=(HOUSE,))
    steady = Wind(**{**vars(wind(preset)), "sheltered": True})
    for late, name, factor in ((0.0, "first", 0.5), (1000.0, "last", 1.0)):
        state.time[:] = late
        heading = getattr(state, f"{name}_heading")[0].tolist()
        other = street(things, (4.0 * heading[0], 4.0 * heading[1]), blocks=(HOUSE,))
        fixed = begin(steady, other)
        fixed.speed *= factor
        for same in ("gust", "sway", "twist"):
            getattr(fixed, same).copy_(getattr(state, same))
        found, wanted = law.force(state, world, 0.01), steady.force(fixed, other, 0.01)
        assert float(wanted.force.abs().max()) > 0.0 and wanted.torque is not None and found.torque is not None
        assert torch.allclose(found.force, wanted.force, rtol=1e-4, atol=1e-6)
        assert torch.allclose(found.torque, wanted.torque, rtol=1e-4, atol=1e-6)


def test_a_lee_turns_with_the_wind() -> None:
    """East of the house is its lee as long as the wind blows to the east, and no more when it blows elsewhere."""
    state, world = started(blocks=(HOUSE,))
    behind = torch.tensor([[[12.0, 8.0, 0.1]]])
    assert float(LAW.speed_at(state, world, behind)) < 0.5 * FAST / 2
    state.time += 1000.0
    assert float(LAW.speed_at(state, world, behind)) > 0.7 * FAST
    x, y = (torch.tensor([10.0, 8.0]) + 4.3 * state.last_heading[0]).tolist()
    assert float(LAW.speed_at(state, world, torch.tensor([[[x, y, 0.1]]]))) < 0.8 * FAST


def test_the_air_that_is_shown_is_that_in_the_middle() -> None:
    state, world = started()
    middle = torch.tensor([[[8.0, 8.0, 0.0]]])
    for _ in range(1800):
        world.chance.tick()
        LAW.advance(state, world, 1 / 30)
        if world.chance.frame[0] % 300 == 0:
            assert torch.allclose(state.speed[:, None] * state.heading, LAW.velocity_at(state, world, middle)[:, 0])
    assert float(state.time[0]) == pytest.approx(60.0, rel=1e-4)


def test_the_front_shows_before_it_arrives() -> None:
    """What flies tells of the fastest air up to 4 m around the square, which the front reaches before its middle."""
    state, world = started()
    reach = 12.0 * float(state.way.abs().sum())  # along its way from the middle to the farthest corner [m]
    shown = []
    for late in (-reach / float(state.pace) - 2.0, -reach / float(state.pace) + 3.1):
        state.time[:] = state.onset + late - 1 / 30
        LAW.advance(state, world, 1 / 30)
        shown.append((float(state.speed), float(state.lifted)))
    assert shown[0] == pytest.approx((FAST / 2, FAST / 2)) and shown[1] == pytest.approx((FAST / 2, FAST))


def test_what_it_has_moved_from_its_place_is_carried_off() -> None:
    state, world = started(things=(Thing(), Thing(at=(5.0, 5.0, 0.0)), Thing(at=(6.0, 3.0, 0.0))))
    world.position[0, 0, 0] += 0.3
    world.position[0, 1, 0] += 0.2
    world.position[0, 2, 0] += 0.3
    world.safe[0, 2] = True
    assert LAW.carried_off(state, world)[0, :3].tolist() == [True, False, False]


def test_seeds_decide_the_front_and_rows_are_their_own() -> None:
    world = street((Thing(),), SCENE, copies=3)
    world.chance.restart(torch.arange(3), torch.tensor([1, 2, 1]))
    state = begin(LAW, world)
    onset, heading = state.onset, state.last_heading
    assert float(onset[0]) == float(onset[2]) != float(onset[1])
    assert torch.equal(heading[0], heading[2]) and not torch.equal(heading[0], heading[1])
    assert all(25.0 <= float(t) <= 50.0 for t in onset)
    before = onset.clone()
    world.chance.restart(torch.tensor([1]), torch.tensor([9]))
    LAW.reset(state, world, torch.tensor([1]))
    assert torch.equal(onset[[0, 2]], before[[0, 2]]) and float(onset[1]) != float(before[1])


def test_a_batch_is_pushed_as_each_scene_alone() -> None:
    """Two environments with other seeds, one before and one behind its front."""
    world = street((Thing(), Thing(at=(4.0, 5.0, 0.0))), SCENE, copies=2)
    world.chance.restart(torch.arange(2), torch.tensor([1, 2]))
    state = begin(LAW, world)
    assert isinstance(state, GaleState)
    state.time[:] = torch.tensor([1.0, 70.0])
    together = LAW.force(state, world, 0.01).force
    for e, seed in enumerate((1, 2)):
        one = street((Thing(), Thing(at=(4.0, 5.0, 0.0))), SCENE)
        one.chance.restart(torch.arange(1), torch.tensor([seed]))
        own = begin(LAW, one)
        assert isinstance(own, GaleState)
        own.time[:] = (1.0, 70.0)[e]
        assert torch.equal(LAW.force(own, one, 0.01).force[0], together[e])


def test_carts_alone_are_free() -> None:
    state, world = started(blocks=(Block("cart", (3.0, 3.0, 0.0), (0.5, 0.9, 1.0)), HOUSE))
    assert LAW.loosens(world.specs[0]) == {"block_0"}
    world.floats[0, 1] = True
    assert LAW.loose(state, world)[0].tolist() == [False, True, False]


@pytest.mark.parametrize("bad", [{"before": 0.0}, {"rise": 0.0}, {"turning": math.inf}, {"earliest": 60.0}])
def test_bad_parameters_are_refused(bad: dict[str, float]) -> None:
    with pytest.raises(ValueError, match=next(iter(bad))):
        Gale(**bad)
