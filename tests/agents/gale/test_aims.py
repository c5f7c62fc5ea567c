"""The aim of agents without privileges in a gale: values by what is at risk, and places in the lee beside the carts."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from hazard_ms.agents.gale.aims import GaleAims, aims_of
from hazard_ms.agents.gale.course import Course, Front, Lees
from hazard_ms.agents.search.outlook import Outlook
from hazard_ms.hazards.presets import gale, wind
from hazard_ms.sensing.semantic_map import SemanticMap
from hazard_ms.sensing.sighting import Sighting
from hazard_ms.sketch.planning.orienteering import solve
from hazard_ms.sketch.planning.problem import Problem
from hazard_ms.sketch.planning.travel import StaticTravel
from hazard_ms.skills.brief import HazardBrief
from hazard_ms.skills.decision import DROP, Action, Result

NAMES = ("suitcase_1", "phone_1", "soda_can_1", "cart_1")
PLACES = ((2.0, 0.0), (0.0, 2.0), (2.0, 1.0), (8.0, 0.0))  # [m]
LEE = 2.5  # east of which the wind loses three quarters [m]


def brief(law: Any) -> Any:
    told = HazardBrief("wind", "wind", "m/s", lambda target, level, height: False, law.withstands)
    targets = [SimpleNamespace(category=name.rpartition("_")[0]) for name in NAMES[:3]]
    return SimpleNamespace(hazards=(told,), targets=targets, radius=0.29, frame_seconds=1 / 30, max_frames=3000)


def decision(held: str | None = None, places: tuple[tuple[float, float], ...] = PLACES) -> Any:
    """The agent is at (0, 0); a suitcase, a phone and a can lie in the open, the cart is beyond the lee."""
    seen = SemanticMap((0.0, 0.0), np.zeros(4, bool))
    seen.tell(np.zeros_like(seen.height), np.ones_like(seen.explored))
    seen.objects = {
        k: Sighting(np.array([*at, 0.1], np.float32), 0.1, 0.2, 0, 9) for k, at in enumerate(places) if NAMES[k] != held
    }
    targets = {n: SimpleNamespace(index=k, name=n, category=n.rpartition("_")[0]) for k, n in enumerate(NAMES[:3])}
    return SimpleNamespace(
        frame=0,
        map=seen,
        names=NAMES,
        held=held,
        agent_position=(0.0, 0.0),
        agent_heading=0.0,
        targets=tuple(targets.values()),
        target=targets.__getitem__,
        index=NAMES.index,
        last_action=None,
        last_result=None,
    )


def aims(speed: float = 1.2) -> GaleAims:
    """Aims of an agent that is sure of a wind of this `speed` [m/s] along x all the time, with a lee in the east."""
    made = GaleAims(brief(gale("paper")))
    loss = np.zeros((3, 60, 60))
    loss[:, :, 30 + round(LEE / 0.5) :] = 0.75
    lees = Lees(np.array([-15.0, -15.0]), loss, np.full_like(loss, 3.0))
    front = Front(1000.0, (1.0, 0.0), 0.5, (0.0, 0.0), 3.0, 40.0)
    course = Course(np.array([[speed, 0.0]] * 3), lees, front, 100.0)
    made._weather = SimpleNamespace(known=True, note=lambda decision: None, courses=lambda: [(1.0, course)])  # type: ignore[assignment]
    return made


def ahead() -> Outlook:
    """The targets, in the order of NAMES, are worth 5, 5 and 1; every way is 100 frames, to the cart 500."""
    table = np.full((5, 5), 100.0)
    table[:, 3] = 500.0
    problem = Problem(StaticTravel(table, 1), [5.0, 5.0, 1.0], [np.inf] * 3, [50.0] * 3, [60.0], limit=3000.0)
    return Outlook(NAMES[:3], (), NAMES[3:], problem, problem, table)


def test_values_are_those_of_what_the_wind_will_move_and_a_tenth_beside() -> None:
    """A suitcase withstands up to 0.37 m^2/s^2 and a can less; a phone 2.3 or more. The wind has 1.44."""
    known = aims()
    known.see(decision())
    assert known.aimed(decision(), ahead()).problem.values == pytest.approx((5.5, 0.0, 1.1))
    assert aims(speed=0.2).aimed(decision(), ahead()).problem.values == pytest.approx((0.0, 0.0, 0.0))


def test_what_has_been_moved_is_at_risk_until_a_hand_puts_it_down() -> None:
    known, moved = aims(), decision(places=(PLACES[0], (1.0, 2.0), *PLACES[2:]))
    known.see(decision())
    known.see(moved)
    assert known.aimed(moved, ahead()).problem.values[1] == pytest.approx(5.5)
    known.see(decision(held="phone_1"))
    known.see(
        SimpleNamespace(**{**vars(moved), "last_action": Action(DROP), "last_result": Result(True)})  # type: ignore[arg-type]
    )
    assert known.aimed(moved, ahead()).problem.values[1] == 0.0


def test_plans_bring_the_suitcase_into_the_lee_and_the_can_into_the_cart() -> None:
    """In the lee the wind has 1.44 / 16 = 0.09: enough for the can to slide, not for the suitcase."""
    problem = aims().aimed(decision(), ahead()).problem
    assert problem.travel.carts > 1 and len(problem.drop) == problem.travel.carts
    carts = {rescue.target: rescue.cart for rescue in solve(problem).rescues if rescue.value > 0.0}
    assert carts[0] >= 1 and carts[2] == 0


def test_it_puts_the_suitcase_down_in_the_lee_but_never_the_can() -> None:
    suitcase, can = decision(held="suitcase_1"), decision(held="soda_can_1")
    action = aims().put_away(suitcase, 700.0)
    assert action is not None and action.verb != DROP  # not here, in the open
    assert aims(speed=1.0).put_away(can, 700.0) is None  # although 0.06 m^2/s^2 does not make it slide
    there = SimpleNamespace(**{**vars(suitcase), "agent_position": (3.0, 0.0)})
    assert aims().put_away(there, 700.0) == Action(DROP)  # type: ignore[arg-type]


def test_only_where_things_are_carried_off_for_good_there_are_such_aims() -> None:
    assert aims_of(brief(gale("paper"))) is not None and aims_of(brief(wind("paper"))) is None
