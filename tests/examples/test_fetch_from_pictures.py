"""The example that fetches from pictures: the walk of a demonstration, what follows it, and both policies at work."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest

from hazard_ms.demonstrations.options import RecordOptions
from hazard_ms.demonstrations.recording import RecordJob, attempt
from hazard_ms.evaluation.options import EpisodeOptions
from tests.worlds.registering import loaded, practising

pytestmark = pytest.mark.render
EXAMPLES = Path(__file__).parents[2] / "examples"
EVERY = 3  # frames


@pytest.fixture(scope="module", autouse=True)
def practice() -> Iterator[Any]:
    with practising() as module:
        yield module


@pytest.fixture(scope="module")
def example() -> Iterator[Any]:
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(EXAMPLES)
        with loaded(EXAMPLES / "fetch_from_pictures.py") as module:
            yield module


@pytest.fixture(scope="module")
def dataset(tmp_path_factory: pytest.TempPathFactory, practice: Any) -> Path:
    episode = EpisodeOptions("HazardFetch-v1", agent="oracle", seed=11, perturb="control:2")
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


def test_a_walk_ends_where_the_thing_is_before_the_robot(example: Any, dataset: Path) -> None:
    (one,) = example.act.read([dataset])
    rows, subtask = example.walk(one), one.frames["subtask"]
    end = example.arrival(one)
    assert [one.meta["subtasks"][number].split()[0] for number in subtask[[0, end - 1, end]]] == [
        "walk",
        "walk",
        "pick",
    ]
    last = -(-end // EVERY)
    every = rows.chunks[:, 0].numpy()
    hidden = np.abs(np.arctan2(every[:, -1], every[:, -2])) > np.deg2rad(60.0)
    assert 0 < hidden.sum() < 0.8 * len(every)
    assert (every[hidden, 11] == 0.0).all() and (every[hidden, 12] == 1.0).all()  # it turns left
    first = np.concatenate([[True], np.diff(every[:, -1]) != 0.0])  # of rows that are there more than once
    assert (np.diff(np.flatnonzero(first & hidden))[:3] == example.SEARCHES).all()
    kept = np.flatnonzero(first | (every[:, example.ARRIVED] == 1.0))
    told, chunks = every[kept], rows.chunks[kept]
    pictures = [view[kept] for view in rows.pictures]
    half = len(kept) // 2
    assert half == last + example.AFTER
    in_mirror, seen = told[half:], ~hidden[kept][:half]
    np.testing.assert_array_equal(in_mirror[:, -1], -told[:half, -1])
    np.testing.assert_array_equal(in_mirror[seen, 12], -told[:half][seen, 12])
    np.testing.assert_array_equal(np.delete(in_mirror, (12, 15), 1), np.delete(told[:half], (12, 15), 1))
    assert all((view[half:] == view[:half].flip(-1)).all() for view in pictures)
    assert rows.body.shape == (len(every), 1) and not rows.body.any()  # it feels nothing
    told, chunks = told[:half], chunks[:half]
    assert told[:, example.ARRIVED].tolist() == [0.0] * last + [1.0] * example.AFTER
    assert not told[last:, 11:13].any() and told[:last, 11].max() > 0.9  # the base stands from then on
    assert chunks[last - 2, :4, example.ARRIVED].tolist() == [0.0, 0.0, 1.0, 1.0]  # foreseen
    forward, left = told[:, -2:].T  # the place of the thing: straight ahead at arm's length at the end, far off before
    assert 0.4 < forward[-1] < 1.0 and abs(left[-1]) < 0.2
    assert np.hypot(forward, left)[0] > 2.0 - 0.1  # no walk begins nearer
    x, y, heading = one.frames["base"][0]
    taken = one.frames["hand"][one.frames["held"] >= 0][0]
    bearing = np.arctan2(taken[1] - y, taken[0] - x) - heading
    assert np.cos(bearing - np.arctan2(left[0], forward[0])) > 0.999
    whole = cv2.VideoCapture(str(one.films["head"])).read()[1][:, :, ::-1]
    np.testing.assert_array_equal(pictures[0][0].numpy(), whole[96:160].transpose(2, 0, 1))  # pixel by pixel


def test_taking_begins_where_the_walk_ends(example: Any, dataset: Path) -> None:
    (one,) = example.act.read([dataset])
    rows, last = example.take(one), -(-example.arrival(one) // EVERY)
    assert len(rows.body) == -(-len(one.frames["action"]) // EVERY) - last
    np.testing.assert_array_equal(rows.body[0, :-1].numpy(), one.frames["qpos"][last * EVERY, 3:])
    assert rows.body[0, -1] == 0.0 and rows.body[:, -1].max() == 1.0


@pytest.mark.long
@pytest.mark.timeout(3600)
def test_one_walks_until_it_has_arrived_and_again_where_nothing_is_taken(
    example: Any, dataset: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(example.act, "BATCH", 8)
    example.train_walk([dataset], out=tmp_path / "walk", minutes=0.02)
    example.train_take([dataset], out=tmp_path / "take", minutes=0.02)
    who = example.Fetching(tmp_path / "walk", tmp_path / "take")
    arrived, done = np.zeros(example.act.CHUNK), []

    def foreseen(seen: dict[str, Any]) -> np.ndarray:
        done.append("walk")
        numbers = np.zeros((example.act.CHUNK, 16))
        numbers[:, example.ARRIVED] = arrived
        return numbers

    monkeypatch.setattr(who.walker, "act", foreseen)
    monkeypatch.setattr(who.taker, "act", lambda seen: (done.append("take"), np.ones((example.act.CHUNK, 13)))[1])
    empty, full = {"agent_pos": np.zeros(8)}, {"agent_pos": np.ones(8)}
    assert who.coming(empty, 0).shape == (example.LOOKS, 13)
    arrived[1:] = 1.0
    assert who.coming(empty, 2).shape == (1, 13)  # it arrives a tenth of a second later
    arrived[:] = 1.0
    assert who.coming(empty, 3).shape == (example.act.CARRIED, 13)
    assert done == ["walk", "walk", "walk", "take"]
    who.coming(empty, 3 + example.TAKES - 1)
    who.coming(full, 3 + example.TAKES)
    away = who.coming(empty, 3 + example.TAKES + 4)  # it let go: it turns left, though it has arrived
    assert done[4:] == ["take", "take", "walk"] and away[:, 11:].tolist() == [[0.0, 1.0]] * example.LOOKS
    who.coming(empty, 3 + example.TAKES + 4 + example.AWAY)
    assert done[7:] == ["walk", "take"]
    arrived[:] = 0.0
    assert not who.coming(empty, 0)[:, 11:].any()  # of the next episode
    monkeypatch.undo()
    won = example.play(tmp_path / "walk", tmp_path / "take", episodes=1, seed=11, split="train")
    assert won in ([False], [True]) and "of 1 succeeded" in capsys.readouterr().out
