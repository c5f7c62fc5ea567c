"""The panels of a film beside its main view: the hazard over the camera's image, and the map of what has been seen."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import cv2
import numpy as np
from numpy.typing import NDArray

from hazard_ms.pictures.drawing import (
    BAD,
    BLUE,
    EDGE,
    GOLD,
    GOOD,
    PANEL,
    SOFT,
    TEXT,
    Colour,
    Pixels,
    chip,
    door,
    dot,
    paint,
    rounded,
    shorten,
    text_width,
    tool,
    write,
)
from hazard_ms.sensing.door_memory import KnownOpening
from hazard_ms.sensing.semantic_map import SemanticMap
from hazard_ms.sensing.target_table import Target
from hazard_ms.spec import Level

FLOOR = np.array((62, 69, 80), np.float32)  # colour of a height of 0
WALL = np.array((208, 213, 221), np.float32)  # of 2 m and more
LOW = 0.05  # share of the way from floor to wall up to which a cell is floor: 0.1 m [ours]
AROUND = (5, 5)  # cells around one of the floor that tell whether it was seen as a point or in an area [ours]
POINTS, AREA = 0.2, 0.5  # shares of these cells that were seen, of a row of points and of an area [ours]
FEW, MANY = 5.0, 10.0  # value from which a thing is worth much: where 5 is the most, and where values reach 20 [ours]
SHUT = 0.1  # share of its width up to which an open door is drawn as shut [ours]
TINTED = 0.9  # share of a hazard's tint on the map, at most


def high_value(values: Sequence[float]) -> float:
    """The value from which a thing is drawn as worth much, where all have these `values` [-]."""
    return MANY if max(values, default=0.0) > FEW else FEW


def cover(image: Pixels, width: int, height: int) -> Pixels:
    """`image` [H, W, 3], RGB, scaled to fill `width` x `height` [pixels]; what sticks out is cut off evenly."""
    if image.shape[:2] == (height, width):
        return image.copy()
    factor = max(width / image.shape[1], height / image.shape[0])
    size = max(width, round(image.shape[1] * factor)), max(height, round(image.shape[0] * factor))
    way = cv2.INTER_AREA if factor < 0.6 else cv2.INTER_LINEAR
    large = cv2.resize(image, size, interpolation=way)
    x, y = (size[0] - width) // 2, (size[1] - height) // 2
    return np.ascontiguousarray(large[y : y + height, x : x + width])


def share(values: NDArray[np.floating], level: Level) -> NDArray[np.floating]:
    """The places of `values`, [H, W] in the unit of `level`, on its scale: 0 at its low end, 1 at its high end [-]."""
    return (values - level.low) / (level.high - level.low)


def coloured(shares: NDArray[np.floating], level: Level) -> Pixels:
    """Colours, RGB, [H, W, 3], of `shares` [H, W], 0 to 1, in the colour map of `level`.

    Raises ValueError for a colour map that OpenCV does not have.
    """
    colours = getattr(cv2, f"COLORMAP_{level.colours.upper()}", None)
    if colours is None:
        raise ValueError(f"the colours of {level.title} must be a colour map of OpenCV, got {level.colours!r}")
    index = (np.clip(np.nan_to_num(shares), 0.0, 1.0) * 255).astype(np.uint8)
    return cv2.cvtColor(cv2.applyColorMap(index, colours), cv2.COLOR_BGR2RGB)


def strongest(most: Sequence[float], levels: Sequence[Level]) -> int:
    """Index of the hazard that reaches furthest up its scale; `most`: the highest number of each, in its unit."""
    return int(np.argmax([share(np.array(number), level) for number, level in zip(most, levels, strict=True)]))


def hazard_panel(head: Pixels, image: NDArray[np.floating], level: Level, most: float) -> Pixels:
    """The hazard `image` over the greyed image of the `head` camera, with a colour scale: [S, S, 3], RGB.

    `image`: [16, 16], in the unit of `level`; `head`: [S, S, 3], RGB; `most`: the highest number, which is told.
    """
    side = len(head)
    grey = cv2.cvtColor(head, cv2.COLOR_RGB2GRAY)
    smooth = np.asarray(cv2.resize(image.astype(np.float32), (side, side), interpolation=cv2.INTER_LINEAR), np.float32)
    warm = coloured(share(smooth, level), level)
    panel: Pixels = cv2.addWeighted(warm, 0.72, cv2.cvtColor(grey, cv2.COLOR_GRAY2RGB), 0.42, 0.0).astype(
        np.uint8, copy=False
    )
    bar = np.broadcast_to(np.linspace(0.0, 1.0, side - 40)[None], (8, side - 40))
    panel[-46:] = (panel[-46:] * 0.45).astype(np.uint8)
    panel[-18:-10, 20:-20] = coloured(bar, level)
    write(panel, f"{level.low:g}", (20, side - 38), 13)
    write(panel, f"{level.high:g}", (side - 20, side - 38), 13, align="right")
    shown = f"{most:.0f}" if level.high > 10 else f"{most:.2f}"
    text = shorten(f"highest {shown} {level.unit}", 13, side - 120) if np.isfinite(most) else "nothing near"
    write(panel, text, (side // 2, side - 38), 13, TEXT, "middle")
    return panel


def _spread(values: NDArray[np.floating]) -> NDArray[np.floating]:
    """`values`, [H, W], with the mean of those around it in place of each NaN; 0 where there is none."""
    known = np.isfinite(values).astype(np.float32)
    total = cv2.blur(np.nan_to_num(values).astype(np.float32), AROUND)
    return np.where(known > 0.0, values, total / np.maximum(cv2.blur(known, AROUND), 1e-6))


@dataclass
class MapPanel:
    """Draws the semantic map; the window grows with what was explored and never jumps back."""

    width: int
    height: int
    levels: tuple[Level, ...]  # of the hazards of the map
    window: list[float] = field(default_factory=list)  # west, south, east, north [m]
    openings: Sequence[KnownOpening] = ()  # of which doors are drawn, with their numbers
    tools: Sequence[int] = ()  # things that can be used, as `seen.objects` knows them
    # south-west and north-east of all that was explored [m]
    _reach: list[NDArray[np.float64]] = field(default_factory=list)

    def draw(
        self,
        seen: SemanticMap,
        targets: Sequence[Target],
        names: Sequence[str],
        agent: tuple[float, float, float],
        path: Sequence[tuple[float, float]],
        goal: str | None,
    ) -> Pixels:
        """The panel, RGB, [height, width, 3].

        `agent`: x, y [m] and heading [rad]; `path`: where it has been [m]; `goal`: the thing that it acts on.
        """
        self._grow(seen, agent)
        image = self._ground(seen)
        if len(path) > 1:
            line = np.array([self.pixel(p) for p in path], np.int32)
            cv2.polylines(image, [line], False, BLUE, 2, cv2.LINE_AA)
        for opening in self.openings:
            if opening.kind == "door":
                door(image, self.pixel(opening.position), str(opening.number), opening.open < SHUT, opening.broken)
        for index in self.tools:
            if index in seen.objects:
                tool(image, self.pixel(seen.objects[index].position))
        worth = high_value([target.value for target in targets])
        for target in sorted(targets, key=lambda t: t.name == goal):  # the goal last, so that nothing hides its name
            self._target(image, seen, target, target.name == goal, worth)
        if goal in names and names.index(goal) in seen.objects and goal not in {t.name for t in targets}:
            position = seen.objects[names.index(goal)].position
            cv2.circle(image, self.pixel(position), 9, SOFT, 2, cv2.LINE_AA)
        self._agent(image, agent)
        self._legend(image, worth)
        return image

    def pixel(self, position: NDArray[np.floating] | tuple[float, ...]) -> tuple[int, int]:
        """The pixel (x, y) of the panel at which a place, [2] or [3] [m], is."""
        west, _, _, north = self.window
        zoom = self.zoom
        return round((float(position[0]) - west) * zoom), round((north - float(position[1])) * zoom)

    @property
    def zoom(self) -> float:
        """Pixels per metre."""
        return self.width / (self.window[2] - self.window[0])

    def _grow(self, seen: SemanticMap, agent: tuple[float, float, float]) -> None:
        y, x = np.nonzero(seen.explored)
        corners = np.array([[agent[0], agent[1]]] * 2, float)
        if len(y):
            low, high = np.array([x.min(), y.min()]), np.array([x.max() + 1, y.max() + 1])
            corners = np.stack([seen.origin + seen.cell * low, seen.origin + seen.cell * high])
        low, high = corners[0] - 0.3, corners[1] + 0.3  # a margin [m]
        if self._reach:
            low, high = np.minimum(low, self._reach[0]), np.maximum(high, self._reach[1])
        self._reach = [low, high]
        zoom = min(self.width / (high[0] - low[0]), self.height / (high[1] - low[1]), 120.0)
        middle, half = (low + high) / 2, np.array([self.width, self.height]) / zoom / 2
        self.window = [*(middle - half).tolist(), *(middle + half).tolist()]

    def _ground(self, seen: SemanticMap) -> Pixels:
        """Floor, furniture and walls as greys, tinted by the hazard that is strongest there.

        Unexplored cells have the colour of the panel. Floor far away, of which a look finds single points in rows,
        fades into it, and what was seen without its hazard has the mean tint around it: both would be stripes.
        """
        west, south, east, north = self.window
        x0, y0 = np.maximum(np.floor((np.array([west, south]) - seen.origin) / seen.cell).astype(int), 0)
        x1, y1 = np.maximum(np.ceil((np.array([east, north]) - seen.origin) / seen.cell).astype(int), 1)
        part = np.s_[y0:y1, x0:x1]
        tall = np.clip(seen.height[part] / 2.0, 0.0, 1.0)[..., None]
        cells = FLOOR * (1 - tall) + WALL * tall
        shares = [_spread(share(of[part], level)) for of, level in zip(seen.levels, self.levels, strict=True)]
        tints = np.array([level.tint for level in self.levels], np.float32)[np.argmax(shares, axis=0)]
        cells += np.clip(np.max(shares, axis=0), 0.0, TINTED)[..., None] * (tints - cells)
        known = seen.explored[part]
        area = np.clip((cv2.blur(known.astype(np.float32), AROUND) - POINTS) / (AREA - POINTS), 0.0, 1.0)
        shown = known * np.where(tall[..., 0] > LOW, 1.0, area)
        cells = PANEL + shown[..., None] * (cells - PANEL)
        corner = seen.origin + seen.cell * np.array([x0, y0])
        edge, zoom = self.zoom * seen.cell, self.zoom
        across, down = (corner[0] - west) * zoom, (north - corner[1]) * zoom
        matrix = np.array([[edge, 0.0, across + edge / 2], [0.0, -edge, down - edge / 2]])
        size = (self.width, self.height)
        drawn = cv2.warpAffine(cells.astype(np.uint8), matrix, size, flags=cv2.INTER_NEAREST, borderValue=PANEL)
        return drawn.astype(np.uint8, copy=False)

    def _target(self, image: Pixels, seen: SemanticMap, target: Target, wanted: bool, worth: float) -> None:
        sighting = seen.objects.get(target.index)
        if sighting is None or target.rescued or target.held:
            return
        x, y = self.pixel(sighting.position)
        colour = BAD if target.damaged else GOLD if target.value >= worth else GOOD
        dot(image, (x, y), 6.5, PANEL)
        dot(image, (x, y), 5.0, colour)
        if wanted:
            cv2.circle(image, (x, y), 10, TEXT, 2, cv2.LINE_AA)
            left = x + 14 if x + 20 + text_width(target.name, 13) < self.width else x - 22 - text_width(target.name, 13)
            chip(image, target.name, (left, y - 11), 13, TEXT, PANEL)

    def _agent(self, image: Pixels, agent: tuple[float, float, float]) -> None:
        x, y = self.pixel(agent[:2])
        turn = np.array([0.0, 2.5, np.pi, -2.5]) - agent[2]
        reach = np.array([13.0, 11.0, 3.0, 11.0])
        points = np.stack([x + reach * np.cos(turn), y + reach * np.sin(turn)], -1)
        cv2.fillPoly(image, [(points * 16).astype(np.int32)], BLUE, cv2.LINE_AA, shift=4)
        cv2.polylines(image, [(points * 16).astype(np.int32)], True, TEXT, 1, cv2.LINE_AA, shift=4)

    def _legend(self, image: Pixels, worth: float) -> None:
        high, low = ("value 5", "value 1") if worth == FEW else (f"value {worth:g} and more", "less")
        entries: tuple[tuple[str, Colour], ...] = ((high, GOLD), (low, GOOD), ("damaged", BAD))
        width = sum(text_width(text, 12) + 30 for text, _ in entries) + 4
        x, y = self.width - width - 8, self.height - 30
        paint(image, rounded(width, 22, 8) * 0.8, (x, y), PANEL)
        for text, colour in entries:
            dot(image, (x + 14, y + 11), 4.5, colour)
            write(image, text, (x + 24, y + 3), 12, TEXT)
            x += text_width(text, 12) + 30
        cv2.rectangle(image, (0, 0), (self.width - 1, self.height - 1), EDGE, 1)
