"""Journals: what is kept of a rescue under way, and what is refused."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import pytest

from hazard_ms.cli.web import rescue as rescues
from hazard_ms.cli.web.rescue import Taken, asked_for, journal, keep, read, taken_over


def test_a_journal_gives_the_same_rescue_again(tmp_path: Path) -> None:
    rescue = asked_for({"env_id": "HazardFlood-v1", "seed": 3, "physics": "realistic", "severity": "extreme"}, ())
    rescue = replace(rescue, taken=(Taken("walk_to", "mug_1", 7), Taken("explore", None)))
    keep(tmp_path, rescue)
    assert read(tmp_path, rescue.name, ()) == rescue
    assert rescue.episode.agent == rescues.HUMAN and not list(tmp_path.rglob("*.json"))


@pytest.mark.parametrize("name", ["", "../x", "a" * 15, "A" * 16, "a" * 16 + "\n"])
def test_no_file_is_named_by_a_page(tmp_path: Path, name: str) -> None:
    with pytest.raises(ValueError, match="the name of a rescue must be"):
        journal(tmp_path, name)


@pytest.mark.parametrize(
    "change",
    [
        {"format": 99},
        {"name": "b" * 16},
        {"taken": [{"verb": "fly"}]},
        {"taken": 3},
        {"episode": {"env_id": "HazardFire-v1", "scene": "/etc/scene.json"}},
        {"episode": {"load": ["evil.py"]}},
        {"after": "evil.py:X"},
        {"after": "evil:X"},
        {"after": "greedy:X"},
        {"after": ["greedy"]},
        {"after": "llm:base_url=https://example.com"},
        {"after": "llm:trace=elsewhere"},
        {"after": "rl:weights=/etc/passwd"},
        {"episode": {"agent": "evil.py:X"}},
        {"episode": {"agent": "human:X"}, "kind": "watch"},
        {"episode": {"agent": "greedy:evil"}, "kind": "watch"},
        {"episode": {"agent": "llm:model=a,base_url=https://example.com"}, "kind": "watch"},
        {"episode": {"agent": "human"}, "every": 10**400},
        {"taken": [{"verb": "explore", "target": None, "waited": 10**13}]},
    ],
)
def test_a_journal_that_somebody_changed_is_refused(tmp_path: Path, change: dict) -> None:
    rescue = asked_for({}, ())
    keep(tmp_path, rescue)
    path = journal(tmp_path, rescue.name)
    path.write_text(json.dumps({**json.loads(path.read_text()), **change}))
    with pytest.raises(ValueError, match="must be the journal of a rescue"):
        read(tmp_path, rescue.name, ())


def test_a_person_goes_on_where_an_agent_was() -> None:
    taken = (Taken("explore", None), Taken("walk_to", "mug_1"))
    watched = replace(asked_for({"kind": "watch", "agent": "greedy", "seed": 5}, ()), taken=taken)
    made = taken_over(watched, 1)
    assert made.episode.agent == "human:after=greedy" and made.taken == taken[:1] and made.kind == rescues.PLAY
    assert made.name != watched.name and made.episode.seed == 5
    with pytest.raises(ValueError, match="at must be"):
        taken_over(watched, 3)


def test_nobody_goes_on_with_a_map_that_shows_what_is_hidden() -> None:
    with pytest.raises(ValueError, match="must see no more than a person"):
        taken_over(asked_for({"kind": "watch", "agent": "oracle"}, ()), 0)


def test_an_agent_whose_result_could_not_be_named_is_refused_before_it_plays() -> None:
    with pytest.raises(ValueError, match="agent must have at most 120 bytes"):
        asked_for({"kind": "watch", "agent": "greedy:give_up=" + "0" * 200 + "3"}, ())


def test_a_journal_of_a_stranger_runs_no_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Files of the names that it gives are there, in the folder of results and where the server was started."""
    monkeypatch.chdir(tmp_path)
    for name in ("evil.py", "greedy.py"):
        (tmp_path / name).write_text("import pathlib; pathlib.Path('ran').touch()\nclass X: pass\n")
    watched = asked_for({"kind": "watch", "agent": "greedy"}, ())
    for change in ({"after": "evil.py:X"}, {"after": "greedy:X"}, {"episode": {"agent": "greedy:X"}}):
        keep(tmp_path, watched)
        path = journal(tmp_path, watched.name)
        row = json.loads(path.read_text())
        episode = {**row["episode"], **change.get("episode", {})}
        path.write_text(json.dumps({**row, **change, "episode": episode}))
        with pytest.raises(ValueError, match="must be the journal of a rescue"):
            taken_over(read(tmp_path, watched.name, ()), 0)
    assert not (tmp_path / "ran").exists()


def test_an_agent_with_parameters_goes_on(tmp_path: Path) -> None:
    for agent in ("greedy:give_up=3", "planner:search=0.5,fading=0.1", "llm:way=letter,model=small"):
        watched = asked_for({"kind": "watch", "agent": agent}, ())
        keep(tmp_path, watched)
        assert read(tmp_path, watched.name, ()) == watched


def test_a_folder_of_journals_that_leads_elsewhere_is_not_read(tmp_path: Path) -> None:
    rescue = asked_for({}, ())
    keep(tmp_path / "other", rescue)
    (tmp_path / "results").mkdir()
    (tmp_path / "results" / rescues.JOURNALS).symlink_to(tmp_path / "other" / rescues.JOURNALS)
    with pytest.raises(ValueError, match="link out of it"):
        read(tmp_path / "results", rescue.name, ())
