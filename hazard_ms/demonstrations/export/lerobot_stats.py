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
    each = [_numbers(column[:, k].astype(np.float64)) for k in range(column.shape[1])]  # one by one, to spare memory
    made = {name: np.array([numbers[name] for numbers in each]) for name in each[0]}
    made = {name: values[:, None, None] for name, values in made.items()} if picture else made
    return {**made, "count": np.array([count])}


def _numbers(values: NDArray[np.float64]) -> dict[str, float]:
    """Numbers about `values`, [R]."""
    quantiles = zip(QUANTILES, np.quantile(values, list(QUANTILES.values())), strict=True)
    return {"min": values.min(), "max": values.max(), "mean": values.mean(), "std": values.std(), **dict(quantiles)}


def joined(parts: Sequence[dict[str, NDArray[Any]]]) -> dict[str, NDArray[Any]]:
    """Numbers [D] about a column from those about its parts side by side."""
    made = {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}
    return {**made, "count": parts[0]["count"]}


def merged(parts: Sequence[dict[str, NDArray[Any]]]) -> dict[str, NDArray[Any]]:
    """Numbers about the pictures of all episodes, [C, 1, 1] each, shares of full brightness, from those about each.

    Quantiles are means over pictures, as LeRobot merges them: not those of all pictures, which are too many to keep.
    """
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
