"""Keys for models are in the environment of no process that needs none."""

from __future__ import annotations

import multiprocessing
import os
import subprocess

import pytest

from hazard_ms.machine.processes import environment, needs_key, without_keys

KEY = "HAZARD_MS_LLM_KEY"


def test_processes_have_no_key(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(KEY, "sk-SENTINEL")
    assert "SENTINEL" not in subprocess.run(["env"], env=environment(), capture_output=True, text=True).stdout
    for needed in (False, True):
        with without_keys(needed), multiprocessing.get_context("spawn").Pool(1) as pool:
            assert pool.apply(os.getenv, (KEY,)) == ("sk-SENTINEL" if needed else None)
    assert os.environ[KEY] == "sk-SENTINEL"


def test_agents_that_may_ask_models_need_it() -> None:
    assert needs_key("llm:way=json") and needs_key("my.py:Mine") and needs_key("mine", ("my.py",))
    assert not needs_key("greedy") and not needs_key("planner:seconds=1.5")
