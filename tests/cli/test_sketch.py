"""The commands `hazard-ms sketch ...`."""

from __future__ import annotations

import inspect
import json
from pathlib import Path

import pytest

from hazard_ms.cli import sketch
from hazard_ms.cli.__main__ import main
from hazard_ms.evaluation.options import EpisodeOptions
from hazard_ms.sketch import skill_times
from hazard_ms.sketch.fidelity import TRIALS
from hazard_ms.sketch.fit_times import FEWEST
from hazard_ms.sketch.policies import POLICIES
from tests.worlds.results import result_of


def test_the_help_offers_the_policies_that_there_are() -> None:
    assert tuple(sketch.POLICIES) == tuple(POLICIES)


def test_check_plays_as_many_rescues_as_the_comparison_of_the_sketch() -> None:
    assert inspect.signature(sketch.check).parameters["trials"].default == TRIALS


def test_fit_reads_a_probe_and_writes_tables(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    row = {"robot": "fetch", "verb": "pick_up", "height": 0.3, "clearance": 0.5, "distance": 0.7, "frames": 40}
    rows = [{**row, "ok": n > 0, "reason": "" if n else "unreachable"} for n in range(FEWEST)]
    probe, made = tmp_path / "rows.jsonl", tmp_path / "times.json"
    probe.write_text("\n".join(map(json.dumps, rows)))
    assert main(["sketch", "fit", str(probe), "-o", str(made), "--source", "a test"]) == 0
    success, frames, _ = skill_times.load("fetch", made).typical("pick_up")
    assert (success, frames) == (pytest.approx(1 - 1 / FEWEST, abs=1e-3), 40.0)
    assert skill_times.load("fetch", made).source == "a test"
    assert f"works {success:5.1%}" in capsys.readouterr().out


def test_check_compares_results_with_the_sketch(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for seed, saved in enumerate((True, False)):
        episode = EpisodeOptions("HazardFire-v1", agent="greedy", seed=seed)
        result_of(episode, saved).write(tmp_path / f"{seed}.json")
    assert main(["sketch", "check", str(tmp_path), "--trials", "2"]) == 1  # nobody played these episodes
    lines = capsys.readouterr().out.splitlines()
    (row,) = (line.split() for line in lines if line.startswith("HazardFire-v1      greedy"))
    assert row[2:4] == ["2", "0.250"]  # one of two targets in one of two episodes
    assert 0.0 < float(row[4]) < 1.0


def test_check_refuses_what_it_cannot_compare(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["sketch", "check", str(tmp_path)]) == 2
    assert "must hold results of greedy, rule" in capsys.readouterr().err
    assert main(["sketch", "check", str(tmp_path), "--agents", "random"]) == 2
    assert "agent must be one of greedy, nearest, rule" in capsys.readouterr().err


def test_speed_prints_what_is_required(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["sketch", "speed", "--scenes", "1"]) == 0
    out = capsys.readouterr().out
    assert "256 rescues at once" in out and "required: 20,000" in out
