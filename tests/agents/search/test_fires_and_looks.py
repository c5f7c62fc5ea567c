"""How planner and mcts name fires, go nearer to them, and look for those that they have not seen."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from hazard_ms.agents.search import candidates, mitigating
from hazard_ms.agents.search.lookouts import Lookout
from hazard_ms.sketch.planning.beginning import Course, best_course
from hazard_ms.skills.decision import EXPLORE, PICK_UP, WALK_TO, Action, Result
from hazard_ms.skills.failures import MAX_FRAMES, NOT_BURNING
from tests.agents.search.test_mitigating import NAMES, PLACES, begun, decision, home, on_fire


def test_it_looks_first_where_a_look_costs_least(monkeypatch: pytest.MonkeyPatch) -> None:
    """A look at the box, on the way to the far book, comes before one at that book, which would show more."""
    marks = Lookout("box_1", (4.2, 1.0), 0.1), Lookout("book_1", (5.0, 1.0), 0.8)
    monkeypatch.setattr(candidates, "fire_lookouts", lambda *told: marks)
    player, take = begun("planner", home()), (Action(PICK_UP, NAMES[1]), Result(True, frames=50))
    assert player.act(decision(take, NAMES[1], 130)) == Action(WALK_TO, "box_1")


@pytest.mark.parametrize("held", [True, False])
def test_a_tool_in_the_hand_is_put_down_only_for_what_is_surely_better(
    held: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Rescues alone must avert more by 1 % of the targets' value, three books of 10, where a tool is in the hand."""
    margins = []

    def noted(*told: object, margin: float, **rest: int) -> Course:
        margins.append(margin)
        return best_course(*told, margin=margin, **rest)  # type: ignore[arg-type]

    monkeypatch.setattr(mitigating, "best_course", noted)
    monkeypatch.setattr(candidates, "fire_lookouts", lambda *told: (Lookout("book_3", (5.0, -1.0), 0.1),))
    take = Action(PICK_UP, NAMES[1]), Result(True, frames=50)
    begun("planner", home()).act(decision(take, NAMES[1], 130) if held else decision(frame=130))
    assert margins == [pytest.approx(0.3 if held else 0.0)]


def test_a_fire_by_which_nothing_is_hot_yet_is_named_by_what_is_near() -> None:
    """A box 1.4 m from a single flame is at 85 degrees there: it is named to the skill all the same."""
    player, take = begun("planner", home()), (Action(PICK_UP, NAMES[1]), Result(True, frames=50))
    held = on_fire(decision(take, NAMES[1], 130), ((3.2, 0.0),))
    assert max(seen.levels[0] for seen in held.map.objects.values()) < 100.0
    assert player.act(held).verb == "extinguish"


def test_a_fire_is_not_named_by_what_is_hot_behind_a_wall() -> None:
    """The jet is for flames in sight of the thing that is named: so by the book beside them, not by the hot one."""
    player, take = begun("planner", home()), (Action(PICK_UP, NAMES[1]), Result(True, frames=50))
    held = on_fire(decision(take, NAMES[1], 130), ((3.2, -1.5),))
    rows = held.map.objects
    hot = replace(rows[3], position=np.array([1.7, -1.5, 0.05], np.float32), levels=(150.0,))
    beside = replace(rows[4], position=np.array([4.7, -1.5, 0.05], np.float32))
    held.map.objects = {**rows, 3: hot, 4: beside}
    assert player.act(held) == Action("extinguish", "book_3")


def test_what_did_not_burn_there_may_burn_beside_it() -> None:
    """Where nothing burned around a thing the fire is not given up: it may be a little farther off."""
    player, take = begun("planner", home()), (Action(PICK_UP, NAMES[1]), Result(True, frames=50))
    held = on_fire(decision(take, NAMES[1], 130), ((3.2, 0.0),))
    first = player.act(held)
    refused = on_fire(decision((first, Result(False, NOT_BURNING)), NAMES[1], 130), ((3.2, 0.0),))
    refused.map.told_at[:] = 100
    again = player.act(refused)
    assert first.verb == again.verb == "extinguish" and len(player._memory.house.seats) == 1  # type: ignore[attr-defined]


def test_it_goes_nearer_to_a_fire_that_nothing_is_known_beside_and_looks_around() -> None:
    """A flame in the corner of the room, 1.84 m from anything known: the walk is to the nearest thing."""
    player, take = begun("planner", home()), (Action(PICK_UP, NAMES[1]), Result(True, frames=50))
    flame = ((5.7, -2.7),)
    held = on_fire(decision(take, NAMES[1], 130), flame)
    went = player.act(held)
    nearest = min(range(len(NAMES)), key=lambda k: np.hypot(*np.subtract(PLACES[k], flame[0])))
    assert went == Action(WALK_TO, NAMES[nearest]) and "put out the fire at" in str(player.note)
    there = on_fire(decision((went, Result(True, frames=50)), NAMES[1], 180), flame)
    assert player.act(there) == Action(EXPLORE)


def test_a_look_that_was_begun_is_gone_on_with(monkeypatch: pytest.MonkeyPatch) -> None:
    """On its way to one place it does not turn round to another one that promises a little more for its distance."""
    marks = [Lookout("box_1", (4.2, 1.0), 0.1), Lookout("book_1", (5.0, 1.0), 0.1)]
    monkeypatch.setattr(candidates, "fire_lookouts", lambda *told: tuple(marks))
    player, take = begun("planner", home()), (Action(PICK_UP, NAMES[1]), Result(True, frames=50))
    went = player.act(decision(take, NAMES[1], 130))
    marks.reverse()
    assert went == Action(WALK_TO, "box_1")
    assert player.act(decision((went, Result(False, MAX_FRAMES, 100)), NAMES[1], 230)) == went
