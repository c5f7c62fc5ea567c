"""Files of policies: what was written is read, and whatever else is there is refused in one line."""

from __future__ import annotations

import json
import struct
from pathlib import Path

import pytest
import torch

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
