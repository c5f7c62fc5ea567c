"""Quantities that are declared once: allocation, partial reset, save, restore and documentation follow from that."""

from __future__ import annotations

import dataclasses
import math
from typing import Any

import torch
from torch import Tensor

DTYPES = {"float": torch.float32, "int": torch.int64, "bool": torch.bool}


def quantity(
    shape: str,
    unit: str,
    meaning: str,
    dtype: str = "float",
    fill: float = 0,
    low: float = -math.inf,
    high: float | str = math.inf,
) -> Any:
    """A field of a state.

    `shape` names its axes: E environments, B bodies, a number, or a name that the hazard's `sizes` has. Raises
    ValueError for other shapes and types of numbers.

    Saved states are restored only with numbers from `low` to `high`. A name as `high` is for indices: of things ("B"),
    or into another quantity of the state.
    """
    if not shape.split() or shape.split()[0] != "E":
        raise ValueError(f"shape of the quantity {meaning!r} must begin with the axis E, got {shape!r}")
    if dtype not in DTYPES:
        raise ValueError(f"dtype of the quantity {meaning!r} must be one of {', '.join(DTYPES)}, got {dtype!r}")
    return dataclasses.field(
        metadata={
            "shape": shape.split(),
            "unit": unit,
            "meaning": meaning,
            "dtype": dtype,
            "fill": fill,
            "low": low,
            "high": high,
        }
    )


class State:
    """Base of hazard states: dataclasses whose fields are all `quantity(...)`."""

    @classmethod
    def allocate(cls, sizes: dict[str, int], device: torch.device | str) -> Any:
        """All quantities at their fill value; `sizes` gives each axis letter its length."""
        made = {}
        for f in dataclasses.fields(cls):  # type: ignore[arg-type]
            shape = [int(axis) if axis.isdigit() else sizes[axis] for axis in f.metadata["shape"]]
            made[f.name] = torch.full(shape, f.metadata["fill"], dtype=DTYPES[f.metadata["dtype"]], device=device)
        return cls(**made)

    def clear(self, rows: Tensor) -> None:
        """Put the environments `rows`, indices [R], back to the fill values."""
        for f in dataclasses.fields(self):  # type: ignore[arg-type]
            getattr(self, f.name)[rows] = f.metadata["fill"]

    def save(self) -> dict[str, Tensor]:
        """Copies of all fields by name, [E, ...], in the units of the fields."""
        return {f.name: getattr(self, f.name).clone() for f in dataclasses.fields(self)}  # type: ignore[arg-type]

    def restore(self, saved: dict[str, Tensor], rows: Tensor | slice = slice(None)) -> None:
        """Write `saved`, as `save` gave it, [R, ...], into the environments `rows`, indices [R].

        Raises ValueError for other fields than those of this state.
        """
        names = {f.name for f in dataclasses.fields(self)}  # type: ignore[arg-type]
        if set(saved) != names:
            raise ValueError(
                f"saved state of {type(self).__name__} must have the fields {sorted(names)}, got {sorted(saved)}"
            )
        for name in names:
            getattr(self, name)[rows] = saved[name].to(getattr(self, name))
