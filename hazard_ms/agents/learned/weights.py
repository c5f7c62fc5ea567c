"""Files of trained policies: NAME.safetensors holds the numbers, NAME.json beside it what they are.

Nothing in such files can run code. The numbers of a policy that sees a map are stored with 16 bits.
"""

from __future__ import annotations

import io
import json
from collections.abc import Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Any

import torch
from safetensors import SafetensorError
from safetensors.torch import load as unpacked
from safetensors.torch import save
from torch import Tensor

from hazard_ms.agents.learned.map_policy import MapPolicy, MapShape
from hazard_ms.agents.learned.set_policy import SetPolicy, Shape
from hazard_ms.skills.options.feature_columns import FEATURES_VERSION, MEASURED_VERSION
from hazard_ms.skills.options.paper_map import MAP_VERSION
from hazard_ms.spec.foreign import plain
from hazard_ms.spec.foreign.arrays import check_archive
from hazard_ms.spec.foreign.files import printable, read_foreign

ENDING = ".safetensors"
LARGEST_STATE = 256_000_000  # of all that a training needs to go on [bytes]; the original's network: 12 million [ours]
LARGEST, LARGEST_TOLD = 64_000_000, 4_000_000  # of both files [bytes]; the original's network has 3 million [ours]
MOST_HAZARDS = 16  # of a task [ours]
LIMITS = plain.Limits(most_entries=1000)  # of a shape [ours]


def contents(policy: SetPolicy | MapPolicy, task: str, facts: Mapping[str, Any]) -> tuple[bytes, str]:
    """The contents of both files of a `policy` for `task`; `facts`, plain data, say how it came about."""
    measures = isinstance(policy, SetPolicy) and policy.shape.measures
    row = {"task": task, **_version(policy, measures), "shape": asdict(policy.shape), **facts}
    return save(dict(stored(policy))), json.dumps(row, indent=1, allow_nan=False) + "\n"


def stored(policy: SetPolicy | MapPolicy) -> dict[str, torch.Tensor]:
    """The numbers of a `policy` as its file holds them, by name, [...] each."""
    numbers = dict(policy.state_dict())
    return {name: part.half() for name, part in numbers.items()} if isinstance(policy, MapPolicy) else numbers


def load(path: Path, task: str, made_by: str = "train bc", measures: bool = False) -> SetPolicy:
    """The policy over options in a file NAME.safetensors, with its NAME.json, ready to be asked at decisions of `task`.

    `made_by`: the command that makes such files; `measures`: whether options of the task have measures about a fire.

    Raises ValueError for files that are missing or damaged, and for policies of another task, or of another version of
    the features.
    """
    found = _read(path, task, made_by, SetPolicy, measures)
    assert isinstance(found, SetPolicy)
    return found


def load_map(path: Path, task: str, made_by: str = "train ppo --actions paper") -> MapPolicy:
    """The policy over the six actions in a file, as `load` does it; it raises the same."""
    found = _read(path, task, made_by, MapPolicy, False)
    assert isinstance(found, MapPolicy)
    return found


def sees_map(path: Path) -> bool:
    """Whether the policy in a file is one over the six actions; False if there is none."""
    try:
        return "map_version" in told(path)
    except ValueError:
        return False


def told(path: Path) -> dict[str, Any]:
    """The content of NAME.json beside NAME.safetensors. Raises ValueError where there is none, or a damaged one."""
    return plain.read(path.with_suffix(".json"), LARGEST_TOLD)


def packed_state(path: Path) -> bytes:
    """The content of the file in which a training keeps all that it needs to go on. Raises ValueError without one."""
    return read_foreign(path, LARGEST_STATE)


def unpacked_state(packed: bytes) -> dict[str, Any]:
    """The plain numbers and tensors in the content of such a file; nothing in it can run code.

    Raises ValueError for what is no archive or unpacks to more than LARGEST_STATE, and errors of many kinds for other
    content.
    """
    check_archive(packed, "the state of a training", LARGEST_STATE)
    return dict(torch.load(io.BytesIO(packed), map_location="cpu", weights_only=True))


def _version(policy: SetPolicy | MapPolicy | type, measures: bool) -> dict[str, int]:
    kind = policy if isinstance(policy, type) else type(policy)
    return {"map_version": MAP_VERSION} if kind is MapPolicy else {"features_version": features_version(measures)}


def features_version(measures: bool) -> int:
    """The version of the features of tasks with `measures`, or of those without."""
    return MEASURED_VERSION if measures else FEATURES_VERSION


def _read(
    path: Path, task: str, made_by: str, kind: type[SetPolicy] | type[MapPolicy], measures: bool
) -> SetPolicy | MapPolicy:
    try:
        facts = told(path)
        for name, wanted in {**_version(kind, measures), "task": task}.items():
            if facts.get(name) != wanted:
                raise ValueError(f"{name} must be {wanted}, got {facts.get(name)!s:.100}")
        shape = plain.made(MapShape if kind is MapPolicy else Shape, facts.get("shape"), "shape", LIMITS)
        if isinstance(shape, Shape) and shape.measures != measures:
            raise ValueError(f"shape.measures must be {measures}, got {shape.measures}")
        if len(shape.ranges) > MOST_HAZARDS or any(not low < high for low, high in shape.ranges):
            raise ValueError(
                f"shape.ranges must be (low, high) pairs of at most {MOST_HAZARDS} hazards, got {shape.ranges!r:.100}"
            )
        numbers = _numbers(read_foreign(path, LARGEST))
        with torch.device("meta"):  # which allocates nothing
            _check(numbers, kind(shape).state_dict())
        policy = kind(shape)
        policy.load_state_dict(numbers)
    except (ValueError, RuntimeError, IndexError, SafetensorError) as error:
        raise ValueError(
            f"{path} must hold a policy for {task}: {printable(str(error)):.500}; "
            f"`hazard-ms {made_by} -e {task} -o FOLDER` makes one"
        ) from None
    return policy.eval()


def _numbers(content: bytes) -> dict[str, Tensor]:
    """The numbers in a file of safetensors, [...] each. Raises ValueError or SafetensorError for other content."""
    found = unpacked(content)
    for name, part in found.items():
        if not part.is_floating_point() or not bool(torch.isfinite(part.float()).all()):
            raise ValueError(f"{name} must hold only finite floating-point numbers, got NaN, infinity or whole numbers")
    return found


def _check(numbers: Mapping[str, Tensor], wanted: Mapping[str, Tensor]) -> None:
    """Raises ValueError unless `numbers`, [...] each, have the names and the shapes of those that are `wanted`."""
    if numbers.keys() != wanted.keys():
        other = sorted(numbers.keys() ^ wanted.keys())
        raise ValueError(f"its tensors must be those of its shape, got a difference in {', '.join(other):.200}")
    for name, part in wanted.items():
        if numbers[name].shape != part.shape:
            raise ValueError(f"{name} must be {list(part.shape)}, got {list(numbers[name].shape)}")
