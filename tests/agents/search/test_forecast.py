"""Forecasts from a map: a fire whose flames are inferred from the floor, water that rises, and other hazards' lines."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from hazard_ms.agents.search.fire_watch import FireWatch
from hazard_ms.agents.search.forecast import STRIDE, Forecast
from hazard_ms.agents.search.house_fire import HouseFire
from hazard_ms.sensing.sighting import Sighting
from hazard_ms.sensing.target_table import Target
from hazard_ms.skills.brief import HazardBrief
from hazard_ms.skills.decision import Decision
from tests.agents.search.test_house_water import RISE, SLOPE, WEST, flooded, thing
from tests.agents.search.test_mitigating import decision, home
from tests.worlds.playground import Playground, brief

FLAME = (2.0, 0.0)  # [m]


def burning_floor(places: dict[str, tuple[float, float]], burning: tuple[float, float] = FLAME) -> Playground:
    """What is known 3 m around the origin, where something burns at FLAME, or `burning`, too, and heats the floor."""
    ground = Playground(places, {}, sight=3.0)
    ground.look()
    seen = ground.map
    y, x = np.nonzero(seen.explored)
    points = seen.origin + 0.1 * (np.stack([x, y], -1) + 0.5)
    weight = sum((0.5 / np.maximum(np.hypot(*(points - at).T), 0.5)) ** 2 for at in {FLAME, burning})
    seen.levels[0, y, x] = (20.0 + 600.0 * weight) / (1.0 + weight)
    for index, sighting in seen.objects.items():
        on_the_floor = np.array([*sighting.position[:2], 0.02], np.float32)
        ground.remember(index, replace(sighting, position=on_the_floor, top=0.04, levels=(20.0,)))
    return ground


def test_a_fire_is_foreseen_from_the_warmth_of_the_floor() -> None:
    """A book 0.5 m from the flame burns soon, one beyond it later, one far away last, and a pan not at all."""
    things = {"book_1": (1.5, 0.0), "book_2": (1.0, 0.0), "pan_1": (2.0, 0.5), "book_3": (-2.5, 0.0)}
    whole = FireWatch(0).whole_until(burning_floor(things).decision(), 0)
    assert 50 < whole[0] < 500
    assert whole[0] < whole[1] < whole[3]
    assert whole[2] == math.inf


def test_what_burns_already_does_not_stay_whole() -> None:
    """A burning book, far from the flame, lights the one beside it, which stays whole for longer without it."""
    things = {"book_1": (-2.0, 0.0), "book_2": (-2.0, 0.5)}
    ground = burning_floor(things, burning=(-2.0, 0.0))
    ground.remember(0, replace(ground.map.objects[0], damaged=True))
    whole = FireWatch(0).whole_until(ground.decision(), 0)
    assert whole[0] < 0
    assert whole[1] < 400 < FireWatch(0).whole_until(burning_floor(things).decision(), 0)[1]


def test_without_warmth_no_fire_is_foreseen() -> None:
    ground = burning_floor({"book_1": (1.5, 0.0)})
    ground.map.levels[:] = 21.0
    assert FireWatch(0).whole_until(ground.decision(), 0) == {}


def test_a_forecast_stays_until_the_map_tells_news() -> None:
    ground, watch = burning_floor({"book_1": (1.5, 0.0)}), FireWatch(0)
    first = watch.whole_until(ground.decision(), 0)
    assert watch.whole_until(replace(ground.decision(), frame=400), 0) is first
    ground.map.levels[0, 130, 140] = 500.0
    assert watch.whole_until(replace(ground.decision(), frame=400), 0) is not first


def wet(frame: int, position: tuple[float, float, float], rise: float = 0.001) -> Sighting:
    """A thing in water that rises evenly from nothing at frame 0, seen at two frames, the later one `frame`."""
    history = ((frame - 100, (rise * (frame - 100),)), (frame, (rise * frame,)))
    return Sighting(np.array(position, np.float32), 0.1, position[2] + 0.1, frame, 50, history[-1][1], history=history)


def target(name: str, index: int, waterproof: bool = False, damaged: bool = False) -> Target:
    return Target(index, name, "book", 1.0, True, waterproof, 200.0, damaged=damaged)


def forecast(ground: Playground, frame: int, task: str = "HazardFlood-v1") -> tuple[Forecast, Decision]:
    decision = replace(ground.decision(), frame=frame)
    return Forecast(brief(task), decision, FireWatch(0)), decision


def test_things_are_whole_until_the_water_reaches_their_middle() -> None:
    """0.001 m a frame: 0.5 m at frame 500, 0.9 m at 900; within the stride of the forecast and the error of the fit."""
    ground = Playground({"low": (1.0, 0.0), "high": (0.0, 2.0)}, {})
    ground.remember(0, wet(300, (1.0, 0.0, 0.5)))
    ground.remember(1, wet(300, (0.0, 2.0, 0.9)))
    ahead, decision = forecast(ground, 300)
    low, high = decision.map.objects[0], decision.map.objects[1]
    assert ahead.whole_until(target("low", 0), low) == pytest.approx(500, abs=2 * STRIDE)
    assert ahead.whole_until(target("high", 1), high) == pytest.approx(900, abs=2 * STRIDE)
    assert ahead.whole_until(target("low", 0, waterproof=True), low) == math.inf
    assert ahead.whole_until(target("low", 0, damaged=True), low) == 0.0


def test_water_is_foreseen_where_it_was_never_seen() -> None:
    """A third thing that was dry when it was seen, among two in the water, which is level."""
    ground = Playground({"a": (1.0, 0.0), "b": (0.0, 2.0), "dry": (1.0, 1.0)}, {})
    ground.remember(0, wet(300, (1.0, 0.0, 0.1)))
    ground.remember(1, wet(300, (0.0, 2.0, 0.1)))
    dry = replace(wet(0, (1.0, 1.0, 0.6)), frame=0, levels=(0.0,), history=((0, (0.0,)),))
    ground.remember(2, dry)
    ahead, _ = forecast(ground, 300)
    assert ahead.whole_until(target("dry", 2), dry) == pytest.approx(600, abs=3 * STRIDE)


def test_other_hazards_go_on_as_they_did() -> None:
    """A hazard of a third party: 0.1 a frame from 30 at frame 300, harmful from 50 on."""
    ground = Playground({"a": (1.0, 0.0)}, {})
    shaken = wet(300, (1.0, 0.0, 0.5), rise=0.1)
    ground.remember(0, shaken)
    quake = HazardBrief("quake", "shaking", "g", lambda target, level, height: level >= 50.0)
    decision = replace(ground.decision(), frame=300)
    ahead = Forecast(replace(brief(), hazards=(quake,)), decision, FireWatch(0))
    assert ahead.whole_until(target("a", 0), shaken) == pytest.approx(500, abs=STRIDE)


def test_what_floats_stays_whole_but_not_where_it_is() -> None:
    """Water rises by 0.25 mm a frame at its wall: 2 m of way from there it is 0.095 m deep at frame 799."""
    given = replace(decision(), map=flooded(600), frame=600)
    forecast = Forecast(home("HazardHouseFlood-v1"), given, HouseFire(0))
    target, sighting = thing("banana")
    there = replace(sighting, position=np.array([WEST + 2.0, 0.0, 0.05], np.float32), levels=(0.05,))
    assert forecast.whole_until(target, there) == np.inf
    assert forecast.stays_until(target, there) == pytest.approx((0.095 + SLOPE * 2.0) / RISE, abs=60)
    sinks, lying = thing("key")
    assert forecast.stays_until(sinks, replace(lying, position=there.position, levels=(0.05,))) == np.inf
