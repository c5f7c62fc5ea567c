"""`hazard-ms validate`: the quick cases of docs/physics.md all pass, and the command says so when one does not."""

from __future__ import annotations

import dataclasses
import math
from pathlib import Path

import numpy as np
import pytest

from hazard_ms.cli.__main__ import main
from hazard_ms.hazards.case import Case, table
from hazard_ms.spec import registry
from hazard_ms.validation import report
from hazard_ms.validation.charts import Chart, Line, draw, ticks
from hazard_ms.validation.outcome import Outcome, check


@pytest.mark.parametrize("hazard", ["fire", "flood", "wind"])
def test_the_quick_cases_pass(hazard: str) -> None:
    results = [check(case) for _, case in report.chosen(hazard, quick=True)]
    failed = [report.line(r) for r in results if not r.passed]
    assert len(results) > 50 and not failed, "\n".join(failed)


@pytest.mark.long
def test_the_slow_cases_pass() -> None:
    results = [check(case) for _, case in report.chosen(None) if case.slow]
    failed = [report.line(r) for r in results if not r.passed]
    assert len(results) > 10 and not failed, "\n".join(failed)


def test_every_section_of_the_specification_has_cases() -> None:
    found = {case.id.split("-")[0] for _, case in report.chosen(None)}
    assert {"I", "F", "N", "L", "W", "3.1"} <= found


@pytest.mark.parametrize(
    ("got", "tolerance", "absolute", "passes"),
    [
        (2.0, 0.0, False, True),
        (2.001, 0.0, False, False),
        (2.019, 0.01, False, True),
        (2.021, 0.01, False, False),
        (2.021, 0.03, True, True),
        (2.031, 0.03, True, False),
        (math.nan, 0.5, True, False),
        (math.inf, 0.5, False, False),
    ],
)
def test_a_case_passes_within_its_tolerance(got: float, tolerance: float, absolute: bool, passes: bool) -> None:
    case = Case("X-1", "two", 2.0, tolerance, lambda: got, absolute=absolute)
    assert check(case).passed == passes


def test_infinite_numbers_must_be_equal() -> None:
    never = Case("X-2", "never", math.inf, 0.0, lambda: math.inf)
    assert check(never).passed
    assert not check(dataclasses.replace(never, run=lambda: 1e9)).passed


def test_a_table_runs_each_row_with_its_own_argument() -> None:
    rows = list(table("X-3", "square of {}", {2: 4.0, 3: 9.0, 4: 16.0}, 0.0, lambda x: x * x))
    assert [c.what for c in rows] == ["square of 2", "square of 3", "square of 4"]
    assert all(check(c).passed for c in rows)


def test_the_command_ends_with_1_when_a_case_fails(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    good, bad = (Case("X-4", "one", 1.0, 0.0, lambda v=v: v) for v in (1.0, 1.5))
    charts = lambda: iter([Chart("wave", "A wave", "x", "y", (Line("a", [0, 1, 2], [0.0, 1.0, 0.5]),))])  # noqa: E731
    for cases, code in (([good], 0), ([good, bad], 1)):
        entry = registry.HazardEntry("wind", None, cases=(lambda cases=cases: iter(cases),), charts=charts)
        monkeypatch.setattr(report, "HAZARDS", {"wind": entry})
        assert main(["validate", "-o", str(tmp_path / "docs")]) == code
        page = (tmp_path / "docs" / "validation.md").read_text()
        assert ("**FAIL**" in page) == bool(code) and f"{len(cases) - code} of {len(cases)} cases pass" in page
        assert ("FAIL" in capsys.readouterr().out) == bool(code)
    assert (tmp_path / "docs" / "validation" / "wave.png").stat().st_size > 1000


def test_bad_orders_are_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "file"
    file.write_text("")
    assert main(["validate", "-o", str(file)]) == 2
    assert "output must be a folder" in capsys.readouterr().err
    with pytest.raises(ValueError, match="fire, flood, wind, got 'earthquake'"):
        report.chosen("earthquake")


def test_charts_have_round_ticks_and_show_their_lines() -> None:
    assert ticks(0.0, 10.0) == [0, 2, 4, 6, 8, 10]
    assert ticks(0.0, 0.93) == pytest.approx([0.0, 0.2, 0.4, 0.6, 0.8])
    chart = Chart(
        "a", "b", "x [s]", "y [m]", (Line("code", [0, 1, 2], [0.0, 1.0, 4.0]), Line("exact", [1], [1.0], points=True))
    )
    image = draw(chart)
    assert image.shape == (520, 880, 3) and len(np.unique(image.reshape(-1, 3), axis=0)) > 50


def test_a_result_is_one_line() -> None:
    made = report.line(Outcome(Case("X-5", "what", 3.0, 0.01, lambda: 3.0, "m"), 3.0, 0.1))
    assert made.startswith("pass  X-5") and "± 1 %" in made and "\n" not in made
