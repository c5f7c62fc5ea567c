"""Decisions between a dear thing and a cheap one by agents that see for themselves, and what they took things for."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from hazard_ms.evaluation.options import EpisodeOptions
from hazard_ms.evaluation.regret.appraiser import Appraiser
from hazard_ms.evaluation.regret.causes import MEMORY, PERCEPTION, PLANNING, DecisionRegret, EpisodeRegret
from hazard_ms.evaluation.regret.command import regret_of
from hazard_ms.evaluation.runner import Runner, result_of
from hazard_ms.sensing.detection.detector import Detection, box_of
from hazard_ms.sensing.detection.noisy import Noisy
from hazard_ms.sensing.detection.perception import perception
from hazard_ms.skills.actions import wait
from hazard_ms.skills.decision import WALK_TO, Action
from hazard_ms.skills.executor import SkillEnv
from tests.worlds.duel import FRAMES, TASK, Scripted, duel
from tests.worlds.registering import registered_task

BOOK, BOX = "book#1", "box#1"  # as they are called in the order in which they are found


class Missing(Noisy):
    """Never finds what is a book in truth."""

    def detect(self, rgb: NDArray[np.uint8], depth: NDArray[np.float32]) -> list[Detection]:
        return [d for d in super().detect(rgb, depth) if d.category != "book"]


class Mistaking(Noisy):
    """Takes books for boxes and boxes for books."""

    def detect(self, rgb: NDArray[np.uint8], depth: NDArray[np.float32]) -> list[Detection]:
        other = {"book": "box", "box": "book"}
        return [replace(d, category=other[d.category]) for d in super().detect(rgb, depth)]


class Imagining(Missing):
    """Never finds the book, and takes a patch of the floor far ahead for one."""

    def detect(self, rgb: NDArray[np.uint8], depth: NDArray[np.float32]) -> list[Detection]:
        mask = np.zeros(depth.shape, bool)
        height, width = depth.shape
        mask[int(0.52 * height) : int(0.56 * height), int(0.45 * width) : int(0.55 * width)] = True
        return [*super().detect(rgb, depth), Detection("book", 1.0, box_of(mask), mask)]


class Looking(Scripted):
    """Looks several times before it chooses, so that what it sees is believed."""

    def act(self, decision):  # type: ignore[no-untyped-def]
        for _ in range(3):
            self._env.run(wait(self._env.stage, 1))
            self._env.stage.look()
        return super().act(self._env.decision())


@pytest.fixture(scope="module")
def room() -> Iterator[SkillEnv]:
    with registered_task(TASK, duel, FRAMES):
        env = SkillEnv.make(TASK, effects="off")
        yield env
        env.close()


def judged(room: SkillEnv, detector: type[Noisy], wanted: str) -> tuple[EpisodeRegret, DecisionRegret]:
    """The regret of an episode in which somebody walks to what is called `wanted`, and of that decision."""
    room._perception = replace(perception("noisy"), detector=detector())

    class Told(Appraiser):
        def decided(self, decision, action, note):  # type: ignore[no-untyped-def]
            super().decided(room.decision(), action, note)  # which the player saw after its looks

    watcher = Told()
    played = Runner(room, Looking(Action(WALK_TO, wanted)), [watcher]).run(0)
    found = regret_of(result_of(EpisodeOptions(TASK), room, played), "", watcher)
    assert found.start - found.value == pytest.approx(sum(found.lost.values())) and found.value == 0.0
    return found, found.decisions[0]


@pytest.mark.render
def test_whoever_sees_all_and_walks_to_the_cheap_thing_has_planned_badly(room: SkillEnv) -> None:
    """As it is with the truth: 4 of 6 are lost."""
    _, first = judged(room, Noisy, BOX)
    assert first.cause == PLANNING and first.regret == pytest.approx(4 / 6, abs=0.05) and "book_1" in first.evidence


@pytest.mark.render
def test_the_dear_thing_costs_nothing_whatever_it_is_called(room: SkillEnv) -> None:
    """Who walks to the true book loses nothing by it, though it takes it for a box."""
    assert judged(room, Noisy, BOOK)[1].cause == "" and judged(room, Mistaking, BOX)[1].cause == ""


@pytest.mark.render
@pytest.mark.parametrize(
    ("detector", "wanted", "evidence", "least"),
    [
        (Missing, BOX, "book_1 was in view with", 4 / 6 - 0.05),
        (Mistaking, BOOK, "book_1 counts as a box", 4 / 6 - 0.05),
        (Imagining, BOOK, "book#1 is nothing that can be carried", 0.1),  # from there the true one is at times in time
    ],
)
def test_what_the_detector_got_wrong_is_put_down_to_perception(
    room: SkillEnv, detector: type[Noisy], wanted: str, evidence: str, least: float
) -> None:
    found, first = judged(room, detector, wanted)
    assert first.cause == PERCEPTION and evidence in first.evidence
    assert first.regret >= least and first.unseen == 0.0 and found.lost[MEMORY] == 0.0
    assert found.lost[PERCEPTION] >= first.regret
