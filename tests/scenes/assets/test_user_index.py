"""The index of the user's models is as fresh as its file."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from hazard_ms.scenes.assets.index import asset, asset_ids
from hazard_ms.scenes.assets.user_models import user_index

ROW: dict[str, Any] = {
    "kind": "object",
    "category": "bowl",
    "visual": "model.glb",
    "licence": "CC0-1.0",
    "author": "a",
    "source": "s",
    "changes": "",
    "extent": [0.1, 0.1, 0.1],
    "mass": 0.2,
}


@pytest.fixture
def mine(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    (tmp_path / "model.glb").write_bytes(b"glTF")
    monkeypatch.setenv("HAZARD_MS_ASSETS", str(tmp_path))
    return tmp_path


def keep(folder: Path, **rows: float) -> None:
    """Write an index of models by id, with their masses [kg]; the file is replaced, as `assets add` does."""
    draft = folder / "draft"
    draft.write_text(json.dumps([{**ROW, "id": name, "mass": mass} for name, mass in rows.items()]))
    draft.replace(folder / "index.json")


def test_models_are_found_as_soon_as_they_are_added_and_no_longer_once_they_are_removed(mine: Path) -> None:
    assert user_index() == {}
    keep(mine, first=0.2)
    assert asset("first").mass == 0.2
    keep(mine, first=0.3)
    assert asset("first").mass == 0.3
    keep(mine, first=0.3, second=0.4)
    assert set(user_index()) == {"first", "second"}
    keep(mine, second=0.4)
    with pytest.raises(ValueError, match="asset must be one of .*, got 'first'"):
        asset("first")


def test_models_of_the_user_are_listed_only_where_they_are_asked_for(mine: Path) -> None:
    """Generated scenes must not change with what the user adds."""
    keep(mine, first=0.2)
    assert "first" not in asset_ids(category="bowl") and "first" not in asset_ids()
    assert asset_ids(category="bowl", users=True) == (*asset_ids(category="bowl"), "first")
