"""The example of an agent: it is played from its file, and what it does is what its description says."""

from __future__ import annotations

import dataclasses
import re
import subprocess
import sys
from pathlib import Path

import pytest

from hazard_ms.agents.base import agent
from hazard_ms.cli.__main__ import main
from hazard_ms.skills.brief import HazardBrief
from hazard_ms.skills.decision import STOP, Action
from tests.worlds.playground import Playground, brief, play

ROOT = Path(__file__).parents[2]
FILE = ROOT / "examples" / "own_agent.py"


def test_it_saves_the_most_valuable_first_and_stops() -> None:
    ground = Playground({"cheap": (1.0, 0.0), "dear": (0.0, 2.5)}, {"cheap": 1.0, "dear": 5.0})
    taken = play(agent(f"{FILE}:Careful"), ground)
    assert [a.target for a in taken if a.verb == "pick_up"] == ["dear", "cheap"]
    assert ground.rescued == {"cheap", "dear"} and taken[-1] == Action(STOP)


def test_it_saves_into_carts() -> None:
    places = {"a": (1.0, 0.0), "b": (0.0, 2.0), "cart": (-2.0, 0.0)}
    ground = Playground(places, {"a": 1.0, "b": 5.0}, carts=("cart",))
    play(agent(f"{FILE}:Careful"), ground)
    assert ground.rescued == {"a", "b"}


@pytest.mark.parametrize(("caution", "goes"), [(1.0, "hot"), (2.0, "cool")])
def test_it_keeps_away_from_what_is_threatened(caution: float, goes: str) -> None:
    """The valuable target is at 200 degrees, and is damaged from 300."""
    ground = Playground({"hot": (2.0, 0.0), "cool": (-2.0, 0.0)}, {"hot": 5.0, "cool": 1.0})
    player = agent(f"{FILE}:Careful:caution={caution}")
    fire = HazardBrief("fire", "temperature", "°C", lambda target, level, height: level >= 300.0)
    player.reset(dataclasses.replace(brief(), hazards=(fire,)))
    ground.do(player.act(ground.decision()))
    ground.remember(0, dataclasses.replace(ground.map.objects[0], levels=(200.0,)))
    ground.remember(1, dataclasses.replace(ground.map.objects[1], levels=(20.0,)))
    assert player.act(ground.decision()).target == goes


def test_it_plays_in_a_room(capsys: pytest.CaptureFixture[str]) -> None:
    """With so much caution it fetches nothing that can burn, so that the episode is short."""
    assert main(["play", "-s", "1", "--agent", f"{FILE}:Careful:caution=1e9"]) == 0
    out = capsys.readouterr().out
    assert re.search(r"own_agent.py:Careful:caution=1e9 rescued \d of \d+ targets .*\(stopped\)", out)


@pytest.mark.long
def test_it_runs_as_a_program(tmp_path: Path) -> None:
    words = [sys.executable, str(FILE), "-s", "1", "--agent", f"{FILE}:Careful:caution=1e9"]
    done = subprocess.run(words, capture_output=True, text=True, cwd=tmp_path, timeout=250)
    assert done.returncode == 0, done.stderr[-2000:]
    assert "(stopped)" in done.stdout
