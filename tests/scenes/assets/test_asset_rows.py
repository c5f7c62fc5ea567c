"""Rows of the shipped index that are not as they must be are refused by name."""

from __future__ import annotations

from typing import Any

import pytest

from hazard_ms.scenes.assets.index import asset
from hazard_ms.scenes.assets.shipped import read_shipped_row

GOOD = {
    "id": "x_1",
    "kind": "object",
    "category": "bowl",
    "visual": "models/x_1.glb",
    "licence": "CC0-1.0",
    "author": "a",
    "source": "s",
    "changes": "",
    "extent": [0.1, 0.1, 0.1],
    "mass": 0.2,
    "boxes": [[0, 0, 0.05, 0.05, 0.05, 0.05]],
    "sha256": {},
}


@pytest.mark.parametrize(
    ("change", "named"),
    [
        ({"kind": "monster"}, "monster"),
        ({"licence": "CC-BY-NC-4.0"}, "CC-BY-NC-4.0"),
        ({"visual": "../../secret.glb"}, "secret.glb"),
        ({"visual": "/models/x.glb"}, "/models/x.glb"),
        ({"hulls": "hulls/../../x.ply"}, "x.ply"),
        ({"extent": [0.1, 0.0, 0.1]}, "extent"),
        ({"extent": [0.1, 40.0, 0.1]}, "extent"),
        ({"extent": [0.1, float("nan"), 0.1]}, "extent"),
        ({"mass": 0.0}, "mass"),
        ({"mass": float("nan")}, "mass"),
        ({"colour": "red"}, "colour"),
    ],
)
def test_a_bad_row_is_refused_by_name(change: dict[str, Any], named: str) -> None:
    assert read_shipped_row(GOOD).id == "x_1"
    with pytest.raises(ValueError, match="x_1") as raised:
        read_shipped_row({**GOOD, **change})
    assert named in str(raised.value)


@pytest.mark.parametrize("missing", ["licence", "author", "visual", "kind"])
def test_a_row_that_lacks_an_entry_is_refused(missing: str) -> None:
    with pytest.raises(ValueError, match=missing):
        read_shipped_row({k: v for k, v in GOOD.items() if k != missing})


def test_unknown_assets_are_refused_with_the_nearest_ones() -> None:
    with pytest.raises(
        ValueError, match="asset must be one of .*, got 'tabel_1' .did you mean table_1, .*hazard-ms assets"
    ):
        asset("tabel_1")
