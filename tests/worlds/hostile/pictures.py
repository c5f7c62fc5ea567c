"""Pictures that are none, are of formats that start programs, or unpack to far more than they are."""

from __future__ import annotations

import io
import random
import struct
import zlib
from pathlib import Path

from PIL import Image

EPS = b"%!PS-Adobe-3.0 EPSF-3.0\n%%BoundingBox: 0 0 9 9\n%%EndComments\n(x) print showpage\n%%EOF\n"
FOREIGN = {
    "EPS": EPS,
    "EPS of DOS": struct.pack("<4sIIIIIIH", b"\xc5\xd0\xd3\xc6", 32, len(EPS), 0, 0, 0, 0, 0xFFFF) + bytes(2) + EPS,
    "SVG": b'<svg xmlns="http://www.w3.org/2000/svg"><image href="file:///etc/passwd"/></svg>',
    "TIFF": b"II*\0\x08\0\0\0\xff\xff" + bytes(64),
    "GIF": b"GIF89a\xff\xff\xff\xff\0\0\0",
    "BMP": b"BM" + bytes(52),
    "PSD": b"8BPS\0\x01" + bytes(40),
    "PDF": b"%PDF-1.7\n",
    "WMF": b"\xd7\xcd\xc6\x9a" + bytes(40),
    "Python": b"import os; os.abort()",
    "nothing": b"",
}


def png(width: int, height: int, bits: int = 1, colour: int = 0, rows: bytes = b"") -> bytes:
    """A PNG file that claims a size [pixels], whatever its `rows` hold."""

    def chunk(kind: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    head = struct.pack(">IIBBBBB", width, height, bits, colour, 0, 0, 0)
    return (
        b"\x89PNG\r\n\x1a\n"
        + chunk(b"IHDR", head)
        + chunk(b"IDAT", rows or zlib.compress(bytes(1000)))
        + chunk(b"IEND", b"")
    )


def true_picture(edge: int, kind: str = "PNG") -> bytes:
    """A picture of one colour, `edge` pixels wide and high."""
    packed = io.BytesIO()
    Image.new("RGB", (edge, edge), (200, 10, 10)).save(packed, kind)
    return packed.getvalue()


def hostile(draw: random.Random) -> bytes:
    """A picture that must be refused, or is at the edge of what is allowed."""
    way = draw.randrange(6)
    if way < 2:
        return draw.choice(list(FOREIGN.values()))
    if way == 2:
        edges = (1, 8192, 8193, 11_500, 60_000, 2**31 - 1)
        return png(draw.choice(edges), draw.choice(edges), draw.choice((1, 8, 16, 99)), draw.choice((0, 2, 3, 6, 9)))
    if way == 3:
        return png(8192, 8192, 8, 6, zlib.compress(bytes(8192 * 200)))
    whole = true_picture(draw.choice((1, 64, 2000)), draw.choice(("PNG", "JPEG", "WEBP")))
    if way == 4:
        return whole[: draw.randrange(1, len(whole))]
    made = bytearray(whole)
    for _ in range(20):
        made[draw.randrange(12, len(made))] = draw.randrange(256)
    return bytes(made)


def fake_ghostscript(folder: Path) -> tuple[Path, Path]:
    """A folder for PATH with a program `gs`, and the file that it writes when it is started."""
    mark = folder / "started"
    (folder / "bin").mkdir()
    program = folder / "bin/gs"
    program.write_text(f"#!/bin/sh\necho started > '{mark}'\n")
    program.chmod(0o755)
    return folder / "bin", mark
