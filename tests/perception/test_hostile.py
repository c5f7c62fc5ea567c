"""Datasets and weights of strangers: refused in a line, with little memory, and without waiting."""

from __future__ import annotations

import json
import os
import random
import resource
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
import torch

from hazard_ms.perception import check, layout
from hazard_ms.perception.detectors.weights import read_weights
from hazard_ms.perception.rows import SCORED
from hazard_ms.perception.score import score
from hazard_ms.perception.training.pictures import read
from tests.worlds.drawn_pictures import draw
from tests.worlds.hostile.junk import damaged, spoilt, text


@pytest.fixture
def data(tmp_path: Path) -> Path:
    return draw(tmp_path / "data", "test", 2, 64)


def changed(data: Path, change: Callable[[Any], None]) -> None:
    path = data / layout.instances("test")
    rows = json.loads(path.read_text())
    change(rows)
    path.write_text(json.dumps(rows))


def test_nothing_found_is_a_result(data: Path, tmp_path: Path) -> None:
    (tmp_path / "none.json").write_text("[]")
    told = score(data, tmp_path / "none.json", "test")
    assert told.count("| all |") == 2 and "0.000 | 0.000 | 0.000" in told


@pytest.mark.parametrize("size", [[100000, 100000], [2**31, 2**31], [-1, -1], [64.5, "a"]])
def test_masks_of_other_sizes_are_refused(data: Path, tmp_path: Path, size: Any) -> None:
    changed(data, lambda rows: rows["annotations"][0].update(segmentation={"size": size, "counts": "0"}))
    (tmp_path / "none.json").write_text("[]")
    with pytest.raises(ValueError, match="annotation .* of instances_test"):
        score(data, tmp_path / "none.json", "test")


def test_a_pipe_and_files_outside_are_refused(data: Path) -> None:
    os.mkfifo(data / "pipe")
    for name in ("pipe", "/etc/hostname", "../x.jpg"):
        changed(data, lambda rows, name=name: rows["images"][0].update(file_name=name))  # type: ignore[misc]
        with pytest.raises(ValueError, match="regular file|inside its folder"):
            read([data], "test")[0].rgb()


def test_a_file_of_50_gb_is_not_hashed(data: Path) -> None:
    """It takes no room on the disk; hashing it would take minutes."""
    name = json.loads((data / layout.instances("test")).read_text())["images"][0]["depth_file"]
    (data / layout.SUMS).write_text(layout.sums_of(data, [name]))
    os.truncate(data / name, 50_000_000_000)
    told = list(check._of_sums(data))
    assert "must have at most 400000000 bytes, got 50000000000" in told[0]


def test_weights_name_nothing_but_tensors(tmp_path: Path) -> None:
    """A pickle that asks for 10 GB of zeros passes weights_only."""
    torch.save({"a": bytearray(8)}, tmp_path / "a.pth")
    torch.save({"a": torch.full((2,), float("nan"))}, tmp_path / "b.pth")
    for name, told in (("a.pth", "must be"), ("b.pth", "must be finite")):
        with pytest.raises(ValueError, match=told):
            read_weights(tmp_path / name)
    for old in (True, False):
        torch.save({"a": torch.ones(2)}, tmp_path / "c.pth", _use_new_zipfile_serialization=not old)
        assert read_weights(tmp_path / "c.pth")["a"].sum() == 2


class Large:
    """What a pickle can ask for although torch calls it safe: 10 GB of zeros."""

    def __reduce__(self) -> Any:
        return bytearray, (10**10,)


@pytest.mark.parametrize("new", [True, False])
def test_a_pickle_that_asks_for_memory_is_refused_before_it_gets_any(new: bool, tmp_path: Path) -> None:
    torch.save({"a": Large()}, tmp_path / "a.pth", _use_new_zipfile_serialization=new)
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    with pytest.raises(ValueError, match="only tensors may be in it, got __builtin__ bytearray"):
        read_weights(tmp_path / "a.pth")
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before < 100_000, "kB"


def test_a_tensor_larger_than_its_file_is_refused(tmp_path: Path) -> None:
    torch.save({"a": torch.zeros(1).expand(10**10)}, tmp_path / "a.pth")
    with pytest.raises(ValueError, match=r"weights must be plain tensors, got a of shape \(10000000000,\)"):
        read_weights(tmp_path / "a.pth")
    head = json.dumps({"a": {"dtype": "F32", "shape": [10**6, 10**6], "data_offsets": [0, 4 * 10**12]}}).encode()
    (tmp_path / "a.safetensors").write_bytes(len(head).to_bytes(8, "little") + head + bytes(16))
    with pytest.raises(ValueError, match="weights must be a file .pth or .safetensors"):
        read_weights(tmp_path / "a.safetensors")


@pytest.mark.parametrize("count", [50, pytest.param(2000, marks=pytest.mark.long)])
def test_generated_files_are_read_or_refused(data: Path, count: int) -> None:
    path = data / layout.instances("test")
    good = path.read_bytes()
    for seed in range(count):
        draw_ = random.Random(seed)
        path.write_bytes(damaged(good, draw_) if seed % 4 == 0 else text(spoilt(json.loads(good), draw_, 3)))
        try:
            layout.read_instances(path, SCORED)
            for picture in read([data], "test"):
                picture.rgb(), picture.ids(), picture.cam2world()
        except ValueError as error:
            assert str(error).isprintable()
