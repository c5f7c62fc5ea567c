"""Records of named arrays as the content of a file: the digest of the rest, then the arrays.

A file in which a single bit has changed is refused.
"""

from __future__ import annotations

import hashlib
import io
from collections.abc import Callable, Mapping
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from hazard_ms.spec.foreign import arrays as foreign
from hazard_ms.spec.foreign.files import printable

LARGEST = foreign.LARGEST_FILE  # of a file [bytes]
Made = TypeVar("Made")
DIGEST_BYTES = hashlib.sha256().digest_size  # at the start of a file


def to_bytes(version: int, columns: Mapping[str, Any]) -> bytes:
    """The content of a file of `columns`, [...] each, whose form has the number `version`."""
    arrays: dict[str, Any] = {name: np.asarray(column) for name, column in columns.items()}
    packed = io.BytesIO()
    np.savez_compressed(packed, format=np.asarray(version), **arrays)
    return hashlib.sha256(packed.getvalue()).digest() + packed.getvalue()


def from_bytes(what: str, version: int, content: bytes) -> dict[str, NDArray[Any]]:
    """The columns, [...] each, that `to_bytes` was given.

    Raises ValueError that names `what` it must be for any other content.
    """
    digest, packed = content[:DIGEST_BYTES], content[DIGEST_BYTES:]
    if hashlib.sha256(packed).digest() != digest:
        raise ValueError(f"{what} must match its checksum, got other content: it is damaged, or another kind of file")
    columns = foreign.from_bytes(packed, what)
    number = columns.pop("format", np.asarray(-1))
    found = int(number.item()) if number.size == 1 and number.dtype.kind in "iu" else -1
    if found != version:
        raise ValueError(f"format of {what} must be {version}, got {found}: make it again")
    return columns


def made_from(
    kind: Callable[..., Made], what: str, columns: Mapping[str, NDArray[Any]], plain: Mapping[str, Callable[[Any], Any]]
) -> Made:
    """The record of a `kind` from its columns, [...] each, of which those in `plain` become what is given there.

    Raises ValueError that names `what` for columns that it does not have, and for those that cannot become that.
    """
    try:
        return kind(**{name: plain[name](column) if name in plain else column for name, column in columns.items()})
    except (ArithmeticError, ValueError, LookupError, TypeError, AttributeError) as error:
        raise ValueError(f"{what} must have the columns of its kind, got {printable(str(error)):.200}") from None
