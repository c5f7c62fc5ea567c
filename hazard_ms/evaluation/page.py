"""One episode as a web page that needs nothing else: film, score, timeline, fates, decisions, and its command."""

from __future__ import annotations

import base64
import os
from pathlib import Path
from typing import Any
from urllib.parse import quote

import jinja2

from hazard_ms.evaluation.choices import team_names
from hazard_ms.evaluation.result import EpisodeResult
from hazard_ms.skills.failures import UNFINISHED

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

LOADS = {  # on the robot: how each is shown, and what it is
    "heat": ("%.3f", "dose of heat; 1: unbearable"),
    "wading": ("%.1f s", "in water"),
    "water": ("%.2f m s", "depth of water, over time"),
    "collisions": ("%d", "collisions"),
}


def page(result: EpisodeResult, video: str | None = None) -> str:
    """The page of `result`, HTML; `video`: address of its film, as `address` gives it."""
    row = result.to_dict()
    return rendered(
        TEMPLATE,
        r=row,
        share=_percent(row["score"]["value"]),
        step="–" if row["score"]["step"] is None else f"{row['score']['step']:.1f}",
        damage=_percent(row["score"]["damage"]),
        averted=_percent(row["score"].get("averted")),
        loads=LOADS,
        saved=sum(f["rescued"] for f in row["targets"]),
        video=video,
        colours=COLOURS,
        unfinished=UNFINISHED,
        robots=robots_of(result),
        steps=rescue_curve(result),
    )


def robots_of(result: EpisodeResult) -> tuple[str, ...]:
    """The robots to which timeline.html gives a row: those of a team by name, or "" for a single one."""
    return team_names(result.settings.get("robot_uids")) or ("",)


def rendered(template: Path, **values: Any) -> str:
    """The page that `template` makes of `values`; it may include style.css and timeline.html, which pages share."""
    environment = jinja2.Environment(
        loader=jinja2.FileSystemLoader([template.parent, TEMPLATE.parent]),
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    return environment.get_template(template.name).render(**values)


def address(video: Path, name: str) -> str:
    """The address of a film for a page beside it: a small film itself, else its `name` as a relative link.

    `video` is where the film is now. Raises OSError where it cannot be read.
    """
    if video.stat().st_size <= LARGEST_EMBEDDED:
        return "data:video/mp4;base64," + base64.b64encode(video.read_bytes()).decode("ascii")
    return quote(name, errors="surrogateescape")


def link(target: Path, source: Path) -> str | None:
    """The address of a file for the page `source`; None where there is no such file, or only a link to one."""
    if not target.is_file() or target.is_symlink():
        return None
    return quote(os.path.relpath(target.resolve(), source.resolve().parent), errors="surrogateescape")


def _percent(share: float | None) -> str:
    return "–" if share is None else f"{100 * share:.1f} %"


def rescue_curve(result: EpisodeResult) -> str:
    """The curve of value rescued over frames as the points of an SVG line for timeline.html, in a box of 1000 x 100."""
    end = max(1, result.max_frames)
    total = sum(f.value for f in result.targets)
    points, level = [(0.0, 100.0)], 0.0
    for fate in sorted((f for f in result.targets if f.frame is not None), key=lambda f: f.frame or 0):
        x = 1000.0 * (fate.frame or 0) / end
        points.append((x, 100.0 - 100.0 * level))
        level += fate.worth / total
        points.append((x, 100.0 - 100.0 * level))
    points.append((1000.0 * result.frames / end, 100.0 - 100.0 * level))
    return " ".join(f"{x:.1f},{y:.1f}" for x, y in points)
