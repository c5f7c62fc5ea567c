"""Things that have moved: a look at the place where one lay shows that it is no longer there, or shows nothing."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from hazard_ms.sensing.sighting import Sighting, merged, sightings, with_missing
from hazard_ms.sensing.view import View
from tests.worlds.rays import Block, cast, intrinsic, looking

ROOM = (12.0, 5.0, 2.6)
EYE = (1.0, 2.0, 1.1)
BALL = Block((3.0, 1.95, 0.0), (3.1, 2.05, 0.1), 1)
BOX = Block((2.2, 1.5, 0.0), (2.4, 2.5, 1.0), 0)  # before the ball
BEHIND = Block((4.2, 1.5, 0.0), (4.4, 2.5, 1.0), 0)  # behind it


def view(blocks: tuple[Block, ...], eye: tuple[float, float, float] = EYE, turn: float = 0.0) -> View:
    """From `eye`, a little downwards, `turn` anticlockwise from +x [rad]."""
    pose = looking(eye, (eye[0] + np.cos(turn), eye[1] + np.sin(turn), 0.8))
    depth, labels = cast(pose, 256, blocks, ROOM)
    return View(depth, intrinsic(256), pose, labels)


def seen() -> dict[int, Sighting]:
    """What is known of the ball after a look at it in frame 0."""
    return sightings(view((BALL,)), 0, 2, frozenset(), None)


def missing(look: View, unmapped: tuple[int, ...] = ()) -> bool:
    """Whether the ball counts as missing after a later `look`."""
    return with_missing(seen(), look, 1, unmapped)[1].missing


@pytest.mark.parametrize("blocks", [(), (BEHIND,)])
def test_a_thing_is_missing_once_a_look_shows_its_place_without_it(blocks: tuple[Block, ...]) -> None:
    assert missing(view(blocks))
    assert missing(view(blocks, (2.6, 2.0, 1.1)))  # from right before it, where it lay at the picture's edge


@pytest.mark.parametrize(
    "look",
    [
        view((BOX,)),  # something hides its place
        view((), turn=np.pi),  # its place is out of the picture
    ],
)
def test_a_look_that_does_not_show_its_place_tells_nothing(look: View) -> None:
    assert not missing(look)


def test_what_is_in_the_hand_or_rescued_is_not_missing() -> None:
    assert not missing(view(()), unmapped=(1,))


def test_a_place_too_far_away_to_show_the_thing_tells_nothing() -> None:
    """From 10 m it would have no twelve pixels."""
    near = replace(seen()[1], position=np.array([11.0, 2.0, 0.08], np.float32))
    assert not with_missing({1: near}, view(()), 1, ())[1].missing
    assert with_missing({1: near}, view((), (9.0, 2.0, 1.1)), 1, ())[1].missing


def test_a_thing_that_is_seen_again_is_missing_no_more_even_by_a_glimpse() -> None:
    lost = with_missing(seen(), view(()), 1, ())[1]
    again = replace(seen()[1], frame=2)
    glimpse = replace(again, pixels=3)
    assert lost.missing and not merged(lost, again).missing and not merged(lost, glimpse).missing
