"""Choices out of recordings, and students that learn from them."""

from __future__ import annotations

import dataclasses
import json
import os
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from hazard_ms.agents.learned.weights import load
from hazard_ms.cli.__main__ import main
from hazard_ms.demonstrations.choices import choices
from hazard_ms.demonstrations.layout import datasets
from hazard_ms.evaluation.options import EpisodeOptions
from hazard_ms.learning.cloning import Student, imitate
from hazard_ms.sketch.policies import Policy, nearest
from hazard_ms.sketch.rescues.features import SketchEncoder
from hazard_ms.sketch.world import Sketch
from hazard_ms.skills.options.features import Encoder
from hazard_ms.skills.options.options import COUNT, END, FIRST, LOOK
from tests.worlds.recordings import stored
from tests.worlds.results import result_of
from tests.worlds.sketch_scenes import chancy_times, random_scene

FIRE = [(20.0, 600.0)]
TASK = "HazardFire-v1"
LAYOUT = Encoder(FIRE, 0.0)


def played(policy: Policy, episodes: int) -> Iterator[dict[str, NDArray[Any]]]:
    """The decisions of rescues in the sketch, as files of recordings have them, and what `policy` chose."""
    encoder, chance = SketchEncoder(FIRE), np.random.default_rng(0)
    sketch = Sketch([random_scene(seed) for seed in range(12)], chancy_times(), episodes)
    seeds = np.arange(episodes)
    sketch.reset(seeds % 12, seeds)
    made: list[dict[str, list[Any]]] = [{} for _ in seeds]
    while not sketch.state.over.all():
        features = encoder.encode(sketch.stack, sketch.state, sketch.slots)
        option = policy(sketch, chance)
        for n in np.flatnonzero(~sketch.state.over):
            row = {"features": features[n], "mask": sketch.mask[n].copy(), "option": option[n], "option_start": True}
            for name, entry in row.items():
                made[n].setdefault(name, []).append(entry)
        sketch.step(option)
    for episode in made:
        yield {name: np.array(entries) for name, entries in episode.items()}


def plain(**other: Any) -> dict[str, NDArray[Any]]:
    """Two decisions: to fetch target 3 of five, and to look around."""
    mask = np.zeros((2, COUNT), bool)
    mask[:, [0, 1, 2, 3, 4, FIRST[LOOK], FIRST[END]]] = True
    made: dict[str, Any] = {"features": np.full((2, LAYOUT.size), 0.5, np.float32), "mask": mask}
    made |= {"option": np.array([3, FIRST[LOOK]], np.int16), "option_start": np.ones(2, bool), **other}
    return made


def test_a_student_learns_a_teachers_rule_from_recordings(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """The nearest target that is known, from 100 recorded rescues; one that has not learnt agrees as chance does."""
    dataset = tmp_path / TASK / "oracle"
    for seed, decisions in enumerate(played(nearest, 100)):
        stored(dataset, seed, decisions=decisions)
    found = choices(tmp_path, TASK, "paper", LAYOUT)
    student, told = Student(FIRE, 0), list[str]()
    before = student.agreement(found)
    made = imitate(student, found, 30, told.append)
    assert made["held out"]["decisions"] > 50 and made["held out"]["agreement"] > 0.8 > 0.5 > before, (before, made)
    assert told[1].startswith(f"{made['held out']['decisions']:,} decisions held out: ")
    words = ["train", "clone", str(tmp_path), "-e", TASK, "-o", str(tmp_path / "made"), "--passes", "2"]
    assert main(words) == 0
    path = tmp_path / "made" / f"bc_{TASK}.safetensors"
    assert str(path) in capsys.readouterr().out and load(path, TASK).shape.ranges == ((20.0, 600.0),)
    facts = json.loads(path.with_suffix(".json").read_text())
    assert facts["command"].endswith(f"-e {TASK} --seed 0 --passes 2 --physics paper")
    assert facts["agreement"]["learnt from"]["decisions"] + facts["agreement"]["held out"]["decisions"] == len(
        found.option
    )


def test_choices_are_those_that_a_student_could_make(tmp_path: Path) -> None:
    stored(tmp_path, 0, decisions=plain())
    stored(tmp_path, 1, decisions=plain(option_start=np.array([False, True])))  # it goes on with an option
    stored(tmp_path, 2, decisions=plain(option=np.array([-1, 7], np.int16)))  # of no option; what only teachers know
    stored(tmp_path, 3, decisions=plain(option=np.array([FIRST[END], 2], np.int16)))  # to stop while there is something
    stored(tmp_path / "failures", 4, decisions=plain())
    found = choices(tmp_path, TASK, "paper", LAYOUT)
    assert found.option.tolist() == [3, FIRST[LOOK], FIRST[LOOK], 2] and found.episode.tolist() == [0, 0, 1, 3]
    assert not found.mask[:, FIRST[END]].any() and found.mask[:, FIRST[LOOK]].all()


def test_every_tenth_episode_is_held_out(tmp_path: Path) -> None:
    for seed in range(20):
        stored(tmp_path, seed, decisions=plain())
    learnt, held_out = choices(tmp_path, TASK, "paper", LAYOUT).split()
    assert np.unique(held_out.episode).tolist() == [9, 19] and len(learnt.option) == 36


def test_what_cannot_be_learnt_from_is_told(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for name, keywords in (("flood", {"env_id": "HazardFlood-v1"}), ("realistic", {"physics": "realistic"})):
        result = result_of(EpisodeOptions(agent="oracle"))
        if "env_id" in keywords:
            result = dataclasses.replace(result, env_id=keywords["env_id"])
        else:
            result = dataclasses.replace(result, settings={**result.settings, **keywords})
        stored(tmp_path / name, 0, played=result, decisions=plain())
    with pytest.raises(ValueError, match=f"demos must hold choices in {TASK} with physics paper, got none in"):
        choices(tmp_path, TASK, "paper", LAYOUT)
    assert len(choices(tmp_path, "HazardFlood-v1", "paper", LAYOUT).option) == 2
    narrow = np.zeros((2, 7), np.float32)
    stored(tmp_path / "narrow", 0, decisions=plain(features=narrow))
    with pytest.raises(ValueError, match=f"must be {LAYOUT.size} numbers, got 7 in .*narrow.*; record it again"):
        choices(tmp_path / "narrow", TASK, "paper", LAYOUT)
    assert main(["train", "clone", str(tmp_path / "nowhere"), "-e", TASK, "-o", str(tmp_path / "made")]) == 2
    assert "folder must hold a dataset" in capsys.readouterr().err and not (tmp_path / "made").exists()


def test_datasets_are_found_while_folders_vanish(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A recording renames the folders of its episodes: one that is gone when it is opened is nobody's fault."""
    stored(tmp_path / "one", 0)
    (tmp_path / "one" / ".s000001.part-1").mkdir()
    real = os.scandir

    def scandir(path: Any) -> Any:
        if ".part-" in os.fspath(path):
            raise FileNotFoundError(path)
        return real(path)

    monkeypatch.setattr(os, "scandir", scandir)
    assert list(datasets(tmp_path)) == [tmp_path / "one"]
