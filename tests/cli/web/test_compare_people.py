"""The tables of the benchmark have a place for people."""

from __future__ import annotations

from pathlib import Path

from hazard_ms.evaluation.comparison.folders import groups
from hazard_ms.evaluation.comparison.summary import summary
from results.make import section
from tests.worlds.courses import course, fate


def test_people_are_a_row_of_the_table_with_their_number_of_episodes(tmp_path: Path) -> None:
    """A person rescues 1 of 2 in one episode, the planner all in two; a second person rescues nothing in wind."""
    course("planner", 0, [fate(1, 100), fate(1, 200)]).write(tmp_path / "a.json")
    course("planner", 1, [fate(1, 100), fate(1, 200)]).write(tmp_path / "b.json")
    course("human", 1, [fate(1, 300), fate(1, None)]).write(tmp_path / "c.json")
    course("human", 1, [fate(1, None)], env_id="HazardWind-v1").write(tmp_path / "d.json")
    fire, wind = (section(summary(group)) for group in groups([tmp_path])[0])
    assert "| human (people) | 50.0 [50.0, 50.0] | 300.0 [300.0, 300.0] | 0.0 [0.0, 0.0] | - | 1 of 2 | 1 |" in fire
    assert fire.index(next(line for line in fire if "planner |" in line)) < len(fire) - 2
    assert fire[-1] == "- planner less human: 50.0 [50.0, 50.0] on 1 episodes"
    assert "| human (people) | 0.0 [0.0, 0.0] | – | – | - | 0 of 1 | 1 |" in wind
