"""An episode whose simulation breaks is told by the exit code of the command."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

STORM = """
from dataclasses import dataclass
from typing import ClassVar

import torch
import hazard_ms
from hazard_ms import Hazard, Level, Push, State, rescue


@dataclass
class Nothing(State):
    pass


@dataclass(frozen=True)
class Blow(Hazard):
    name: ClassVar[str] = "blow"
    state_type: ClassVar[type[State]] = Nothing
    level: ClassVar[Level] = Level("force", "N", 0.0, 1.0)

    def reset(self, state, world, rows):
        pass

    def force(self, state, world, dt):
        return Push(world.mass[..., None] * torch.tensor([0.0, 0.0, 1e6]))  # 1e6 m/s^2: out of the world in a frame

    def advance(self, state, world, dt):
        pass

    def damaged(self, state, world):
        return torch.zeros_like(world.movable)

    def image(self, state, world, points):
        return torch.zeros(points.shape[:2])

    def threatens(self, target, level, height):
        return False


hazard_ms.register_hazard("blow", lambda preset: Blow())
hazard_ms.register_task("HazardBlow-v1", lambda physics: rescue([Blow()]))
"""


@pytest.mark.long
@pytest.mark.render
def test_play_ends_with_1_where_the_simulation_broke(tmp_path: Path) -> None:
    (tmp_path / "storm.py").write_text(STORM)
    command = [
        sys.executable,
        "-m",
        "hazard_ms.cli",
        "play",
        "-e",
        "HazardBlow-v1",
        "--load",
        "storm.py",
        "--effects",
        "off",
    ]
    done = subprocess.run(
        command,
        cwd=tmp_path,
        env={**os.environ, "HAZARD_MS_DUMPS": str(tmp_path / "dumps")},
        capture_output=True,
        text=True,
        check=False,
    )
    assert "(simulation error)" in done.stdout, done.stderr
    assert done.returncode == 1
