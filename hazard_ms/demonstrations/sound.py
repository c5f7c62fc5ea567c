"""Checks of the content of an episode's files: types, shapes that fit each other, and indices that point somewhere."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hazard_ms.demonstrations.layout import DECISIONS, EPISODE, FRAMES, DamagedDatasetError
from hazard_ms.skills.options.options import COUNT

Arrays = Mapping[str, NDArray[Any]]

# types of the entries of episode.json; docs/demonstrations.md says what they mean
META: dict[str, tuple[type, ...]] = {
    **dict.fromkeys(("teacher", "instruction", "robot", "control_mode", "reward_mode", "obs", "reason"), (str,)),
    **dict.fromkeys(("subtasks", "joints", "hazards", "things", "targets", "verbs"), (list, str)),
    **dict.fromkeys(("recipe", "seeds"), (dict,)),
    **dict.fromkeys(("fps", "reach"), (float,)),
    **dict.fromkeys(("every", "format"), (int,)),
    "prompts": (list, dict),
    "privileged": (bool,),
    "hashes": (dict, str),
    "checksum": (str,),
}
# kinds of numpy's types, and shapes by letters, of the arrays that the package itself reads
FRAME_ARRAYS = {
    "action": ("f", "TA"),
    "qpos": ("f", "UQ"),
    "qvel": ("f", "UQ"),
    "base": ("f", "U3"),
    "hand": ("f", "U3"),
    "held": ("i", "U"),
    "hazard": ("f", "UH"),
    "subtask": ("i", "T"),
    "decision": ("i", "T"),
    "reward": ("f", "T"),
    "terminated": ("b", "T"),
    "truncated": ("b", "T"),
    "success": ("b", "T"),
    "obs": ("f", "UD"),
    "state_frame": ("i", "K"),
    "state": ("f", "KS"),
}
DECISION_ARRAYS = {
    "frame": ("i", "N"),
    "option": ("i", "N"),
    "option_start": ("b", "N"),
    "mask": ("b", "NO"),
    "features": ("f", "NF"),
}
TRUTH_ARRAYS = {"option_value": ("f", "NO")}


class Named(dict[str, Any]):
    """Entries of a file by name; asking for one that it lacks raises a DamagedDatasetError that names the file."""

    def __init__(self, file: str, entries: Mapping[str, Any]) -> None:
        """Take the `entries` of a `file`."""
        super().__init__(entries)
        self._file = file

    def __missing__(self, name: str) -> Any:
        raise DamagedDatasetError(f"{self._file} must hold {name}, got none; see `hazard-ms demos repair`")


def check_meta(meta: Mapping[str, Any]) -> None:
    """Check the types of what is there of episode.json, apart from its result. Raises ValueError."""
    for name, kinds in META.items():
        if name in meta and not _is(meta[name], *kinds):
            raise ValueError(f"{name} must be {' of '.join(kind.__name__ for kind in kinds)}, got {meta[name]!r:.100}")
    for number, prompt in enumerate(meta.get("prompts", ())):
        options = prompt.get("options")
        if not (_is(prompt.get("text"), str) and _is(options, dict, int) and len(options) <= COUNT):
            raise ValueError(f"prompts[{number}] must have a text and a dict of options by letter, got {prompt!r:.100}")
        if not all(0 <= option < COUNT for option in options.values()):
            raise ValueError(f"options of prompts[{number}] must be from 0 to {COUNT - 1}, got {options!r:.100}")
    if meta.get("fps", 1.0) <= 0 or meta.get("every", 0) < 0:
        raise ValueError(f"fps must be positive and every at least 0, got {meta.get('fps')} and {meta.get('every')}")


def _is(value: Any, kind: type, inner: type | None = None) -> bool:
    """Whether a value is of a type, where whole numbers count as floats; and whether all entries are of `inner`."""
    if type(value) is not kind and not (kind is float and type(value) is int):
        return False
    if inner is None:
        return True
    entries: Any = value.values() if isinstance(value, dict) else value
    return all(type(entry) is inner for entry in entries)


def check_arrays(meta: Mapping[str, Any], decisions: Arrays, frames: Arrays) -> None:
    """Check what is there of both files of arrays, [N, ...] and [T, ...], against each other. Raises ValueError."""
    sizes: dict[str, int] = {"3": 3}
    check_shapes(frames, FRAME_ARRAYS, FRAMES, sizes)
    check_shapes(decisions, DECISION_ARRAYS, DECISIONS, sizes)
    if "U" in sizes and sizes.setdefault("T", sizes["U"] - 1) != sizes["U"] - 1:
        raise ValueError(f"{FRAMES} must hold one state more than actions, got {sizes['U']} and {sizes['T']}")
    if "prompts" in meta and sizes.setdefault("N", len(meta["prompts"])) != len(meta["prompts"]):
        raise ValueError(f"{EPISODE} must hold {sizes['N']} prompts, got {len(meta['prompts'])}")
    _within(frames, "subtask", 0, len(meta["subtasks"]) if "subtasks" in meta else 0)
    _within(frames, "state_frame", 0, sizes.get("T", 0) + 1)
    _within(decisions, "option", -1, sizes.get("O", 0))


def check_shapes(arrays: Arrays, wanted: Mapping[str, tuple[str, str]], file: str, sizes: dict[str, int]) -> None:
    """Check kinds and shapes of the arrays, [...] each, of a `file`; `sizes` of letters are compared, and entered.

    Raises ValueError.
    """
    for name, (kind, letters) in wanted.items():
        if name not in arrays:
            continue
        array = arrays[name]
        empty = array.size == 0 and array.ndim == 1  # what no frame was put into
        if array.dtype.kind != kind or array.dtype.itemsize > 8 or not (empty or array.ndim == len(letters)):
            raise ValueError(f"{file} must hold {name} as {kind} [{letters}], got {array.dtype} {array.shape}")
        for letter, size in zip(letters, array.shape, strict=False):
            if sizes.setdefault(letter, size) != size:
                raise ValueError(f"{file} must hold {name} with {sizes[letter]} entries, got {size}")


def _within(arrays: Arrays, name: str, low: int, end: int) -> None:
    found = arrays.get(name, np.empty(0))
    if found.size and not (low <= found.min() and found.max() < end):
        raise ValueError(f"{name} must be from {low} to {end - 1}, got from {found.min()} to {found.max()}")
