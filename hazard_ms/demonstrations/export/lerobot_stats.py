"""Statistics of the columns of a LeRobot dataset, by which policies scale what they see and do."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

QUANTILES = {"q01": 0.01, "q10": 0.1, "q50": 0.5, "q90": 0.9, "q99": 0.99}
Stats = dict[str, dict[str, NDArray[Any]]]  # column -> name of the number -> [D], or [3, 1, 1] for pictures


def stats_of(column: NDArray[Any], picture: bool = False) -> dict[str, NDArray[Any]]:
    """Numbers [D] about a column [R, D], in its unit; pictures, [R, H, W, 3] from 0 to 255, count from 0 to 1."""
    count = len(column)
    if picture:
        column = column.reshape(-1, column.shape[-1]) / 255.0
    numbers = column.astype(np.float64)
    made = {
        "min": numbers.min(axis=0),
        "max": numbers.max(axis=0),
        "mean": numbers.mean(axis=0),
        "std": numbers.std(axis=0),
        **dict(zip(QUANTILES, np.quantile(numbers, list(QUANTILES.values()), axis=0), strict=True)),
    }
    made = {name: each[:, None, None] for name, each in made.items()} if picture else made
    return {**made, "count": np.array([count])}


def merged(parts: Sequence[Stats]) -> Stats:
    """Numbers about all episodes from those about each; quantiles are means over frames, as LeRobot merges them."""
    return {name: _merged([part[name] for part in parts]) for name in parts[0]}


def _merged(parts: Sequence[dict[str, NDArray[Any]]]) -> dict[str, NDArray[Any]]:
    stacked = {name: np.stack([part[name] for part in parts]) for name in parts[0]}
    counts = stacked["count"][:, 0]

    def mean(each: NDArray[Any]) -> NDArray[Any]:
        weighted: NDArray[Any] = np.average(each, axis=0, weights=counts)
        return weighted

    middle = mean(stacked["mean"])
    return {
        "min": stacked["min"].min(axis=0),
        "max": stacked["max"].max(axis=0),
        "mean": middle,
        "std": np.sqrt(mean(stacked["std"] ** 2 + (stacked["mean"] - middle) ** 2)),
        **{name: mean(stacked[name]) for name in QUANTILES},
        "count": np.array([counts.sum()]),
    }
