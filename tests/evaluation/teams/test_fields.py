"""Results of teams: what they tell beside what those of one robot do, and that these stay as they are."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from hazard_ms.evaluation.averted.loss import Loads
from hazard_ms.evaluation.options import EpisodeOptions, SweepOptions
from hazard_ms.evaluation.page import page
from hazard_ms.evaluation.replay import DIFFERENT, EXACT, compare, episode_of, job_of
from hazard_ms.evaluation.report import report
from hazard_ms.evaluation.result import DamagedResultError, DecisionRecord, EpisodeResult
from hazard_ms.skills.decision import EXPLORE, PICK_UP, WALK_TO
from tests.worlds.files.html_pages import Reader
from tests.worlds.results import result_of

PAIR = EpisodeOptions("HazardWind-v1", robot_uids=("fetch", "g1"), agent="joint", seed=3)
DECISIONS = (
    DecisionRecord(0, EXPLORE, None, True, "", 60, robot="fetch-0"),
    DecisionRecord(0, WALK_TO, "pan_1", False, "no_path", 40, "why", robot="g1-1"),
    DecisionRecord(40, PICK_UP, "pan_1", False, "episode_over", 90, robot="g1-1"),
)
LOADS = {"fetch-0": Loads(heat=0.25), "g1-1": Loads(collisions=1)}
TEAM = replace(result_of(PAIR), decisions=DECISIONS, robot_collisions=2, format=4, robot_loads=LOADS)


def test_a_result_of_one_robot_has_none_of_it() -> None:
    """Its keys are those that format 3 had before there were teams."""
    one = replace(result_of(EpisodeOptions()), decisions=(DecisionRecord(0, EXPLORE, None, True, "", 60),))
    row = json.loads(one.to_json())
    of_episode = "score env_id agent seed scene settings frames max_frames ended targets decisions command links error"
    timing = "wall_seconds phase_seconds clock perception eyes counters files lost lost_alone loads"
    assert list(row) == [*of_episode.split(), *timing.split(), "versions", "machine", "format"]
    told = "frame verb target ok reason frames note held value waited fallback thought"
    assert list(row["decisions"][0]) == told.split()
    assert row["format"] == 3 and row["settings"]["robot_uids"] == "fetch"


def test_a_result_of_a_team_survives_its_file(tmp_path: Path) -> None:
    TEAM.write(tmp_path / "team.json")
    row = json.loads((tmp_path / "team.json").read_text())
    assert row["format"] == 4 and row["robot_collisions"] == 2 and row["robot_loads"]["fetch-0"]["heat"] == 0.25
    assert [d["robot"] for d in row["decisions"]] == ["fetch-0", "g1-1", "g1-1"]
    read = EpisodeResult.read(tmp_path / "team.json")
    assert read == replace(TEAM, settings={**TEAM.settings, "robot_uids": ["fetch", "g1"]})
    again = episode_of(read)
    assert (again.robot_uids, again.team, again.settings) == (("fetch", "g1"), ("fetch-0", "g1-1"), PAIR.settings)
    assert job_of(read).robots == ("fetch-0", "g1-1", "g1-1")


@pytest.mark.parametrize(
    ("change", "told"),
    [
        ({"decisions": [{**DECISIONS[0].__dict__, "robot": "fetch-1"}]}, "must be one of fetch-0, g1-1, got 'fetch-1'"),
        ({"robot_loads": {"fetch-1": {}}}, "a robot of a result must be one of fetch-0, g1-1, got 'fetch-1'"),
        ({"format": 3}, "got format 3 and 2 for 2 robots"),
        ({"robot_collisions": None}, "got format 4 and None for 2 robots"),
        ({"settings": {"robot_uids": "fetch"}}, "got format 4 and 2 for 1 robots"),
    ],
)
def test_what_no_team_can_have_is_refused(change: dict[str, Any], told: str, tmp_path: Path) -> None:
    (tmp_path / "team.json").write_text(json.dumps({**TEAM.to_dict(), **change}))
    with pytest.raises(DamagedResultError, match=told):
        EpisodeResult.read(tmp_path / "team.json")


def test_other_collisions_are_another_episode() -> None:
    assert compare(TEAM, TEAM) == (EXACT, "")
    verdict, why = compare(TEAM, replace(TEAM, robot_collisions=5))
    assert verdict == DIFFERENT and "2 collisions of robots in the file, 5 now" in why


def test_the_page_and_the_table_tell_of_each_robot() -> None:
    reader, shown = Reader(), page(TEAM)
    reader.feed(shown)
    assert not reader.open and shown.count("<td>g1-1</td>") == 2 and shown.count("<td>fetch-0</td>") == 1
    assert "<title>g1-1, frame 40: pick_up pan_1 unfinished</title>" in shown and "collisions of robots" in shown
    rows = {line.partition('y="')[2].partition('"')[0] for line in shown.splitlines() if "<rect" in line}
    assert rows == {"112", "142"}
    alone = page(result_of(EpisodeOptions()))
    assert "robot</th>" not in alone and 'viewBox="-20 -14 1040 166"' in alone
    options = SweepOptions(PAIR, agents=("joint",), episodes=2)
    told = report(options, [TEAM, replace(TEAM, seed=4, robot_collisions=1)])
    assert "robots fetch and g1" in told and "joint: 3 collisions of robots with one another in 2 episodes" in told
