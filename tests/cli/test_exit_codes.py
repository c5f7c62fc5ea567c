"""Exit codes of `hazard-ms play`: a script must not take a broken episode for a good one."""

from __future__ import annotations

import pytest

from hazard_ms.cli.__main__ import main
from hazard_ms.evaluation import runner
from tests.worlds.results import result_of


@pytest.mark.parametrize(("ended", "code"), [("time", 0), ("all rescued", 0), ("stopped", 0), ("simulation error", 1)])
def test_play_ends_with_1_where_the_simulation_broke(
    ended: str, code: int, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """The result is made by hand: test_broken_simulation plays one that really breaks."""
    monkeypatch.setattr(runner, "play", lambda episode, watchers: result_of(episode, ended=ended))
    assert main(["play"]) == code
    assert f"({ended})" in capsys.readouterr().out
