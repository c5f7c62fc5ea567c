"""The command `hazard-ms verify`: simulates a submission, compares it with earlier ones, and signs the report."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from hazard_ms.evaluation.spread import Where
from hazard_ms.evaluation.submissions.commitments import read_hidden
from hazard_ms.evaluation.submissions.copies import copied
from hazard_ms.evaluation.submissions.packing import read_submission
from hazard_ms.evaluation.submissions.report import SUFFIX, read_report
from hazard_ms.evaluation.submissions.signing import sign
from hazard_ms.evaluation.submissions.simulating import HERE
from hazard_ms.evaluation.submissions.simulating import verify as simulated
from hazard_ms.evaluation.submissions.tracks import HIDDEN, TRACKS, Track, track_of
from hazard_ms.spec.storage.files import make_folder, write

SHOWN = 20  # faults that are printed [ours]


def verify(
    file: Path,
    output: Path | None = None,
    episodes: int = 0,
    seed: int = 0,
    where: Where = HERE,
    key: Path | None = None,
    known: Path | None = None,
    hidden: tuple[Path, Path] | None = None,
) -> int:
    """Verify a submission as `hazard-ms verify` describes it. Returns 1 if there is any fault, else 0.

    Raises ValueError for files that are not there, for a report that cannot be written or signed, and where a
    simulation says nothing of the submission.
    """
    if key is not None and output is None:
        raise ValueError("--key needs --output, since the key signs the report that is written there")
    if output is not None and not output.name.endswith(SUFFIX):
        raise ValueError(f"output must end in {SUFFIX}, got {output.name!r}")
    earlier = [read_report(path) for path in sorted(known.rglob(f"*{SUFFIX}"))] if known else []
    report = simulated(file, _track(file, read_hidden(hidden)), episodes, seed, where)
    report = replace(report, faults=(*report.faults, *copied(report, earlier)))
    for fault in report.faults[:SHOWN]:
        print(fault)
    if len(report.faults) > SHOWN:
        print(f"and {len(report.faults) - SHOWN} more faults")
    print(f"{file}: {report.verdict}")
    if output is not None:
        make_folder(output.parent)
        write(output, report.to_json())
        print(f"report: {output.resolve()}, {'not signed' if key is None else f'signed: {sign(output, key).name}'}")
    return int(bool(report.faults))


def _track(file: Path, hidden: Track | None) -> Track | None:
    """The track that a submission names; None where it names none, or cannot be read.

    Raises ValueError for a hidden one whose scenes are not given.
    """
    try:
        name = read_submission(file).manifest.track
    except ValueError:
        return None
    return track_of(name, hidden) if name in TRACKS or name.startswith(HIDDEN) else None
