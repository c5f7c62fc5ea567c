"""What a choice leaves of a rescue: a hall in which boxes stand on a line, worked out by hand."""

from __future__ import annotations

import dataclasses
import math

import pytest

from hazard_ms.agents.action_values import PACES, ActionValues, Notion, State, mean
from hazard_ms.robots.fetch import HazardFetch
from hazard_ms.sketch import skill_times
from hazard_ms.sketch.rescue_problem import RescueScene
from hazard_ms.skills.decision import DROP, EXPLORE, PICK_UP, STOP, WALK_ONE_STEP, WALK_TO, Action
from tests.worlds.halls import future, hall

LEFT, RIGHT, CART = "box_0", "box_1", "cart"  # LEFT is worth 5, RIGHT 1
SPEC = hall(1.0, 9.0)  # at 2 m and 10 m
CARTS = hall(1.0, 9.0, cart=5.0)  # and a cart at 6 m
START = State((6.0, 3.0), None, 0, None, (0, 1), 0.0)
WORTH = Notion({0: 5.0, 1: 1.0})
SCENE = RescueScene(SPEC, "fetch", HazardFetch.build.radius, 1500)
TIMES = skill_times.load("fetch")
PICK = TIMES.usual(skill_times.PICK_UP, 0.0)  # frames, of a box on the floor
VALUES = ActionValues(SCENE, (), TIMES)
REST = PICK + SCENE.bag  # frames of a rescue without its walk
NEAR = 0.5 + 0.02**0.5  # from the middle of a box at which a walk arrives [m]
END = (1500.0,)  # the last frame of an episode
ONE = 62 * (4 - NEAR) + 3 + REST  # frames of the first rescue
BOTH = ONE + 62 * (8 - 2 * NEAR) + 30 + 3 + REST  # it stands before LEFT, and turns round
ROUND = 14  # frames by which ways over cells of 0.1 m differ from straight lines


def worth(action: Action, limit: float, notion: Notion = WORTH, damaged: int = -1, state: State = START) -> float:
    """The value that is left by an action in a hall where LEFT is damaged at a frame."""
    line, best = future(SPEC, damaged=damaged), VALUES.best(state, notion, future(SPEC, damaged=damaged), (limit,))
    return VALUES.choice(state, action, notion, line, (limit,), best)[0]


def after(action: Action, state: State = START) -> State:
    return VALUES.after(state, action, WORTH, future(SPEC))


@pytest.mark.parametrize(
    ("limit", "damaged", "left", "right"),
    [
        (BOTH + ROUND, -1, 6.0, 6.0),
        (BOTH - ROUND, -1, 5.0, 5.0),  # it can still turn back
        (ONE + ROUND, -1, 5.0, 1.0),
        (ONE - ROUND, -1, 0.0, 0.0),
        (BOTH + ROUND, int(ONE + ROUND), 6.0, 3.5),
    ],
)
def test_the_wrong_target_first_costs_what_comes_too_late(
    limit: float, damaged: int, left: float, right: float
) -> None:
    assert [worth(Action(WALK_TO, name), limit, damaged=damaged) for name in (LEFT, RIGHT)] == [left, right]


def test_a_walk_that_can_still_be_turned_back_costs_its_frames_alone() -> None:
    """After 100 frames on the way to RIGHT, LEFT is 97 / 62 m farther away, and behind: 200 frames and half a turn."""
    limit = ONE + 200 + 30 + ROUND
    assert worth(Action(WALK_TO, RIGHT), limit) == 5.0
    assert worth(Action(WALK_TO, RIGHT), limit - 3 * ROUND) == 1.0


def test_looking_around_costs_its_frames_and_stopping_all() -> None:
    look = Action(EXPLORE)
    assert worth(look, ONE + 60 + ROUND) == 5.0 and worth(look, ONE + 60 - 2 * ROUND) == 0.0
    assert worth(Action(STOP), 1500, state=dataclasses.replace(START, saved=2.5)) == 2.5


def test_a_choice_is_judged_by_what_somebody_takes_the_targets_for() -> None:
    right, limit = Action(WALK_TO, RIGHT), BOTH - ROUND
    assert worth(right, limit, Notion({1: 1.0})) == 1.0  # it knows of no other
    assert worth(right, limit, Notion({0: 1.0, 1: 5.0})) == 5.0
    assert worth(right, BOTH + ROUND, Notion({0: 5.0, 1: 1.0}, {0: (10.5, 3.0)})) == 6.0
    assert worth(right, ONE + 50, Notion({0: 5.0, 1: 1.0}, {0: (10.5, 3.0)})) == 5.0  # it lies on the way


def test_walks_end_after_a_hundred_frames_or_a_metre() -> None:
    far, step, there = (after(Action(verb, LEFT), state) for verb, state in (
        (WALK_TO, START), (WALK_ONE_STEP, START), (WALK_TO, dataclasses.replace(START, place=(3.0, 3.0)))
    ))  # fmt: skip
    assert far.frame == 100 and far.place[0] == pytest.approx(6 - 97 / 62, abs=0.1)
    assert step.frame == pytest.approx(62 + 3, abs=4) and step.place[0] == pytest.approx(5.0, abs=0.1)
    assert there.frame == pytest.approx(62 * (1 - NEAR) + 3, abs=7)
    assert there.place[0] == pytest.approx(2 + NEAR, abs=0.15)


def test_a_walk_that_is_cut_short_faces_the_rest_of_its_way() -> None:
    before = dataclasses.replace(START, heading=1.0)
    west, east = after(Action(WALK_TO, LEFT), before), after(Action(WALK_ONE_STEP, RIGHT), before)
    assert west.heading is not None and abs(west.heading) == pytest.approx(math.pi, abs=0.1)
    assert east.heading == pytest.approx(0.0, abs=0.1)


def test_a_pick_up_turns_to_its_target_and_comes_nearer_first() -> None:
    away = dataclasses.replace(START, place=(3.6, 3.0), heading=0.0)  # 1.6 m east of LEFT, and it looks east
    held = after(Action(PICK_UP, LEFT), away)
    assert held.holding == 0 and held.heading is not None and abs(held.heading) == pytest.approx(math.pi, abs=0.1)
    assert held.frame == pytest.approx(30 + 62 * (1.6 - NEAR) + PICK, abs=7)
    assert held.place[0] == pytest.approx(2 + NEAR, abs=0.15)
    near = dataclasses.replace(START, place=(2.0, 3.5), heading=0.0)  # 0.5 m north of LEFT: only a quarter turn is due
    turned = after(Action(PICK_UP, LEFT), near)
    assert turned.place == near.place and turned.heading == pytest.approx(-math.pi / 2)
    assert turned.frame == round(15) + round(PICK)


def test_a_target_is_taken_where_it_is_near_and_put_away_where_it_counts() -> None:
    reach, drop = Action(PICK_UP, LEFT), Action(DROP)
    assert after(reach) == START and after(drop) == START
    near = dataclasses.replace(START, place=(2.6, 3.0))
    held = after(reach, near)
    assert (held.holding, held.frame) == (0, round(PICK)) and after(reach, held) == held
    safe = after(drop, held)
    assert (safe.holding, safe.left, safe.saved, safe.frame) == (None, (1,), 5.0, round(PICK) + round(SCENE.bag))
    assert worth(drop, 1500, state=held) == 6.0 and worth(Action(EXPLORE), 170, state=held) == 5.0
    late = dataclasses.replace(held, frame=1500)
    assert worth(drop, 1500, state=late) == 0.0 == worth(reach, 1500, state=late)


def test_a_state_is_worth_the_mean_over_paces_and_in_the_end_what_is_safe() -> None:
    """At a frame from where the first rescue just fits at the two slower paces of four: 5 at each of these."""
    middle = dataclasses.replace(START, frame=1500 - round(ONE))
    line, limits = future(SPEC), VALUES.limits(middle.frame)
    assert limits == pytest.approx([middle.frame + pace * round(ONE) for pace in PACES])
    assert VALUES.best(middle, WORTH, line, limits) == (0.0, 0.0, 5.0, 5.0) and mean((0.0, 0.0, 5.0, 5.0)) == 2.5
    over = dataclasses.replace(START, frame=1500, saved=1.5)
    assert VALUES.best(over, WORTH, line, VALUES.limits(1500)) == (1.5,) * 4


def test_what_is_held_goes_into_the_cart() -> None:
    scene = RescueScene(CARTS, "fetch", HazardFetch.build.radius, 1500)
    line = future(CARTS)
    boxes, cart = (line.index(LEFT), line.index(RIGHT)), line.index(CART)
    values, notion = ActionValues(scene, (cart,), TIMES), Notion({boxes[0]: 5.0, boxes[1]: 1.0})
    held = State((2.7, 3.0), None, 0, boxes[0], boxes, 0.0)

    def left(action: Action, state: State) -> float:
        return values.choice(state, action, notion, line, END, values.best(state, notion, line, END))[0]

    assert [left(Action(WALK_TO, CART), held), left(Action(DROP, CART), held)] == [6.0, 6.0]
    beside = dataclasses.replace(held, place=(5.3, 3.0), frame=1500 - int(scene.cart) - 5)
    assert left(Action(DROP, CART), beside) == 5.0
    assert left(Action(DROP), beside) == left(Action(WALK_TO, RIGHT), beside) == 0.0
    assert values.begins_with(held, notion, line, END[0]) == "to put away what it held"
    free = dataclasses.replace(held, holding=None)
    assert values.begins_with(free, notion, line, END[0]) == f"to rescue {LEFT}"
