"""Checks saved states as a whole, before anything of them is written into an environment.

A state is right if it has the parts and shapes of the state that the environment has now, and numbers that a sound
simulation can have.
"""

from __future__ import annotations

import dataclasses
from typing import Any

import torch
from torch import Tensor

from hazard_ms.hazards.base import State
from hazard_ms.spec import checks
from hazard_ms.tasks.episode.episode import Episode
from hazard_ms.tasks.episode.grasp import Hand
from hazard_ms.tasks.episode.snapshot import WORD

FARTHEST = 1e6  # largest number of a body or a joint, in its SI unit; its square is far from float32's end [ours]
LARGEST = {"float": 1e9, "int": 1e13}  # finite numbers of a hazard go up to it, in their units [ours]
NEAR_UNIT = 0.01  # most by which the length of a quaternion may differ from 1 [ours]
KINEMATIC = slice(3, 7)  # the quaternion in ManiSkill's state of a body or a robot


def checked(state: Any, now: dict[str, Any], episode: Episode, rows: int) -> dict[str, Any]:
    """A copy of `state`, [R, N] tensors in dicts, with the types of `now`, a state of the same environment.

    States without a batch axis get one. Raises ValueError for a state of another environment or scene, and for numbers
    that no sound simulation has; `rows` is the number R of environments.
    """
    if isinstance(state, dict) and isinstance(state.get("controller"), dict) and "controller" not in now:
        state = {key: value for key, value in state.items() if key != "controller"}  # of another control mode
    if isinstance(state, dict) and "controller" not in state:
        now = {key: value for key, value in now.items() if key != "controller"}
    made: dict[str, Any] = alike(state, now, rows, "state")
    for kind in ("actors", "articulations"):
        for name, numbers in made.get(kind, {}).items():
            _within(numbers, -FARTHEST, FARTHEST, f"state.{kind}.{name}")
            _unit(numbers[:, KINEMATIC], f"state.{kind}.{name}")
    for path, numbers in leaves(made.get("controller", {}), "state.controller"):
        _within(numbers, -FARTHEST, FARTHEST, path)
    saved = made["hazard_ms"]
    for name, part in episode.parts.items():
        _check_part(part, saved[name], episode.world.num_bodies, f"state.hazard_ms.{name}")
    for name in (name for name, part in episode.parts.items() if isinstance(part, Hand)):
        _unit(saved[name]["turn"][saved[name]["held"][:, 0] >= 0], f"state.hazard_ms.{name}.turn")
    _within(saved["chance"]["seed"], 0, WORD - 1, "state.hazard_ms.chance.seed")
    _within(saved["chance"]["frame"], 0, 2**31 - 1, "state.hazard_ms.chance.frame")
    return made


def alike(given: Any, model: Any, rows: int, path: str) -> Any:
    """A copy of `given`, [R, ...] tensors in dicts, with the names, shapes and types of `model`, [E, ...].

    `path` names it in errors. Raises ValueError where names, shapes or types differ.
    """
    if not isinstance(model, dict):
        return _tensor(given, torch.as_tensor(model), rows, path)
    if not isinstance(given, dict):
        raise ValueError(f"{path} must be a dict as get_state_dict returns it, got {type(given).__name__}")
    for name in model:
        if name not in given:
            raise ValueError(
                f"{path} must have an entry {name!r}, got none: it comes from another environment or scene"
            )
    for name in given:
        if name not in model:
            raise ValueError(f"{path} must have no entry {name!r}, got one: it comes from another environment or scene")
    return {name: alike(given[name], entry, rows, f"{path}.{name}") for name, entry in model.items()}


def leaves(state: dict[str, Any], path: str) -> list[tuple[str, Tensor]]:
    """The path and the numbers, [R, N], of every entry of a nested `state`."""
    found: list[tuple[str, Tensor]] = []
    for name, entry in state.items():
        here = f"{path}.{name}"
        found += leaves(entry, here) if isinstance(entry, dict) else [(here, entry)]
    return found


def _tensor(given: Any, model: Tensor, rows: int, path: str) -> Tensor:
    """The numbers `given` in the type of `model`, [R, ...]."""
    numbers: Tensor = checks.numbers(given, path, flags=True)
    shape = (rows, *model.shape[1:])
    if tuple(numbers.shape) == shape[1:] and rows == 1:
        numbers = numbers[None]
    if tuple(numbers.shape) != shape:
        raise ValueError(f"{path} must have shape {shape}, got {tuple(numbers.shape)}: it comes from another scene")
    made = numbers.to(device=model.device, dtype=model.dtype)
    wide = numbers.to(made.device, torch.float64)
    if bool(wide.isnan().any()) or (not model.is_floating_point() and bool((made.double() != wide).any())):
        kind = "numbers" if model.is_floating_point() else "0 or 1" if model.dtype == torch.bool else "whole numbers"
        raise ValueError(f"{path} must hold {kind}, got {wide[made.double() != wide][0].item():g}")
    return made


def _check_part(part: State, saved: dict[str, Tensor], bodies: int, path: str) -> None:
    """Raise ValueError unless the numbers of a record are within the ranges that its quantities declare."""
    for field in dataclasses.fields(part):  # type: ignore[arg-type]
        declared, numbers = field.metadata, saved[field.name]
        low, high = declared["low"], declared["high"]
        if isinstance(high, str):  # it counts the things, or the numbers of another quantity
            high = (bodies if high == "B" else getattr(part, high)[0].numel()) - 1
        if declared["fill"] == torch.inf:
            numbers = numbers[numbers != torch.inf]
        if declared["dtype"] != "bool":
            most = LARGEST[declared["dtype"]]
            _within(numbers, max(low, -most), min(high, most), f"{path}.{field.name}")


def _within(numbers: Tensor, low: float, high: float, path: str) -> None:
    wrong = ~((numbers >= low) & (numbers <= high))
    if bool(wrong.any()):
        raise ValueError(f"{path} must hold numbers from {low:g} to {high:g}, got {numbers[wrong][0].item():g}")


def _unit(rotation: Tensor, path: str) -> None:
    length = rotation.norm(dim=-1)
    wrong = ~((length - 1.0).abs() <= NEAR_UNIT)
    if bool(wrong.any()):
        raise ValueError(f"{path} must hold a unit quaternion, got one of length {length[wrong][0].item():g}")
