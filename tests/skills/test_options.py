"""Options of a learner: which can be chosen, what they do, and how they are played; in a room without physics."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from hazard_ms.skills.decision import DROP, EXPLORE, PICK_UP, STOP, WALK_TO, Action
from hazard_ms.skills.options.macros import play
from hazard_ms.skills.options.options import COUNT, FIRST, GIVE_UP, LOOK, Menu, Option, Options, option_of
from tests.worlds.playground import Playground

BAG = dict(places={"mug": (2.0, 0.0), "book": (0.0, 2.5), "sofa": (-2.0, 0.0)}, values={"mug": 1.0, "book": 5.0})
STREET = dict(places={"mug": (2.0, 0.0), "cart_1": (0.0, 2.0)}, values={"mug": 1.0}, carts=("cart_1",))


def offered(menu: Menu) -> set[str]:
    return {str(menu.option(int(number))) for number in np.flatnonzero(menu.mask)}


def do(ground: Playground, option: Option) -> tuple[list[Action], bool]:
    """Play an option to its end."""
    taken: list[Action] = []
    macro = play(option, ground.decision())
    action = next(macro)
    while True:
        taken.append(action)
        ground.do(action)
        try:
            action = macro.send(ground.decision())
        except StopIteration as ended:
            return taken, ended.value


def test_every_number_means_one_option() -> None:
    """32 targets, 3 carts, 8 landmarks, look and stop, in this order."""
    ground = Playground(**BAG)
    ground.look()
    menu = Options().menu(ground.decision())
    assert len(menu.mask) == 45 and menu.mask.dtype == bool
    assert (menu.option(0), menu.option(1), menu.option(2)) == (Option("target", "mug"), Option("target", "book"), None)
    assert menu.option(32) is None and menu.option(35) is not None and menu.option(35).kind == "landmark"
    assert (menu.option(43), menu.option(44)) == (Option("look"), Option("stop"))
    for number in np.flatnonzero(menu.mask).tolist():
        assert menu.number(menu.option(number)) == number
    for wrong in (-1, COUNT):
        with pytest.raises(ValueError, match="0 to 44"):
            menu.option(wrong)
    with pytest.raises(ValueError, match="target must be one of mug, book, got 'sofa'"):
        menu.number(Option("target", "sofa"))


def test_before_anything_is_seen_an_agent_can_only_look_or_stop() -> None:
    menu = Options().menu(Playground(**BAG).decision())
    assert offered(menu) == {"look", "stop"}
    assert offered(Options(stop=False).menu(Playground(**BAG).decision())) == {"look"}


def test_what_was_seen_is_offered_and_what_is_rescued_is_not() -> None:
    ground = Playground(**BAG)
    ground.look()
    assert {"target mug", "target book", "look", "stop"} <= offered(Options().menu(ground.decision()))
    assert do(ground, Option("target", "mug"))[1]
    assert "target mug" not in offered(Options().menu(ground.decision()))


def test_looking_around_is_offered_once_at_each_spot() -> None:
    """Unless there is nothing else to do."""
    ground, options = Playground(**BAG), Options()
    ground.look()
    options.note(Option(LOOK), True)
    assert not options.menu(ground.decision()).mask[FIRST[LOOK]]
    options.note(Option("target", "mug"), True)
    assert options.menu(ground.decision()).mask[FIRST[LOOK]]
    options.note(Option(LOOK), True)
    assert options.menu(Playground(**BAG).decision()).mask[FIRST[LOOK]]


def test_what_failed_four_times_is_given_up() -> None:
    ground, options = Playground(**BAG), Options()
    ground.look()
    for _ in range(GIVE_UP):
        assert "target mug" in offered(options.menu(ground.decision()))
        options.note(Option("target", "mug"), False)
    assert "target mug" not in offered(options.menu(ground.decision()))


def test_with_a_full_hand_only_carts_are_left_or_the_bag() -> None:
    ground = Playground(**STREET)
    ground.look()
    assert "cart cart_1" not in offered(Options().menu(ground.decision()))
    assert do(ground, Option("target", "mug")) == (
        [Action(WALK_TO, "mug"), Action(PICK_UP, "mug")],
        True,
    )
    menu = Options().menu(ground.decision())
    assert "cart cart_1" in offered(menu) and not menu.mask[:32].any()
    bag = Playground(**BAG, held="mug")
    bag.look()
    assert [name for name in offered(Options().menu(bag.decision())) if name.startswith("target")] == ["target mug"]


def test_fetching_walks_on_until_it_arrives_and_uses_the_bag_at_once() -> None:
    """A walk takes 1.6 m at most, so 4 m are three walks; then pick up, and drop into the bag."""
    ground = Playground({"mug": (4.4, 0.0)}, {"mug": 1.0}, sight=6.0)
    ground.look()
    taken, worked = do(ground, Option("target", "mug"))
    assert taken == [*[Action(WALK_TO, "mug")] * 3, Action(PICK_UP, "mug"), Action(DROP)] and worked
    assert ground.rescued == {"mug"}


def test_what_is_in_the_hand_is_only_put_away() -> None:
    ground = Playground(**BAG, held="mug")
    ground.look()
    assert do(ground, Option("target", "mug")) == ([Action(DROP)], True)


@pytest.mark.parametrize("bad", ["broken", "slippery"])
def test_fetching_fails_where_no_way_leads_or_no_grip_holds(bad: str) -> None:
    ground = Playground(**BAG, **{bad: frozenset({"mug"})})
    ground.look()
    taken, worked = do(ground, Option("target", "mug"))
    assert not worked and [a.verb for a in taken] == {"broken": [WALK_TO], "slippery": [WALK_TO, PICK_UP]}[bad]


def test_bringing_walks_to_the_cart_and_drops_over_it() -> None:
    ground = Playground(**STREET, held="mug")
    ground.look()
    taken, worked = do(ground, Option("cart", "cart_1"))
    assert (taken, worked) == ([Action(WALK_TO, "cart_1"), Action(DROP, "cart_1")], True)
    assert ground.rescued == {"mug"}


def test_searching_walks_to_the_landmark_and_looks_there() -> None:
    ground = Playground(**BAG)
    ground.look()
    assert do(ground, Option("landmark", "sofa")) == ([Action(WALK_TO, "sofa"), Action(EXPLORE)], True)
    assert do(ground, Option("look"))[0] == [Action(EXPLORE)] and do(ground, Option("stop"))[0] == [Action(STOP)]
    with pytest.raises(ValueError, match="option must be"):
        play(Option("target"), ground.decision())


def test_landmarks_stand_at_the_edge_of_what_was_seen_and_are_used_up() -> None:
    """Seen is a disc of 3 m; from its middle, 3 m from the edge, there is nothing new to see."""
    places = {"near": (0.1, 0.1), "east": (2.5, 0.0), "close_to_east": (2.6, 0.3), "north": (0.0, 2.5)}
    ground, options = Playground(places, {}), Options()
    ground.look()

    def names() -> list[str]:
        return [mark.name for mark in options.menu(ground.decision()).landmarks]

    assert "near" not in names() and "north" in names() and len(names()) == 2  # only one of the two in the east
    for _ in range(2):
        options.note(Option("landmark", "north"), True)
    assert "north" not in names()


def test_actions_of_other_agents_belong_to_options() -> None:
    ground = Playground(**STREET)
    ground.look()
    menu, decision = Options().menu(ground.decision()), ground.decision()
    assert option_of(menu, decision, Action(WALK_TO, "mug")) == Option("target", "mug")
    assert option_of(menu, decision, Action(PICK_UP, "mug")) == Option("target", "mug")
    assert option_of(menu, decision, Action(DROP, "cart_1")) == Option("cart", "cart_1")
    assert option_of(menu, decision, Action(EXPLORE)) == Option("look")
    assert option_of(menu, decision, Action(STOP)) == Option("stop")
    assert option_of(menu, decision, Action(DROP)) is None
    holding = dataclasses.replace(decision, held="mug", containers=())
    assert option_of(menu, holding, Action(DROP)) == Option("target", "mug")


def test_more_targets_than_slots_are_refused() -> None:
    places = {f"mug_{k}": (1.0, 0.1 * k) for k in range(33)}
    with pytest.raises(ValueError, match="at most 32 targets, got 33"):
        Options().menu(Playground(places, dict.fromkeys(places, 1.0)).decision())
