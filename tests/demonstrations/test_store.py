"""Whatever kills a writer, and whenever: what was finished stays, nothing is half written, a new run ends the same."""

from __future__ import annotations

import os
import shutil
from pathlib import Path

import pytest

from hazard_ms.demonstrations.claims import claimed
from hazard_ms.demonstrations.layout import EPISODE, MANIFEST, DamagedDatasetError, Entry
from hazard_ms.demonstrations.reading import demonstrations, entries
from hazard_ms.demonstrations.repair import repair
from hazard_ms.demonstrations.store import append, entry_of, parts
from hazard_ms.demonstrations.verify import verify
from tests.worlds.recordings import content, killed_at, stored

FEWEST_CALLS = 25  # system calls of one episode, at each of which its writer is killed


def test_a_writer_killed_at_any_step_leaves_a_dataset_that_can_be_read_and_resumed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(os, "fsync", lambda opened: None)  # a process dies here, not the machine, and disks are slow
    stored(tmp_path / "begun", 0)
    shutil.copytree(tmp_path / "begun", tmp_path / "undisturbed")
    stored(tmp_path / "undisturbed", 1)
    wanted = content(entries(tmp_path / "undisturbed"))
    calls = 0
    killed = True
    while killed:
        dataset = tmp_path / f"killed-{calls}"
        shutil.copytree(tmp_path / "begun", dataset)
        killed = killed_at(calls, lambda dataset=dataset: stored(dataset, 1))  # type: ignore[misc]
        calls += killed
        read = [demonstration.folder for demonstration in demonstrations(dataset)]
        assert dataset / "kitchen_b-00-s000000" in read and len(read) == len(entries(dataset))
        repair(dataset)
        assert verify(dataset) == 0 and not list(parts(dataset)) and not list(dataset.glob(".s*"))
        if len(entries(dataset)) == 1:
            stored(dataset, 1)
        assert content(entries(dataset)) == wanted
    assert calls >= FEWEST_CALLS


def test_a_new_line_does_not_continue_one_that_was_torn(tmp_path: Path) -> None:
    stored(tmp_path, 0)
    first = (tmp_path / MANIFEST).read_bytes()
    (tmp_path / MANIFEST).write_bytes(first + first[: len(first) // 2])
    assert [e.seed for e in entries(tmp_path)] == [0]
    stored(tmp_path, 1)
    assert [e.seed for e in entries(tmp_path)] == [0, 1]


def test_an_episode_is_written_by_one_process_at_a_time(tmp_path: Path) -> None:
    with claimed(tmp_path, 7) as mine:
        with claimed(tmp_path, 7) as another, claimed(tmp_path, 8) as other:
            assert (mine, another, other) == (True, False, True)
        assert list(tmp_path.glob(".s000007.lock"))
    with claimed(tmp_path, 7) as again:
        assert again


def test_a_lock_does_not_outlive_its_process(tmp_path: Path) -> None:
    def hold() -> None:
        with claimed(tmp_path, 7) as mine:
            assert mine
            os.fsync(1)  # the system call at which it is killed

    assert killed_at(2, hold)
    assert (tmp_path / ".s000007.lock").exists()
    with claimed(tmp_path, 7) as mine:
        assert mine


def test_the_hash_of_an_episode_does_not_depend_on_times(tmp_path: Path) -> None:
    """Another process, at another time: only what is not hashed differs."""
    stored(tmp_path / "here", 3)
    assert not killed_at(10**6, lambda: stored(tmp_path / "there", 3))
    here, there = entries(tmp_path / "here")[0], entries(tmp_path / "there")[0]
    assert here.content == there.content and here.seconds != there.seconds


def test_an_episode_whose_description_was_edited_is_not_entered(tmp_path: Path) -> None:
    folder = stored(tmp_path, 0)
    path = folder / EPISODE
    path.write_text(path.read_text().replace('"seed": 0', '"seed": 1'))
    with pytest.raises(DamagedDatasetError, match="must match its episode.json"):
        entry_of(folder)


def test_a_line_of_another_format_is_refused(tmp_path: Path) -> None:
    stored(tmp_path, 0)
    line = entries(tmp_path)[0].line().replace('"format": 1', '"format": 2')
    with pytest.raises(ValueError, match="the format of a dataset must be 1, got 2"):
        Entry.of_line(line)


def test_a_folder_that_is_no_dataset_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="must be a dataset with a manifest.jsonl"):
        entries(tmp_path)


def test_a_manifest_that_cannot_be_written_whole_is_told(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    stored(tmp_path, 0)
    entry = entries(tmp_path)[0]
    real = os.write
    monkeypatch.setattr(os, "write", lambda opened, text: real(opened, text[:5]))
    with pytest.raises(OSError, match="could not be written whole; free some space"):
        append(tmp_path, entry)
