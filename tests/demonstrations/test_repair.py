"""Verifying, repairing, merging and counting datasets."""

from __future__ import annotations

import shutil
from pathlib import Path

import numpy as np
import pytest

from hazard_ms.demonstrations.claims import claimed
from hazard_ms.demonstrations.layout import DAMAGED, EPISODE, FAILURES, MANIFEST, DamagedDatasetError, files_of
from hazard_ms.demonstrations.merging import merge
from hazard_ms.demonstrations.reading import demonstrations, entries
from hazard_ms.demonstrations.repair import ENTERED, KEPT, MISSING, MOVED, REMOVED, broken_datasets, repair
from hazard_ms.demonstrations.stats import Stats
from hazard_ms.demonstrations.store import begin, parts
from hazard_ms.demonstrations.verify import verify
from tests.worlds.recordings import RECIPE, content, stored

SLOW = "50.0 % of the value, of 90.0 % that can be reached"


@pytest.fixture
def dataset(tmp_path: Path) -> Path:
    """Two episodes that were kept, and one that was not."""
    made = tmp_path / "HazardFire-v1" / "oracle"
    for seed in (0, 1):
        stored(made, seed)
    stored(made, 2, SLOW)
    return made


def test_what_was_stored_is_read(dataset: Path) -> None:
    first, second = demonstrations(dataset)
    assert (first.result.seed, second.result.seed) == (0, 1) and first.video is None
    assert np.array_equal(second.frames["action"], np.random.default_rng(1).random((3, 2), np.float32))
    assert first.decisions["frame"].tolist() == [0, 2] and first.privileged()["best"].tolist() == [1.0, 1.0]
    assert first.meta["recipe"] == RECIPE and first.result.versions == {} and "physics" in first.result.phase_seconds
    (failure,) = demonstrations(dataset / FAILURES)
    assert failure.meta["reason"] == SLOW


def test_one_flipped_byte_in_any_file_is_found(dataset: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert verify(dataset) == 0
    folder = dataset / entries(dataset)[0].name
    found = {**files_of(folder), MANIFEST: dataset / MANIFEST}
    assert len(found) == 5
    for name, path in found.items():
        before = path.read_bytes()
        for place in (0, len(before) // 3, len(before) // 2, len(before) - 2):
            path.write_bytes(before[:place] + bytes([before[place] ^ 1]) + before[place + 1 :])
            capsys.readouterr()
            assert verify(dataset) == 1, f"byte {place} of {name}"
            assert Path(name).name in capsys.readouterr().out
        path.write_bytes(before)
    assert verify(dataset) == 0


def test_what_is_missing_or_superfluous_is_found(dataset: Path) -> None:
    folder = dataset / entries(dataset)[0].name
    (folder / "more.txt").touch()
    assert verify(dataset) == 1
    (folder / "more.txt").unlink()
    (folder / "frames.npz").unlink()
    assert verify(dataset) == 1
    with pytest.raises(DamagedDatasetError, match=r"must match its manifest, got no frames\.npz"):
        list(demonstrations(dataset))


def test_a_folder_without_datasets_is_refused(tmp_path: Path) -> None:
    for command in (verify, broken_datasets):
        with pytest.raises(ValueError, match="folder must hold a dataset"):
            command(tmp_path)


def test_a_lost_manifest_is_made_again_from_whole_folders(dataset: Path) -> None:
    wanted = content(entries(dataset))
    (dataset / MANIFEST).unlink()
    assert broken_datasets(dataset.parent) == [dataset]
    assert repair(dataset) == {ENTERED: 2, KEPT: 1}
    assert content(entries(dataset)) == wanted and not any(e.verified for e in entries(dataset))
    assert verify(dataset) == 0


def test_what_is_damaged_is_moved_aside_and_what_is_unfinished_deleted(dataset: Path) -> None:
    first, second = (dataset / entry.name for entry in entries(dataset))
    (first / EPISODE).write_text("{")
    (first / "privileged" / "truth.npz").unlink()
    shutil.rmtree(second)
    (begin(dataset, 5) / "frames.npz").touch()
    with (dataset / MANIFEST).open("a") as file:
        file.write('{"name": "torn')
    assert repair(dataset) == {KEPT: 1, MOVED: 1, MISSING: 1, REMOVED: 1}
    assert entries(dataset) == [] and (dataset / DAMAGED / first.name / EPISODE).read_text() == "{"
    assert not list(parts(dataset)) and verify(dataset) == 0
    assert repair(dataset) == {KEPT: 1}


def test_an_episode_that_is_under_way_is_left_alone(dataset: Path) -> None:
    with claimed(dataset, 5) as mine:
        assert mine
        part = begin(dataset, 5)
        assert not repair(dataset)[REMOVED] and part.exists()


def test_datasets_are_merged_and_what_is_in_both_is_copied_once(dataset: Path, tmp_path: Path) -> None:
    other = tmp_path / "other" / "HazardFire-v1" / "oracle"
    for seed in (1, 3):
        stored(other, seed)
    out = tmp_path / "both"
    place = out / "HazardFire-v1" / "oracle"
    assert merge([dataset.parent, other], out) == {place: 4}
    assert content(entries(place)) == content([*entries(dataset), *entries(other)])
    assert [e.reason for e in entries(place / FAILURES)] == [SLOW] and verify(out) == 0
    assert merge([dataset], out) == {place: 0}
    assert "| 3 of 4 |" in (place / "README.md").read_text().replace("  ", "")


def test_datasets_that_differ_are_not_merged(dataset: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    stored(tmp_path / "a", 9, recipe={**RECIPE, "settings": {"physics": "realistic"}})
    with pytest.raises(ValueError, match="must have one recipe, got a different settings in"):
        merge([dataset, tmp_path / "a"], out)
    stored(tmp_path / "b", 1, saved=False)
    with pytest.raises(ValueError, match="episode kitchen_b-00-s000001 must be the same in all datasets"):
        merge([dataset, tmp_path / "b"], out)
    path = dataset / MANIFEST
    path.write_text(path.read_text().replace('"format": 1', '"format": 0'))
    with pytest.raises(ValueError, match="the format of a dataset must be 1, got 0"):
        merge([dataset], out)
    assert not out.exists()


def test_numbers_of_a_dataset(dataset: Path) -> None:
    found = Stats.of(dataset)
    assert (len(found.kept), len(found.entries)) == (2, 3)
    assert found.reasons == {"… % of the value, of … % that can be reached": 1}
    table = found.table()
    sizes = sum(path.stat().st_size for path in dataset.glob("**/*kitchen*/**/*") if path.is_file())
    assert f"{sizes / 1e6:.1f} MB, {sizes / 9:.0f} bytes per frame" in table and "| 50.0 % |" in table.replace("  ", "")


@pytest.mark.parametrize("name", ["manifest.jsonl", "README.md", "failures/manifest.jsonl"])
def test_repair_writes_to_no_file_that_a_link_names(tmp_path: Path, name: str) -> None:
    """The file outside stays as it was: it would get the lines that the manifest should have."""
    dataset, secret = tmp_path / "data", tmp_path / "secret"
    stored(dataset, 3)
    secret.write_text("of its reader\n")
    link = dataset / name
    link.parent.mkdir(exist_ok=True)
    link.unlink(missing_ok=True)
    link.symlink_to(secret)
    with pytest.raises(ValueError, match=f"{name} must be a file, got a link; delete it"):
        repair(dataset)
    assert secret.read_text() == "of its reader\n"
