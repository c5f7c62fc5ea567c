"""Files appear whole or not at all: under full disks, folders that cannot be written, kills, and several at once."""

from __future__ import annotations

import json
import os
import random
import resource
import signal
import stat
import subprocess
import sys
import time
from pathlib import Path

import pytest

from hazard_ms.spec.storage.files import drafts, make_folder, write, write_together

KILLS = 20
SET = ("out.mp4", "out.json", "out.html")
ENDLESS = """
import sys
from pathlib import Path
from hazard_ms.spec.storage.files import write_together
run = 0
while True:
    run += 1
    write_together({Path(name): f"{run} " * 200_000 for name in sys.argv[1:]})
    print(run, flush=True)
"""


def names(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.iterdir())


def child(code: str, *words: object, **options: object) -> subprocess.Popen[str]:
    command = [sys.executable, "-c", code, *map(str, words)]
    return subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, **options)  # type: ignore[call-overload, no-any-return]


def test_readers_of_the_older_file_keep_it(tmp_path: Path) -> None:
    place = tmp_path / "answer.json"
    place.write_text("old")
    with place.open() as reader:
        write(place, "new")
        assert reader.read() == "old"
    assert place.read_text() == "new" and names(tmp_path) == ["answer.json"]


def test_nothing_is_there_before_the_end(tmp_path: Path) -> None:
    with drafts(tmp_path / "a.txt") as (draft,):
        draft.write(b"\0\xff")
        assert not (tmp_path / "a.txt").exists() and draft.path.suffix == ".txt"
    assert (tmp_path / "a.txt").read_bytes() == b"\0\xff"


def test_an_error_in_the_block_leaves_all_as_it_was(tmp_path: Path) -> None:
    (tmp_path / "a").write_text("old")
    with pytest.raises(ZeroDivisionError), drafts(tmp_path / "a", tmp_path / "b") as (first, second):
        first.write("new")
        second.write("new")
        raise ZeroDivisionError
    assert names(tmp_path) == ["a"] and (tmp_path / "a").read_text() == "old"


def test_a_set_of_which_one_cannot_have_its_name_is_not_there_at_all(tmp_path: Path) -> None:
    """A folder takes the name of the third file while all are written: the first two become the older ones again."""
    (tmp_path / "a").write_text("old")
    with pytest.raises(ValueError, match=f"{tmp_path}/c: Is a directory; name a file"):
        with drafts(*(tmp_path / name for name in "abc")) as made:
            for draft in made:
                draft.write("new")
            (tmp_path / "c").mkdir()
    assert names(tmp_path) == ["a", "c"] and (tmp_path / "a").read_text() == "old"


def test_what_utf_8_cannot_hold_is_escaped(tmp_path: Path) -> None:
    write(tmp_path / "page.html", "one \ud800 two")
    assert (tmp_path / "page.html").read_text(encoding="utf-8") == "one \\ud800 two"


def test_modes_are_those_of_the_older_file_or_the_usual_ones(tmp_path: Path) -> None:
    (tmp_path / "plain").touch()
    (tmp_path / "private").touch(0o600)
    for name in ("private", "new"):
        write(tmp_path / name, "x")
    mode = {name: stat.S_IMODE((tmp_path / name).stat().st_mode) for name in names(tmp_path)}
    assert mode["private"] == 0o600 and mode["new"] == mode["plain"]


def test_links_are_kept_and_lead_to_the_new_content(tmp_path: Path) -> None:
    (tmp_path / "real").mkdir()
    (tmp_path / "link").symlink_to(tmp_path / "real/file")
    write(tmp_path / "link", "new")
    assert (tmp_path / "link").is_symlink() and (tmp_path / "real/file").read_text() == "new"


@pytest.mark.parametrize(
    ("name", "told"),
    [
        ("no/such/folder/x.json", "No such file or directory; make its folder first"),
        ("file/x.json", "Not a directory; make its folder first"),
        ("folder", "Is a directory; name a file"),
        ("pipe", "it is a device or a pipe; name another place"),
        ("n" * 300, "File name too long; choose a shorter name"),
    ],
)
def test_places_where_no_file_can_be_are_refused(name: str, told: str, tmp_path: Path) -> None:
    (tmp_path / "folder").mkdir()
    (tmp_path / "file").touch()
    os.mkfifo(tmp_path / "pipe")
    with pytest.raises(ValueError) as refused:
        write(tmp_path / name, "x")
    assert str(refused.value) == f"output must be a writable file, got {tmp_path / name}: {told}"
    assert names(tmp_path) == ["file", "folder", "pipe"]


def test_devices_are_not_replaced() -> None:
    with pytest.raises(ValueError, match="device"):
        write(Path("/dev/null"), "x")
    assert stat.S_ISCHR(os.stat("/dev/null").st_mode)


def test_a_folder_that_cannot_be_made_is_named(tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    with pytest.raises(ValueError, match=f"a writable folder, got {tmp_path}/file/in: Not a directory"):
        make_folder(tmp_path / "file/in")
    make_folder(tmp_path / "a/b")
    make_folder(tmp_path / "a/b")
    assert (tmp_path / "a/b").is_dir()


def test_a_disk_that_is_full_leaves_the_older_files(tmp_path: Path) -> None:
    """The limit on the size of files ends the writing of the second file in its midst."""
    (tmp_path / "b").write_text("old")
    code = (
        "import sys; from pathlib import Path; from hazard_ms.spec.storage.files import write_together\n"
        "try: write_together({Path('a'): 'x', Path('b'): 'x' * 100_000})\n"
        "except ValueError as error: sys.exit(str(error))"
    )
    made = child(code, cwd=tmp_path, preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (5000, 5000)))
    error = made.communicate(timeout=60)[1]
    assert made.returncode == 1 and f"{tmp_path}/b: File too large; raise the limit" in error
    assert names(tmp_path) == ["b"] and (tmp_path / "b").read_text() == "old"


@pytest.mark.skipif(os.geteuid() != 0, reason="only root may become somebody else")
def test_a_folder_of_others_is_refused_with_a_remedy(tmp_path: Path) -> None:
    code = (
        "import os; from pathlib import Path; from hazard_ms.spec.storage.files import write; os.setuid(65534)\n"
        "write(Path('/x.json'), 'x')"
    )
    error = child(code).communicate(timeout=60)[1]
    assert "/x.json: Permission denied; name a folder that you may write to" in error


def test_killed_at_any_moment_a_set_is_the_older_or_the_newer_one(tmp_path: Path) -> None:
    """And the next run deletes the drafts that were left."""
    places, moment = [tmp_path / name for name in SET], random.Random(0)
    write_together({place: "0 " * 200_000 for place in places})
    left = 0
    for _ in range(KILLS):
        running = child(ENDLESS, *places)
        assert running.stdout is not None and running.stdout.readline() == "1\n"
        time.sleep(moment.uniform(0.0, 0.05))
        running.send_signal(signal.SIGKILL)
        running.communicate(timeout=60)
        runs = [set(place.read_text().split()) for place in places]
        assert all(place.read_text().count(" ") == 200_000 for place in places) and all(len(run) == 1 for run in runs)
        between_two_names = any("older" in name for name in names(tmp_path))  # some 20 us of each run
        assert len(set.union(*runs)) == 1 or between_two_names
        left += len(names(tmp_path)) > len(SET)
        write_together({place: "0 " * 200_000 for place in places})
        assert names(tmp_path) == sorted(SET)
    assert left > 0, "some were killed while they wrote"


def test_drafts_of_a_living_process_are_not_deleted(tmp_path: Path) -> None:
    with drafts(tmp_path / "a.txt") as (first,):
        first.write("first")
        write(tmp_path / "a.txt", "second")
        assert first.path.exists()
    assert (tmp_path / "a.txt").read_text() == "first" and names(tmp_path) == ["a.txt"]


def test_two_at_once_leave_the_set_of_one(tmp_path: Path) -> None:
    """Never files of both."""
    places = [tmp_path / name for name in SET]
    running = [child(ENDLESS, *places) for _ in range(2)]
    for each in running:
        assert each.stdout is not None and each.stdout.readline() == "1\n"
    time.sleep(1.0)
    for each in running:
        each.send_signal(signal.SIGKILL)
        each.communicate(timeout=60)
    between_two_names = any("older" in name for name in names(tmp_path))
    assert len({place.read_text() for place in places}) == 1 or between_two_names


def test_readers_never_meet_a_part(tmp_path: Path) -> None:
    place = tmp_path / "a.json"
    write(place, json.dumps([0] * 100_000))
    code = (
        "import json; from pathlib import Path; from hazard_ms.spec.storage.files import write\n"
        "while True: write(Path('a.json'), json.dumps([1] * 100_000)); print(flush=True)"
    )
    writer = child(code, cwd=tmp_path)
    try:
        assert writer.stdout is not None
        writer.stdout.readline()
        assert all(len(json.loads(place.read_text())) == 100_000 for _ in range(100))
    finally:
        writer.kill()
        writer.communicate(timeout=60)
