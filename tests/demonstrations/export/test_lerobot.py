"""Exports for LeRobot: pyarrow, av and the real LeRobotDataset find in them what was recorded.

The real reader needs an environment of its own: HAZARD_MS_LEROBOT_PYTHON names the Python of one with lerobot 0.4.
"""

from __future__ import annotations

import json
import os
import subprocess
from pathlib import Path

import gymnasium as gym
import numpy as np
import pytest

pytest.importorskip("pyarrow", reason="pyarrow is not installed; the extra demos brings it")
pytest.importorskip("av", reason="av is not installed; the extra demos brings it")

import av
import pyarrow.parquet as pq

from hazard_ms.demonstrations.export import lerobot, lerobot_film, lerobot_tables
from hazard_ms.demonstrations.export.source import Source
from tests.worlds.recorded import SUBTASKS, TASKS, dataset, driven, frames_of, level, subtasks_of

READER = "HAZARD_MS_LEROBOT_PYTHON"
HEAD = "observation.images.head"
LENGTHS = (7, 12, 9)  # frames; with a picture for every third, 3, 4 and 3 rows
ROWS = (3, 4, 3)


class Export:
    """An export, read by pyarrow: its tables as columns, and what describes them."""

    def __init__(self, recorded: Path, output: Path) -> None:
        lerobot.write(Source(recorded), output)
        self.folder = output
        self.rows = pq.read_table(output / "data").to_pydict()
        self.episodes = pq.read_table(output / "meta/episodes").to_pydict()
        self.info = json.loads((output / "meta/info.json").read_text())
        self.stats = json.loads((output / "meta/stats.json").read_text())


@pytest.fixture(scope="module")
def pictured(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return dataset(tmp_path_factory.mktemp("recorded"), LENGTHS, "rgb", 3)


@pytest.fixture(scope="module")
def by_frame(tmp_path_factory: pytest.TempPathFactory) -> Export:
    recorded = dataset(tmp_path_factory.mktemp("recorded"), obs="state")
    return Export(recorded, tmp_path_factory.mktemp("export"))


@pytest.fixture(scope="module")
def by_picture(tmp_path_factory: pytest.TempPathFactory, pictured: Path) -> Export:
    return Export(pictured, tmp_path_factory.mktemp("export"))


def state_of(arrays: dict[str, np.ndarray], frame: int) -> np.ndarray:
    parts = [arrays[name][frame] for name in ("qpos", "qvel", "base", "hand")]
    return np.array([*np.concatenate(parts), arrays["held"][frame] >= 0], np.float32)


def test_a_row_for_every_frame_where_there_are_no_pictures(by_frame: Export) -> None:
    rows, info = by_frame.rows, by_frame.info
    assert (info["codebase_version"], info["fps"], info["total_episodes"], info["total_frames"]) == ("v3.0", 30, 2, 13)
    assert info["video_path"] is None and not any("/" in name for name in info["features"])
    assert rows["index"] == list(range(13)) and rows["episode_index"] == [0] * 5 + [1] * 8
    index = 0
    for number, frames in enumerate((5, 8)):
        arrays = frames_of(number, frames, True)
        for frame in range(frames):
            np.testing.assert_array_equal(rows["observation.state"][index], state_of(arrays, frame))
            np.testing.assert_array_equal(rows["observation.environment_state"][index], arrays["obs"][frame])
            np.testing.assert_array_equal(rows["action"][index], arrays["action"][frame])
            assert rows["next.reward"][index] == frame + 1
            assert rows["next.done"][index] == rows["next.success"][index] == (frame == frames - 1)
            assert rows["timestamp"][index] == np.float32(frame / 30)
            assert (rows["frame_index"][index], rows["task_index"][index]) == (frame, number)
            assert SUBTASKS[rows["subtask_index"][index]] == subtasks_of(number)[arrays["subtask"][frame]]
            index += 1


def test_features_say_how_wide_columns_are_and_what_their_numbers_mean(by_frame: Export) -> None:
    for name, feature in by_frame.info["features"].items():
        width = np.atleast_1d(by_frame.rows[name][0]).shape
        assert width == tuple(feature["shape"]), name
        assert feature["names"] is None or len(feature["names"]) == width[0]
    assert by_frame.info["features"]["action"]["names"][0] == "arm.shoulder_pan_joint"
    assert "targets" in (by_frame.folder / "README.md").read_text()


def test_pandas_finds_texts_as_the_index(by_frame: Export) -> None:
    for name, texts in (("task", TASKS), ("subtask", SUBTASKS)):
        table = pq.read_table(by_frame.folder / f"meta/{name}s.parquet")
        (index,) = json.loads(table.schema.metadata[b"pandas"])["index_columns"]
        assert table.to_pydict() == {f"{name}_index": list(range(len(texts))), index: list(texts)}


def assert_quantiles(stats: dict[str, list[float]], rows: np.ndarray) -> None:
    """Those of all rows, not means over episodes: policies that scale by them would cut actions off."""
    for name, share in (("q01", 0.01), ("q10", 0.1), ("q50", 0.5), ("q90", 0.9), ("q99", 0.99)):
        np.testing.assert_allclose(stats[name], np.quantile(rows, share, axis=0), rtol=1e-9, err_msg=name)


def test_statistics_of_episodes_and_of_all_rows(by_frame: Export) -> None:
    every = np.concatenate([frames_of(number, frames, True)["action"] for number, frames in enumerate((5, 8))])
    whole = every.astype(np.float64)
    stats = by_frame.stats["action"]
    for name, expected in (
        ("min", whole.min(0)),
        ("max", whole.max(0)),
        ("mean", whole.mean(0)),
        ("std", whole.std(0)),
    ):
        np.testing.assert_allclose(stats[name], expected, rtol=1e-9)
    assert stats["count"] == [13]
    assert_quantiles(stats, whole)
    np.testing.assert_allclose(by_frame.episodes["stats/action/mean"][1], whole[5:].mean(0))
    np.testing.assert_allclose(by_frame.episodes["stats/action/q50"][1], np.median(whole[5:], axis=0))
    assert by_frame.episodes["stats/next.reward/max"] == [[5.0], [8.0]]


def test_statistics_of_numbers_of_rows_episodes_and_tasks(by_frame: Export) -> None:
    stats, rows = by_frame.stats, by_frame.rows
    assert set(stats) == set(rows) == set(by_frame.info["features"])
    assert (stats["episode_index"]["max"], stats["task_index"]["max"], stats["index"]["max"]) == ([1], [1], [12])
    for name in ("episode_index", "task_index", "index", "next.reward", "next.done"):
        assert_quantiles(stats[name], np.array(rows[name], np.float64)[:, None])


def test_the_table_of_episodes_says_how_they_begin_again(by_frame: Export) -> None:
    found = by_frame.episodes
    assert (found["seed"], found["scene"]) == ([10, 11], ["kitchen_b/00"] * 2)
    assert (found["env_id"], found["control_mode"]) == (["HazardFire-v1"] * 2, ["pd_joint_pos"] * 2)
    assert json.loads(found["settings"][0])["physics"] == "paper"
    card = (by_frame.folder / "README.md").read_text()
    assert card.startswith("---\nlicense: cc-by-3.0\n") and "- LeRobot\n" in card.split("---")[1]
    assert '"split": "train"' in card and "ATTRIBUTION.md" in card


def test_its_actions_give_its_states_again(tmp_path: Path) -> None:
    """As the card says, bit by bit, for an episode that was driven through the real environment."""
    made = Export(driven(tmp_path / "driven"), tmp_path / "export")
    row = {name: made.episodes[name][0] for name in ("env_id", "seed", "scene", "control_mode", "settings")}
    settings = {**json.loads(row["settings"]), "obs_mode": "none", "render_backend": "none"}
    env = gym.make(row["env_id"], control_mode=row["control_mode"], **settings)
    env.reset(seed=row["seed"], options={"scene": row["scene"]})
    for action, state in zip(made.rows["action"], made.rows["observation.state"], strict=True):
        joints = env.unwrapped.agent.robot.get_qpos()[0].numpy()  # type: ignore[attr-defined]
        np.testing.assert_array_equal(np.array(state[:15], np.float32), joints)
        env.step(np.array(action, np.float32))
    env.close()


def test_a_row_for_every_picture_where_there_are_some(by_picture: Export) -> None:
    rows = by_picture.rows
    assert by_picture.info["fps"] == 10 and by_picture.episodes["length"] == list(ROWS)
    starts = [0, *np.cumsum(ROWS)]
    assert by_picture.episodes["dataset_from_index"] == starts[:-1]
    assert by_picture.episodes["dataset_to_index"] == starts[1:]
    for number, (frames, count) in enumerate(zip(LENGTHS, ROWS, strict=True)):
        arrays = frames_of(number, frames, False)
        for row in range(count):
            index, frame = starts[number] + row, 3 * row
            np.testing.assert_allclose(rows["action"][index], arrays["action"][frame : frame + 3].mean(0), rtol=1e-6)
            assert rows["next.reward"][index] == arrays["reward"][frame : frame + 3].sum()
            assert rows["next.done"][index] == rows["next.success"][index] == (row == count - 1)
            assert rows["timestamp"][index] == np.float32(row / 10)


def test_films_follow_each_other_and_each_picture_stands_at_its_time(by_picture: Export) -> None:
    episodes = by_picture.episodes
    with av.open(str(by_picture.folder / f"videos/{HEAD}/chunk-000/file-000.mp4")) as film:
        stream = film.streams.video[0]
        shown = {round(float(p.pts * p.time_base), 4): p.to_ndarray(format="rgb24") for p in film.decode(stream)}
        assert stream.average_rate == 10 and float(stream.duration * stream.time_base) == 1.0
    assert list(shown) == [k / 10 for k in range(sum(ROWS))]
    for number, count in enumerate(ROWS):
        start = episodes[f"videos/{HEAD}/from_timestamp"][number]
        assert episodes[f"videos/{HEAD}/to_timestamp"][number] == pytest.approx(start + count / 10)
        for row in range(count):
            picture = shown[round(start + row / 10, 4)]
            assert np.abs(picture.astype(int) - level(number, 3 * row)).max() <= 2  # video compression
    mean = np.array(episodes[f"stats/{HEAD}/mean"][1]) * 255
    assert mean.shape == (3, 1, 1) and np.abs(mean - np.mean([level(1, 3 * k) for k in range(4)])).max() <= 2


def test_full_files_are_followed_by_others(pictured: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(lerobot_tables, "TABLE_SIZE", 0)
    monkeypatch.setattr(lerobot_film, "FILM_SIZE", 0)
    monkeypatch.setattr(lerobot_tables, "CHUNK", 2)
    monkeypatch.setattr(lerobot_film, "CHUNK", 2)
    monkeypatch.setattr(lerobot_tables, "BLOCK", 4)  # numbers of 13 that are read at once
    found = Export(pictured, tmp_path)
    whole = np.array(found.rows["action"], np.float64)
    assert_quantiles(found.stats["action"], whole)
    np.testing.assert_allclose(found.stats["action"]["mean"], whole.mean(0), rtol=1e-9)
    assert found.stats["action"]["count"] == [sum(ROWS)]
    places = ["chunk-000/file-000", "chunk-000/file-001", "chunk-001/file-000"]
    assert found.episodes["data/chunk_index"] == found.episodes[f"videos/{HEAD}/chunk_index"] == [0, 0, 1]
    assert found.episodes["data/file_index"] == found.episodes[f"videos/{HEAD}/file_index"] == [0, 1, 0]
    assert found.episodes[f"videos/{HEAD}/from_timestamp"] == [0.0, 0.0, 0.0]
    for number, name in enumerate(places):
        assert len(pq.read_table(tmp_path / f"data/{name}.parquet")) == ROWS[number]
        with av.open(str(tmp_path / f"videos/{HEAD}/{name}.mp4")) as film:
            assert film.streams.video[0].frames == ROWS[number]


def test_what_lerobot_cannot_hold_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="every must divide 30, the frames per second, for lerobot, got 4"):
        lerobot.write(Source(dataset(tmp_path / "four", (5,), "rgb", 4)), tmp_path)
    short = dataset(tmp_path / "short", (5,), "rgb", 3)
    one = next(iter(Source(short)))
    with pytest.raises(ValueError, match="must hold 9 pictures in order, got 2"):
        lerobot_film.Film(tmp_path, HEAD, 10).add(one.films["head"], 9)


@pytest.mark.skipif(READER not in os.environ, reason=f"{READER} must name a Python with lerobot 0.4")
@pytest.mark.parametrize("pictures", [False, True])
def test_the_reader_of_lerobot_gives_what_was_recorded(
    by_frame: Export, by_picture: Export, tmp_path: Path, pictures: bool
) -> None:
    folder = (by_picture if pictures else by_frame).folder
    lengths, step = (LENGTHS, 3) if pictures else ((5, 8), 1)
    rows = [(n, frame) for n, frames in enumerate(lengths) for frame in range(0, frames, step)]
    script = Path(__file__).with_name("lerobot_reader.py")
    variables = {**os.environ, "HF_HUB_OFFLINE": "1", "HF_HOME": str(tmp_path / "cache"), "PYTHONPATH": ""}
    command = [os.environ[READER], str(script), str(folder), *map(str, range(len(rows)))]
    out = subprocess.run(command, capture_output=True, text=True, env=variables, check=False)
    assert out.returncode == 0, out.stderr[-3000:]
    found = json.loads(out.stdout.splitlines()[-1])
    assert (found["episodes"], found["rows"], found["rate"]) == (len(lengths), len(rows), 30 // step)
    for row, (number, frame) in zip(found["read"], rows, strict=True):
        arrays = frames_of(number, lengths[number], not pictures)
        np.testing.assert_array_equal(np.array(row["observation.state"], np.float32), state_of(arrays, frame))
        lasting = arrays["action"][frame : frame + step].mean(0)
        np.testing.assert_allclose(np.array(row["action"], np.float32), lasting, rtol=1e-6)
        assert row["timestamp"] == pytest.approx(frame / 30, abs=1e-6) and row["episode_index"] == number
        assert (row["task"], row["subtask"]) == (TASKS[number % 2], subtasks_of(number)[arrays["subtask"][frame]])
        if pictures:
            shown = np.array(row[HEAD]) * 255
            assert shown.shape == (3, 64, 64) and np.abs(shown - level(number, frame)).max() <= 2
