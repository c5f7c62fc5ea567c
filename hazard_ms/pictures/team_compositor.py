"""The pictures of a film of a team: third person, and a row for each robot with its head camera and its map."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace

from hazard_ms.pictures.compositor import (
    CAPTION,
    GAP,
    MAIN,
    SIDE,
    TOP,
    Shot,
    labelled,
    main_view,
    progress,
    titled,
)
from hazard_ms.pictures.drawing import ACCENT, SOFT, TEXT, Pixels, place, shorten, text_width, write
from hazard_ms.pictures.panels import MapPanel, cover
from hazard_ms.spec import Level

LEFT, ACROSS = GAP * 2 + MAIN[0], 2 * SIDE + GAP  # of the rows: where they begin, and their width
LINE = 28  # height of a row's line of text
WIDEST = 200  # a head camera's picture, at most


class TeamCompositor:
    """Puts the frames of one video together."""

    def __init__(self, title: str, subtitle: str, levels: tuple[Level, ...], names: Sequence[str]) -> None:
        """`title`: what is played; `subtitle`: by whom and with which seed; `levels`: of the task's hazards.

        `names`: those of the robots.
        """
        self._row = (MAIN[1] + GAP) // len(names)  # from the top of one row to that of the next
        self._high = self._row - GAP - LINE
        self._head = min(self._high, WIDEST)
        self._maps = {name: MapPanel(ACROSS - GAP - self._head, self._high, levels) for name in names}
        self._sheet = titled(title, subtitle)

    def compose(self, shots: Mapping[str, Shot], stopped: Collection[str], collisions: int) -> Pixels:
        """The frame of the video: [720, 1280, 3], uint8, RGB.

        `shots`: what it shows of each robot; `stopped`: those that have stopped for good; `collisions`: of robots with
        one another, so far.
        """
        sheet = self._sheet.copy()
        first = next(iter(shots.values()))
        main_view(sheet, first)
        for number, (name, shot) in enumerate(shots.items()):
            self._robot(sheet, name, shot, TOP + number * self._row, name in stopped)
        write(sheet, f"{len(shots)} robots", (GAP + 4, CAPTION), 24, ACCENT)
        write(sheet, f"collisions with one another: {collisions}", (GAP + 4, CAPTION + 34), 15, SOFT)
        held = {shot.held for shot in shots.values()} - {None}
        targets = tuple(replace(target, held=target.name in held) for target in first.targets)
        progress(sheet, replace(first, targets=targets), f"{len(held)} in hands")
        return sheet

    def _robot(self, sheet: Pixels, name: str, shot: Shot, top: int, stopped: bool) -> None:
        """Draw the row of one robot: what it does, and below that its head camera and its map."""
        verb = shot.verb.replace("_", " ") or ("has stopped" if stopped else "stands")
        x = LEFT + text_width(name, 15) + 12
        write(sheet, name, (LEFT + 2, top + 3), 15, SOFT)
        write(sheet, verb, (x, top + 3), 15, ACCENT)
        x += text_width(verb, 15) + 8
        write(sheet, shorten(_on(shot), 15, LEFT + ACROSS - x), (x, top + 3), 15, TEXT)
        place(sheet, labelled(cover(shot.head, self._head, self._high), "head camera"), (LEFT, top + LINE))
        drawn = self._maps[name]
        drawn.openings, drawn.tools = shot.openings, shot.tools
        plan = drawn.draw(shot.map, shot.targets, shot.names, shot.agent, shot.path, shot.target)
        place(sheet, labelled(plan, "what it has seen"), (LEFT + self._head + GAP, top + LINE))


def _on(shot: Shot) -> str:
    """What a robot does something with, and what it holds meanwhile, where that is another thing."""
    holding = f"holding {shot.held}" if shot.held not in (None, shot.target) else ""
    return ", ".join(filter(None, (shot.target, holding)))
