"""The decisions of a language model as one web page: what it was asked, what it said, and what was done.

With the result of the episode it shows the outcome, too, and with what `hazard-ms regret` wrote, what each choice gave
away and what the best plan would have done; with pictures, what could be seen at each decision.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from types import MappingProxyType
from typing import Any

from hazard_ms.evaluation.page import COLOURS, rendered, rescue_curve
from hazard_ms.evaluation.regret.causes import EpisodeRegret
from hazard_ms.evaluation.result import EpisodeResult
from hazard_ms.skills.failures import UNFINISHED

TEMPLATE = Path(__file__).with_name("decision_page.html")
NEEDED = ("frame", "asked", "options", "replies", "letter", "action", "note", "fallback")  # of a line of a trace
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
        steps=rescue_curve(result) if result is not None else "",
    )


def read_trace(path: Path) -> list[dict[str, Any]]:
    """The lines of a trace, in order. Raises ValueError for a file that is not a trace."""
    try:
        rows = [json.loads(line) for line in path.read_text(encoding="utf-8").splitlines()]
        for row in rows:
            missing = [name for name in NEEDED if name not in row]
            if missing:
                raise ValueError(f"a line without {', '.join(missing)}")
            for reply in row["replies"]:
                float(reply["seconds"]), int(reply["tokens"][0]), int(reply["tokens"][1])
    except (OSError, ValueError, LookupError, TypeError, AttributeError, RecursionError) as error:
        raise ValueError(f"trace must be a file that llm:trace=FOLDER wrote, got {path}: {error}") from None
    return rows
