"""Arrays of others: what they announce is compared with a limit before anything is unpacked."""

from __future__ import annotations

import io
import struct
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from hazard_ms.spec.foreign import arrays


def packed(**named: Any) -> bytes:
    made = io.BytesIO()
    np.savez_compressed(made, **named)
    return made.getvalue()


def member(header: str, data: bytes = b"") -> bytes:
    """A .npz file with one array whose header is given as text."""
    raw = header.encode() + b"\n"
    made = io.BytesIO()
    with zipfile.ZipFile(made, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("a.npy", b"\x93NUMPY\x01\x00" + struct.pack("<H", len(raw)) + raw + data)
    return made.getvalue()


def test_arrays_are_read_as_numpy_writes_them(tmp_path: Path) -> None:
    wanted = {
        "f": np.arange(6, dtype=np.float32).reshape(2, 3),
        "fortran": np.asfortranarray(np.arange(6.0).reshape(2, 3)),
        "empty": np.zeros((0, 4), np.int16),
        "text": np.array(["a", "häuser"]),
        "flag": np.array(True),
        "big_endian": np.arange(3, dtype=">i4"),
    }
    (tmp_path / "a.npz").write_bytes(packed(**wanted))
    found = arrays.read_arrays(tmp_path / "a.npz")
    assert list(found) == list(wanted)
    for name, array in wanted.items():
        np.testing.assert_array_equal(found[name], array)
        assert found[name].dtype == array.dtype
        assert found[name].flags.writeable


def objects() -> bytes:
    made = io.BytesIO()
    np.savez(made, a=np.array([{}], dtype=object))
    return made.getvalue()


def many_members() -> bytes:
    made = io.BytesIO()
    with zipfile.ZipFile(made, "w") as archive:
        for n in range(20_000):
            archive.writestr(f"{n:05d}.npy", b"")
    return made.getvalue()


def large_sizes() -> bytes:
    """An archive whose sizes have 64 bits, as its end says."""
    content = packed(a=np.zeros(3))
    return content[:-22] + b"PK\x06\x07" + bytes(16) + content[-22:]


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (packed(a=np.zeros(2_000_000, np.uint8)), "at most 1000000 bytes, got 2000128"),
        (packed(a=np.zeros(600_000, np.uint8), b=np.zeros(600_000, np.uint8)), "unpack to at most 1000000 bytes"),
        (member("{'descr': '<f8', 'fortran_order': False, 'shape': (10**9,)}".replace("10**9", "1000000000")), "hold"),
        (member("{'descr': '<f8', 'fortran_order': False, 'shape': (-1,)}"), "must hold arrays"),
        (member("{'descr': '<f8', 'fortran_order': False, 'shape': (2,)}", bytes(15)), "must hold arrays"),
        (member("{'descr': '<f8', 'fortran_order': False, 'shape': (2,)}", bytes(17)), "must hold arrays"),
        (member("(" * 5000), "must hold arrays"),
        (objects(), "must hold arrays"),
        (many_members, "list its members in at most 1000000 bytes"),
        (large_sizes(), "must be a zip archive"),
        (b"", "must be a zip archive"),
        (b"PK\x05\x06" + bytes(17) + b"\x07", "must be a zip archive"),
        (packed(a=np.zeros(9))[:-1], "must be a zip archive"),
    ],
)
def test_what_is_not_an_honest_file_is_refused(content: bytes | Callable[[], bytes], words: str) -> None:
    made = content if isinstance(content, bytes) else content()
    with pytest.raises(ValueError, match=f"the file must .*{words}|{words}") as refusal:
        arrays.from_bytes(made, "the file", most=1_000_000)
    assert str(refusal.value).startswith("the file must")


def test_a_flipped_bit_is_noticed() -> None:
    content = bytearray(packed(a=np.random.default_rng(0).random(100)))
    content[200] ^= 1
    with pytest.raises(ValueError, match="must hold arrays"):
        arrays.from_bytes(bytes(content), "the file")
