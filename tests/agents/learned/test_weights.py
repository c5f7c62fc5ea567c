"""Files of policies: what was written is read, and whatever else is there is refused in one line."""

from __future__ import annotations

import io
import json
import os
import resource
import struct
import zipfile
from collections.abc import Callable
from pathlib import Path

import pytest
import torch
from safetensors.torch import load, save

from hazard_ms.agents.learned import weights
from hazard_ms.agents.learned.set_policy import SetPolicy, Shape

FIRE = "HazardFire-v1"


def stored(folder: Path) -> Path:
    """The file of an untrained policy."""
    torch.manual_seed(3)
    packed, told = weights.contents(SetPolicy(Shape(((20.0, 600.0),), ignored=("front",))), FIRE, {"command": "none"})
    path = folder / "one.safetensors"
    path.write_bytes(packed)
    path.with_suffix(".json").write_text(told)
    return path


def test_a_policy_comes_back_as_it_was(tmp_path: Path) -> None:
    path = stored(tmp_path)
    torch.manual_seed(3)
    want, got = SetPolicy(Shape(((20.0, 600.0),), ignored=("front",))), weights.load(path, FIRE)
    assert got.shape == want.shape and not got.training
    for name, tensor in want.state_dict().items():
        assert torch.equal(got.state_dict()[name], tensor)
    assert torch.equal(got.get_buffer("read"), want.get_buffer("read"))


def test_what_is_not_a_policy_of_the_task_is_refused(tmp_path: Path) -> None:
    path = stored(tmp_path)
    beside, packed = path.with_suffix(".json"), path.read_bytes()
    plain = json.loads(beside.read_text())
    with pytest.raises(ValueError, match="task must be HazardFlood-v1, got HazardFire-v1; `hazard-ms train bc"):
        weights.load(path, "HazardFlood-v1")
    beside.write_text(json.dumps({**plain, "features_version": 0}))
    with pytest.raises(ValueError, match="features_version must be 1, got 0"):
        weights.load(path, FIRE)
    beside.write_text(json.dumps({**plain, "shape": {**plain["shape"], "width": 8, "heads": 2}}))
    with pytest.raises(ValueError, match="must hold a policy"):
        weights.load(path, FIRE)
    beside.write_text(json.dumps(plain))
    for content in (b"", packed[:-4], b"\xff" * 40, struct.pack("<Q", 2) + b"[]"):
        path.write_bytes(content)
        with pytest.raises(ValueError, match=f"{path} must hold a policy"):
            weights.load(path, FIRE)
    beside.unlink()
    with pytest.raises(ValueError, match=r"one\.json"):
        weights.load(path, FIRE)


def test_a_policy_without_measures_is_refused_where_there_are_some_and_the_other_way_round(tmp_path: Path) -> None:
    """Layouts of both have versions of their own, so that the published tasks keep their policies."""
    path = stored(tmp_path)
    with pytest.raises(ValueError, match="features_version must be 2, got 1; `hazard-ms train bc"):
        weights.load(path, FIRE, measures=True)
    shape = Shape(((20.0, 600.0),), measures=True)
    packed, told = weights.contents(SetPolicy(shape), FIRE, {})
    path.write_bytes(packed)
    path.with_suffix(".json").write_text(told)
    assert weights.load(path, FIRE, measures=True).shape == shape
    with pytest.raises(ValueError, match="features_version must be 1, got 2"):
        weights.load(path, FIRE)
    path.with_suffix(".json").write_text(told.replace('"measures": true', '"measures": false'))
    with pytest.raises(ValueError, match="shape.measures must be True, got False"):
        weights.load(path, FIRE, measures=True)


@pytest.mark.parametrize(
    ("change", "told"),
    [
        (lambda part: torch.full_like(part, float("nan")), "must hold only finite floating-point numbers"),
        (lambda part: torch.full_like(part, float("inf")), "must hold only finite floating-point numbers"),
        (lambda part: part.long(), "must hold only finite floating-point numbers"),
        (lambda part: part[:1], r"must be \[.*\], got \[1"),
    ],
)
def test_numbers_that_no_policy_has_are_refused(
    tmp_path: Path, change: Callable[[torch.Tensor], torch.Tensor], told: str
) -> None:
    path = stored(tmp_path)
    path.write_bytes(save({name: change(part).contiguous() for name, part in load(path.read_bytes()).items()}))
    with pytest.raises(ValueError, match=told):
        weights.load(path, FIRE)


@pytest.mark.parametrize(
    "shape",
    [{"width": 50_000}, {"blocks": 10**9}, {"width": 40.5}, {"ranges": [[1.0, 1.0]]}, {"ranges": [[0.0, 1.0]] * 10**5}],
)
def test_a_shape_is_compared_with_the_file_before_anything_is_made(tmp_path: Path, shape: dict[str, object]) -> None:
    path = stored(tmp_path)
    beside = path.with_suffix(".json")
    plain = json.loads(beside.read_text())
    beside.write_text(json.dumps({**plain, "shape": {**plain["shape"], **shape}}))
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    with pytest.raises(ValueError, match=f"{path} must hold a policy"):
        weights.load(path, FIRE)
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before < 200_000  # [kB]


def test_the_largest_shape_is_refused_without_its_memory(tmp_path: Path) -> None:
    """Its numbers would take 1.1 GB: 32 blocks of 8 x 1024 x 1024."""
    path = stored(tmp_path)
    beside = path.with_suffix(".json")
    plain = json.loads(beside.read_text())
    beside.write_text(json.dumps({**plain, "shape": {**plain["shape"], "width": 1024, "heads": 4, "blocks": 32}}))
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    with pytest.raises(ValueError, match="its tensors must be those of its shape, got a difference"):
        weights.load(path, FIRE)
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before < 200_000  # [kB]


def test_the_state_of_a_training_is_counted_before_it_is_unpacked(tmp_path: Path) -> None:
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED) as archive, archive.open("a/data/0", "w") as file:
        for _ in range(300):
            file.write(bytes(1_000_000))
    with pytest.raises(ValueError, match="must unpack to at most 256000000 bytes, got 300000000"):
        weights.unpacked_state(packed.getvalue())
    packed = io.BytesIO()
    torch.save({"curve": [], "best": torch.ones(2)}, packed)
    assert weights.unpacked_state(packed.getvalue())["best"].tolist() == [1.0, 1.0]
    os.mkfifo(tmp_path / "one.training")
    with pytest.raises(ValueError, match="must be a regular file"):
        weights.packed_state(tmp_path / "one.training")
