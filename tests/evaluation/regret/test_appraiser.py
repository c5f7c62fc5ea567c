"""Decisions between a dear thing and a cheap one, of which only one can be saved: each fault has its own cause."""

from __future__ import annotations

import copy
import dataclasses
from collections.abc import Callable, Iterator
from types import MappingProxyType

import numpy as np
import pytest

from hazard_ms.evaluation.options import EpisodeOptions
from hazard_ms.evaluation.regret.appraiser import Appraiser
from hazard_ms.evaluation.regret.causes import (
    BY_FORMAT,
    EXECUTION,
    LATENCY,
    MEMORY,
    PERCEPTION,
    PLANNING,
    EpisodeRegret,
)
from hazard_ms.evaluation.regret.command import regret_of
from hazard_ms.evaluation.runner import Runner, result_of
from hazard_ms.skills.actions import wait
from hazard_ms.skills.context import Skill
from hazard_ms.skills.decision import STOP, WALK_TO, Action, Decision, Result
from hazard_ms.skills.executor import SkillEnv
from tests.worlds.duel import CHEAP, DEAR, FRAMES, PAUSE, TASK, Scripted, duel
from tests.worlds.registering import registered_task


@pytest.fixture(scope="module")
def room() -> Iterator[SkillEnv]:
    with registered_task(TASK, duel, FRAMES):
        env = SkillEnv.make(TASK, effects="off")
        yield env
        env.close()


Shown = Callable[[Decision], Decision]


def judged(room: SkillEnv, player: Scripted, shown: Shown = lambda decision: decision) -> EpisodeRegret:
    """The regret of an episode in which the first decision is `shown` otherwise to the judge."""

    class Told(Appraiser):
        def decided(self, decision: Decision, action: Action, note: str) -> None:
            super().decided(decision if self.appraisals else shown(decision), action, note)

    watcher = Told()
    pause = player.pause
    played = Runner(room, player, [watcher]).run(0)
    assert [decision.waited for decision in played.decisions] == [pause, 0]
    found = regret_of(result_of(EpisodeOptions(TASK), room, played), "", watcher)
    assert found.start - found.value == pytest.approx(sum(found.lost.values())) and found.value == 0.0
    return found


def with_object(decision: Decision, name: str, away: float | None) -> Decision:
    """The decision with a thing `away` [m] from where the map has it, or out of the map."""
    index, objects = decision.index(name), dict(decision.map.objects)
    seen, made = objects.pop(index), copy.copy(decision.map)
    if away is not None:
        objects[index] = dataclasses.replace(seen, position=seen.position + np.array([0.0, away, 0.0], np.float32))
    vars(made)["objects"] = MappingProxyType(objects)
    return dataclasses.replace(decision, map=made)


def as_cheap(decision: Decision) -> Decision:
    rows = [dataclasses.replace(row, category="box", value=1.0) for row in decision.targets]
    return dataclasses.replace(decision, targets=tuple(rows))


@pytest.mark.render
@pytest.mark.parametrize(
    ("shown", "cause"),
    [
        (lambda decision: decision, PLANNING),
        (lambda decision: with_object(decision, DEAR, None), PERCEPTION),
        (as_cheap, PERCEPTION),
        (lambda decision: with_object(decision, DEAR, 4.0), MEMORY),
        (lambda decision: with_object(decision, DEAR, 0.4), PLANNING),
        (lambda decision: with_object(decision, CHEAP, 4.0), PLANNING),
    ],
    ids=["nothing", "missed", "mistaken", "misplaced", "nearly right", "another misplaced"],
)
def test_to_go_for_the_cheap_thing_is_put_down_to_what_the_map_held(room: SkillEnv, shown: Shown, cause: str) -> None:
    """Both can be reached alike, and whoever walks to one is too late for the other: 4 of 6 are lost."""
    first, last = judged(room, Scripted(Action(WALK_TO, CHEAP)), shown).decisions
    assert (first.cause, last.verb) == (cause, STOP)
    assert first.best == pytest.approx(5 / 6) and first.regret == pytest.approx(4 / 6) and first.unseen == 0.0
    assert DEAR in first.evidence and last.regret >= 1 / 6


@pytest.mark.render
def test_the_right_choice_that_comes_too_late_is_latency(room: SkillEnv) -> None:
    first, _ = judged(room, Scripted(Action(WALK_TO, DEAR), pause=PAUSE)).decisions
    assert first.cause == LATENCY and f"the agent took {PAUSE} frames to choose" in first.evidence
    assert first.regret == pytest.approx(5 / 6, abs=0.05)
    slow_and_wrong = judged(room, Scripted(Action(WALK_TO, CHEAP), pause=PAUSE)).decisions[0]
    assert slow_and_wrong.cause == PLANNING


@pytest.mark.render
def test_what_stands_in_for_an_answer_is_put_down_to_its_format(room: SkillEnv) -> None:
    first, _ = judged(room, Scripted(Action(WALK_TO, CHEAP), fallback=True)).decisions
    assert first.cause == BY_FORMAT


@pytest.mark.render
def test_a_skill_that_takes_too_long_loses_by_execution(room: SkillEnv) -> None:
    """A blameless choice, and a walk that stands still for a while at its end."""
    run = room.run

    def slowly(doing: Skill) -> Result:
        result = run(doing)
        run(wait(room.stage, PAUSE if result.frames else 0))
        return result

    room.run = slowly  # type: ignore[method-assign]
    try:
        found = judged(room, Scripted(Action(WALK_TO, DEAR)))
    finally:
        room.run = run  # type: ignore[method-assign]
    assert found.decisions[0].cause == "" and found.lost[EXECUTION] > 0.6
