"""Files of trained policies: NAME.safetensors holds the numbers, NAME.json beside it what they are.

Nothing in such files can run code. The numbers of a policy that sees a map are stored with 16 bits.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Any

import torch
from safetensors import SafetensorError
from safetensors.torch import load as unpacked
from safetensors.torch import save

from hazard_ms.agents.learned.map_policy import MapPolicy, MapShape
from hazard_ms.agents.learned.set_policy import SetPolicy, Shape
from hazard_ms.skills.options.feature_columns import FEATURES_VERSION
from hazard_ms.skills.options.paper_map import MAP_VERSION

ENDING = ".safetensors"


def contents(policy: SetPolicy | MapPolicy, task: str, facts: Mapping[str, Any]) -> tuple[bytes, str]:
    """The contents of both files of a `policy` for `task`; `facts`, plain data, say how it came about."""
    told = {"task": task, **_version(policy), "shape": asdict(policy.shape), **facts}
    return save(dict(stored(policy))), json.dumps(told, indent=1, allow_nan=False) + "\n"


def stored(policy: SetPolicy | MapPolicy) -> dict[str, torch.Tensor]:
    """The numbers of a `policy` as its file holds them, by name, [...] each."""
    numbers = dict(policy.state_dict())
    return {name: part.half() for name, part in numbers.items()} if isinstance(policy, MapPolicy) else numbers


def load(path: Path, task: str, made_by: str = "train bc") -> SetPolicy:
    """The policy over options in a file NAME.safetensors, with its NAME.json, ready to be asked at decisions of `task`.

    `made_by`: the command that makes such files.

    Raises ValueError for files that are missing or damaged, and for policies of another task, or of another version of
    the features.
    """
    found = _read(path, task, made_by, SetPolicy)
    assert isinstance(found, SetPolicy)
    return found


def load_map(path: Path, task: str, made_by: str = "train ppo --actions paper") -> MapPolicy:
    """The policy over the six actions in a file, as `load` does it; it raises the same."""
    found = _read(path, task, made_by, MapPolicy)
    assert isinstance(found, MapPolicy)
    return found


def sees_map(path: Path) -> bool:
    """Whether the policy in a file is one over the six actions; False if there is none."""
    try:
        return "map_version" in json.loads(path.with_suffix(".json").read_text(encoding="utf-8"))
    except (OSError, ValueError, TypeError):
        return False


def _version(policy: SetPolicy | MapPolicy | type) -> dict[str, int]:
    kind = policy if isinstance(policy, type) else type(policy)
    return {"map_version": MAP_VERSION} if kind is MapPolicy else {"features_version": FEATURES_VERSION}


def _read(path: Path, task: str, made_by: str, kind: type[SetPolicy] | type[MapPolicy]) -> SetPolicy | MapPolicy:
    beside = path.with_suffix(".json")
    try:
        told = json.loads(beside.read_text(encoding="utf-8"))
        for name, wanted in {**_version(kind), "task": task}.items():
            if told.get(name) != wanted:
                raise ValueError(f"{name} must be {wanted}, got {told.get(name)}")
        plain = dict(told["shape"])
        ranges = tuple((float(low), float(high)) for low, high in plain.pop("ranges"))
        shape = {**plain, "ignored": tuple(plain["ignored"])}
        policy = MapPolicy(MapShape(ranges, **shape)) if kind is MapPolicy else SetPolicy(Shape(ranges, **shape))
        policy.load_state_dict(unpacked(path.read_bytes()))
    except (OSError, ValueError, KeyError, TypeError, AttributeError, RuntimeError, SafetensorError) as error:
        raise ValueError(
            f"{path} must hold a policy for {task}: {error}; `hazard-ms {made_by} -e {task} -o FOLDER` makes one"
        ) from None
    return policy.eval()
