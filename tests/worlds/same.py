"""Whether two records of arrays and plain values are the same, to the bit and the type."""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np


def same_fields(one: Any, other: Any) -> None:
    """Assert that two objects of one dataclass have equal fields."""
    for field in dataclasses.fields(one):
        a, b = getattr(one, field.name), getattr(other, field.name)
        assert type(a) is type(b), field.name
        if isinstance(a, np.ndarray):
            assert a.dtype == b.dtype and np.array_equal(a, b), field.name
        else:
            assert a == b, field.name
