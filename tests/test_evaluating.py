"""`hazard-ms evaluate`: which episodes it plays, that it goes on where it stopped, and that its table is that of the scores."""

from __future__ import annotations

from pathlib import Path

import pytest

from hazard_ms import evaluating
from hazard_ms.evaluating_order import Evaluation
from hazard_ms.evaluation.metrics import Fate
from hazard_ms.evaluation.result import EpisodeResult


def result(evaluation: Evaluation, place: int, saved: bool) -> EpisodeResult:
    order = evaluation.orders()[place]
    fate = Fate("book_1", "book", 5.0, saved, False, 100 if saved else None)
    lost = Fate("pan_1", "pan", 5.0, False, False, None)
    return EpisodeResult(order.env_id, order.agent, order.seed, "kitchen_b/00", order.settings, 1500, 1500, "time", (fate, lost), (), "")


def test_every_agent_plays_every_seed_in_a_file_of_its_own(tmp_path: Path) -> None:
    evaluation = Evaluation(episodes=3, first=10, out=tmp_path)
    orders = evaluation.orders()
    assert sorted((o.agent, o.seed) for o in orders) == sorted((a, s) for a in ("greedy", "random") for s in (10, 11, 12))
    assert all(o.split == "test" for o in orders)
    assert len({evaluation.place(o) for o in orders}) == 6 and all(evaluation.place(o).parent == tmp_path for o in orders)


@pytest.mark.parametrize("bad", [{"episodes": 0}, {"workers": -1}, {"first": -1}, {"env_id": "HazardQuake-v1"}])
def test_bad_orders_are_refused(bad: dict[str, object]) -> None:
    with pytest.raises(ValueError, match="allowed"):
        Evaluation(**bad).orders()  # type: ignore[arg-type]


def test_what_is_there_is_not_played_again_and_the_table_holds_its_scores(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Greedy saves one of two equal targets in both episodes, random in one of two: 50 and 25 per cent."""
    evaluation = Evaluation(episodes=2, out=tmp_path)
    for k, order in enumerate(evaluation.orders()):
        result(evaluation, k, saved=order.agent == "greedy" or order.seed == 0).write(evaluation.place(order))
    before = {p.name: p.stat().st_mtime_ns for p in tmp_path.iterdir()}
    assert evaluating.evaluate(evaluation) == 0
    assert {p.name: p.stat().st_mtime_ns for p in tmp_path.iterdir()} == before
    printed = capsys.readouterr().out
    assert "50.0 [50.0, 50.0]" in printed and "25.0 [0.0, 50.0]" in printed and "2/4" in printed and "1/4" in printed
