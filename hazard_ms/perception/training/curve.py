"""The curve of a training as CSV and as a picture."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from html import escape

Row = Mapping[str, float]
WIDTH, HEIGHT, MARGIN = 640.0, 220.0, 46.0  # of each of the two charts, and around it [pixels]
COLOURS = ("#1f6fb4", "#d1621c", "#2c8f4d", "#7d4bb0", "#b08d12", "#b8342b", "#157f85", "#6b7280")


def csv_of(rows: Sequence[Row]) -> str:
    """One line for each of `rows`, with the columns of all of them; empty where a row has no number."""
    names = list(dict.fromkeys(name for row in rows for name in row))
    lines = [",".join(f"{row[name]:.6g}" if name in row else "" for name in names) for row in rows]
    return "\n".join([",".join(names), *lines, ""])


def svg_of(rows: Sequence[Row], scores: Sequence[str]) -> str:
    """The loss with its parts over the steps, and below it the columns `scores`, from 0 to 1 each."""
    parts = [name for name in dict.fromkeys(name for row in rows for name in row) if name.startswith("loss")]
    charts = [(parts, max((row[n] for row in rows for n in parts if n in row), default=1.0)), (list(scores), 1.0)]
    total = 2 * (HEIGHT + MARGIN)
    drawn = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH + 2 * MARGIN:.0f} {total:.0f}" '
        f'font-family="sans-serif" font-size="11"><rect width="100%" height="100%" fill="white"/>'
    ]
    for number, (names, highest) in enumerate(charts):
        drawn += _chart(rows, names, highest, number * (HEIGHT + MARGIN) + 12.0)
    return "\n".join([*drawn, "</svg>", ""])


def _chart(rows: Sequence[Row], names: Sequence[str], highest: float, top: float) -> list[str]:
    """Lines of the columns `names` over the steps, from 0 to `highest`, below `top`."""
    end = max((row["step"] for row in rows), default=1.0)
    low = top + HEIGHT - MARGIN / 2
    drawn = []
    for k in range(5):
        y, x = low - (low - top) * k / 4, MARGIN + WIDTH * k / 4
        drawn.append(f'<line x1="{MARGIN}" x2="{MARGIN + WIDTH}" y1="{y:.1f}" y2="{y:.1f}" stroke="#d5d9df"/>')
        drawn.append(f'<text x="{MARGIN - 6}" y="{y + 4:.1f}" text-anchor="end">{highest * k / 4:.3g}</text>')
        drawn.append(f'<text x="{x:.1f}" y="{low + 16:.1f}" text-anchor="middle">{end * k / 4:,.0f}</text>')
    for k, name in enumerate(names):
        known = [(row["step"], row[name]) for row in rows if name in row and math.isfinite(row[name])]
        places = [(MARGIN + WIDTH * step / end, low - (low - top) * value / highest) for step, value in known]
        points = " ".join(f"{x:.1f},{y:.1f}" for x, y in places)
        colour = COLOURS[k % len(COLOURS)]
        drawn.append(f'<polyline points="{points}" fill="none" stroke="{colour}" stroke-width="1.8"/>')
        x, y = MARGIN + WIDTH - 4, top + 12 + 14 * k
        drawn.append(f'<text x="{x}" y="{y}" text-anchor="end" fill="{colour}">{escape(name)}</text>')
    return drawn
