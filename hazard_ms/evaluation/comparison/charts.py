"""Charts as SVG for pages about many episodes: lines over frames, areas that add up, bars, intervals."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from html import escape

import numpy as np
from numpy.typing import NDArray

from hazard_ms.evaluation.metrics import Score

Curve = NDArray[np.float64]
Stroke = tuple[str, float]  # colour and width [pixels] of a line

AGENT_COLOURS = (  # one agent after the other; they begin again after the last
    "#5cadff",
    "#ff8a3d",
    "#56cc82",
    "#d98cff",
    "#ffcd56",
    "#ef5f54",
    "#4fd6d2",
    "#b0b8c6",
    "#ff9ecb",
    "#a4d65e",
)
FATE_COLOURS = {"rescued whole": "#56cc82", "rescued damaged": "#ffcd56", "whole": "#39414f", "damaged": "#ef5f54"}
OPACITY = {"done": 1.0, "unfinished": 0.55, "failed": 0.25}  # of bars of skills
SOFT, EDGE = "#949dab", "#2c313a"  # of words and of lines
LEFT, RIGHT, TOP, BOTTOM = 46.0, 22.0, 10.0, 26.0  # margins [pixels]
TICKS = 5  # steps of the axis of frames


def colour(number: int) -> str:
    """The colour of the agent with this number."""
    return AGENT_COLOURS[number % len(AGENT_COLOURS)]


def lines(
    curves: Mapping[str, Curve],
    frames: Curve,
    size: tuple[float, float] = (1000.0, 300.0),
    strokes: Mapping[str, Stroke] | None = None,
) -> str:
    """Shares, 0 to 1, over `frames`, one line for each name; the axis ends where the highest line does.

    `strokes`: how each line is drawn; if not given, in the colour of an agent.
    """
    strokes = strokes or {name: (colour(k), 2.2) for k, name in enumerate(curves)}
    highest = max(float(curve.max()) for curve in curves.values())
    step = 0.1 if highest <= 0.5 else 0.2
    top = step * max(1.0, np.ceil(highest / step - 1e-9))
    drawn = [
        f'<polyline points="{_points(frames, curve / top, float(frames[-1]), size)}" fill="none" '
        f'stroke="{strokes[name][0]}" stroke-width="{strokes[name][1]}"><title>{escape(name)}</title></polyline>'
        for name, curve in curves.items()
    ]
    return _chart([*_axes(float(frames[-1]), top, step, size), *drawn], size, "Value rescued over frames")


def areas(curves: Mapping[str, Curve], frames: Curve, size: tuple[float, float] = (480.0, 190.0)) -> str:
    """Shares that add up to 1 over `frames`, one above the other, in the colours of FATE_COLOURS."""
    end, low, drawn = float(frames[-1]), np.zeros_like(frames), []
    for name, share in curves.items():
        high = low + share
        outline = f"{_points(frames, high, end, size)} {_points(frames[::-1], low[::-1], end, size)}"
        drawn.append(f'<polygon points="{outline}" fill="{FATE_COLOURS[name]}"><title>{escape(name)}</title></polygon>')
        low = high
    return _chart([*drawn, *_axes(end, 1.0, 0.2, size)], size, "Fates of targets over frames")


def bars(rows: Mapping[str, Sequence[tuple[str, float, str, float]]], unit: str, width: float = 1000.0) -> str:
    """A bar for each agent, of pieces (words, length, colour, opacity) one beside the other; lengths in `unit`."""
    name_width, step, thick = 190.0, 28.0, 18.0  # [pixels]
    longest = max(max(sum(piece[1] for piece in pieces) for pieces in rows.values()), 1e-9)
    scale = (width - name_width - 90.0) / longest
    drawn = []
    for k, (name, pieces) in enumerate(rows.items()):
        x, y = name_width, 8.0 + k * step
        drawn.append(_text(name_width - 10.0, y + 13.5, name, "end", 13))
        for words, length, fill, opacity in pieces:
            title = f"<title>{escape(words)}</title>"
            drawn.append(
                f'<rect x="{x:.1f}" y="{y:.1f}" width="{max(length * scale - 0.6, 0.0):.1f}" height="{thick:.0f}" '
                f'fill="{fill}" opacity="{opacity}">{title}</rect>'
            )
            x += length * scale
        drawn.append(_text(x + 8.0, y + 13.5, f"{sum(piece[1] for piece in pieces):.0f} {unit}", "start"))
    return _chart(drawn, (width, 8.0 + step * len(rows)), f"Bars in {unit}")


def intervals(rows: Sequence[tuple[str, Score, str]], width: float = 480.0) -> str:
    """Shares, 0 to 1, one row for each (name, score, colour): a dot at the mean and a line over the interval."""
    name_width, step = 165.0, 28.0  # [pixels]
    across, bottom = width - name_width - RIGHT, 8.0 + step * len(rows)
    ends = [end for _, score, _ in rows for end in (score.low, score.high) if end is not None]
    low, high = (0.1 * np.floor(10.0 * min(ends, default=0.0)), 0.1 * np.ceil(10.0 * max(ends, default=1.0)))
    low, high = min(low, 0.0), max(high, low + 0.1)
    drawn = []
    for k in range(round(10.0 * (high - low)) + 1):
        x = name_width + across * k * 0.1 / (high - low)
        drawn.append(f'<line x1="{x:.1f}" x2="{x:.1f}" y1="0" y2="{bottom:.1f}" stroke="{EDGE}"/>')
        drawn.append(_text(x, bottom + 17.0, f"{100.0 * low + 10.0 * k:.0f}", "middle"))
    for k, (name, score, fill) in enumerate(rows):
        y = 8.0 + step * (k + 0.5)
        drawn.append(_text(name_width - 14.0, y + 4.5, name if len(name) <= 19 else f"{name[:18]}…", "end", 13))
        if score.mean is None or score.low is None or score.high is None:
            continue
        left, mid, right = (name_width + across * (s - low) / (high - low) for s in (score.low, score.mean, score.high))
        drawn.append(f'<line x1="{left:.1f}" x2="{right:.1f}" y1="{y}" y2="{y}" stroke="{fill}" stroke-width="3"/>')
        drawn.append(f'<circle cx="{mid:.1f}" cy="{y}" r="6" fill="{fill}"><title>{escape(name)}</title></circle>')
    return _chart(drawn, (width, bottom + BOTTOM), "Scores with their intervals")


def _chart(drawn: Sequence[str], size: tuple[float, float], label: str) -> str:
    box = f"0 0 {size[0]:.0f} {size[1]:.0f}"
    return f'<svg viewBox="{box}" role="img" aria-label="{escape(label)}">{"".join(drawn)}</svg>'


def _points(x: Curve, y: Curve, end: float, size: tuple[float, float]) -> str:
    """Points of a line through `x`, 0 to `end`, and `y`, 0 to 1."""
    across, up = size[0] - LEFT - RIGHT, size[1] - TOP - BOTTOM
    places = zip(LEFT + across * x / max(end, 1.0), TOP + up * (1.0 - y), strict=True)
    return " ".join(f"{px:.1f},{py:.1f}" for px, py in places)


def _axes(end: float, top: float, step: float, size: tuple[float, float]) -> list[str]:
    """Lines and numbers of the axes: frames from 0 to `end`, shares from 0 to `top` in per cent, one each `step`."""
    drawn = []
    for k in range(TICKS + 1):
        x = LEFT + (size[0] - LEFT - RIGHT) * k / TICKS
        drawn.append(_text(x, size[1] - 9.0, f"{end * k / TICKS:.0f}", "middle"))
    for k in range(round(top / step) + 1):
        y = size[1] - BOTTOM - (size[1] - TOP - BOTTOM) * k * step / top
        drawn.append(f'<line x1="{LEFT}" x2="{size[0] - RIGHT}" y1="{y:.1f}" y2="{y:.1f}" stroke="{EDGE}"/>')
        drawn.append(_text(LEFT - 6.0, y + 4.0, f"{100.0 * step * k:.0f} %", "end"))
    return drawn


def _text(x: float, y: float, words: str, anchor: str, size: int = 11) -> str:
    return (
        f'<text x="{x:.1f}" y="{y:.1f}" fill="{SOFT}" font-size="{size}" text-anchor="{anchor}">{escape(words)}</text>'
    )
