"""The pictures of a film: third person, head camera, hazard and map side by side, with captions of action and score."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hazard_ms.pictures.drawing import (
    ACCENT,
    BAD,
    EDGE,
    GOLD,
    GOOD,
    NIGHT,
    PANEL,
    SOFT,
    TEXT,
    Pixels,
    chip,
    dot,
    paint,
    place,
    rounded,
    shorten,
    text_width,
    write,
)
from hazard_ms.pictures.panels import MapPanel, cover, hazard_panel, high_value, strongest
from hazard_ms.sensing.door_memory import KnownOpening
from hazard_ms.sensing.semantic_map import SemanticMap
from hazard_ms.sensing.target_table import Target
from hazard_ms.spec import Level

WIDTH, HEIGHT = 1280, 720
GAP = 12  # between panels
TOP = 52  # of the panels, below the title
MAIN = (760, 564)  # the third person's view, width and height
RENDERED = (560, 416)  # it is rendered a little smaller, which saves a third of the time of a film on a CPU
SIDE = 236  # of the head camera's and the hazard's image
BOTTOM = TOP + MAIN[1] + GAP  # of the line above the caption
CAPTION = BOTTOM + 16  # top of the caption


@dataclass(frozen=True)
class Shot:
    """Everything that one frame of the video shows."""

    third_person: Pixels
    head: Pixels
    level: NDArray[np.floating] | None  # [K, 16, 16], of the task's K hazards in their units
    told: tuple[float, ...]  # the highest number of each of them, as `hazard_ms.pictures.peak_levels` finds it
    map: SemanticMap
    names: tuple[str, ...]  # of the things that the map refers to by index
    targets: tuple[Target, ...]
    frame: int
    max_frames: int
    agent: tuple[float, float, float]  # x, y [m], heading [rad]
    path: tuple[tuple[float, float], ...]  # where the agent has been [m]
    verb: str
    target: str | None
    note: str  # why the agent chose this
    held: str | None
    value: float  # share of the value rescued so far
    openings: tuple[KnownOpening, ...] = ()  # doors and windows that were seen
    tools: tuple[int, ...] = ()  # things that can be used, as the map refers to them
    news: str = ""  # shown over the main view for a while: a rescue, a failure
    good_news: bool = True


class Compositor:
    """Puts the frames of one video together."""

    def __init__(self, title: str, subtitle: str, levels: tuple[Level, ...]) -> None:
        """`title`: what is played; `subtitle`: by whom and with which seed; `levels`: of the task's K hazards."""
        self._levels = levels
        self._map = MapPanel(2 * SIDE + GAP, MAIN[1] - SIDE - GAP, levels)
        self._sheet = titled(title, subtitle)

    def compose(self, shot: Shot) -> Pixels:
        """The frame of the video that shows `shot`: [720, 1280, 3], uint8, RGB."""
        sheet = self._sheet.copy()
        main_view(sheet, shot)
        left = GAP * 2 + MAIN[0]
        head = cover(shot.head, SIDE, SIDE)
        place(sheet, self._hazard(head, shot), (left + SIDE + GAP, TOP))
        place(sheet, labelled(head, "head camera"), (left, TOP))
        self._map.openings, self._map.tools = shot.openings, shot.tools
        plan = self._map.draw(shot.map, shot.targets, shot.names, shot.agent, shot.path, shot.target)
        place(sheet, labelled(plan, "what the robot has seen"), (left, TOP + SIDE + GAP))
        self._caption(sheet, shot)
        return sheet

    def _hazard(self, head: Pixels, shot: Shot) -> Pixels:
        """The panel of the hazard that is strongest in view."""
        images = shot.level
        if images is None or not np.isfinite(images).any(axis=(1, 2)).all():
            return labelled(head.copy(), "no hazard image")
        which = strongest(shot.told, self._levels)
        level = self._levels[which]
        return labelled(hazard_panel(head, images[which], level, shot.told[which]), level.title)

    def _caption(self, sheet: Pixels, shot: Shot) -> None:
        y = CAPTION
        verb = shot.verb.replace("_", " ")
        write(sheet, verb, (GAP + 4, y), 24, ACCENT)
        if shot.target is not None:
            write(sheet, shorten(shot.target, 24, 240), (GAP + 14 + text_width(verb, 24), y), 24)
        write(sheet, shorten(shot.note, 15, 400), (GAP + 4, y + 34), 15, SOFT)
        holding = f"holding {shot.held}" if shot.held is not None else "empty hand"
        progress(sheet, shot, holding)


def titled(title: str, subtitle: str) -> Pixels:
    """An empty sheet, [720, 1280, 3], RGB, with `title` and `subtitle`."""
    sheet = np.full((HEIGHT, WIDTH, 3), NIGHT, np.uint8)
    dot(sheet, (GAP + 12, TOP // 2), 7.0, ACCENT)
    write(sheet, title, (GAP + 30, 13), 21)
    write(sheet, subtitle, (WIDTH - GAP - 4, 17), 16, SOFT, "right")
    return sheet


def labelled(panel: Pixels, text: str) -> Pixels:
    """The `panel`, [H, W, 3], RGB, with `text` in its corner."""
    chip(panel, text, (10, 10), 13, TEXT, PANEL)
    return panel


def main_view(sheet: Pixels, shot: Shot) -> None:
    """Place the third person's view with the news on a `sheet`, [720, 1280, 3], RGB."""
    main = cover(shot.third_person, *MAIN)
    if shot.news:
        chip(main, shot.news, (16, MAIN[1] - 52), 20, TEXT, (24, 110, 62) if shot.good_news else (142, 44, 38), 0.9)
    place(sheet, main, (GAP, TOP))


def progress(sheet: Pixels, shot: Shot, more: str) -> None:
    """Write time, targets and value of `shot`, and `more`, on a `sheet`, [720, 1280, 3], RGB."""
    width = WIDTH - 2 * GAP
    done = min(1.0, shot.frame / max(1, shot.max_frames))
    sheet[BOTTOM : BOTTOM + 4, GAP : GAP + width] = EDGE
    sheet[BOTTOM : BOTTOM + 4, GAP : GAP + max(1, round(width * done))] = ACCENT
    y = CAPTION
    _squares(sheet, shot, 450, y)
    saved = sum(t.rescued for t in shot.targets)
    write(sheet, shorten(f"{saved} of {len(shot.targets)} rescued, {more}", 15, 530), (450, y + 34), 15, SOFT)
    write(sheet, f"{shot.value:.0%}", (1010, y - 2), 30, GOOD if shot.value > 0 else TEXT)
    write(sheet, "value rescued", (1010, y + 34), 15, SOFT)
    write(sheet, f"{shot.frame}", (WIDTH - GAP - 4, y - 2), 30, TEXT, "right")
    write(sheet, f"of {shot.max_frames} frames", (WIDTH - GAP - 4, y + 34), 15, SOFT, "right")


def _squares(sheet: Pixels, shot: Shot, x: int, y: int) -> None:
    """One square per target: filled green when rescued, red when damaged; a gold edge marks the high value."""
    side = 22 if len(shot.targets) <= 18 else 14
    worth = high_value([target.value for target in shot.targets])
    for i, target in enumerate(shot.targets):
        left = x + i * (side + 6)
        fill = GOOD if target.rescued else BAD if target.damaged else ACCENT if target.held else EDGE
        edge = GOLD if target.value >= worth else SOFT
        paint(sheet, rounded(side, side, 5), (left, y + 4), edge)
        paint(sheet, rounded(side - 4, side - 4, 4), (left + 2, y + 6), fill)
        if target.rescued and target.damaged:
            paint(sheet, rounded(side - 12, side - 12, 3), (left + 6, y + 10), BAD)
