"""Runs the cases, prints them as a table, and writes a page with the important curves."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from pathlib import Path

from hazard_ms.hazards.case import Case
from hazard_ms.pictures.files import encoded
from hazard_ms.spec.registry import HAZARDS, find, load
from hazard_ms.spec.storage.files import make_folder, write_together
from hazard_ms.validation.charts import Chart, draw
from hazard_ms.validation.outcome import Outcome, check

PAGE = "validation.md"
PICTURES = "validation"  # the folder of pictures beside the page
ABOUT = """\
# Validation of the physics

Written by `hazard-ms validate -o docs`; do not edit. Expected numbers are exact solutions, tables of the original
benchmark's code, or publications (NIST FDS Correlation Guide, CFAST, NFPA, ISO 13571, Quintiere and Harkleroad): no
number is computed by the code that it checks. Motion is that of the real simulator. The power law of wind (W-23) is not
covered, since it is not used. Letters: I integrator, F fire of the original, N and 3.1 realistic fire, L flood, W wind.
"""


def chosen(hazard: str | None, quick: bool = False) -> list[tuple[str, Case]]:
    """The cases of `hazard`, or of every registered one, each with the hazard's name.

    `quick`: without those that take more than a second or two. Raises ValueError for an unknown hazard.
    """
    names = list(HAZARDS) if hazard is None else [find(HAZARDS, hazard, "hazard").name]
    every = ((name, case) for name in names for part in HAZARDS[name].cases for case in load(part)())
    return [(name, case) for name, case in every if not (quick and case.slow)]


def number(value: float) -> str:
    """Six significant digits."""
    return f"{value:.6g}"


def tolerance(case: Case) -> str:
    """The tolerance of a case in words."""
    if not case.tolerance:
        return "exact"
    return f"± {case.tolerance:.3g}" if case.absolute else f"± {100 * case.tolerance:.3g} %"


def line(result: Outcome) -> str:
    """One result as a line of text."""
    case = result.case
    verdict = "pass" if result.passed else "FAIL"
    values = f"{number(case.expected):>10} {number(result.got):>10} {case.unit:6} {tolerance(case):>10}"
    return f"{verdict}  {case.id:10} {case.what:64} {values}"


def run(cases: Iterable[Case], say: Callable[[str], None] = print) -> list[Outcome]:
    """Check all of `cases`, telling each as it ends."""
    results = []
    for case in cases:
        results.append(check(case))
        say(line(results[-1]))
    return results


def charts_of(hazard: str) -> list[Chart]:
    """The curves of `hazard` for the page, if it has any."""
    make = HAZARDS[hazard].charts
    return [] if make is None else list(load(make)())


def page(results: dict[str, list[Outcome]], charts: dict[str, list[Chart]]) -> str:
    """The page, Markdown."""
    parts = [ABOUT]
    for name, found in results.items():
        parts.append(f"\n## {name.capitalize()}: {sum(r.passed for r in found)} of {len(found)} cases pass\n")
        parts += [f"![{c.title}]({PICTURES}/{c.file}.png)\n" for c in charts[name]]
        parts.append(
            "| case | quantity | expected | computed | unit | tolerance | |\n"
            "| --- | --- | ---: | ---: | --- | ---: | --- |"
        )
        for r in found:
            cells = (r.case.id, r.case.what, number(r.case.expected), number(r.got), r.case.unit, tolerance(r.case))
            parts.append(f"| {' | '.join(cells)} | {'pass' if r.passed else '**FAIL**'} |")
    return "\n".join(parts) + "\n"


def write(folder: Path, results: dict[str, list[Outcome]]) -> Path:
    """Write page and pictures into `folder`, all or none; returns the page. Raises ValueError where that fails."""
    make_folder(folder / PICTURES)
    charts = {name: charts_of(name) for name in results}
    contents: dict[Path, str | bytes] = {
        folder / PICTURES / f"{c.file}.png": encoded(draw(c), ".png") for some in charts.values() for c in some
    }
    write_together({**contents, folder / PAGE: page(results, charts)})
    return folder / PAGE


def validate(hazard: str | None, quick: bool, folder: Path | None) -> int:
    """Run the cases of `hazard`, or of all, print them, and write the page into `folder` if one is given.

    Returns 1 if a case fails, else 0. Raises ValueError for an unknown hazard, and for a file as the folder.
    """
    if folder is not None and folder.exists() and not folder.is_dir():
        raise ValueError(f"output must be a folder, got the file {str(folder)!r}")
    results: dict[str, list[Outcome]] = {}
    for name, case in chosen(hazard, quick):
        results.setdefault(name, []).extend(run([case]))
    every = [r for found in results.values() for r in found]
    failed = [r for r in every if not r.passed]
    print(f"{len(every) - len(failed)} of {len(every)} cases pass in {sum(r.seconds for r in every):.0f} s")
    if folder is not None:
        print(f"written: {write(folder, results)}")
    return 1 if failed else 0
