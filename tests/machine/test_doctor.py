"""The command `doctor` and the environments on a machine whose Vulkan really is broken."""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Mapping
from pathlib import Path

import pytest

from hazard_ms.machine import render_backend
from hazard_ms.machine.vulkan import ask_vulkan
from tests.worlds.files.machines import broken_environment, environment


@pytest.fixture
def broken(tmp_path: Path) -> Mapping[str, str]:
    return broken_environment(tmp_path)


def test_broken_vulkan_is_noticed_in_the_child(broken: Mapping[str, str]) -> None:
    assert not ask_vulkan(broken).usable and ask_vulkan(broken).fault
    assert render_backend.trial_fault("cpu", environ=broken)


def test_doctor_names_the_broken_driver_and_ends_with_1(broken: Mapping[str, str]) -> None:
    command = [sys.executable, "-m", "hazard_ms.cli", "doctor", "--json", "--no-draw"]
    child = subprocess.run(command, capture_output=True, text=True, check=False, env=dict(broken))
    answer = json.loads(child.stdout)
    assert child.returncode == 1
    assert answer["backend"] == "none"
    drivers = next(finding for finding in answer["findings"] if finding["name"] == "vulkan drivers")
    assert "broken_icd.json" in drivers["detail"] and drivers["command"] == "unset VK_DRIVER_FILES"
    assert answer["cause"] == next(finding for finding in answer["findings"] if finding["state"] == "fault")


def test_a_crash_in_the_child_is_a_finding(tmp_path: Path) -> None:
    """`sitecustomize` runs at the start of every Python: here it dies as a crashing driver would."""
    (tmp_path / "sitecustomize.py").write_text("import os, signal\nos.kill(os.getpid(), signal.SIGSEGV)\n")
    environ = environment(PYTHONPATH=str(tmp_path))
    assert "signal 11" in ask_vulkan(environ).fault
    assert "signal 11" in render_backend.trial_fault("cpu", environ=environ)


def test_state_observations_need_no_vulkan(broken: Mapping[str, str]) -> None:
    code = (
        "import gymnasium as gym, hazard_ms\n"
        "env = gym.make('HazardFire-v1', obs_mode='state'); env.reset(seed=0); env.step(env.action_space.sample())\n"
        "print(env.unwrapped.scene.can_render())"
    )
    child = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False, env=dict(broken))
    assert child.stdout.split()[-1:] == ["False"], child.stderr[-2000:]
