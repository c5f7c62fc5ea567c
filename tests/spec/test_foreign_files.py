"""Files and words of others: read with a limit, without waiting, and shown without what a terminal carries out."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from hazard_ms.spec.foreign.files import folder_name, inside, printable, read_foreign, read_text, sha256_of


def test_a_file_is_read_up_to_its_limit(tmp_path: Path) -> None:
    (tmp_path / "a").write_bytes(b"12345")
    (tmp_path / "link").symlink_to(tmp_path / "a")
    assert read_foreign(tmp_path / "a", 5) == read_foreign(tmp_path / "link", 5) == b"12345"
    with pytest.raises(ValueError, match="the thing must have at most 4 bytes, got 5"):
        read_foreign(tmp_path / "a", 4, "the thing")


@pytest.mark.parametrize(
    ("name", "word"),
    [
        ("pipe", "must be a regular file, got"),
        ("folder", "must be a regular file, got"),
        ("zero", "must be a regular file, got"),
        ("none", "there is no file"),
        ("file/none", "there is no file"),
        ("circle", "cannot be read: Too many levels"),
        ("endless", "at most 9 bytes, got more"),
    ],
)
def test_what_is_not_a_file_is_refused_without_waiting(name: str, word: str, tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "folder").mkdir()
    (tmp_path / "file").touch()
    (tmp_path / "zero").symlink_to("/dev/zero")
    (tmp_path / "circle").symlink_to(tmp_path / "circle")
    (tmp_path / "endless").symlink_to("/proc/self/maps")  # says that it has 0 bytes
    with pytest.raises(ValueError, match=word):
        read_foreign(tmp_path / name, 9)


def test_words_are_shown_without_what_a_terminal_carries_out(tmp_path: Path) -> None:
    assert printable("Tür 1_ä.glb, 家") == "Tür 1_ä.glb, 家"
    assert printable("\x1b[31m\x9b\r\n\u202e\ud800") == r"\x1b[31m\x9b\r\n\u202e\ud800"
    with pytest.raises(ValueError, match=r"no file .*/a\\x1b\[31m$"):
        read_foreign(tmp_path / "a\x1b[31m", 9)


@pytest.mark.parametrize("name", ["a", "a/b.png", "a b/ä.json", ".hidden/x"])
def test_paths_in_files_stay_inside_their_folder(name: str, tmp_path: Path) -> None:
    assert inside(tmp_path, name, "file_name") == tmp_path / name


@pytest.mark.parametrize(
    "name",
    [
        "",
        "/etc/passwd",
        "../a",
        "a/../../b",
        "a//b",
        "a/./b",
        "a\\b",
        "a\0b",
        "a\x1b",
        "x" * 256,
        None,
        3,
        "link/a",
        "out",
    ],
)
def test_paths_that_leave_their_folder_are_refused(name: object, tmp_path: Path) -> None:
    (tmp_path / "in").mkdir()
    (tmp_path / "in/link").symlink_to(tmp_path)
    (tmp_path / "in/out").symlink_to("/etc/passwd")
    with pytest.raises(ValueError, match="file_name must be a path inside its folder, got"):
        inside(tmp_path / "in", name, "file_name")


def test_a_link_that_stays_inside_is_followed(tmp_path: Path) -> None:
    (tmp_path / "a").write_text("x")
    (tmp_path / "b").symlink_to("a")
    assert inside(tmp_path, "b", "file_name").read_text() == "x"


@pytest.mark.parametrize("name", ["", ".", "..", ".a", "a/b", "/a", "a\0", "x" * 256, "ä" * 128, "a\x1b", 7, None])
def test_a_name_of_a_folder_is_one_visible_part(name: object) -> None:
    assert folder_name("kitchen_a-07-s000012", "name") == "kitchen_a-07-s000012"
    with pytest.raises(ValueError, match="name must be the name of a folder, got"):
        folder_name(name, "name")


def test_hashes_are_those_of_regular_files_only(tmp_path: Path) -> None:
    (tmp_path / "a").write_bytes(b"abc")
    known = "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad"  # FIPS 180-2, B.1
    assert sha256_of(tmp_path / "a") == known
    os.mkfifo(tmp_path / "pipe")
    with pytest.raises(ValueError, match="must be a regular file"):
        sha256_of(tmp_path / "pipe")


def test_text_is_utf8(tmp_path: Path) -> None:
    (tmp_path / "a").write_bytes("ä".encode())
    (tmp_path / "b").write_bytes(b"\xff")
    assert read_text(tmp_path / "a", 9) == "ä"
    with pytest.raises(ValueError, match="the thing must be text in UTF-8"):
        read_text(tmp_path / "b", 9, "the thing")
