"""A real model on this machine, where one is installed; elsewhere, what is said of what is missing."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

from hazard_ms.agents.llm.agent import Llm
from hazard_ms.agents.llm.local import local_server, weights
from tests.agents.llm.conftest import Ground
from tests.worlds.playground import play


def test_a_missing_package_is_named_with_the_way_to_get_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "xllamacpp", None)  # as if it were not installed
    local_server.cache_clear()
    with pytest.raises(ValueError, match="base_url=local needs the package xllamacpp.*pip install xllamacpp"):
        Llm(base_url="local")


def test_weights_are_a_file(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    place = tmp_path / "small.gguf"
    monkeypatch.setenv("HAZARD_MS_LLM_GGUF", str(place))
    with pytest.raises(
        ValueError, match=r"HAZARD_MS_LLM_GGUF must name a file of weights, NAME.gguf, got .*small.gguf"
    ):
        weights()
    place.touch()
    assert weights() == place


@pytest.mark.long
def test_a_small_model_plays() -> None:
    """Nothing is said of how well: its answers can be read, which the schema of the way json ensures."""
    pytest.importorskip("xllamacpp")
    local_server.cache_clear()
    player = Llm(base_url="local", way="json", options=6, deadline=200.0)
    taken = play(player, Ground(), most=4)
    assert len(taken) >= 1 and player.counters["calls"] >= 1
    assert player.counters["lost"] == player.counters["fallbacks"] == 0
