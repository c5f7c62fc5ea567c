"""What is damaged in the folder of compiled kernels is compiled again, in words, and never run."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

LONG = pytest.mark.long  # each process takes seconds to start
CHILD = """
import torch, warp as wp
from hazard_ms.simulation.kernels.launch import OPTIONS, Launches
wp.set_module_options(OPTIONS)

@wp.kernel
def double(given: wp.array(dtype=float), made: wp.array(dtype=float)):
    made[wp.tid()] = 2.0 * given[wp.tid()]

made = torch.zeros(2)
Launches().run(double, (2,), torch.tensor([1.0, 3.0]), made)
print(made.tolist())
"""


def started(home: Path) -> subprocess.Popen[str]:
    """A process that runs a kernel and keeps it under `home`."""
    script = home / "child.py"
    if not script.exists():
        script.write_text(CHILD)
    environ = {k: v for k, v in os.environ.items() if k not in ("WARP_CACHE_PATH", "HAZARD_MS_QUIET")}
    return subprocess.Popen(
        [sys.executable, str(script)],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env={**environ, "HAZARD_MS_HOME": str(home), "CUDA_VISIBLE_DEVICES": ""},
    )


def told(home: Path) -> str:
    """What is said by a process that runs a kernel; its result must be right."""
    out, error = started(home).communicate(timeout=300)
    assert out.strip() == "[2.0, 6.0]", error
    return error


def kept(home: Path) -> dict[str, bytes]:
    """The files of the compiled kernel by ending."""
    (folder,) = (home / "kernels").glob("*/wp_*/")
    return {path.suffix: path.read_bytes() for path in folder.iterdir()}


@pytest.fixture(scope="module")
def home(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    """A folder in which a kernel has been compiled; each test leaves it whole."""
    folder = tmp_path_factory.mktemp("home")
    assert "damaged" not in told(folder)
    yield folder
    assert not list(folder.rglob("*.part*")), "no drafts are left"


@LONG
def test_a_whole_kernel_is_loaded_without_a_word(home: Path) -> None:
    (folder,) = (home / "kernels").glob("*/wp_*/")
    before = {path.name: path.stat().st_mtime_ns for path in folder.iterdir()}
    assert "damaged" not in told(home)
    assert {path.name: path.stat().st_mtime_ns for path in folder.iterdir()} == before


@pytest.mark.parametrize(
    ("ending", "share"), [(".o", 0.0), *(pytest.param(*case, marks=LONG) for case in ((".o", 0.7), (".meta", 0.0)))]
)
def test_a_file_that_was_cut_is_compiled_again(home: Path, ending: str, share: float) -> None:
    whole = kept(home)
    (file,) = (home / "kernels").glob(f"*/wp_*/*{ending}")
    file.write_bytes(whole[ending][: int(share * len(whole[ending]))])
    assert "damaged or unfinished; compiling them again" in told(home)
    assert kept(home)[ending] == whole[ending]


@LONG
def test_bytes_that_a_disk_lost_are_noticed(home: Path) -> None:
    """Zeros in the middle, as a power failure leaves them: the size is right."""
    whole = kept(home)[".o"]
    (file,) = (home / "kernels").glob("*/wp_*/*.o")
    third = len(whole) // 3
    file.write_bytes(whole[:third] + bytes(third) + whole[2 * third :])
    assert "damaged" in told(home) and kept(home)[".o"] == whole


@LONG
def test_a_process_that_was_killed_before_the_seal_left_nothing_that_is_used(home: Path) -> None:
    (seal,) = (home / "kernels").glob("*/wp_*.sha256")
    seal.unlink()
    assert "damaged or unfinished" in told(home) and seal.exists()


@LONG
def test_two_processes_at_once_share_one_compilation(tmp_path: Path) -> None:
    (tmp_path / "child.py").write_text(CHILD)
    for child in [started(tmp_path), started(tmp_path)]:
        out, error = child.communicate(timeout=300)
        assert out.strip() == "[2.0, 6.0]" and "damaged" not in error
    assert len(list((tmp_path / "kernels").glob("*/wp_*.sha256"))) == 1
