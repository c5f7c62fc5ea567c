"""The leaderboard as a static site: a page with the tracks, and one for each submission. It needs nothing else."""

from __future__ import annotations

import shutil
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from markupsafe import Markup

from hazard_ms.evaluation import page as episode_page
from hazard_ms.evaluation.comparison import charts
from hazard_ms.evaluation.metrics import Score
from hazard_ms.evaluation.submissions.standings import FILM, Row, apart
from hazard_ms.evaluation.submissions.tracks import TRACKS
from hazard_ms.spec.storage.files import make_folder, write

BOARD = Path(__file__).with_name("board.html")
ENTRY = Path(__file__).with_name("entry.html")
LARGEST_FILM = 200_000_000  # [bytes] [ours]


def write_site(tracks: dict[str, list[Row]], left_out: Sequence[str], output: Path) -> Path:
    """Write the site of `tracks` into the folder `output`. Returns its first page.

    Raises ValueError where a page or a film cannot be written.
    """
    make_folder(output)
    for rows in tracks.values():
        for row in rows:
            films = _copied(row, output)
            write(output / page_name(row), episode_page.rendered(ENTRY, row=row, films=films, share=share))
    shown = [_track(name, rows) for name, rows in tracks.items()]
    first = output / "index.html"
    write(first, episode_page.rendered(BOARD, tracks=shown, left_out=left_out, share=share, page_name=page_name))
    return first


def page_name(row: Row) -> str:
    """The name of a submission's page: its SHA-256 alone, since people choose its other names."""
    return f"{row.report.submission[:16]}.html"


def share(score: Score, sign: str = "") -> str:
    """A share with its interval in per cent, "81.0 [75.2, 86.9]"; "–" where it is undefined. `sign`: "+" shows it."""
    if score.mean is None or score.low is None or score.high is None:
        return "–"
    return f"{100 * score.mean:{sign}.1f} [{100 * score.low:{sign}.1f}, {100 * score.high:{sign}.1f}]"


def _track(name: str, rows: Sequence[Row]) -> dict[str, Any]:
    """What the page shows of a track."""
    track = TRACKS.get(name)
    ranks, rank = [], 0
    for row in rows:
        rank += not row.privileged
        ranks.append("" if row.privileged else rank)
    labels = [f"{row.title}{' *' if row.privileged else ''}" for row in rows]
    bars = [(label, row.score, charts.colour(k)) for k, (label, row) in enumerate(zip(labels, rows, strict=True))]
    return {
        "name": name,
        "words": track.words if track else "the published tasks in scenes that nobody knew while agents were made",
        "score": "Averted" if track and track.averted else "Value",
        "tasks": list(dict.fromkeys(task for row in rows for task in row.task_scores())),
        "rows": list(zip(ranks, rows, strict=True)),
        "chart": Markup(charts.intervals(bars)),  # noqa: S704 made of numbers and of names that it escapes
        "apart": {(a, b): apart(rows[a], rows[b]) for a in range(len(rows)) for b in range(len(rows)) if a != b},
        "history": _history(rows),
    }


def _history(rows: Sequence[Row]) -> list[tuple[Row, str]]:
    """The submissions by the date of their verification, and what each changed."""
    best, made = -1.0, []
    for row in sorted(rows, key=lambda r: (r.report.date, r.name)):
        mean = row.score.mean or 0.0
        led = not row.privileged and mean > best
        best = mean if led else best
        made.append((row, "reference" if row.privileged else "takes the lead" if led else ""))
    return made


def _copied(row: Row, output: Path) -> dict[tuple[str, int], str]:
    """The address of each film, copied into the site. Raises ValueError for one that is too large."""
    made = {}
    for (task, seed), path in row.films.items():
        if (task, seed) not in row.scenes:
            continue
        if path.stat().st_size > LARGEST_FILM:
            raise ValueError(f"a film must have at most {LARGEST_FILM} bytes, got {path}")
        name = f"{row.report.submission[:16]}-{task}-{seed:04d}{FILM}"
        try:
            shutil.copyfile(path, output / name)
        except OSError as error:
            raise ValueError(f"output must be a folder for films, got {output}: {error.strerror}") from None
        made[task, seed] = name
    return made
