"""The example that learns from pictures: its rows are those of the recording, and it learns, resumes and plays."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest
import torch

from hazard_ms.demonstrations.options import RecordOptions
from hazard_ms.demonstrations.recording import RecordJob, attempt
from hazard_ms.evaluation.options import EpisodeOptions
from tests.worlds.registering import loaded, practising

pytestmark = pytest.mark.render
EXAMPLE = Path(__file__).parents[2] / "examples" / "act_from_pictures.py"
EVERY = 3  # frames


@pytest.fixture(scope="module", autouse=True)
def practice() -> Iterator[Any]:
    with practising() as module:
        yield module


@pytest.fixture(scope="module")
def example() -> Iterator[Any]:
    with loaded(EXAMPLE) as module:
        yield module


@pytest.fixture(scope="module")
def dataset(tmp_path_factory: pytest.TempPathFactory, practice: Any) -> Path:
    episode = EpisodeOptions("HazardPickUp-v1", agent="oracle", seed=4)
    options = RecordOptions(
        episode,
        "oracle",
        verify=False,
        obs="rgb",
        cameras="head+wrist",
        every=EVERY,
        output=tmp_path_factory.mktemp("d"),
    )
    options.dataset.mkdir(parents=True)
    assert not attempt(RecordJob(episode, 60.0, record=options), lambda word: None).error
    return options.dataset


def test_rows_are_what_was_seen_and_what_was_done_from_then_on(example: Any, dataset: Path) -> None:
    (one,) = example.read([dataset])
    rows = example.rows_of(one, [*one.films])
    actions, last = one.frames["action"], (len(one.frames["action"]) - 1) // EVERY
    assert [view.shape for view in rows.pictures] == [(last + 1, 3, 96, 96)] * 2
    assert rows.body.shape == (last + 1, 13)
    for row in (0, 5, last - 3, last):
        for step in range(example.CHUNK):
            frame = min(row + step, last) * EVERY
            np.testing.assert_allclose(
                rows.chunks[row, step].numpy(), actions[frame : frame + EVERY].mean(0), atol=1e-6
            )
        np.testing.assert_array_equal(rows.body[row, :-1].numpy(), one.frames["qpos"][row * EVERY, 3:])
    assert rows.body[:, -1].tolist() == (one.frames["held"][:-1:EVERY] >= 0).tolist()
    video = cv2.VideoCapture(str(one.films["head"]))
    whole = video.read()[1][:, :, ::-1]  # of 256 pixels, of which the policy sees what is before its hands
    seen = cv2.resize(whole[96:256, 48:208], (96, 96), interpolation=cv2.INTER_AREA)
    np.testing.assert_array_equal(rows.pictures[0][0].numpy(), seen.transpose(2, 0, 1))
    apart = (rows.pictures[0].float() - rows.pictures[1].float()).abs().mean()
    assert apart > 20.0  # two cameras


def test_a_folder_without_episodes_is_named(example: Any, tmp_path: Path) -> None:
    (tmp_path / "manifest.jsonl").touch()
    with pytest.raises(SystemExit, match=f"{tmp_path}: no episode"):
        example.read([tmp_path])


@pytest.mark.long
def test_it_learns_goes_on_and_plays(
    example: Any, dataset: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(example, "BATCH", 8)
    losses = []
    for minutes in (0.02, 0.1):
        example.train([dataset], out=tmp_path / "made", minutes=minutes)
        losses.append(float(capsys.readouterr().out.split()[-1]))
    assert losses[1] < 0.8 * losses[0]
    settings = json.loads((tmp_path / "made" / "settings.json").read_text())
    env = {"task": "HazardPickUp-v1", "cameras": ["wrist"], "every": EVERY, "robot_uids": "fetch"}
    assert settings == {"views": ["head", "wrist"], "env": env}
    assert example.play(tmp_path / "made", episodes=1, seed=4, split="train", hazards=("flood",)) in ([False], [True])
    assert "of 1 succeeded" in capsys.readouterr().out


def test_between_two_ways_to_go_on_it_takes_one(example: Any) -> None:
    """Half of the demonstrations drive ahead where the other half drives back: the mean of both stands still."""
    torch.manual_seed(0)
    model = example.Chunks(2, 3, 2)
    optimiser = torch.optim.AdamW(model.parameters(), 1e-3)
    seen = [torch.randint(0, 255, (1, 3, 96, 96), dtype=torch.uint8) for _ in range(2)]
    pictures = [view.expand(8, -1, -1, -1) for view in seen]
    body = torch.zeros(8, 3)
    ahead = torch.tensor([1.0, -1.0]).repeat(4)[:, None, None].expand(8, example.CHUNK, 2)
    for _ in range(60):
        loss = model.loss(pictures, body, ahead)
        optimiser.zero_grad()
        loss.backward()
        optimiser.step()
    with torch.no_grad():
        ways, choice = model.eval()(seen, body[:1])
    assert ways[0, int(choice.argmax())].abs().min() > 0.7
