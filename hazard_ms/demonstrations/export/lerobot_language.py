"""The sentences of an episode as LeRobot has them from 0.6 on: the column `language_persistent`.

Every row of an episode holds the whole list of its sentences, each with the time from which on it holds until the next
of its style does.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

COLUMN = "language_persistent"
FEATURE: dict[str, Any] = {"dtype": "language", "shape": [1], "names": None}  # in info.json
ROLE, STYLE = "assistant", "subtask"  # whose words they are, and of what
FIELDS = ("role", "content", "style", "timestamp", "camera", "tool_calls")  # of a sentence, as LeRobot orders them
MOST_SENTENCES = 10_000  # of an episode [ours]


def sentences(running: NDArray[np.int64], times: NDArray[np.float32], texts: Sequence[str]) -> list[dict[str, Any]]:
    """The sentences of an episode of R rows: a new one wherever another of the `texts` is `running`, [R].

    `times` are those of the rows [s], [R].

    Raises ValueError for more than MOST_SENTENCES.
    """
    starts = [0, *(np.flatnonzero(np.diff(running)) + 1).tolist()] if len(running) else []
    if len(starts) > MOST_SENTENCES:
        raise ValueError(f"an episode must have at most {MOST_SENTENCES} skills, got {len(starts)}")
    made = []
    for row in starts:
        given = (ROLE, texts[int(running[row])], STYLE, float(times[row]), None, None)
        made.append(dict(zip(FIELDS, given, strict=True)))
    return made


def as_column(told: Sequence[dict[str, Any]], rows: int) -> Any:
    """The column of an episode with so many `rows`, as pyarrow holds it."""
    import pyarrow as pa

    text, number = pa.string(), pa.float32()
    kinds = dict(zip(FIELDS, (text, text, text, number, text, pa.null()), strict=True))
    entry = pa.struct([pa.field(name, kind) for name, kind in kinds.items()])
    one = pa.array([list(told)], pa.list_(entry))
    return pa.concat_arrays([one] * rows) if rows else one[:0]
