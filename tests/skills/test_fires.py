"""Fires as options of policies: what is known of them, what can be chosen, and how they are put out."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from hazard_ms.sensing.sighting import Sighting
from hazard_ms.skills.decision import Action, Decision, Result, Tool
from hazard_ms.skills.failures import NOT_BURNING
from hazard_ms.skills.options.feature_columns import MEASURED_VERSION
from hazard_ms.skills.options.features import Encoder
from hazard_ms.skills.options.fires import FireMemory, measured
from hazard_ms.skills.options.macros import play
from hazard_ms.skills.options.options import COUNT, FIRE, FIRST, MEASURED_COUNT, TARGET, TOOL, Option, Options
from tests.worlds.playground import Playground

RANGE = (20.0, 600.0)
PLACES = {"mug": (2.0, 0.0), "extinguisher": (0.0, 1.0), "sofa": (2.5, 0.5), "chair": (-2.0, -1.0)}


def warm(ground: Playground, place: tuple[float, float], flames: int, frame: int) -> None:
    """Heat of `flames` at a place [m], as a map shows it that was seen at `frame`."""
    seen = ground.map
    y, x = np.indices(seen.explored.shape)
    away = np.maximum(np.hypot(*np.moveaxis(seen.centre_of(y, x) - place, -1, 0)), 0.5)
    weight = flames * (0.5 / away) ** 2
    told = (20.0 + 600.0 * weight) / (1.0 + weight)
    near = away < 2.0
    known = np.where(np.isfinite(seen.levels[0]), seen.levels[0], -np.inf)
    seen.levels[0] = np.where(near, np.maximum(told, known), seen.levels[0])
    seen.told_at[near] = frame


def scene(**more: object) -> tuple[Playground, Decision]:
    """A home with a fire of a flame beside the sofa, which is hot, and an extinguisher."""
    ground = Playground(dict(PLACES), {"mug": 20.0})
    ground.look()
    warm(ground, (2.6, 0.6), 1, 0)
    hot = Sighting(np.array([2.5, 0.5, 0.4], np.float32), 0.5, 0.8, 0, 50, levels=(150.0,))
    ground.remember(2, hot)
    tool = Tool("extinguisher", "fire_extinguisher", "powder", 1.0, False)
    return ground, dataclasses.replace(ground.decision(), **{"tools": (tool,), **more})


def test_only_tasks_with_a_fire_and_the_skill_have_measures() -> None:
    assert measured(("open", "extinguish"), ["flood", "fire"]) == 1
    assert measured(("open",), ["fire"]) is None and measured(("extinguish",), ["flood"]) is None


def test_a_fire_is_where_it_is_hottest_and_told_by_a_hot_thing() -> None:
    _, decision = scene()
    (fire,) = FireMemory(0).fires(decision)
    assert fire.name == "sofa" and fire.place == pytest.approx((2.6, 0.6), abs=0.1) and fire.seen == 0


def test_what_was_put_out_comes_back_with_newer_heat_alone() -> None:
    ground, decision = scene()
    memory = FireMemory(0)
    memory.fires(decision)
    memory.note("sofa", 100, True)
    assert memory.fires(decision) == () and memory.count_out == 1
    warm(ground, (2.6, 0.6), 1, 101)
    assert [fire.name for fire in memory.fires(dataclasses.replace(decision, map=ground.map))] == ["sofa"]


def test_the_menu_of_a_task_with_measures() -> None:
    """With an empty hand a fire and the tool can be chosen; with the tool in hand that is not fetched again."""
    _, decision = scene()
    menu = Options(fire=0).menu(decision)
    assert len(menu.mask) == MEASURED_COUNT and len(Options().menu(decision).mask) == COUNT
    assert menu.mask[FIRST[FIRE]] and menu.mask[FIRST[TOOL]] and not menu.mask[FIRST[FIRE] + 1 : FIRST[TOOL]].any()
    assert menu.option(FIRST[FIRE]) == Option(FIRE, "sofa", "extinguisher")
    held = (dataclasses.replace(decision.tools[0], held=True),)
    menu = Options(fire=0).menu(dataclasses.replace(decision, tools=held, held="extinguisher"))
    assert menu.mask[FIRST[FIRE]] and not menu.mask[FIRST[TOOL]] and menu.mask[FIRST[TARGET]]
    assert menu.option(FIRST[FIRE]) == Option(FIRE, "sofa")
    empty = (dataclasses.replace(decision.tools[0], left=0.0),)
    assert not Options(fire=0).menu(dataclasses.replace(decision, tools=empty)).mask[FIRST[FIRE] :].any()


def test_a_fire_that_was_gone_is_not_offered_and_does_not_count_as_put_out() -> None:
    _, decision = scene()
    options = Options(fire=0)
    options.menu(decision)
    options.note(Option(FIRE, "sofa"), False, dataclasses.replace(decision, last_result=Result(False, NOT_BURNING)))
    menu = options.menu(decision)
    assert menu.fires == () and menu.out == 0


def test_the_macro_fetches_and_puts_out() -> None:
    ground, decision = scene()
    macro = play(Option(FIRE, "sofa", "extinguisher"), decision)
    taken = [next(macro)]
    arrived = dataclasses.replace(decision, last_action=taken[0], last_result=Result(True))
    taken.append(macro.send(arrived))
    taken.append(macro.send(dataclasses.replace(arrived, held="extinguisher")))
    unfinished = dataclasses.replace(arrived, last_result=Result(False, "max_frames", 450))
    taken.append(macro.send(unfinished))
    assert [str(action) for action in taken] == [
        *("walk_to extinguisher", "pick_up extinguisher", "extinguish sofa", "extinguish sofa")
    ]
    with pytest.raises(StopIteration) as ended:
        macro.send(arrived)
    assert ended.value.value is True


def test_a_tool_is_put_down_before_a_target_is_fetched() -> None:
    _, decision = scene()
    held = dataclasses.replace(
        decision, tools=(dataclasses.replace(decision.tools[0], held=True),), held="extinguisher"
    )
    assert next(play(Option(TARGET, "mug"), held)) == Action("drop")


def test_features_of_the_fire_and_the_tool() -> None:
    """The fire is 2.6 m ahead and 0.6 m to the left; the mug beside it is worth 20 of 40; powder lasts 12 s."""
    _, decision = scene(frame=300)
    encoder = Encoder([RANGE], 0.3, measures=True)
    assert MEASURED_VERSION == 2 and encoder.size == Encoder([RANGE], 0.3).size + 6 * 8 + 7
    parts = encoder.split(encoder.encode(decision, Options(fire=0).menu(decision)))
    names = [column.name for column in encoder.tables["fires"][1]]
    fire = dict(zip(names, parts["fires"][0].tolist(), strict=True))
    assert (fire["known"], fire["near"], fire["unseen"]) == pytest.approx((1.0, 0.5, 0.2))
    assert (5 * fire["ahead"], 5 * fire["left"]) == pytest.approx((2.6, 0.6), abs=0.1)
    assert parts["fires"][1:].sum() == 0.0
    names = [column.name for column in encoder.tables["tools"][1]]
    tool = dict(zip(names, parts["tools"][0].tolist(), strict=True))
    assert (tool["known"], tool["held"], tool["charge"], tool["left"]) == pytest.approx((1.0, 0.0, 360 / 500, 0.2))
    assert parts["targets"][0][6] == 1.0  # the value of 20 is the most there is


def test_a_tool_in_the_hand_is_not_something_that_is_held() -> None:
    """As in the sketch: what is fetched next is not barred by it."""
    _, decision = scene()
    held = dataclasses.replace(
        decision, tools=(dataclasses.replace(decision.tools[0], held=True),), held="extinguisher"
    )
    encoder = Encoder([RANGE], 0.3, measures=True)
    names = [column.name for column in encoder.tables["global"][1]]
    row = encoder.split(encoder.encode(held, Options(fire=0).menu(held)))["global"][0]
    assert row[names.index("holding")] == 0.0
