"""The floor of a realistic fire: the fires at the start, and cells that remember the heat they took up."""

from __future__ import annotations

import dataclasses

import pytest

from hazard_ms.hazards import presets
from hazard_ms.hazards.fire.fire import BURNING
from hazard_ms.hazards.fire.realistic.blaze import Blaze
from hazard_ms.spec.severity import SEVERITIES
from tests.hazards.fire.test_blaze import REAL, begin, run, with_room
from tests.worlds.fire_worlds import room_world


def test_the_spread_does_not_know_the_frame_rate() -> None:
    """Burning cells of a carpet after 25 s at 10 and at 40 frames a second."""
    seen = []
    for dt in (1 / 10, 1 / 40):
        world = with_room(room_world([], [(2.5, 2.5)], size=(5.0, 5.0)), floor="carpet")
        state = begin(dataclasses.replace(REAL, horizon=25.0), world)
        run(REAL, state, world, 25.0, dt)
        seen.append(int((state.flame_cell >= 0).sum()))
    assert seen[0] >= 30 and abs(seen[0] - seen[1]) <= 8


def test_a_floor_remembers_what_heated_it() -> None:
    """A carpet under flames for two thirds of the time that lights it, then cold for 2 s, lights after the last third.

    Acrylic carpet under the 30 kW/m^2 of flames: 28.7 s. They are of a waste basket, 100 kW.
    """
    plain = dataclasses.replace(REAL, time_scale=1.0, every=1, first_release=100.0, first_base=0.3)
    world = with_room(room_world([], [(2.5, 2.5)], size=(5.0, 5.0)), floor="carpet")
    state = begin(plain, world)
    place = state.flame_birth[:, 0].clone()
    run(plain, state, world, 19.0, 0.5)
    state.flame_birth[:, 0] = 2**40  # it is out
    run(plain, state, world, 2.0, 0.5)
    assert int((state.flame_cell >= 0).sum()) == 1
    state.flame_birth[:, 0] = place
    run(plain, state, world, 8.5, 0.5)
    assert int((state.flame_cell >= 0).sum()) == 1
    run(plain, state, world, 3.5, 0.5)
    assert int((state.flame_cell >= 0).sum()) == 5


def test_what_burns_on_a_wooden_floor_lights_it_and_tiles_never_burn() -> None:
    """A sofa at full heat beside the first cells, whose own flame is out: wood burns within 150 s, tiles do not."""
    for floor, burns in (("wood", True), ("tile", False), ("concrete", False)):
        plain = dataclasses.replace(REAL, time_scale=1.0, every=1)
        things = [("sofa", (2.5, 3.2, 0.0))]
        world = with_room(room_world(things, [(2.5, 2.5)], size=(5.0, 5.0), extent=(1.0, 0.8, 0.8)), floor=floor)
        state = begin(plain, world)
        state.flame_birth[:, 0] = 2**40
        state.status[:], state.burn_age[:] = BURNING, 150.0
        run(plain, state, world, 150.0, 1.0)
        assert (int((state.flame_cell >= 0).sum()) > 1) is burns


def test_what_burns_first_grows_to_the_peak_that_was_measured() -> None:
    """Three bags of rubbish [SFPE], an upholstered chair and a wardrobe [CFAST fire library], in seconds of fire."""
    for severity, peak in {"moderate": 350.0, "severe": 2100.0, "extreme": 4500.0}.items():
        usual = presets.fire("realistic", severity)
        assert isinstance(usual, Blaze)
        law = dataclasses.replace(usual, time_scale=1.0, every=1)
        world = room_world([], [(2.5, 2.5), (1.0, 4.0)], size=(5.0, 5.0))  # two fires, which share it
        state = begin(law, world)
        law.advance(state, world, 1e-3)
        grown = SEVERITIES[severity].fire_growth * 60.0**2  # a minute old
        assert float(state.heat_release) == pytest.approx(min(grown, peak), rel=1e-3)
        state.flame_age[:] = 1e4
        law.advance(state, world, 1e-3)
        assert float(state.heat_release) == pytest.approx(peak, rel=1e-3)
