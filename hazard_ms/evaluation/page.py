"""One episode as a web page that needs nothing else: film, score, timeline, fates, decisions, and its command."""

from __future__ import annotations

import base64
import os
from pathlib import Path

import jinja2

from hazard_ms.evaluation.result import EpisodeResult
from hazard_ms.spec.catalogue import DAMAGED_SHARE

TEMPLATE = Path(__file__).with_name("page.html")
LARGEST_EMBEDDED = 30 * 1024 * 1024  # a larger video is linked, not embedded [bytes]
COLOURS = {  # of the verbs in the timeline
    "walk_to": "#5cadff",
    "walk_one_step": "#8fc5ff",
    "pick_up": "#ffcd56",
    "drop": "#56cc82",
    "explore": "#8791a3",
    "stop": "#ef5f54",
}


def write_page(path: Path, result: EpisodeResult, video: Path | None = None) -> None:
    """Write the page of `result`; a small `video` becomes part of it, a large one is linked relative to the page."""
    row = result.to_dict()
    environment = jinja2.Environment(
        autoescape=True, undefined=jinja2.StrictUndefined, trim_blocks=True, lstrip_blocks=True
    )
    page = environment.from_string(TEMPLATE.read_text(encoding="utf-8")).render(
        r=row,
        share=_percent(row["score"]["value"]),
        step="–" if row["score"]["step"] is None else f"{row['score']['step']:.1f}",
        damage=_percent(row["score"]["damage"]),
        saved=sum(f["rescued"] for f in row["targets"]),
        video=None if video is None else _source(video, path),
        colours=COLOURS,
        steps=_steps(result),
    )
    path.write_text(page, encoding="utf-8")


def _percent(share: float | None) -> str:
    return "–" if share is None else f"{100 * share:.1f} %"


def _source(video: Path, page: Path) -> str:
    if video.stat().st_size <= LARGEST_EMBEDDED:
        return "data:video/mp4;base64," + base64.b64encode(video.read_bytes()).decode("ascii")
    return Path(os.path.relpath(video.resolve(), page.resolve().parent)).as_posix()


def _steps(result: EpisodeResult) -> str:
    """The curve of value rescued over frames as the points of an SVG line, in a box of 1000 x 100."""
    end = max(1, result.max_frames)
    total = sum(f.value for f in result.targets)
    points, level = [(0.0, 100.0)], 0.0
    for fate in sorted((f for f in result.targets if f.frame is not None), key=lambda f: f.frame or 0):
        x = 1000.0 * (fate.frame or 0) / end
        points.append((x, 100.0 - 100.0 * level))
        level += fate.value * (DAMAGED_SHARE if fate.damaged else 1.0) / total
        points.append((x, 100.0 - 100.0 * level))
    points.append((1000.0 * result.frames / end, 100.0 - 100.0 * level))
    return " ".join(f"{x:.1f},{y:.1f}" for x, y in points)
