"""Curves of episodes and the frames of skills, against episodes worked out by hand."""

from __future__ import annotations

import numpy as np
import pytest

from hazard_ms.evaluation.comparison.curves import fate_curves, outcome, skill_frames, times, value_curve
from hazard_ms.evaluation.result import DecisionRecord
from tests.worlds.courses import course, drawn, fate

FRAMES = times(1200)  # every 10 frames
# of 8 in value: 5 whole at 300, 1 damaged at 400 and rescued at 600, 1 damaged at 900 and left, 1 whole and left
FIRST = course("greedy", 0, [fate(5, 300), fate(1, 600, 400), fate(1, None, 900), fate(1, None)])
SECOND = course("greedy", 1, [fate(5, None)])


def test_value_grows_with_each_rescue() -> None:
    curve = dict(zip(FRAMES.tolist(), value_curve([FIRST], FRAMES).tolist(), strict=True))
    assert [curve[f] for f in (0, 290, 300, 590, 600, 1200)] == pytest.approx([0, 0, 5 / 8, 5 / 8, 5.5 / 8, 5.5 / 8])
    assert value_curve([FIRST, SECOND], FRAMES)[-1] == pytest.approx(5.5 / 16)


def test_each_target_has_one_fate_at_a_time() -> None:
    curves = fate_curves([FIRST, SECOND], FRAMES)
    at = {
        frame: {name: 5 * float(curve[frame // 10]) for name, curve in curves.items()} for frame in range(0, 1201, 10)
    }
    for frame, whole, damaged, well, late in ((0, 5, 0, 0, 0), (300, 4, 0, 1, 0), (400, 3, 1, 1, 0), (900, 2, 1, 1, 1)):
        want = {"whole": whole, "damaged": damaged, "rescued whole": well, "rescued damaged": late}
        assert at[frame] == pytest.approx(want), frame
    results = [drawn("greedy", seed, 0.6) for seed in range(9)]
    assert sum(fate_curves(results, times(1500)).values()) == pytest.approx(np.ones(121))
    assert value_curve(results, times(1500))[-1] == pytest.approx(np.mean([r.tally.value for r in results]))


def test_damage_whose_frame_was_not_recorded_comes_as_late_as_can_be() -> None:
    old = course("greedy", 0, [fate(1, 600, 600), fate(1, None, 700)], frames=1000)
    targets = tuple(type(t)(t.name, t.category, t.value, t.rescued, t.damaged, t.frame) for t in old.targets)
    curves = fate_curves([course("greedy", 0, targets, frames=1000)], FRAMES)
    assert [curves["damaged"][k] for k in (59, 60, 99, 100)] == [0, 0, 0, 0.5]
    assert curves["rescued damaged"][60] == 0.5


@pytest.mark.parametrize(
    ("verb", "ok", "reason", "want"),
    [
        ("walk_to", True, "", "done"),
        ("walk_to", False, "max_frames", "unfinished"),
        ("walk_to", False, "no_path", "failed"),
        ("pick_up", False, "unreachable", "failed"),
        ("pick_up", False, "episode_over", "unfinished"),
    ],
)
def test_what_is_cut_off_has_not_failed(verb: str, ok: bool, reason: str, want: str) -> None:
    assert outcome(DecisionRecord(0, verb, "pen_1", ok, reason, 40)) == want


def test_frames_are_counted_by_skill_and_outcome() -> None:
    made = [("walk_to", True, 80), ("walk_to", False, 100), ("pick_up", True, 60), ("walk_to", False, 100)]
    decisions = [DecisionRecord(0, verb, "pen_1", ok, "" if ok else "max_frames", n) for verb, ok, n in made]
    found = skill_frames([course("greedy", 0, [fate(1, None)], decisions)] * 2)
    assert found == {
        "pick_up": {"done": (2, 120), "unfinished": (0, 0), "failed": (0, 0)},
        "walk_to": {"done": (2, 160), "unfinished": (4, 400), "failed": (0, 0)},
    }
