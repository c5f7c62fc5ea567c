"""The causes of regrets by their definitions (docs/regret.md), and the sums of what was lost."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import pytest

from hazard_ms.evaluation.regret.causes import (
    BY_FORMAT,
    CAUSES,
    ENDED,
    EXECUTION,
    LATENCY,
    MEMORY,
    MITIGATION,
    PARTS,
    PERCEPTION,
    PLANNING,
    SMALL,
    UNSEEN,
    Appraisal,
    EpisodeRegret,
    Without,
    beside,
    cause_of,
    decisions_of,
    digest,
    lost_by,
    place_of,
)
from hazard_ms.evaluation.regret.table import shares, table

CHOICE = Appraisal(120, "walk_to", "pan_1", best=0.9, regret=0.2, seen=0.2, instead="to rescue book_1")


def having(seen: float = 0.2, **left: float) -> Appraisal:
    """A choice with a regret of 0.2, `seen` of it among known targets, of which some is `left` without each cause."""
    without = {name: Without(regret, f"{name} went wrong") for name, regret in left.items()}
    return dataclasses.replace(CHOICE, seen=seen, without=without)


@pytest.mark.parametrize(
    ("appraisal", "fallback", "cause"),
    [
        (dataclasses.replace(CHOICE, regret=0.02, seen=0.02), True, ""),
        (having(seen=0.02), True, UNSEEN),
        (having(perception=0.1, memory=0.0, latency=0.0), True, PERCEPTION),
        (having(perception=0.11, memory=0.1, latency=0.0), True, MEMORY),
        (having(perception=0.11, memory=0.11, latency=0.0), True, BY_FORMAT),
        (having(perception=0.11, memory=0.11, latency=0.1), False, LATENCY),
        (having(perception=0.11, memory=0.11, latency=0.11), False, PLANNING),
        (having(latency=0.1, mitigation=0.0), False, LATENCY),
        (having(latency=0.11, mitigation=0.1), False, MITIGATION),
        (having(mitigation=0.11), False, PLANNING),
        (having(seen=0.1, perception=0.06), False, PLANNING),
        (having(), False, PLANNING),
    ],
)
def test_the_first_cause_that_explains_half_of_a_regret_is_to_blame(
    appraisal: Appraisal, fallback: bool, cause: str
) -> None:
    found, evidence = cause_of(appraisal, fallback)
    assert found == cause and bool(evidence) == bool(cause)
    if cause in (PERCEPTION, MEMORY, LATENCY, MITIGATION):
        assert f"{cause} went wrong; without that the choice loses 10.0 instead of 20.0 % of the value" in evidence
    if cause == PLANNING:
        assert "to rescue book_1 was worth" in evidence


def test_all_that_was_lost_adds_up() -> None:
    """From 0.9 to 0.3 in four decisions: 0.1 unseen and 0.1 planning, 0.2 latency, 0.01 small, the rest by skills."""
    rows = [
        having(seen=0.1),
        dataclasses.replace(having(latency=0.0), best=0.65),
        dataclasses.replace(having(seen=0.01), best=0.5, regret=0.01),
        dataclasses.replace(having(), best=0.5, regret=0.0, seen=0.0),
    ]
    landings = [0.65, 0.5, 0.5, 0.35]
    decisions = decisions_of(rows, [False] * 4, landings)
    assert [row.cause for row in decisions] == [PLANNING, LATENCY, "", ""]
    assert [row.execution for row in decisions] == pytest.approx([0.05, -0.05, -0.01, 0.15])
    lost = lost_by(decisions, 0.05)
    wanted = {UNSEEN: 0.1, PLANNING: 0.1, LATENCY: 0.2, SMALL: 0.01, EXECUTION: 0.14, ENDED: 0.05}
    assert lost == pytest.approx({part: wanted.get(part, 0.0) for part in PARTS})
    assert sum(lost.values()) == pytest.approx(0.9 - 0.3) and set(CAUSES) < set(PARTS)


def test_what_fails_at_once_loses_nothing() -> None:
    """0.2 would be lost by the walk that was chosen; it finds no path, and all is as it was, twice. Then it is made."""
    decisions = decisions_of([having(seen=0.2)] * 3, [False] * 3, [0.9, 0.9, 0.7], [0, 0, 80])
    assert [(row.regret, row.execution) for row in decisions[:2]] == [(0.0, 0.0)] * 2
    assert decisions[2].regret == pytest.approx(0.2) and decisions[2].execution == pytest.approx(0.0)
    (stop,) = decisions_of([having(seen=0.2)], [False], [0.7], [0])
    assert (stop.regret, stop.execution) == (pytest.approx(0.2), pytest.approx(0.0))


def test_a_decision_whose_regret_is_almost_all_unseen_keeps_the_rest_as_small() -> None:
    (row,) = decisions_of([having(seen=0.015)], [False], [0.7])
    assert (row.cause, row.unseen, row.execution) == (UNSEEN, pytest.approx(0.185), pytest.approx(0.0))
    assert lost_by([row], 0.0)[SMALL] == pytest.approx(0.015)


def made(result: Path, agent: str = "greedy", value: float = 0.3) -> EpisodeRegret:
    decisions = decisions_of([having()], [False], [value])
    return EpisodeRegret(digest(result), agent, 3, "room/00", 0.9, value, lost_by(decisions, 0.0), decisions)


def test_a_file_belongs_to_its_result(tmp_path: Path) -> None:
    result = tmp_path / "greedy-1.5-0003.json"
    result.write_text("one")
    assert beside(result) is None
    regret = made(result)
    regret.write(place_of(result))
    assert place_of(result).name == "greedy-1.5-0003.regret.json" and beside(result) == regret
    result.write_text("two")
    assert beside(result) is None
    place_of(result).write_text("{}")
    with pytest.raises(ValueError, match=r"0003.regret.json must hold what `hazard-ms regret` wrote: .*delete it"):
        beside(result)


def test_an_agents_loss_is_the_mean_over_its_episodes(tmp_path: Path) -> None:
    result = tmp_path / "one.json"
    result.write_text("one")
    found = [made(result), made(result, value=0.5), made(result, "planner")]
    row = shares(found[:2])
    assert (row["start"], row["value"]) == pytest.approx((0.9, 0.4))
    assert (row[PLANNING], row[EXECUTION]) == pytest.approx((0.2, 0.3))
    lines = table(found).splitlines()
    assert [line.split()[0] for line in lines[1:]] == ["greedy", "planner"] and lines[1].split()[-1] == "2"
    assert MITIGATION not in lines[0]
    there = table([*found, dataclasses.replace(found[0], averts=True)]).splitlines()[0].split()
    assert there.index(MITIGATION) + 1 == there.index(PLANNING)
    with pytest.raises(ValueError, match="episodes must hold at least one, got none"):
        shares([])


def test_all_that_is_lost_by_going_for_what_is_no_target_is_lost_by_perception() -> None:
    """0.9 could be reached before, 0.3 after it: the hand that found nothing there has done nothing wrong."""
    taken = dataclasses.replace(CHOICE, regret=0.1, seen=0.0, mistaken="pan_1 is a lamp")
    (found,) = decisions_of([taken], [False], [0.3])
    assert (found.cause, found.evidence) == (PERCEPTION, "pan_1 is a lamp")
    assert found.regret == pytest.approx(0.6) and found.execution == pytest.approx(0.0) and found.unseen == 0.0
    lost = lost_by([found], 0.0)
    assert lost[PERCEPTION] == pytest.approx(0.6) and lost[EXECUTION] == pytest.approx(0.0)
