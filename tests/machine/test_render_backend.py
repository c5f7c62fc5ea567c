"""The choice of renderer, and the answer that is kept."""

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


def test_backend_is_one_of_three_and_can_be_chosen(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("HAZARD_MS_RENDER", "none")
    assert render_backend.backend() == "none"
    monkeypatch.setenv("HAZARD_MS_RENDER", "opengl")
    with pytest.raises(ValueError, match="gpu, cpu, none, got 'opengl'"):
        render_backend.backend()


def test_the_answer_is_kept_and_a_damaged_one_is_found_anew(tmp_path: Path, broken: Mapping[str, str]) -> None:
    code = "from hazard_ms.machine.render_backend import *; import os; print(machine_key(os.environ), backend())"

    def ask() -> tuple[str, str]:
        out = subprocess.run(
            [sys.executable, "-c", code], capture_output=True, text=True, check=True, env=dict(broken)
        ).stdout
        return out.split()[0], out.split()[1]

    key, answer = ask()
    assert answer == "none"
    kept = tmp_path / "home" / f"rendering-{key}.json"
    assert not kept.exists(), "what is missing may be installed at any time, so `none` is not kept"
    kept.parent.mkdir(exist_ok=True)
    kept.write_text('{"backend": "cpu"}')
    assert ask() == (key, "cpu"), "a kept answer needs no trial"
    kept.write_text('{"backe')
    assert ask() == (key, "none")


@pytest.mark.render
def test_a_working_backend_is_kept_on_disk(tmp_path: Path) -> None:
    code = "from hazard_ms.machine.render_backend import backend; print(backend())"
    environ = environment(HAZARD_MS_HOME=str(tmp_path), HAZARD_MS_RENDER="")
    answer = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True, env=environ
    ).stdout.strip()
    assert answer in ("gpu", "cpu")
    assert [json.loads(path.read_text()) for path in tmp_path.glob("rendering-*.json")] == [{"backend": answer}]


@pytest.mark.render
def test_vulkan_says_which_mesa_draws() -> None:
    answer = ask_vulkan()
    assert answer.usable
    for device in answer.devices:
        assert device.name and (not device.lavapipe or device.version >= (24, 3))
