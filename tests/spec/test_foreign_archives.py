"""Archives of strangers: names that lead out, links, bombs, doubles and lies about sizes are refused."""

from __future__ import annotations

import io
import stat
import struct
import warnings
import zipfile
from collections.abc import Callable

import pytest

from hazard_ms.spec.foreign.archives import read_archive

MOST, MEMBERS = 10_000, 3
Write = Callable[[zipfile.ZipFile], object]


def archive(write: Write) -> bytes:
    made = io.BytesIO()
    with zipfile.ZipFile(made, "w", zipfile.ZIP_DEFLATED) as file, warnings.catch_warnings():
        warnings.simplefilter("ignore")  # names that are there twice
        write(file)
    return made.getvalue()


def member(name: str, mode: int = stat.S_IFREG | 0o644, content: bytes = b"a") -> Write:
    told = zipfile.ZipInfo("x")
    told.filename, told.external_attr = name, mode << 16
    return lambda file: file.writestr(told, content)


def both(*writes: Write) -> Write:
    return lambda file: [write(file) for write in writes]


def test_files_are_read_in_their_order() -> None:
    content = archive(both(member("b.json"), member("a/c.json", content=b"")))
    assert list(read_archive(content, "it", MOST, MEMBERS).items()) == [("b.json", b"a"), ("a/c.json", b"")]


HOSTILE: dict[str, tuple[Write, str]] = {
    "a path out": (member("../a"), "plain names that stay inside it"),
    "a path out further in": (member("a/../../b"), "plain names that stay inside it"),
    "an absolute path": (member("/etc/passwd"), "plain names that stay inside it"),
    "a path of Windows": (member("a\\b"), "plain names that stay inside it"),
    "a drive": (member("C:a"), "plain names that stay inside it"),
    "no name": (member(""), "plain names that stay inside it"),
    "codes of a terminal": (member("\x1b[2J"), "plain names that stay inside it"),
    "a folder": (member("a/"), "plain names that stay inside it"),
    "a link": (member("a", stat.S_IFLNK | 0o777, b"/etc/passwd"), "regular files, got a link"),
    "a device": (member("a", stat.S_IFCHR | 0o666), "regular files, got a link"),
    "a name twice": (both(member("a"), member("a")), "names that differ"),
    "many members": (both(*(member(f"{n}") for n in range(4))), "at most 3 members, got 4"),
    "a bomb": (member("a", content=b"\0" * 1_000_000), "must unpack to at most 10000 bytes, got 1000000"),
}


@pytest.mark.parametrize("name", HOSTILE)
def test_a_hostile_archive_is_refused(name: str) -> None:
    write, told = HOSTILE[name]
    with pytest.raises(ValueError, match=told):
        read_archive(archive(write), "it", MOST, MEMBERS)


@pytest.mark.parametrize("size", [1, 5_000])
def test_a_member_that_lies_about_its_size_is_refused(size: int) -> None:
    """The list of members says `size`, but a megabyte of zeros follows."""
    content = bytearray(archive(member("a", content=b"\0" * 1_000_000)))
    at = content.rindex(b"PK\x01\x02") + 24
    content[at : at + 4] = struct.pack("<I", size)
    with pytest.raises(ValueError, match="must be an archive with BadZipFile"):
        read_archive(bytes(content), "it", MOST, MEMBERS)


def test_a_changed_byte_is_found() -> None:
    content = archive(lambda file: file.writestr("a", b"1234567890", zipfile.ZIP_STORED))
    with pytest.raises(ValueError, match="must be an archive with BadZipFile"):
        read_archive(content.replace(b"12345", b"12346"), "it", MOST, MEMBERS)


def test_what_is_encrypted_or_packed_otherwise_is_refused() -> None:
    with pytest.raises(ValueError, match="stored or deflated"):
        read_archive(archive(lambda file: file.writestr("a", b"a", zipfile.ZIP_BZIP2)), "it", MOST, MEMBERS)
    content = bytearray(archive(member("a")))
    content[content.rindex(b"PK\x01\x02") + 8] |= 1
    with pytest.raises(ValueError, match="not encrypted"):
        read_archive(bytes(content), "it", MOST, MEMBERS)
