"""The decisions of a language model as one web page: what it was asked, what it said, and what was done.

With the result of the episode it shows the outcome, too, and with what `hazard-ms regret` wrote, what each choice gave
away and what the best plan would have done; with pictures, what could be seen at each decision.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from types import MappingProxyType
from typing import Any

from hazard_ms.evaluation.page import COLOURS, rendered, rescue_curve, robots_of
from hazard_ms.evaluation.regret.causes import EpisodeRegret
from hazard_ms.evaluation.result import EpisodeResult
from hazard_ms.skills.failures import UNFINISHED
from hazard_ms.spec.foreign.files import printable, read_text
from hazard_ms.spec.foreign.plain import Limits, made, parse

TEMPLATE = Path(__file__).with_name("decision_page.html")
LARGEST = 100_000_000  # size of a trace [bytes] [ours]
Objects = tuple[dict[str, Any], ...]
TYPES: dict[str, Any] = {  # of a line of a trace
    "frame": int,
    "asked": Objects,
    "options": dict[str, str],
    "replies": Objects,
    "letter": str,
    "action": str,
    "note": str,
    "fallback": bool,
}
REPLY: dict[str, Any] = {
    "text": str,
    "thought": str,
    "seconds": float,
    "tokens": tuple[int, int],
    "cached": bool,
    "refused": bool,
    "truncated": bool,
}
AT_LEAST: Mapping[str, Any] = MappingProxyType({"thought": "", "cached": False, "refused": False, "truncated": False})
WITHIN = Limits(farthest=1e9, longest_text=2_000_000)
NO_VIEWS: Mapping[int, tuple[str, str]] = MappingProxyType({})
FREE = 0.0005  # share of the value that a choice may give away and still count as the best


def decision_page(
    trace: list[dict[str, Any]],
    title: str,
    result: EpisodeResult | None = None,
    regret: EpisodeRegret | None = None,
    views: Mapping[int, tuple[str, str]] = NO_VIEWS,
) -> str:
    """The page of a trace, HTML; `views`: by frame, the head camera's picture and a map, as data URLs."""
    done = {} if result is None else {record.frame: record for record in result.decisions}
    judged = {} if regret is None else {each.frame: each for each in regret.decisions}
    calls = [reply for row in trace for reply in row["replies"]]
    return rendered(
        TEMPLATE,
        title=title,
        rows=[
            {
                **row,
                "record": done.get(row["frame"]),
                "judged": judged.get(row["frame"]),
                "views": views.get(row["frame"]),
            }
            for row in trace
        ],
        calls=len(calls),
        seconds=sum(reply["seconds"] for reply in calls),
        tokens=[sum(reply["tokens"][k] for reply in calls) for k in (0, 1)],
        fallbacks=sum(row["fallback"] for row in trace),
        r=result,
        unfinished=UNFINISHED,
        free=FREE,
        colours=COLOURS,
        robots=("",) if result is None else robots_of(result),
        steps=rescue_curve(result) if result is not None else "",
    )


def read_trace(path: Path) -> list[dict[str, Any]]:
    """The lines of a trace, in order. Raises ValueError for a file that is not a trace."""
    try:
        lines = read_text(path, LARGEST, "the trace").splitlines()
        return [_row(parse(line, f"line {k + 1}"), f"line {k + 1}") for k, line in enumerate(lines)]
    except ValueError as error:
        shown = printable(str(path))
        raise ValueError(f"trace must be a file that llm:trace=FOLDER wrote, got {shown}: {error}") from None


def _row(row: Any, where: str) -> dict[str, Any]:
    """A line of a trace. Raises ValueError for one that lacks something or holds something of another type."""
    known = row if isinstance(row, dict) else {}
    missing = [name for name in TYPES if name not in known]
    if missing:
        raise ValueError(f"{where} must have {', '.join(missing)}, got none")
    typed = {name: made(kind, known[name], f"{where}.{name}", WITHIN) for name, kind in TYPES.items()}
    typed["asked"] = [
        {name: made(str, each.get(name), f"{where}.asked.{name}", WITHIN) for name in ("role", "content")}
        for each in typed["asked"]
    ]
    typed["replies"] = [
        {
            name: made(kind, each.get(name, AT_LEAST.get(name)), f"{where}.replies.{name}", WITHIN)
            for name, kind in REPLY.items()
        }
        for each in typed["replies"]
    ]
    return typed
