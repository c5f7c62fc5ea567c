"""What the oracle takes to be at stake in a gale, and what that and the lee make of the problem of a rescue."""

from __future__ import annotations

from collections.abc import Iterator
from types import SimpleNamespace
from typing import Any

import gymnasium as gym
import numpy as np
import pytest

import hazard_ms  # noqa: F401 registers the environments
from hazard_ms.agents.gale.truth import GaleTruth, hazard_of
from hazard_ms.sketch.rescue_problem import Outset, RescueScene
from hazard_ms.sketch.timeline import Timeline

LIMIT = 3000


@pytest.fixture
def base() -> Iterator[Any]:
    env = gym.make("HazardGale-v1", obs_mode="none", render_backend="none", control_mode="pd_joint_pos", split="test")
    env.reset(seed=4)
    yield env.unwrapped
    env.close()


def truth(base: Any, mitigate: bool = True) -> GaleTruth:
    hazard = hazard_of(base)
    assert hazard is not None
    return GaleTruth(base, hazard, RescueScene(base.specs[0], "fetch", 0.29, LIMIT), mitigate)


def record(base: Any, blown: list[int]) -> Timeline:
    """A record in which the things `blown`, along B, are carried 3 m along x in the middle of the episode."""
    start = base.world.position[0, : len(base.specs[0].things)].cpu().numpy()
    offsets = np.zeros((LIMIT // 10 + 1, len(blown), 3), np.float16)
    offsets[LIMIT // 20 :, :, 0] = 3.0
    whole: Any = dict.fromkeys(("levels", "damaged_at", "safe_at", "flame_birth", "flame_place"), np.zeros(0))
    moves = np.array(blown, np.int16)
    names = base.world.names[0]
    return Timeline("", "", "", "", 4, 0, 10, names, start, moves, offsets, **whole)


def of_category(base: Any, category: str) -> int:
    return next(k for k, body in enumerate(base.specs[0].bodies) if body.category == category)


def test_what_nobody_touched_is_at_stake_if_the_record_says_that_it_is_carried_off(base: Any) -> None:
    light, phone = of_category(base, "basket"), of_category(base, "phone")
    stake = truth(base).at_stake(record(base, [light]))
    assert stake[light] and not stake[phone] and stake.sum() == 1
    base.world.safe[0, light] = True
    assert not truth(base).at_stake(record(base, [light])).any()


def test_what_was_put_down_is_at_stake_unless_its_place_keeps_it(base: Any) -> None:
    """A basket of 0.8 kg in the open slides off; a phone, which withstands any wind here, stays."""
    light, phone = of_category(base, "basket"), of_category(base, "phone")
    known, state, world = truth(base), base.episode.states["wind"], base.world
    for thing in (light, phone):
        world.position[0, thing, :2] += 0.5
        state.place[0, thing] = world.position[0, thing]  # as a hand would
    stake = known.at_stake(record(base, []))
    assert stake[light] and not stake[phone]
    state.place[0, phone, 0] += 1.0  # it has been blown from there
    assert known.at_stake(record(base, []))[phone]


def test_the_future_moves_what_is_at_stake_from_where_it_is(base: Any) -> None:
    light, phone = of_category(base, "basket"), of_category(base, "phone")
    known = truth(base)
    base.world.frame[:] = 600
    ahead = known.future(record(base, [light, phone]))
    base.world.safe[0, phone] = True
    rests = known.future(record(base, [light, phone]))
    here = base.world.position[0].cpu().numpy()
    assert ahead.first == 600 and ahead.position_at(1000)[light] == pytest.approx(here[light])
    assert ahead.position_at(2000)[light] == pytest.approx(here[light] + [3.0, 0.0, 0.0])
    assert ahead.position_at(2000)[phone] == pytest.approx(here[phone] + [3.0, 0.0, 0.0])
    assert rests.position_at(2000)[phone] == pytest.approx(here[phone])


@pytest.mark.parametrize("mitigate", [True, False])
def test_the_lee_is_a_place_to_rescue_to_unless_that_is_forbidden(base: Any, mitigate: bool) -> None:
    """A suitcase withstands 0.3 m^2/s^2, less than half of the wind: many places behind cars keep it, a can none."""
    heavy, can = of_category(base, "suitcase"), of_category(base, "soda_can")
    carts = np.array([k for k, thing in enumerate(base.specs[0].things) if thing.category == "cart"])
    problem = truth(base, mitigate).problem(
        record(base, [heavy, can]),
        np.array([heavy, can]),
        np.array([5.0, 1.0]),
        carts,
        Outset((8.0, 8.0), None, 0),
        np.zeros(2),
        0.0,
        0.0,
    )
    assert problem.values == pytest.approx((5.5, 1.1))
    ways = np.array([problem.travel.to_carts((target, 0)) for target in (0, 1)])
    assert np.isfinite(ways[:, :3]).all() and not np.isfinite(ways[1, 3:]).any()
    assert (ways.shape[1] > 3) == mitigate
    assert not mitigate or np.isfinite(ways[0, 3:]).any()


def test_no_other_hazard_is_a_gale() -> None:
    assert hazard_of(SimpleNamespace(task=SimpleNamespace(hazards=()))) is None


def test_a_cart_that_failed_is_no_reason_not_to_use_the_lee(base: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    """`put_away` is asked with the frames to the nearest cart that works, or inf where none does."""
    asked: list[float] = []
    monkeypatch.setattr("hazard_ms.agents.gale.truth.put_away", lambda *given: asked.append(given[-1]))
    names, heavy = base.world.names[0], of_category(base, "suitcase")
    carts = np.array([k for k, thing in enumerate(base.specs[0].things) if thing.category == "cart"])
    decision: Any = SimpleNamespace(held=names[heavy], index=names.index, names=names, agent_position=(8.0, 8.0))
    known = truth(base)
    for failures in ({}, {names[k]: 1 for k in carts}):
        assert known.put_away(decision, carts, failures) is None
    assert np.isfinite(asked[0]) and asked[1] == np.inf
