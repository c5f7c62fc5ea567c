"""Arrays and archives of others: announced sizes are compared with a limit before anything is unpacked."""

from __future__ import annotations

import io
import math
import zipfile
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np
from numpy.typing import NDArray

from hazard_ms.spec.foreign.files import printable, read_foreign

LARGEST_FILE = 256_000_000  # [bytes]; all frames of a long episode have 20 million [ours]
MOST_UNPACKED = 400_000_000  # of one file, all arrays together [bytes] [ours]
MOST_DIRECTORY = 1_000_000  # of the list of an archive's members [bytes]; one takes 50 to 200 [ours]
READ_AT_ONCE = 1 << 20  # [bytes]
KINDS = "biufcSU"  # of numpy's types: numbers, truth values and text; no objects
END, END_SIZE = b"PK\x05\x06", 22  # the record at the end of a zip archive that has no comment (APPNOTE.TXT 4.3.16)
LARGE_END, LARGE_END_SIZE = b"PK\x06\x07", 20  # before it where sizes have 64 bits, as torch's (APPNOTE.TXT 4.3.15)
LARGE_RECORD, LARGE_RECORD_SIZE = b"PK\x06\x06", 56  # before that: the record itself (APPNOTE.TXT 4.3.14)


def read_arrays(path: Path, most: int = MOST_UNPACKED) -> dict[str, NDArray[Any]]:
    """All arrays of a .npz file by name, [...] each, in any unit.

    Raises ValueError for a file that is none, for arrays of objects, and for arrays of more than `most` bytes together.
    """
    return from_bytes(read_foreign(path, LARGEST_FILE), str(path), most)


def from_bytes(content: bytes, what: str, most: int = MOST_UNPACKED) -> dict[str, NDArray[Any]]:
    """All arrays, [...] each, in any unit, of the content of a .npz file, as `read_arrays` gives them.

    Raises ValueError, which calls the file `what`, for the same.
    """
    check_archive(content, what, most)
    found = {}
    try:
        with zipfile.ZipFile(io.BytesIO(content)) as archive:
            for member in archive.infolist():
                with archive.open(member) as file:
                    found[member.filename.removesuffix(".npy")] = _array(file, member.file_size)
    except Exception as error:  # numpy, zipfile and zlib raise many kinds
        raise ValueError(f"{printable(what)} must hold arrays, got {_words(error)}") from None
    return found


def check_archive(content: bytes, what: str, most: int = MOST_UNPACKED) -> None:
    """Check that `content`, called `what` in errors, is a zip archive that unpacks to at most `most` bytes.

    Raises ValueError for anything else, and for an archive whose list of members is absurdly long.
    """
    shown = printable(what)
    end = content[-END_SIZE:]
    plain = end.startswith(END) and end.endswith(b"\0\0")  # else zipfile looks for another end further up
    directory = _directory_size(content) if plain and len(end) == END_SIZE else None
    if directory is None:
        raise ValueError(f"{shown} must be a zip archive of numpy or torch, got something else or an incomplete one")
    if directory > MOST_DIRECTORY:
        raise ValueError(f"{shown} must list its members in at most {MOST_DIRECTORY} bytes, got {directory}")
    try:
        with zipfile.ZipFile(io.BytesIO(content)) as archive:
            unpacked = sum(member.file_size for member in archive.infolist())
    except Exception as error:  # of several kinds
        raise ValueError(f"{shown} must be a zip archive, got {_words(error)}") from None
    if unpacked > most:
        raise ValueError(f"{shown} must unpack to at most {most} bytes, got {unpacked}")


def _directory_size(content: bytes) -> int | None:
    """The bytes of the list of members that the end of an archive announces; None where its parts do not follow."""
    locator = content[-END_SIZE - LARGE_END_SIZE : -END_SIZE]
    if not locator.startswith(LARGE_END):
        return int.from_bytes(content[-END_SIZE:][12:16], "little")
    start = len(content) - END_SIZE - LARGE_END_SIZE - LARGE_RECORD_SIZE
    record = content[max(start, 0) :][:LARGE_RECORD_SIZE]
    if not record.startswith(LARGE_RECORD) or int.from_bytes(locator[8:16], "little") != start:
        return None
    return int.from_bytes(record[40:48], "little")


def _array(file: Any, size: int) -> NDArray[Any]:
    """The array, [...], in any unit, of a member of `size` bytes. Raises ValueError for one that says it is larger."""
    version = np.lib.format.read_magic(file)
    header = np.lib.format.read_array_header_1_0 if version == (1, 0) else np.lib.format.read_array_header_2_0
    shape, by_column, dtype = header(file)
    needed = math.prod(shape) * dtype.itemsize
    if dtype.kind not in KINDS or any(length < 0 for length in shape) or needed > size:
        raise ValueError(f"an array of {dtype} with shape {shape} in {size} bytes")
    raw = bytearray(needed)
    _fill(raw, file)
    flat = np.frombuffer(raw, dtype) if needed else np.empty(0, dtype)
    return flat.reshape(shape, order="F" if by_column else "C")


def _fill(raw: bytearray, file: BinaryIO) -> None:
    """Read all of `raw` from a file, which must end with it. Raises ValueError if it does not."""
    done = 0
    while part := file.read(READ_AT_ONCE):
        raw[done : done + len(part)] = part[: len(raw) - done]
        done += len(part)
        if done > len(raw):
            break
    if done != len(raw):
        raise ValueError(f"an array whose header says {len(raw)} bytes, with {'more' if done > len(raw) else done}")


def _words(error: Exception) -> str:
    return printable(f"{type(error).__name__}: {error}")[:200]
