"""Files and words of others: read with a limit, without waiting, and shown without what a terminal carries out."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from hazard_ms.assets.foreign import printable, read_foreign


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
