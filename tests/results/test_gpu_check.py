"""What `./run gpu-check` measures, with one environment on the CPU in the place of many on a GPU."""

from __future__ import annotations

import sys
import warnings
from pathlib import Path

import numpy as np
import pytest

from results.gpu import rates, report, waits
from results.gpu.__main__ import TASKS, main
from results.gpu.apart import StoppedError, complaints, failure, run
from results.gpu.comparison import BODIES, JOINTS, course, difference, differences_table, keep, kept
from results.gpu.gpu_tests import gpu_tests
from results.gpu.looks import SIDES
from results.gpu.needs import DRIVER, missing
from results.speed import GPU
from tests.worlds.files.checkout import ROOT

CHECKED = (0, 1, 4)


def cells(text: str) -> list[list[str]]:
    """The cells of the rows of the first table in a text, without headings."""
    lines = [line for line in text.splitlines() if line.startswith("|")]
    return [[cell.strip() for cell in line.split("|")[1:-1]] for line in lines[2:]]


def test_a_rate_counts_the_frames_of_all_environments() -> None:
    row = cells(rates.rates_table([rates.Rate(4096, 0.5, 90.0, 3 * 2**30)]))
    assert row == [["4,096", "8,192", "500.0", "90", "3.0"]]


def test_the_rate_of_one_environment_on_the_cpu_is_measured() -> None:
    made = rates.rate("HazardWind-v1", 1, rates.STATE, "cpu", frames=5)
    assert made.num_envs == 1 and 0.0 < made.step < made.start
    if not DRIVER.exists():
        assert made.memory is None and cells(rates.rates_table([made]))[0][-1] == "none"


@pytest.mark.long
@pytest.mark.render
def test_the_rate_of_pictures_is_measured() -> None:
    assert rates.rate("HazardFire-v1", 1, rates.PICTURES, "cpu", frames=2).step > 0.0


def test_a_table_ends_with_a_line_where_the_memory_does() -> None:
    asked = []

    def measure(size: int) -> rates.Rate:
        asked.append(size)
        if size == 16:
            raise failure("Traceback\ntorch.OutOfMemoryError: CUDA out of memory. Tried to allocate 2 GiB.\n", 1)
        return rates.Rate(size, 0.1, 1.0, None)

    made, stopped = rates.growth((1, 4, 16, 64), measure)
    assert [r.num_envs for r in made] == [1, 4] and asked == [1, 4, 16]
    assert stopped is not None and stopped.limit
    assert str(stopped).startswith("a batch of 16: the memory is exhausted: torch.OutOfMemoryError: CUDA out of")
    assert rates.growth((1, 4), measure)[1] is None


@pytest.mark.parametrize(
    ("said", "code", "reason", "limit"),
    [
        ("vk::Device::allocateMemory: ErrorOutOfDeviceMemory\nAborted", -6, "the memory is exhausted: vk", True),
        ("RuntimeError: CUDA error: out of memory", 1, "the memory is exhausted", True),
        (
            "[SAPIEN] [critical] fail to allocate memory 64 bytes!! Result = 2\nRuntimeError: x",
            1,
            "the memory is",
            True,
        ),
        ("loading", -9, "killed from outside", True),
        ("loading", -11, "crashed (signal 11): loading", False),
        ("Traceback\nValueError: seed must be a number\n", 1, "ValueError: seed must be a number", False),
        ("", 3, "it printed nothing", False),
    ],
)
def test_a_failure_is_told_in_a_line(said: str, code: int, reason: str, limit: bool) -> None:
    error = failure(said, code)
    assert str(error).startswith(reason) and error.limit == limit


def test_a_process_may_exhaust_memory_or_time() -> None:
    assert run([sys.executable, "-c", "print('done')"], 60.0) == "done\n"
    with pytest.raises(StoppedError, match="the memory is exhausted: MemoryError"):
        run([sys.executable, "-c", "bytearray(1 << 60)"], 60.0)
    with pytest.raises(StoppedError, match=r"took longer than 0\.2 s"):
        run([sys.executable, "-c", "import time; time.sleep(60)"], 0.2)


def test_what_the_simulator_complains_of_is_told_once() -> None:
    log = "".join(
        f"[2026-01-01 00:00:0{k}.000] [SAPIEN] [critical] Patch buffer overflow detected, please increase its size "
        f"to at least {1000 + k} in the scene desc!\n[2026-01-01] [SAPIEN] [warning] something else\n"
        for k in range(3)
    )
    text = "Patch buffer overflow detected, please increase its size to at least 1000 in the scene desc!"
    assert complaints(log) == {text: 3}


def test_the_cpu_does_not_differ_from_itself_and_planted_differences_are_seen(tmp_path: Path) -> None:
    a, b = (course("HazardWind-v1", "cpu", CHECKED) for _ in range(2))
    table = differences_table(a, b)
    assert cells(table) == [[BODIES, "0", "0", "0"], [JOINTS, "0", "0", "0"]]
    count = len(a) // len(CHECKED)
    assert table.endswith(f"{count} of {count} quantities.")
    assert (a[f"4/{JOINTS}"] != a[f"0/{JOINTS}"]).any() and (a[f"4/{BODIES}"] != a[f"0/{BODIES}"]).any()
    keep(tmp_path / "a.npz", a)
    again = kept(tmp_path / "a.npz")
    assert {k: v.dtype for k, v in again.items()} == {k: v.dtype for k, v in a.items()}
    b[f"1/{BODIES}"][0, 2] += 0.25
    b["4/wind: speed [m/s]"][...] += 1.0
    b["4/damage: " + next(k for k in a if k.startswith("4/damage: ")).split(": ", 1)[1]][0, :2] ^= True
    rows = {row[0]: row[1:] for row in cells(differences_table(again, b))}
    assert rows[BODIES] == ["0", "2.5e-01", "0"] and rows[JOINTS] == ["0", "0", "0"]
    assert rows["wind: speed [m/s]"] == ["0", "0", "1.0e+00"]
    assert [row[2][:5] for name, row in rows.items() if name.startswith("damage: ")] == ["2 of "]


def test_differences_of_numbers_that_are_not_finite() -> None:
    inf, nan = np.inf, np.nan
    assert difference(np.array([inf, nan, 1.0]), np.array([inf, nan, 1.0])) == 0.0
    assert difference(np.array([1.0, nan]), np.array([1.0, 2.0])) == inf
    assert difference(np.array([inf]), np.array([-inf])) == inf
    assert difference(np.array([1, 2, 3]), np.array([9, 2, 4])) == 2.0
    with pytest.raises(ValueError, match="one shape"):
        difference(np.zeros(2), np.zeros(3))


def test_waits_are_counted_by_the_line_that_waits() -> None:
    with pytest.warns(RuntimeWarning, match="something else"), waits.counted() as places:
        for _ in range(3):
            warnings.warn(f"{waits.WARNING} (Triggered internally at x.cpp:1.)", UserWarning, stacklevel=1)
        warnings.warn("something else", RuntimeWarning, stacklevel=1)
    ((place, count),) = places.items()
    assert count == 3 and place.startswith("tests/results/test_gpu_check.py:")
    assert not Path(place).is_absolute()


def test_a_wait_names_the_line_of_the_package_that_led_to_it(monkeypatch: pytest.MonkeyPatch) -> None:
    from hazard_ms.spec import checks

    monkeypatch.setattr(checks, "numbers", lambda *a: warnings.warn(waits.WARNING, stacklevel=1))
    with waits.counted() as places, pytest.raises(AttributeError):
        checks.action(0.0, 1, "mode", lambda mode: 1)
    (place,) = places
    assert place.startswith("tests/results/test_gpu_check.py:") and ", from hazard_ms/spec/checks.py:" in place


def test_a_machine_without_a_gpu_is_told_what_is_missing(tmp_path: Path) -> None:
    assert missing(tmp_path / "driver").startswith("an NVIDIA GPU with its driver (there is no ")


@pytest.mark.skipif(DRIVER.exists(), reason="a GPU would be measured")
def test_the_command_ends_early_without_a_gpu(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["-o", str(tmp_path / "page.md")]) == 1
    said = capsys.readouterr()
    assert said.out == "" and said.err.count("\n") == 1
    assert "this machine lacks an NVIDIA GPU" in said.err and "runs the tests marked gpu" in said.err
    assert not [*tmp_path.iterdir()]


def test_the_page_on_speed_says_what_its_script_would_write() -> None:
    assert (ROOT / "docs/speed.md").read_text(encoding="utf-8").endswith(f"\n\n{GPU}")
    assert all(f"- `{part}`: " in GPU for part in report.PARTS)


def test_wrong_input_is_refused_before_anything_is_measured(tmp_path: Path) -> None:
    for words in ({"parts": ("rate",)}, {"budget": 0.0}, {"sizes": ()}, {"env_ids": ("HazardFir-v1",)}):
        with pytest.raises(ValueError, match="must be"):
            report.report(tmp_path / "page.md", **{"env_ids": TASKS, **words})  # type: ignore[arg-type]
    assert not [*tmp_path.iterdir()]


def test_a_report_has_its_tables(tmp_path: Path) -> None:
    page = tmp_path / "new" / "page.md"
    assert report.report(page, ("HazardWind-v1",), ("state",), (1,), simulator="cpu") == 0
    text = page.read_text(encoding="utf-8")
    assert text.startswith("---\norphan: true\n---\n\n# On a GPU\n") and "torch" in text
    ((number, rate, *_),) = cells(text)
    assert number == "1" and float(rate.replace(",", "")) > 0


@pytest.mark.long
def test_a_report_compares_and_counts_and_says_what_failed(tmp_path: Path) -> None:
    """A batch of two fails, as it needs a GPU."""
    if DRIVER.exists():
        pytest.skip("a GPU measures them")
    page = tmp_path / "page.md"
    parts = ("state", "comparison", "waits")
    assert report.report(page, ("HazardWind-v1",), parts, (2,), simulator="cpu") == 2
    text = page.read_text(encoding="utf-8")
    rows = [row for row in cells(text) if row[0] in (BODIES, JOINTS)]
    assert len(rows) == 4 and {cell for row in rows for cell in row[1:]} == {"0"}
    assert text.count("**Failed**: ") == 2 and "a batch of 2: ValueError: num_envs must be 1" in text


def test_tests_of_a_gpu_are_run_and_told(tmp_path: Path) -> None:
    (tmp_path / "tests").mkdir()
    (tmp_path / "tests/conftest.py").write_text(
        "def pytest_addoption(parser):\n    parser.addoption('--long', action='store_true')\n"
    )
    (tmp_path / "pytest.ini").write_text("[pytest]\naddopts = -ra\nmarkers =\n  gpu: a\n")
    file, head = tmp_path / "tests/test_it.py", "import pytest\npytestmark = pytest.mark.gpu\ndef test_a(): pass\n"
    file.write_text(head)
    said, passed = gpu_tests(tmp_path)
    assert passed and "1 passed" in said
    file.write_text(head + "def test_b(): pytest.skip('why')\n")
    said, passed = gpu_tests(tmp_path)
    assert not passed and "SKIPPED [1] tests/test_it.py" in said and "1 passed, 1 skipped" in said


def test_what_needs_physx_is_left_out_without_it_and_counts_as_failed(tmp_path: Path) -> None:
    page = tmp_path / "page.md"
    assert report.report(page, ("HazardWind-v1",), ("state", "waits"), (1,), simulator="cpu", lack="a file") == 2
    assert "**Left out**: state, waits. This machine lacks a file." in page.read_text(encoding="utf-8")


@pytest.mark.long
@pytest.mark.render
def test_a_report_has_hazards_alone_and_looks(tmp_path: Path) -> None:
    page = tmp_path / "page.md"
    assert report.report(page, ("HazardWind-v1",), ("laws", "looks"), (1, 2), simulator="cpu") == 0
    text = page.read_text(encoding="utf-8")
    assert text.count("waits a frame.") == 2 and "0.00 waits a frame." in text
    looks = [row for row in cells(text[text.index("drawn on the GPU") :]) if row[0] == "HazardWind-v1"]
    assert [row[1] for row in looks] == [str(side) for side in SIDES]
    assert {cell for row in looks for cell in row[4:]} == {"0.000", "0.00"}
