"""What the page of comparisons shows is what the results say: against `hazard-ms report`, and worked out by hand."""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import Any
from urllib.parse import quote

import numpy as np
import pytest

from hazard_ms.cli.__main__ import main
from hazard_ms.cli.web.compare.numbers import MOST_AGENTS
from hazard_ms.evaluation.regret.causes import (
    EXECUTION,
    PARTS,
    PLANNING,
    DecisionRegret,
    EpisodeRegret,
    digest,
    place_of,
)
from hazard_ms.evaluation.result import DecisionRecord
from tests.worlds.asking import Asking
from tests.worlds.courses import course, drawn, fate

SKILLS = {"greedy": 0.6, "oracle": 0.95, "human": 0.8}
SETTINGS = "HazardFire-v1, split test, physics paper, robot fetch"


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """Six episodes of two agents, three of a person, and one episode in wind."""
    for agent, skill in SKILLS.items():
        (tmp_path / "results" / agent).mkdir(parents=True)
        for seed in range(3 if agent == "human" else 6):
            drawn(agent, seed, skill).write(tmp_path / "results" / agent / f"{seed}.json")
    drawn("greedy", 0, 0.6, "HazardWind-v1").write(tmp_path / "results" / "wind.json")
    return tmp_path / "results"


def numbers(asking: Asking, settings: str = SETTINGS, more: str = "") -> dict[str, Any]:
    answer = asking.get(f"/api/compare/numbers?settings={quote(settings)}{more}")
    assert answer.status == 200, answer.body
    return answer.json  # type: ignore[no-any-return]


def test_the_numbers_are_those_of_the_report(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["report", str(folder), "--json"]) == 0
    told = {group["settings"]: group for group in json.loads(capsys.readouterr().out)["groups"]}
    found = numbers(Asking(folder))
    assert {name: found[name] for name in told[SETTINGS]} == told[SETTINGS]
    assert [len(row["cells"]) for row in found["rows"]] == [3, 3, 3, 2, 2, 2] and found["people"] == ["human"]
    assert found["agents"]["human"]["episodes"] == 3 and found["agents"]["human"]["regret"]["mean"] is not None


def test_values_and_curves_against_numbers_worked_out_by_hand(tmp_path: Path) -> None:
    """Of 8 in value: 5 whole at 300, 1 damaged at 400 and rescued at 600, 1 damaged at 900, 1 left."""
    course("greedy", 0, [fate(5, 300), fate(1, 600, 400), fate(1, None, 900), fate(1, None)]).write(tmp_path / "a.json")
    course("greedy", 1, [fate(5, None)]).write(tmp_path / "b.json")
    found = numbers(Asking(tmp_path))
    assert [row["cells"]["greedy"]["value"] for row in found["rows"]] == [5.5 / 8, 0.0]
    row = found["agents"]["greedy"]
    assert (row["value"]["mean"], row["step"]["mean"], row["damage"]["mean"]) == (5.5 / 16, 300.0, 0.5)
    for frame, value, whole, damaged in (
        (0, 0, 5, 0),
        (300, 5 / 16, 4, 0),
        (600, 5.5 / 16, 3, 0),
        (900, 5.5 / 16, 2, 1),
    ):
        at = int(np.searchsorted(found["frames"], frame))
        assert found["values"]["greedy"][at] == pytest.approx(value, abs=1e-4)
        assert 5 * found["fates"]["greedy"]["whole"][at] == pytest.approx(whole, abs=1e-3)
        assert 5 * found["fates"]["greedy"]["damaged"][at] == pytest.approx(damaged, abs=1e-3)


def test_folders_and_groups_say_what_is_in_them(folder: Path) -> None:
    asking = Asking(folder)
    told = {row["name"]: row for row in asking.get("/api/compare/folders").json["folders"]}
    assert {name: row["results"] for name, row in told.items()} == {
        "results": 1,
        "results/greedy": 6,
        "results/human": 3,
        "results/oracle": 6,
    }
    assert told["results/human"]["agents"] == [{"name": "human", "person": True}]
    assert told["results/greedy"]["settings"] == [SETTINGS]
    groups = {row["settings"]: row["results"] for row in asking.get("/api/compare/groups").json["groups"]}
    assert groups == {SETTINGS: 15, SETTINGS.replace("Fire", "Wind"): 1}
    few = numbers(asking, more=f"&folder={told['results/human']['key']}&folder={told['results/oracle']['key']}")
    assert set(few["agents"]) == {"human", "oracle"}
    refused = asking.get("/api/compare/groups?folder=nowhere")
    assert refused.status == 400 and refused.json["error"] == "folder must be one of those on the page, got 'nowhere'"
    assert asking.get("/api/compare/numbers?settings=another").status == 400


def test_what_counts_once_is_counted_once_and_the_rest_is_named(folder: Path) -> None:
    (folder / "later").mkdir()
    drawn("human", 0, 0.1).write(folder / "later" / "again.json")
    for number in range(MOST_AGENTS):
        course(f"agent-{number:02d}", 0, [fate(1, 100)]).write(folder / "later" / f"one-{number:02d}.json")
    found = numbers(Asking(folder))
    assert len(found["agents"]) == MOST_AGENTS and set(SKILLS) <= set(found["agents"])
    assert found["rows"][0]["cells"]["human"]["value"] == drawn("human", 0, 0.8).tally.value
    reasons = {row["name"]: row["reason"] for row in found["left_out"]}
    assert reasons["results/later/again.json"] == "the same agent and episode as results/human/0.json, which counts"
    late = {name.removeprefix("results/later/") for name in reasons}
    assert late == {"again.json", "one-17.json", "one-18.json", "one-19.json"} and found["left_out_count"] == 4


def test_timelines_hold_decisions_and_their_regrets(tmp_path: Path) -> None:
    decisions = [
        DecisionRecord(0, "explore", None, True, "", 60, "nothing known"),
        DecisionRecord(70, "walk_to", "pen_1", False, "no_path", 90, held="cup_1", value=0.5, waited=12),
    ]
    path = tmp_path / "a.json"
    course("human", 0, [fate(1, 40), fate(1, None, 130)], decisions).write(path)
    judged = DecisionRegret(70, "walk_to", "pen_1", 0.8, 0.25, 0.05, -0.1, PLANNING, "to rescue the cup was worth more")
    lost = dict.fromkeys(PARTS, 0.0) | {PLANNING: 0.2, EXECUTION: 0.1}
    EpisodeRegret(digest(path), "human", 0, "x", 0.9, 0.5, lost, (judged,)).write(place_of(path))
    path.with_suffix(".mp4").write_bytes(b"a film")
    asking = Asking(tmp_path)
    cell = numbers(asking)["rows"][0]["cells"]["human"]
    assert cell["film"] and cell["judged"] and cell["ended"] == "time"
    (made,) = asking.get(f"/api/compare/episodes?key={cell['key']}").json["episodes"]
    first, second = made["decisions"]
    assert made["person"] and (first["note"], first["outcome"], first["regret"]) == ("nothing known", "done", None)
    assert (second["frame"], second["waited"], second["frames"], second["outcome"]) == (70, 12, 90, "failed")
    assert second["regret"]["cause"] == PLANNING and second["regret"]["lost"] == 0.25 and second["held"] == "cup_1"
    assert [(t["rescued"], t["damaged"]) for t in made["targets"]] == [(40, None), (None, 130)]
    assert made["lost"] == {"start": 0.9, "value": 0.5, "parts": lost}
    assert asking.get(made["film_link"]).body == b"a film"
    page = asking.get(made["page_link"])
    assert page.headers["content-type"].startswith("text/html") and 'src="../0/a.mp4"' in page.body.decode()
    assert asking.get(f"/api/compare/episodes?{'&'.join(['key=' + cell['key']] * 13)}").status == 400


def test_a_file_is_read_once_until_it_changes(tmp_path: Path) -> None:
    path = tmp_path / "a.json"
    course("greedy", 0, [fate(5, 300), fate(5, None)]).write(path)
    asking = Asking(tmp_path)
    assert numbers(asking)["agents"]["greedy"]["value"]["mean"] == 0.5
    text, state = path.read_text(), path.stat()
    path.write_text(text.replace('"agent": "greedy"', '"agent": "unread"'))
    os.utime(path, ns=(state.st_atime_ns, state.st_mtime_ns))
    assert list(numbers(asking)["agents"]) == ["greedy"]
    os.utime(path, ns=(state.st_atime_ns, state.st_mtime_ns + 1))
    assert list(numbers(asking)["agents"]) == ["unread"]
    path.unlink()
    assert asking.get("/api/compare/groups").json == {"groups": []}
