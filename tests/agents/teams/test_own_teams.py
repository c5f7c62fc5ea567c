"""Teams of one's own: found by module or file and class, with parameters, and run nowhere before they play."""

from __future__ import annotations

from pathlib import Path

import pytest

from hazard_ms.agents.team import check_team_name, team_agent
from hazard_ms.machine.processes import needs_key

OWN = """
import sys
from hazard_ms import Agent
from hazard_ms.agents.team import TeamAgent
from hazard_ms.skills.decision import Action
class Mine(TeamAgent):
    def __init__(self, patience: int = 1):
        self.patience = patience
    def reset(self, briefs):
        pass
    def act(self, decisions):
        return {name: Action("stop") for name in decisions}
class One(Agent):
    def reset(self, brief):
        pass
    def act(self, decision):
        return Action("stop")
class Leaves(Mine):
    def __init__(self):
        sys.exit(3)
"""


@pytest.fixture
def own(tmp_path: Path) -> Path:
    (tmp_path / "own.py").write_text(OWN)
    return tmp_path / "own.py"


def test_a_team_of_ones_own_is_made_with_its_parameters(own: Path) -> None:
    made = team_agent(f"{own}:Mine:patience=3")
    assert vars(made) == {"patience": 3} and made.act({}) == {}
    assert needs_key(f"{own}:Mine")  # it may ask a model
    assert type(team_agent("hazard_ms.agents.teams.joint:Joint")) is type(team_agent("joint"))


@pytest.mark.parametrize(
    ("name", "error", "told"),
    [
        ("One", ValueError, r"must be a subclass of hazard_ms\.agents\.team\.TeamAgent, got '.*own\.py:One'"),
        ("Mine:speed=1", ValueError, "a parameter of Mine must be one of patience=..., got 'speed=1'"),
        ("Nobody", ValueError, r"agent must name a class in .*own\.py, got 'Nobody'"),
        ("Leaves", RuntimeError, r"got sys\.exit\(3\)"),
    ],
)
def test_what_is_no_team_is_refused(name: str, error: type[Exception], told: str, own: Path) -> None:
    with pytest.raises(error, match=told):
        team_agent(f"{own}:{name}")


def test_names_are_checked_without_running_code(tmp_path: Path) -> None:
    (tmp_path / "bad.py").write_text("1 / 0")
    for name in (f"{tmp_path}/bad.py:Mine", f"independent:{tmp_path}/bad.py:Mine", "package:Mine:patience=3"):
        check_team_name(name)
    with pytest.raises(ZeroDivisionError):
        team_agent(f"{tmp_path}/bad.py:Mine")
    for bad in ("greedy:give_up=3", "mine", "joint:planner"):
        with pytest.raises(ValueError, match="team agent must be"):
            check_team_name(bad)
