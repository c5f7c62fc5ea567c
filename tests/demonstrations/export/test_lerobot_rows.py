"""Rows for LeRobot, and their statistics, which need none of the packages that write them."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from hazard_ms.demonstrations.export.lerobot import rows_of
from hazard_ms.demonstrations.export.lerobot_stats import merged, stats_of
from hazard_ms.demonstrations.export.source import Source
from tests.worlds.recorded import dataset


def test_rows_add_up_what_passes_between_pictures(tmp_path: Path) -> None:
    """Rewards are 1 to 8, and success comes with the last frame."""
    (one,) = Source(dataset(tmp_path, (8,)))
    rows = rows_of(one, 3)
    assert rows["next.reward"].tolist() == [1 + 2 + 3, 4 + 5 + 6, 7 + 8]
    assert rows["next.success"].tolist() == rows["next.done"].tolist() == [False, False, True]
    sent = one.frames["action"]
    lasting = [(sent[0] + sent[1] + sent[2]) / 3, (sent[3] + sent[4] + sent[5]) / 3, (sent[6] + sent[7]) / 2]
    np.testing.assert_allclose(rows["action"], lasting, rtol=1e-6)
    np.testing.assert_array_equal(rows["observation.state"][:, :15], one.frames["qpos"][[0, 3, 6]])
    assert rows["observation.state"][:, -1].tolist() == [0.0, 0.0, 1.0]  # it holds something from frame 5 on


def test_statistics_of_parts_give_those_of_the_whole() -> None:
    rng = np.random.default_rng(0)
    whole = rng.normal(size=(30, 2)) * [1.0, 100.0]
    found = merged([stats_of(whole[:8]), stats_of(whole[8:])])
    for name, expected in stats_of(whole).items():
        if not name.startswith("q"):
            np.testing.assert_allclose(found[name], expected, rtol=1e-12, err_msg=name)


def test_pictures_count_from_0_to_1() -> None:
    pictures = np.zeros((2, 4, 4, 3), np.uint8)
    pictures[1, :, :, 0] = 255
    found = stats_of(pictures, picture=True)
    assert found["mean"].shape == (3, 1, 1) and found["mean"].ravel().tolist() == [0.5, 0.0, 0.0]
    assert found["max"].ravel().tolist() == [1.0, 0.0, 0.0] and found["count"] == [2]
