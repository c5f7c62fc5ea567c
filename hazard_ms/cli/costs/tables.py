"""Tables as the benches print them: Markdown that is legible as plain text, too."""

from __future__ import annotations

from collections.abc import Sequence

LEAST = 2  # characters of a column: Markdown's rule of a column of numbers is "-:" at least


def table(headings: Sequence[str], rows: Sequence[Sequence[str]], words: int = 1) -> str:
    """A table with columns of equal width; the first `words` columns hold words, the others numbers."""
    widths = [max(LEAST, *(len(row[i]) for row in (headings, *rows))) for i in range(len(headings))]

    def line(cells: Sequence[str]) -> str:
        aligned = [c.ljust(w) if i < words else c.rjust(w) for i, (c, w) in enumerate(zip(cells, widths, strict=True))]
        return "| " + " | ".join(aligned) + " |"

    rule = ["-" * width if i < words else "-" * (width - 1) + ":" for i, width in enumerate(widths)]
    return "\n".join([line(headings), line(rule), *map(line, rows)])
