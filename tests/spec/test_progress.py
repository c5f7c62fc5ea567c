"""What takes long says so, once and on the standard error; what is quick, or asked to be quiet, does not."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from pathlib import Path

import pytest

from hazard_ms.spec import progress

ROOT = Path(__file__).parents[2]


def test_only_what_is_slow_is_told(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.setattr(progress, "PATIENCE", 0.05)
    monkeypatch.delenv("HAZARD_MS_QUIET", raising=False)
    with progress.slow("being quick"):
        pass
    with progress.slow("being slow"):
        time.sleep(0.3)
    told = capsys.readouterr()
    assert told.err == "hazard_ms: being slow ...\n" and told.out == ""
    monkeypatch.setenv("HAZARD_MS_QUIET", "1")
    with progress.slow("being slow again"):
        time.sleep(0.3)
    assert capsys.readouterr().err == ""


def test_a_fault_is_not_swallowed() -> None:
    with pytest.raises(KeyError), progress.slow("failing"):
        raise KeyError


@pytest.mark.long
def test_compiling_kernels_is_told_where_none_are_kept(tmp_path: Path) -> None:
    code = (
        "from hazard_ms.spec import progress; progress.PATIENCE = 0.2\n"
        "import gymnasium as gym, hazard_ms\n"
        "env = gym.make('HazardFlood-v1', obs_mode='none', render_backend='none'); env.reset(); env.step(None)\n"
    )

    env = {**os.environ, "WARP_CACHE_PATH": str(tmp_path)}
    env.pop("HAZARD_MS_QUIET", None)
    out = subprocess.run([sys.executable, "-c", code], env=env, cwd=ROOT, capture_output=True, text=True, check=True)
    lines = [line for line in out.stderr.splitlines() if line.startswith("hazard_ms: ")]
    assert "hazard_ms: loading PyTorch, SAPIEN and ManiSkill ..." in lines
    assert "hazard_ms: compiling kernels (once, about 10 s) ..." in lines and out.stdout == ""
