"""Journals: what is kept of a rescue under way, and what is refused."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import pytest

from hazard_ms.web import rescue as rescues
from hazard_ms.web.rescue import Taken, asked_for, journal, keep, read, taken_over


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
    with pytest.raises(ValueError, match="sees no more than a person"):
        taken_over(asked_for({"kind": "watch", "agent": "oracle"}, ()), 0)


def test_an_agent_whose_result_could_not_be_named_is_refused_before_it_plays() -> None:
    with pytest.raises(ValueError, match="agent must have at most 120 bytes"):
        asked_for({"kind": "watch", "agent": "greedy:give_up=" + "0" * 200 + "3"}, ())
