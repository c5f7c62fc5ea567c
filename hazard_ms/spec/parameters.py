"""Parameters that follow a name in text, "name:key=value,key=value", converted as a function annotates them."""

from __future__ import annotations

import inspect
import typing
from collections.abc import Iterable
from typing import Any

FLAGS = {"true": True, "false": False}


def parameters(made: Any, given: Iterable[str]) -> dict[str, Any]:
    """The keywords `key=value` in `given` for the class `made`, converted as its `__init__` annotates them.

    Raises ValueError for parameters that it does not have, and for values of another type.
    """
    start: Any = made.__init__
    known = [] if start is object.__init__ else [*inspect.signature(start).parameters][1:]
    kinds = typing.get_type_hints(start) if known else {}
    keywords = {}
    for part in filter(None, given):
        key, equals, value = part.partition("=")
        if not equals or key not in known:
            allowed = ", ".join(f"{name}=..." for name in known) or "(none)"
            raise ValueError(f"a parameter of {made.__name__} must be one of {allowed}, got {part!r}")
        keywords[key] = _converted(value, kinds.get(key, str), key)
    return keywords


def _converted(value: str, kind: Any, key: str) -> Any:
    """`value` as `kind`: int, float, bool, str, or one of several such types."""
    for each in typing.get_args(kind) or (kind,):
        if each is bool and value.lower() in FLAGS:
            return FLAGS[value.lower()]
        if each is type(None) and value.lower() == "none":
            return None
        if each in (int, float, str):
            try:
                return each(value)
            except ValueError:
                continue
    raise ValueError(f"{key} must be {getattr(kind, '__name__', kind)}, got {value!r}")
