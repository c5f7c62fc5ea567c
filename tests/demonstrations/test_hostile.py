"""Datasets of strangers: nothing is written or read outside of them, and what is wrong is one line."""

from __future__ import annotations

import dataclasses
import io
import json
import os
import tracemalloc
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from hazard_ms.cli.__main__ import main
from hazard_ms.demonstrations.layout import (
    EPISODE,
    FAILURES,
    FRAMES,
    MANIFEST,
    DamagedDatasetError,
    content_of,
    hashes_of,
)
from hazard_ms.demonstrations.merging import merge
from hazard_ms.demonstrations.reading import demonstrations, differences, entries, read_episode
from hazard_ms.demonstrations.repair import repair
from hazard_ms.demonstrations.verify import verify
from tests.worlds.recordings import RECIPE, stored

COMMANDS = (["verify"], ["stats"], ["show", "-o", "p.html"], ["merge", "-o", "m"], ["export", "-f", "tar", "-o", "t"])


@pytest.fixture
def dataset(tmp_path: Path) -> Path:
    """One episode, with a film that is none."""
    made = tmp_path / "in" / "HazardFire-v1" / "oracle"
    stored(made, 0, film=b"12345")
    return made


def relisted(dataset: Path, **changes: Any) -> Path:
    """Let the manifest list the files of the episode as they are now, with other entries besides; its folder."""
    (entry,) = entries(dataset)
    hashes = hashes_of(dataset / entry.name)
    line = dataclasses.replace(entry, files=hashes, content=content_of(hashes), **changes).line()
    (dataset / MANIFEST).write_text(line)
    return dataset / entry.name


def everything(folder: Path) -> dict[str, Any]:
    """All that lies in a folder by its path; the content of files."""
    return {str(p.relative_to(folder)): p.read_bytes() if p.is_file() else None for p in sorted(folder.rglob("*"))}


def bomb(shape: tuple[int, ...], content: int) -> bytes:
    """A file of one array of `shape`, with `content` bytes of zeros, packed."""
    packed, header = io.BytesIO(), io.BytesIO()
    np.lib.format.write_array_header_1_0(header, {"descr": "<f4", "fortran_order": False, "shape": shape})
    with zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED) as archive, archive.open("action.npy", "w") as file:
        file.write(header.getvalue())
        for _ in range(content >> 20):
            file.write(bytes(1 << 20))
    return packed.getvalue()


@pytest.mark.parametrize("name", ["{top}/outside", "../../outside", "..", ".hidden", "a\x1b[2J"])
def test_merging_writes_nowhere_else(dataset: Path, tmp_path: Path, name: str) -> None:
    relisted(dataset, recipe=RECIPE | {"env_id": name.format(top=tmp_path)})
    before = everything(tmp_path)
    with pytest.raises(ValueError, match="env_id in .* must be the name of a folder"):
        merge([dataset], tmp_path / "out")
    assert everything(tmp_path) == before


@pytest.mark.parametrize("name", ["../../outside", "/usr/share", FAILURES, MANIFEST, ".git", "a\x1b[2J", ""])
def test_an_episode_of_such_a_name_is_a_damaged_line(dataset: Path, tmp_path: Path, name: str) -> None:
    relisted(dataset, name=name)
    assert entries(dataset) == [] and verify(dataset) == 1
    with pytest.raises(DamagedDatasetError, match=r"manifest\.jsonl must be whole, got a damaged line 1"):
        merge([dataset], tmp_path / "out")
    assert not (tmp_path / "out").exists()


def pipe(path: Path) -> None:
    os.mkfifo(path)


def link(path: Path) -> None:
    (path.parents[2] / "secret").write_text("of its reader")
    path.symlink_to(path.parents[2] / "secret")


def folder_link(path: Path) -> None:
    (path.parents[2] / "secrets").mkdir()
    (path.parents[2] / "secrets" / "file").write_text("of its reader")
    path.symlink_to(path.parents[2] / "secrets")


@pytest.mark.parametrize("kind", [pipe, link, folder_link])
@pytest.mark.parametrize("name", ["head.mp4", EPISODE, "more"])
def test_what_is_no_regular_file_is_a_fault(
    dataset: Path, kind: Callable[[Path], None], name: str, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    (entry,) = entries(dataset)
    path = dataset / entry.name / name
    path.unlink(missing_ok=True)
    kind(path)
    assert differences(dataset / entry.name, entry) == [
        f"{path} must be a regular file, got a link, a pipe or a device"
    ]
    for command, *words in COMMANDS:
        wanted = 1 if command == "verify" else 2
        where = [str(tmp_path / word) if "-o" in words and word == words[-1] else word for word in words]
        assert main(["demos", command, str(dataset), *where]) == wanted
        assert str(path) in "".join(capsys.readouterr())
    repair(dataset)
    assert entries(dataset) == [] and os.path.lexists(dataset / "damaged" / entry.name / name)


def test_locks_and_failures_that_are_links_are_not_followed(dataset: Path, tmp_path: Path) -> None:
    secret = tmp_path / "secret"
    secret.mkdir()
    (dataset / FAILURES).symlink_to(secret)
    assert verify(dataset) == 1
    with pytest.raises(ValueError, match="failures must be a folder, got a link"):
        repair(dataset)
    (dataset / FAILURES).unlink()
    (secret / "file").write_text("of its reader")
    (dataset / ".s000004.part-1").symlink_to(secret)
    repair(dataset)
    assert everything(secret) == {"file": b"of its reader"}


@pytest.mark.parametrize("name", [".s000003.lock", ".lock"])
@pytest.mark.parametrize("kind", [pipe, link, folder_link, Path.mkdir])
def test_a_lock_that_is_no_file_is_named(
    dataset: Path, kind: Callable[[Path], None], name: str, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    path = dataset / name
    path.unlink(missing_ok=True)
    kind(path)
    before = everything(tmp_path)
    assert main(["demos", "repair", str(dataset)]) == 2
    assert f"hazard-ms: {path} must be a regular file" in capsys.readouterr().err
    assert everything(tmp_path) == before


def test_a_dataset_in_a_dataset_is_not_moved_aside(dataset: Path) -> None:
    inner = dataset / "inner"
    stored(inner, 3)
    repair(dataset)
    assert len(entries(inner)) == 1 and not (dataset / "damaged").exists()


@pytest.mark.parametrize(("length", "content"), [(2**26, 2**28), (2**40, 0)])
def test_arrays_are_counted_before_they_are_unpacked(dataset: Path, length: int, content: int) -> None:
    (dataset / entries(dataset)[0].name / FRAMES).write_bytes(bomb((length,), content))
    folder = relisted(dataset)
    tracemalloc.start()
    try:
        with pytest.raises(DamagedDatasetError, match=rf"{folder / FRAMES} must"):
            next(demonstrations(dataset))
        assert tracemalloc.get_traced_memory()[1] < 50_000_000  # numpy's own memory is traced, too
    finally:
        tracemalloc.stop()


def edited(dataset: Path, change: Callable[[dict[str, Any]], object]) -> Path:
    """Change episode.json, and let the manifest say so; its folder."""
    path = dataset / entries(dataset)[0].name / EPISODE
    row = json.loads(path.read_text())
    change(row)
    path.write_text(json.dumps(row))
    return relisted(dataset)


@pytest.mark.parametrize(
    "change",
    [
        lambda row: row["result"]["targets"][0].update(value=10**400),
        lambda row: [target.update(value=0) for target in row["result"]["targets"]],
        lambda row: row["result"].update(max_frames=10**11),
        lambda row: row["result"].update(targets=[]),
        lambda row: row.update(reach="<b>"),
        lambda row: row.update(recipe=[1]),
        lambda row: row.pop("result"),
        lambda row: row.update(prompts=[{"text": "", "options": {"A": -1}}]),
        lambda row: row.update(deep=json.loads("[" * 200 + "]" * 200)),
    ],
)
def test_a_description_that_no_episode_has_is_refused(
    dataset: Path, change: Callable[[dict[str, Any]], object], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = edited(dataset, change)
    with pytest.raises(DamagedDatasetError, match=str(folder / EPISODE)):
        next(demonstrations(dataset))
    assert main(["demos", "show", str(dataset), "-o", str(tmp_path / "page.html")]) == 2
    assert main(["demos", "merge", str(dataset), "-o", str(tmp_path / "out")]) == 2
    assert str(folder / EPISODE) in capsys.readouterr().err and not (tmp_path / "out").exists()


def test_a_description_that_lacks_something_names_it(dataset: Path) -> None:
    folder = edited(dataset, lambda row: row.pop("reach"))
    read = read_episode(folder)
    with pytest.raises(DamagedDatasetError, match=r"episode\.json must hold reach, got none"):
        read.meta["reach"]
    with pytest.raises(DamagedDatasetError, match=r"frames\.npz must hold qpos, got none"):
        read.frames["qpos"]


@pytest.mark.parametrize(
    "frames",
    [
        {"action": np.zeros((3, 2), np.float32), "reward": np.zeros(4, np.float32)},
        {"action": np.zeros((3, 2), np.float32), "base": np.zeros((3, 3), np.float32)},
        {"hand": np.zeros((4, 2), np.float32)},
        {"success": np.zeros(3, np.float32)},
        {"action": np.zeros((3, 2), "U8")},
        {"state_frame": np.array([7], np.int32), "action": np.zeros((3, 2), np.float32)},
    ],
)
def test_arrays_that_do_not_fit_each_other_are_refused(dataset: Path, frames: dict[str, Any]) -> None:
    folder = dataset / entries(dataset)[0].name
    np.savez_compressed(folder / FRAMES, **frames)
    with pytest.raises(DamagedDatasetError, match="must hold arrays that fit each other"):
        read_episode(folder)


def test_an_added_file_is_named_and_keeps_the_episode_from_being_read(dataset: Path) -> None:
    (entry,) = entries(dataset)
    (dataset / entry.name / "more.txt").touch()
    assert differences(dataset / entry.name, entry) == ["an unknown file more.txt"]
    with pytest.raises(DamagedDatasetError, match=r"got an unknown file more\.txt"):
        next(demonstrations(dataset))
