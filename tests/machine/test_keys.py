"""Keys for models are in the environment of no process that needs none."""

from __future__ import annotations

import ast
import multiprocessing
import os
import subprocess
import time
from pathlib import Path
from typing import Any

import pytest

import hazard_ms
from hazard_ms.evaluation.options import EpisodeOptions
from hazard_ms.evaluation.workers import Job, Outcome, Worker
from hazard_ms.machine.processes import environment, needs_key, without_keys

KEY = "HAZARD_MS_LLM_KEY"


def test_processes_have_no_key(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(KEY, "sk-SENTINEL")
    assert "SENTINEL" not in subprocess.run(["env"], env=environment(), capture_output=True, text=True).stdout
    for needed in (False, True):
        with without_keys(needed), multiprocessing.get_context("spawn").Pool(1) as pool:
            assert pool.apply(os.getenv, (KEY,)) == ("sk-SENTINEL" if needed else None)
    assert os.environ[KEY] == "sk-SENTINEL"


STARTERS = {"run", "Popen", "check_output", "check_call", "call"}


def starts_with_our_environment(code: str) -> list[int]:
    """The lines in which subprocess starts a process that gets all our environment."""
    calls = [node for node in ast.walk(ast.parse(code)) if isinstance(node, ast.Call)]
    return [
        call.lineno
        for call in calls
        if isinstance(call.func, ast.Attribute)
        and isinstance(call.func.value, ast.Name)
        and (call.func.value.id, call.func.attr in STARTERS) == ("subprocess", True)
        and not any(keyword.arg == "env" for keyword in call.keywords)
    ]


def test_no_module_starts_a_process_with_all_our_environment() -> None:
    assert starts_with_our_environment("subprocess.run(a)\nsubprocess.Popen(a, env=b)") == [1]
    package = Path(hazard_ms.__file__).parent
    found = {str(p.relative_to(package)): starts_with_our_environment(p.read_text()) for p in package.rglob("*.py")}
    assert {name: lines for name, lines in found.items() if lines} == {}


def nothing(job: Job, tell: Any) -> Any:
    """What a worker does with a job here."""
    return Outcome(None, "nothing")


def test_a_worker_takes_a_key_from_no_job_to_the_next(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """The first job's agent is one of a file, which may ask a model; the second's is not."""
    monkeypatch.setenv(KEY, "sk-SENTINEL")
    (tmp_path / "mine.py").write_text("class Mine: pass\n")
    worker, seen = Worker(nothing), []
    try:
        for agent in (f"{tmp_path / 'mine.py'}:Mine", "greedy"):
            worker.begin(Job(EpisodeOptions(agent=agent), 60.0))
            assert worker._process is not None
            place = Path(f"/proc/{worker._process.pid}")
            while b"spawn_main" not in (place / "cmdline").read_bytes():  # it is still a copy of this process
                time.sleep(0.01)
            seen.append("sk-SENTINEL" in (place / "environ").read_text())
    finally:
        worker.end()
    assert seen == [True, False]


def test_agents_that_may_ask_models_need_it() -> None:
    assert needs_key("llm:way=json") and needs_key("my.py:Mine") and needs_key("mine", ("my.py",))
    assert not needs_key("greedy") and not needs_key("planner:seconds=1.5")
