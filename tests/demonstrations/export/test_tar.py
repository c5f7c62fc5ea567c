"""Exports as tar files: the files of an episode follow each other, under names that WebDataset understands."""

from __future__ import annotations

import io
import json
import tarfile
from pathlib import Path

import numpy as np
import pytest

from hazard_ms.demonstrations.export import tar
from hazard_ms.demonstrations.export.source import Source
from tests.worlds.recorded import dataset, frames_of


def contents(path: Path) -> list[tuple[str, bytes]]:
    with tarfile.open(path) as file:
        return [(entry.name, file.extractfile(entry).read()) for entry in file]  # type: ignore[union-attr]


@pytest.mark.parametrize("privileged", [False, True])
def test_names_and_bytes_of_all_files(tmp_path: Path, privileged: bool) -> None:
    recorded = dataset(tmp_path / "recorded")
    tar.write(Source(recorded, privileged=privileged), tmp_path)
    parts = ["decisions.npz", "episode.json", "frames.npz"] + ["privileged-truth.npz"] * privileged
    keys = ["kitchen_b-00-s000010", "kitchen_b-00-s000011"]
    files = contents(tmp_path / "shard-000000.tar")
    assert [name for name, _ in files] == [f"{key}.{part}" for key in keys for part in parts]
    for name, content in files:
        key, _, part = name.partition(".")
        assert content == (recorded / key / part.replace("privileged-", "privileged/")).read_bytes()
    found = np.load(io.BytesIO(dict(files)["kitchen_b-00-s000011.frames.npz"]))
    np.testing.assert_array_equal(found["action"], frames_of(1, 8, False)["action"])
    about = json.loads((tmp_path / "about.json").read_text())
    assert about["episodes"] == 2 and "targets" in about["actions"]


def test_full_shards_are_followed_by_others(tmp_path: Path) -> None:
    """An episode is never split, even one that is larger than a shard should be."""
    source = Source(dataset(tmp_path / "recorded", (5, 8, 6)))
    assert tar.write(source, tmp_path, size=1) == "shard-{000000..000002}.tar"
    for number in range(3):
        keys = {name.partition(".")[0] for name, _ in contents(tmp_path / f"shard-{number:06d}.tar")}
        assert keys == {f"kitchen_b-00-s{10 + number:06d}"}
    with (tmp_path / "shard-000000.tar").open("rb") as file:
        assert len(file.read()) % tarfile.RECORDSIZE == 0
