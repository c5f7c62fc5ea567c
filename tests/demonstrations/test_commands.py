"""`hazard-ms demos ...` from end to end, and recordings that are killed."""

from __future__ import annotations

import dataclasses
import functools
import random
import subprocess
import sys
from importlib.metadata import version
from pathlib import Path

import numpy as np
import pytest

from hazard_ms.cli.__main__ import main
from hazard_ms.demonstrations.layout import FAILURES, MANIFEST, datasets
from hazard_ms.demonstrations.options import RecordOptions
from hazard_ms.demonstrations.reading import entries
from hazard_ms.demonstrations.recording import RecordJob, attempt
from hazard_ms.evaluation.result import EpisodeResult, versions
from hazard_ms.evaluation.spread import spread
from results.killed_recordings import Ordeal
from tests.worlds.files.checkout import ROOT
from tests.worlds.recordings import content, stored

AGENT = "tests.evaluation.test_play:Short"


def test_a_dataset_is_looked_after_by_commands(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    dataset = tmp_path / "a" / "HazardFire-v1" / "oracle"
    stored(dataset, 0)
    assert main(["demos", "verify", str(tmp_path)]) == 0 and "1 episodes, no faults" in capsys.readouterr().out
    assert main(["demos", "merge", str(dataset), "-o", str(tmp_path / "b")]) == 0
    assert "1 episodes added" in capsys.readouterr().out
    (dataset / "kitchen_b-00-s000000" / "frames.npz").write_bytes(b"")
    assert main(["demos", "verify", str(dataset)]) == 1
    assert "other bytes in frames.npz" in capsys.readouterr().out
    assert main(["demos", "repair", str(tmp_path)]) == 0 and "1 moved aside" in capsys.readouterr().out
    assert main(["demos", "stats", str(tmp_path / "b")]) == 0 and "1 of 1" in capsys.readouterr().out
    assert main(["demos", "stats", str(tmp_path / "none")]) == 2
    assert "folder must hold a dataset" in capsys.readouterr().err


def test_episodes_of_another_engine_are_told_beside_the_verdict(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """The verdict is that of the simulation; with one action that was changed, an episode is damaged, not different."""
    here_alone = functools.partial(spread, backend="serial")  # a new process would take seconds to start
    monkeypatch.setattr("hazard_ms.demonstrations.verify.spread", here_alone)
    dataset = tmp_path / "HazardFire-v1" / "oracle"
    stored(dataset, 0)
    manifest, here = dataset / MANIFEST, version("sapien")
    (entry,) = entries(dataset)
    manifest.write_text(dataclasses.replace(entry, versions={**versions(), "sapien": "3.0.0"}).line())
    told = f"recorded with sapien 3.0.0, here {here}\n"
    assert main(["demos", "stats", str(dataset)]) == 0 and f"1 episodes {told}" in capsys.readouterr().out
    main(["demos", "verify", str(tmp_path), "--replay", "--workers", "1"])
    (line,) = [line for line in capsys.readouterr().out.splitlines(keepends=True) if "s000000: " in line]
    assert line.endswith(f"; {told}")
    frames = dataset / entry.name / "frames.npz"
    with np.load(frames) as file:
        arrays = dict(file)
    arrays["action"][1, 0] += 1e-3
    np.savez_compressed(frames, **arrays)
    assert main(["demos", "verify", str(tmp_path), "--replay", "--workers", "1"]) == 1
    assert "other bytes in frames.npz" in (said := capsys.readouterr().out) and "different" not in said


@pytest.mark.render
@pytest.mark.long
def test_episodes_are_recorded_verified_and_not_played_twice(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    words = ["demos", "record", "-a", AGENT, "--episodes", "2", "--keep", "0", "--workers", "2", "-o", str(tmp_path)]
    assert main(words) == 0
    (dataset,) = datasets(tmp_path)
    made = entries(dataset)
    assert {entry.seed for entry in made} == {0, 1} and all(entry.verified for entry in made)
    assert main(["demos", "verify", str(tmp_path), "--replay", "--workers", "1"]) == 0
    capsys.readouterr()
    assert main(words) == 0
    assert "2 of 2 episodes are already recorded" in capsys.readouterr().out and entries(dataset) == made
    assert main([*words, "--physics", "shipped"]) == 2
    assert "output must hold episodes with {'settings'" in capsys.readouterr().err
    assert "| 2 of 2 " in (dataset / "README.md").read_text()


@pytest.mark.render
@pytest.mark.long
def test_a_dataset_of_which_no_episode_was_kept_has_numbers(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    words = ["demos", "record", "-a", AGENT, "--episodes", "1", "--keep", "1", "--no-verify", "-o", str(tmp_path)]
    assert main(words) == 0
    capsys.readouterr()
    assert main(["demos", "stats", str(tmp_path)]) == 0
    assert "| 0 of 1 " in capsys.readouterr().out


@pytest.mark.render
@pytest.mark.long
def test_an_episode_that_differs_when_it_is_simulated_again_is_not_kept(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from hazard_ms.demonstrations import recording

    real = recording.job_of

    def other(result: EpisodeResult, load: tuple[str, ...]) -> object:
        return real(dataclasses.replace(result, decisions=result.decisions[:1]), load)

    monkeypatch.setattr(recording, "job_of", other)
    options = RecordOptions(agent=AGENT, episodes=1, keep=0.0, output=tmp_path)
    options.dataset.mkdir(parents=True)
    outcome = attempt(RecordJob(options.episode_options()[0], 60.0, record=options), lambda word: None)
    assert not outcome.error
    (entry,) = entries(options.dataset / FAILURES)
    assert entry.reason.startswith("simulated again, it is ") and not entry.verified


@pytest.mark.render
@pytest.mark.long
def test_a_recording_that_is_killed_again_and_again_ends_as_an_undisturbed_one(tmp_path: Path) -> None:
    """By the command that tells how recordings stand `kill -9`."""
    words = ["demos", "record", "-a", AGENT, "--episodes", "2", "--keep", "0", "-o", str(tmp_path / "undisturbed")]
    assert main(words) == 0
    (dataset,) = datasets(tmp_path / "undisturbed")
    command = [sys.executable, "-m", "results.killed_recordings", str(dataset), "-o", str(tmp_path / "killed")]
    done = subprocess.run([*command, "--kills", "4", "--longest", "8"], capture_output=True, text=True, cwd=ROOT)
    assert done.returncode == 0, done.stdout + done.stderr
    assert "recorded while 4 random `kill -9` struck" in done.stdout
    assert "0 episodes could not be read, 0 were lost after they had been told of, 0 differ" in done.stdout
    (found,) = datasets(tmp_path / "killed")
    assert content(entries(found)) == content(entries(dataset))


def test_what_a_kill_has_cost_is_noticed(tmp_path: Path) -> None:
    names = [stored(tmp_path / "one", seed).name for seed in range(3)]
    log = tmp_path / "log.txt"
    log.write_text("".join(f"{name}: 50.0 % of the value, 3 frames, 1 s, kept\n" for name in (*names, "gone-s000007")))
    tried = Ordeal([], tmp_path / "one", log, 1, random.Random(0))
    tried.look()
    assert tried.lost == {"gone-s000007"} and not tried.unreadable
    (tmp_path / "one" / names[1] / "frames.npz").write_bytes(b"")
    tried.look()
    assert tried.unreadable == {names[1]}
