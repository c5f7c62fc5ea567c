"""Regret where a fire can be fought: it should have been, or was in vain; all parts still add up."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from hazard_ms.evaluation.averted.account import Account
from hazard_ms.evaluation.options import EpisodeOptions
from hazard_ms.evaluation.regret.appraiser import Appraiser
from hazard_ms.evaluation.regret.causes import MITIGATION, PARTS, PLANNING, UNSEEN, EpisodeRegret
from hazard_ms.evaluation.regret.command import line, regret_of, sees_all
from hazard_ms.evaluation.regret.table import table
from hazard_ms.evaluation.runner import Runner, result_of
from hazard_ms.skills.decision import DROP, EXPLORE, PICK_UP, WALK_TO, Action
from hazard_ms.skills.executor import SkillEnv
from hazard_ms.spec import SceneSpec
from tests.worlds.duel import Scripted
from tests.worlds.fire_fights import around, room, task_in
from tests.worlds.registering import registered_task

pytestmark = pytest.mark.render
FRAMES = 900
# eight books that burn from frame 440 to 505, and an extinguisher beside the robot
RING = room("ring", (7.5, 4.0), (4.4, 4.0), around((7.5, 4.0), 0.9, 8))
# a book 4 m to the east that burns at frame 425, and an extinguisher 4 m to the west
VAIN = room("vain", (9.9, 4.0), (1.0, 4.0), [(9.0, 4.0)])
TOOL = "powder_0"


def made(scene: SceneSpec) -> Iterator[SkillEnv]:
    task = f"HazardFireFight{scene.name.rpartition('/')[2].title()}-v1"
    with registered_task(task, task_in(scene), FRAMES):
        env = SkillEnv.make(task, sensor_configs={"width": 128, "height": 128}, effects="off")
        yield env
        env.close()


@pytest.fixture(scope="module")
def ring() -> Iterator[SkillEnv]:
    yield from made(RING)


@pytest.fixture(scope="module")
def vain() -> Iterator[SkillEnv]:
    yield from made(VAIN)


def judged(env: SkillEnv, *actions: Action, told: bool = False) -> EpisodeRegret:
    """The regret of an episode of these actions; the value at its end is what its account says is not lost."""
    watcher, account = Appraiser(told=told), Account()
    played = Runner(env, Scripted(*actions), [watcher, account]).run(0)
    found = regret_of(result_of(EpisodeOptions(env.base.task.name), env, played), "", watcher)
    lost = account.close()
    assert lost is not None and found.value == pytest.approx(1.0 - lost.targets / lost.targets_total)
    assert found.averts and found.start - found.value == pytest.approx(sum(found.lost.values()))
    return found


RESCUES = (Action(WALK_TO, "book_4"), Action(PICK_UP, "book_4"), Action(DROP), Action(PICK_UP, "book_3"), Action(DROP))


def test_who_leaves_a_fire_that_could_be_put_out_loses_by_mitigation(ring: SkillEnv) -> None:
    """All eight books could be kept; two are, and six keep a half each: 5/8 is not lost.

    By frame 240 it is too late for the fire, and with rescues alone four books burn: a quarter of the value is gone.
    """
    found = judged(ring, Action(EXPLORE), *RESCUES)
    assert found.start == pytest.approx(1.0, abs=1e-5) and found.value == 5 / 8
    blamed = [row for row in found.decisions if row.cause == MITIGATION]
    assert [(row.verb, row.target, row.unseen) for row in blamed] == [(PICK_UP, "book_3", 0.0)]
    assert blamed[0].regret == pytest.approx(4 * 0.5 / 8, abs=1e-5)
    assert f"nothing was done about the hazard, where it helps to fetch {TOOL}, put out fire 0" in blamed[0].evidence
    assert found.lost[MITIGATION] == pytest.approx(blamed[0].regret) and found.decisions[-1].cause == PLANNING
    assert "62.5 of 100.0 % of the value is not lost" in line(found) and MITIGATION in table([found])


def test_who_puts_it_out_loses_nothing(ring: SkillEnv) -> None:
    fetch = (Action(EXPLORE), Action(WALK_TO, TOOL), Action(PICK_UP, TOOL), Action(WALK_TO, "book_4"))
    found = judged(ring, *fetch, Action("extinguish", "book_4"), Action(DROP))
    assert found.value == 1.0 and all(abs(share) < 1e-5 for share in found.lost.values())


def test_what_was_not_seen_could_not_be_fought_unless_everything_was_told(ring: SkillEnv) -> None:
    """The robot faces the fire, not the extinguisher behind it, so that it knows of none."""
    seen, told = judged(ring, *RESCUES), judged(ring, *RESCUES, told=True)
    assert seen.lost[MITIGATION] == 0.0 and told.lost[UNSEEN] == 0.0
    assert told.lost[MITIGATION] == pytest.approx(seen.lost[UNSEEN]) and seen.lost[UNSEEN] > 1 / 8


def test_to_fight_where_a_rescue_would_have_been_in_time_is_lost_by_mitigation(vain: SkillEnv) -> None:
    """The book is 4 m away and could be safe by 300; after 100 frames the other way it cannot: half of it is lost."""
    found = judged(vain, Action(EXPLORE), Action(WALK_TO, TOOL))
    _, walk, _ = found.decisions
    assert found.start == pytest.approx(1.0, abs=1e-5) and found.value == 0.5
    assert (
        walk.cause == MITIGATION
        and walk.regret == pytest.approx(0.5, abs=1e-5)
        and walk.execution == pytest.approx(0.0)
    )
    assert f"walk_to {TOOL} was done about the hazard, where something else averts more" in walk.evidence
    assert {part for part in PARTS if abs(found.lost[part]) > 1e-5} == {MITIGATION}


def test_the_oracle_alone_sees_all() -> None:
    given = ["oracle", "oracle:mitigate=false", "oracle:known=true", "greedy", "some.module:Agent"]
    assert [sees_all(name) for name in given] == [True, True, False, False, False]
