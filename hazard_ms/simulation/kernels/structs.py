"""Structs of kernels that are filled from torch tensors, and kept as long as these stay the same (Warp)."""

from __future__ import annotations

import operator
from collections.abc import Callable
from typing import Any

import warp as wp
from torch import Tensor

Argument = Any  # of a kernel: a tensor, a number or a struct


class Filled:
    """A struct and the values that it was filled with, which are kept alive."""

    def __init__(self, kind: wp.Struct) -> None:
        self._kind = kind
        self._read: Callable[[object], tuple[Argument, ...]] = operator.attrgetter(*kind.vars)
        self._values: tuple[Argument, ...] = ()
        self._struct: Any = None

    def by(self, source: object) -> Any:
        """The struct with the values of `source`; another struct if they are others than before."""
        values, before = self._read(source), self._values
        if self._struct is not None and all(map(operator.is_, before, values)):
            return self._struct
        others = [k for k, pair in enumerate(zip(before, values, strict=self._struct is not None)) if another(*pair)]
        if self._struct is None or not all(alike(before[k], values[k]) for k in others):
            self._struct = self._filled(values)
        elif others:
            self._struct = self._pointed(others, values)
        self._values = values
        return self._struct

    def _filled(self, values: tuple[Argument, ...]) -> Any:
        made = self._kind()
        for (name, field), value in zip(self._kind.vars.items(), values, strict=True):
            tensor = isinstance(value, Tensor)
            setattr(made, name, wp.from_torch(value, dtype=field.type.dtype) if tensor else value)
        return made

    def _pointed(self, others: list[int], values: tuple[Argument, ...]) -> Any:
        """The same struct as another object, with the memory of `values` in the fields `others`: a tenth of the time.

        The one of before has the same content from now on.
        """
        made = object.__new__(type(self._struct))
        made.__dict__.update(self._struct.__dict__)
        names = list(self._kind.vars)
        for k in others:
            getattr(made.__ctype__(), names[k]).data = values[k].data_ptr()
            made.__dict__[names[k]] = values[k]  # not the array of before, which would keep its memory
        return made


def another(before: Argument, now: Argument) -> bool:
    """Whether an argument is another tensor or struct, or a number of another value."""
    return before is not now and (not isinstance(now, float | int) or before != now)


def alike(before: Argument, now: Argument) -> bool:
    """Whether two arguments are tensors that differ in nothing but where their numbers are."""
    if not (isinstance(before, Tensor) and isinstance(now, Tensor)):
        return False
    same = before.dtype == now.dtype and before.device == now.device
    return same and before.shape == now.shape and before.stride() == now.stride()
