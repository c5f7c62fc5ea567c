"""Ways in which files of runs are damaged, or made to mean harm: JSON, arrays, tensors, databases, and any bytes."""

from __future__ import annotations

import hashlib
import io
import json
import os
import random
import sqlite3
import struct
import tempfile
import zipfile
from collections.abc import Callable
from contextlib import closing
from pathlib import Path
from typing import Any

import numpy as np

from tests.worlds.hostile.junk import NUMBERS, damaged, places, spoilt, text

Mutation = Callable[[bytes, random.Random], bytes]
SHAPES = ((), (0,), (3,), (7,), (2, 2), (1, 1, 1, 1), (2**20,), (2**40,), (2**31, 2**31), (-1,), (2**63,), (1,) * 40)
TYPES = ("<f4", "<f8", "<i8", "|b1", "<c16", "<U7", "|S3", "|O", "<M8[s]", "|V9", "<f2", ">i2", "<U0")
MANY = 2_000_000  # bytes of what is repeated


def json_text(data: bytes, draw: random.Random) -> bytes:
    """JSON, of one object or of one on each line, with values of other types and sizes, keys twice, or deep nesting."""
    lines = data.splitlines() if data.count(b"\n") and not data.startswith(b"{\n") else [data]
    at = draw.randrange(len(lines))
    lines[at] = _spoilt_line(lines[at], draw)
    if draw.random() < 0.1:
        lines.insert(draw.randrange(len(lines) + 1), draw.choice(lines))
    return b"\n".join(lines) + b"\n"


def _spoilt_line(line: bytes, draw: random.Random) -> bytes:
    way = draw.randrange(8)
    if way == 0:
        tree = json.loads(line)
        key = draw.choice(list(tree)) if isinstance(tree, dict) and tree else "a"
        return line.replace(b"{", b'{"%s": %s, ' % (key.encode(), text(draw.choice(NUMBERS))), 1)
    if way == 1:
        holder, key = draw.choice(places(tree := json.loads(line)))
        holder[key] = "HOLE"
        deep = draw.choice((30, 100, 100_000))
        inside = draw.choice(
            (b"[" * deep + b"]" * deep, b'{"a":' * deep + b"1" + b"}" * deep, b"[" * deep, b"1" * deep)
        )
        return text(tree).replace(b'"HOLE"', inside)
    if way == 2:
        holder, key = draw.choice(places(tree := json.loads(line)))
        holder[key] = "HOLE"
        many = draw.choice((b"[],", b"{},", b'"a",', b"1,"))
        return text(tree).replace(b'"HOLE"', b"[" + many * (MANY // len(many)) + b"1]")
    return text(spoilt(json.loads(line), draw, draw.choice((1, 1, 2, 5))))


def arrays(data: bytes, draw: random.Random) -> bytes:
    """A .npz of which arrays are missing, of other types, shapes and numbers, or say that they are larger."""
    with np.load(io.BytesIO(data), allow_pickle=False) as read:
        found = dict(read)
    for _ in range(draw.choice((1, 1, 3))):
        name, way = draw.choice(list(found)), draw.randrange(6)
        array = found[name]
        if way == 0 and len(found) > 1:
            del found[name]
        elif way == 1:
            found[draw.choice(("x", "../../x", "a\x1b[2J", "file", "format", "__init__", "a/b"))] = array
        elif way == 2:
            found[name] = np.zeros(draw.choice(SHAPES[:6]), draw.choice(TYPES[:7]))
        elif way == 3 and array.dtype.kind == "f":
            found[name] = np.full_like(array, draw.choice((np.nan, np.inf, -1e30, 0.0)))
        elif way == 4 and array.dtype.kind in "iu":
            found[name] = np.full(array.shape, draw.choice((-1, 30_000, 99))).astype(array.dtype)
        elif array.ndim:
            found[name] = draw.choice((array[:-1], array[..., None], np.concatenate([array, array]), array.T))
    packed = io.BytesIO()
    np.savez_compressed(packed, **{name: found[name] for name in found if name != "file"})
    return _with_lie(packed.getvalue(), draw) if draw.random() < 0.3 else packed.getvalue()


def _with_lie(data: bytes, draw: random.Random) -> bytes:
    """The archive with one member replaced by one of zeros whose header announces something else."""
    packed = io.BytesIO()
    with zipfile.ZipFile(io.BytesIO(data)) as read, zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED) as made:
        names = read.namelist()
        victim = draw.choice(names)
        for name in names:
            content = read.read(name)
            if name == victim:
                header = {"descr": draw.choice(TYPES), "fortran_order": False, "shape": draw.choice(SHAPES)}
                start = io.BytesIO()
                np.lib.format.write_array_header_1_0(start, header)
                content = start.getvalue() + bytes(draw.choice((0, 12, 1000, 64_000_000)))
            made.writestr(name, content)
    return packed.getvalue()


def tensors(data: bytes, draw: random.Random) -> bytes:
    """A file of safetensors with another header, or other numbers."""
    size = int.from_bytes(data[:8], "little")
    header, body = json.loads(data[8 : 8 + size]), data[8 + size :]
    way = draw.randrange(4)
    if way == 0:
        return struct.pack("<Q", draw.choice((0, 2**31, 2**62, size - 1, 2**64 - 1))) + data[8:]
    if way == 1:
        value = draw.choice((float("nan"), float("inf"), -3e38))
        at = 4 * draw.randrange(len(body) // 4)
        return data[: 8 + size] + body[:at] + struct.pack("<f", value) + body[at + 4 :]
    made = _spoilt_line(text(header), draw) if way == 2 else text(spoilt(header, draw, 2))
    return struct.pack("<Q", len(made)) + made + body


def database(data: bytes, draw: random.Random) -> bytes:
    """A file of recorded answers with other rows or other tables."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "a.sqlite"
        path.write_bytes(data)
        body = json_text(b'{"choices": [{"message": {"content": "A"}}]}', draw)
        values = (body.decode("utf-8", "replace"), body, None, 7, "", "[]", float("inf"), -1.0, "x" * MANY)
        with closing(sqlite3.connect(path)) as opened, opened:
            if draw.random() < 0.3:
                opened.execute(draw.choice(STATEMENTS))
            column = draw.choice(("body", "seconds"))
            opened.execute(f"UPDATE OR IGNORE answers SET {column} = ?", (draw.choice(values),))
        return path.read_bytes()


STATEMENTS = (
    "CREATE TABLE other (a)",
    "CREATE VIEW more AS SELECT * FROM answers",
    "CREATE TRIGGER t AFTER INSERT ON answers BEGIN DELETE FROM answers; END",
    "CREATE INDEX i ON answers (length(body))",
    "ALTER TABLE answers ADD COLUMN more TEXT",
    "PRAGMA user_version = 77",
)


def anything(data: bytes, draw: random.Random) -> bytes:
    """The bytes, cut off, changed, doubled, or none or only zeros."""
    return draw.choice((b"", bytes(len(data)), b"null", b"[]")) if draw.random() < 0.2 else damaged(data, draw)


def replaced(path: Path, secret: Path, draw: random.Random) -> None:
    """Put something in place of a file that is no file: a link to a `secret`, a pipe, a folder, a huge file, none."""
    path.unlink()
    way = draw.randrange(6)
    if way == 0:
        path.symlink_to(secret)
    elif way == 1:
        os.mkfifo(path)
    elif way == 2:
        path.mkdir()
    elif way == 3:
        path.touch()
        os.truncate(path, 50_000_000_000)  # of which the disk holds nothing
    elif way == 4:
        path.symlink_to(draw.choice(("/dev/zero", path.name, "/proc/self/mem")))


def columns(data: bytes, draw: random.Random) -> bytes:
    """The file of a timeline or a scene of the sketch with other arrays, and their digest."""
    made = arrays(data[32:], draw)
    return hashlib.sha256(made).digest() + made


KINDS: dict[str, Mutation] = {
    ".json": json_text,
    ".jsonl": json_text,
    ".journal": json_text,
    ".npz": arrays,
    ".timeline": columns,
    ".scene": columns,
    ".safetensors": tensors,
    ".sqlite": database,
}


def mutated(name: str, data: bytes, draw: random.Random) -> bytes:
    """The content of a file called `name`, made hostile in the way of its kind, or in any way."""
    ways: Any = KINDS.get(Path(name).suffix, anything)
    return anything(data, draw) if draw.random() < 0.25 else ways(data, draw)
