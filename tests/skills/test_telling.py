"""Robots of a team tell one another what they have seen: when it arrives, what enters a map, and what is refused."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest

from hazard_ms.skills.decision import EXPLORE, Action, Message
from hazard_ms.skills.executor import SkillEnv
from hazard_ms.skills.team import TeamSkills
from hazard_ms.skills.telling import FRAMES, LONGEST, named_in

LOOK, WAIT = Action(EXPLORE), Action("tell", "wait")


@pytest.fixture(scope="module")
def three() -> Iterator[TeamSkills]:
    made = TeamSkills.make("HazardFire-v1", ("fetch",) * 3, effects="off")
    yield made
    made.close()


def test_what_one_tells_reaches_all_others_with_the_places_of_what_it_names(three: TeamSkills) -> None:
    """None but the first sees the thing; the second knew it by an older look, the third by a later one."""
    three.reset(seed=1)
    first, second, third = three.names
    three.step({first: LOOK, second: WAIT, third: WAIT})
    while first not in three.free:  # it turns round, the others stand
        three.step(dict.fromkeys(three.free, WAIT))
    if set(three.free) == {first}:
        three.step({first: WAIT})
    frame, heard = three.frame, [len(three.decision(name).messages) for name in three.names]
    mine, older, later = (three.knowledge[name] for name in three.names)
    index = next(i for i in mine.seen.objects if i not in older.seen.objects and i not in later.seen.objects)
    name, seen = mine.labeller.names[index], mine.seen.objects[index]
    text = f"I saw {name}, near the wall; nothing_1 is gone."
    elsewhere = replace(seen, position=seen.position + np.float32(1.0))
    older.seen.objects = {**older.seen.objects, index: replace(elsewhere, frame=seen.frame - 1)}
    later.seen.objects = {**later.seen.objects, index: replace(elsewhere, frame=seen.frame + 1000)}
    saying = {first: Action("tell", text), second: WAIT, third: WAIT}
    info = three.step({name: saying[name] for name in three.free})[3]
    while first not in info["results"]:
        info = three.step(dict.fromkeys(three.free, WAIT))[3]
    assert info["results"][first].frames == FRAMES
    new = [three.decision(name).messages[count:] for name, count in zip(three.names, heard, strict=True)]
    words = Message(three.frame, first, text)
    assert words not in new[0] and words in new[1] and words in new[2] and three.frame >= frame + FRAMES
    assert three.decision(second).map.objects[index] == seen
    np.testing.assert_array_equal(three.decision(third).map.objects[index].position, elsewhere.position)


@pytest.mark.parametrize("text", ["", "x" * (LONGEST + 1), "two\nlines", None])
def test_messages_have_a_length(three: TeamSkills, text: str | None) -> None:
    decisions, _ = three.reset(seed=1)
    with pytest.raises(ValueError, match=r"a message must be 1 to 200 printable characters|the target of tell must be"):
        three.step({name: Action("tell", text) for name in decisions})
    assert three.frame == 0


def test_a_single_robot_has_nobody_to_tell() -> None:
    env = SkillEnv.make("HazardFire-v1", effects="off")
    env.reset(seed=1)
    with pytest.raises(ValueError, match="verb must be one of walk_to, .* got 'tell'"):
        env.step(Action("tell", "hello"))
    env.close()


def test_things_are_named_by_whole_words() -> None:
    names = ("pan_1", "pan_10", "a_pan_1", "bag_2")
    assert named_in("bag_2 and pan_1; not pan_100.", names) == ("pan_1", "bag_2")
