"""Files of trained policies: NAME.safetensors holds the numbers, NAME.json beside it what they are.

Nothing in such files can run code.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Any

from safetensors import SafetensorError
from safetensors.torch import load as unpacked
from safetensors.torch import save

from hazard_ms.agents.learned.set_policy import SetPolicy, Shape
from hazard_ms.skills.options.feature_columns import FEATURES_VERSION

ENDING = ".safetensors"


def contents(policy: SetPolicy, task: str, facts: Mapping[str, Any]) -> tuple[bytes, str]:
    """The contents of both files of a `policy` for `task`; `facts`, plain data, say how it came about."""
    told = {"task": task, "features_version": FEATURES_VERSION, "shape": asdict(policy.shape), **facts}
    return save(dict(policy.state_dict())), json.dumps(told, indent=1, allow_nan=False) + "\n"


def load(path: Path, task: str, made_by: str = "train bc") -> SetPolicy:
    """The policy in a file NAME.safetensors, with its NAME.json, ready to be asked at decisions of `task`.

    `made_by`: the command that makes such files.

    Raises ValueError for files that are missing or damaged, and for policies of another task, or of another version of
    the features.
    """
    beside = path.with_suffix(".json")
    try:
        told = json.loads(beside.read_text(encoding="utf-8"))
        for name, wanted in (("features_version", FEATURES_VERSION), ("task", task)):
            if told[name] != wanted:
                raise ValueError(f"{name} must be {wanted}, got {told[name]}")
        plain = told["shape"]
        ranges = tuple((float(low), float(high)) for low, high in plain.pop("ranges"))
        policy = SetPolicy(Shape(ranges, **{**plain, "ignored": tuple(plain["ignored"])}))
        policy.load_state_dict(unpacked(path.read_bytes()))
    except (OSError, ValueError, KeyError, TypeError, RuntimeError, SafetensorError) as error:
        raise ValueError(
            f"{path} must hold a policy for {task}: {error}; `hazard-ms {made_by} -e {task} -o FOLDER` makes one"
        ) from None
    policy.eval()
    return policy
