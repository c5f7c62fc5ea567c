"""What recorded decisions are called: subtasks, options, prompts, and reasons not to keep an episode."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import pytest

from hazard_ms.demonstrations.options import RecordOptions
from hazard_ms.demonstrations.reading import entries
from hazard_ms.demonstrations.recording import MOST_BLOCKED, recorded, why_not
from hazard_ms.demonstrations.store import append
from hazard_ms.demonstrations.watching.played_options import PlayedOptions
from hazard_ms.demonstrations.watching.prompts import prompt
from hazard_ms.demonstrations.watching.sentences import sentence
from hazard_ms.evaluation.options import EnvOptions, EpisodeOptions
from hazard_ms.evaluation.result import BROKEN, DecisionRecord
from hazard_ms.skills.decision import DROP, EXPLORE, PICK_UP, STOP, WALK_TO, Action
from hazard_ms.skills.failures import BLOCKED, MAX_FRAMES, NO_PATH
from hazard_ms.skills.options.options import CART, FIRST, GIVE_UP, LANDMARK, LOOK
from tests.worlds.playground import Playground, brief
from tests.worlds.recordings import RECIPE, stored
from tests.worlds.results import result_of

HALF = result_of(EpisodeOptions(), saved=True)  # half of the value is rescued


def ground(**changes: object) -> Playground:
    """Two targets and a shelf within sight."""
    made = Playground({"mug": (2.0, 0.0), "pen": (9.0, 0.0), "shelf": (2.5, 1.0)}, {"mug": 5.0, "pen": 1.0}, **changes)  # type: ignore[arg-type]
    made.look()
    return made


def test_subtasks_are_sentences() -> None:
    at, carts = ground(held="mug").decision(), ground(held="mug", carts=("shelf",)).decision()
    told = {
        sentence(Action(WALK_TO, "pen"), at): "walk to pen",
        sentence(Action(PICK_UP, "pen"), at): "pick up pen",
        sentence(Action(DROP), at): "put mug into the bag",
        sentence(Action(DROP), carts): "put mug on the ground",
        sentence(Action(DROP, "shelf"), carts): "put mug into shelf",
        sentence(Action(EXPLORE), at): "look around",
        sentence(Action(STOP), at): "stop",
    }
    assert all(got == wanted for got, wanted in told.items()) and len(told) == 7


def test_an_option_lasts_from_the_first_step_to_the_last() -> None:
    world, options = ground(), PlayedOptions()
    labels = []
    for action in (Action(WALK_TO, "mug"), Action(PICK_UP, "mug"), Action(DROP), Action(EXPLORE), Action(EXPLORE)):
        labels.append(options.decided(world.decision(), action))
        world.do(action)
        assert world.last[1] is not None
        options.ended(world.last[1])
    assert [(label.number, label.starts) for label in labels] == [
        (0, True),
        (0, False),
        (0, False),
        (FIRST[LOOK], True),
        (FIRST[LOOK], True),
    ]
    assert labels[3].menu.mask[FIRST[LOOK]] and not labels[4].menu.mask[FIRST[LOOK]]  # it has just looked around


def test_looking_around_at_a_landmark_belongs_to_it() -> None:
    world, options = ground(), PlayedOptions()
    first = options.decided(world.decision(), Action(WALK_TO, "shelf"))
    world.do(Action(WALK_TO, "shelf"))
    options.ended(world.last[1])  # type: ignore[arg-type]
    assert first.menu.names(LANDMARK)[first.number - FIRST[LANDMARK]] == "shelf"
    second = options.decided(world.decision(), Action(EXPLORE))
    assert not second.starts and second.menu.names(LANDMARK)[second.number - FIRST[LANDMARK]] == "shelf"


@pytest.mark.parametrize(("reason", "given_up"), [(NO_PATH, True), (MAX_FRAMES, False)])
def test_only_what_has_failed_counts_as_a_failure(reason: str, given_up: bool) -> None:
    """A walk that ran out of frames is still under way."""
    world, options = ground(), PlayedOptions()
    failed = dataclasses.replace(world._do(Action(PICK_UP, "pen")), reason=reason)
    for _ in range(GIVE_UP):
        options.decided(world.decision(), Action(WALK_TO, "mug"))
        options.ended(failed)
    assert bool(options.decided(world.decision(), Action(EXPLORE)).menu.mask[0]) is not given_up


def test_what_is_no_option_has_no_number() -> None:
    world, options = ground(held="mug", carts=()), PlayedOptions()
    assert options.decided(world.decision(), Action(WALK_TO, "pen")).number == 1
    stray = options.decided(ground().decision(), Action(DROP))
    assert (stray.number, stray.starts) == (-1, True) and stray.menu.names(CART) == ()


def test_a_prompt_names_what_was_seen_and_every_option_that_can_be_chosen() -> None:
    world = ground()
    menu = PlayedOptions().decided(world.decision(), Action(STOP)).menu
    made = prompt(brief(), world.decision(), menu)
    text = made["text"]
    assert "- mug: worth 5, 2.0 m away, ahead, seen 0 frames ago" in text and "- pen: worth 1, not seen yet" in text
    assert sorted(made["options"].values()) == menu.mask.nonzero()[0].tolist()
    assert "A) fetch mug\n" in text and made["options"]["A"] == 0
    world.held = "mug"
    assert "In your hand: mug." in prompt(brief(), world.decision(), menu)["text"]


@pytest.mark.parametrize(
    ("change", "reach", "reason"),
    [
        ({}, 0.6, ""),
        ({}, 0.7, "50.0 % of the value, of 70.0 % that can be reached"),
        ({"ended": BROKEN}, 0.5, BROKEN),
        ({"decisions": (DecisionRecord(0, WALK_TO, "pen", False, BLOCKED, 9),) * MOST_BLOCKED}, 0.5, ""),
        ({"decisions": (DecisionRecord(0, WALK_TO, "pen", False, BLOCKED, 9),) * 4}, 0.5, "4 skills were blocked"),
    ],
)
def test_reasons_not_to_keep_an_episode(change: dict[str, object], reach: float, reason: str) -> None:
    found = dataclasses.replace(HALF, **change)  # type: ignore[arg-type]
    assert why_not(found, reach, keep=0.8, succeeded=False) == reason


def test_with_keep_0_only_broken_simulations_are_not_kept() -> None:
    blocked = (DecisionRecord(0, WALK_TO, "pen", False, BLOCKED, 9),) * 9
    assert why_not(dataclasses.replace(HALF, decisions=blocked), 1.0, keep=0.0, succeeded=False) == ""
    assert why_not(HALF, 1.0, keep=0.8, succeeded=True) == ""
    assert why_not(dataclasses.replace(HALF, ended=BROKEN), 0.0, keep=0.0, succeeded=True) == BROKEN


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"episodes": 0}, "episodes must be"),
        ({"keep": 1.5}, "keep must be a share from 0 to 1, got 1.5"),
        ({"obs": "rgb+none"}, "obs must be one of state, rgb, depth, segmentation"),
        ({"every": 0}, "every must be"),
        ({"cameras": "head+elbow", "obs": "rgb"}, "cameras must be one of head, wrist, shoulder, got 'elbow'"),
        ({"cameras": "wrist", "obs": "rgb"}, "cameras must include head, and others only with rgb in obs, got 'wrist'"),
        ({"cameras": "head+wrist", "obs": "depth"}, "others only with rgb in obs, got 'head.wrist'"),
        ({"env": EnvOptions("HazardFlod-v1")}, "did you mean 'HazardFlood-v1'"),
    ],
)
def test_what_cannot_be_recorded_is_refused(change: dict[str, object], said: str) -> None:
    with pytest.raises(ValueError, match=said):
        RecordOptions(**change).check()  # type: ignore[arg-type]


def test_a_dataset_has_one_recipe(tmp_path: Path) -> None:
    stored(tmp_path, 0)
    stored(tmp_path, 1, reason="because")
    assert [entry.seed for entry in recorded(tmp_path, RECIPE)] == [0, 1]
    with pytest.raises(ValueError, match=r"output must hold episodes with \{'keep': 0.5\} only, got kitchen_b"):
        recorded(tmp_path, {**RECIPE, "keep": 0.5})
    append(tmp_path, dataclasses.replace(entries(tmp_path)[0], versions={"hazard-ms": "0.0.9"}))
    with pytest.raises(ValueError, match=r"must hold episodes of hazard-ms \d.* only, got kitchen_b.* of 0\.0\.9"):
        recorded(tmp_path, RECIPE)
