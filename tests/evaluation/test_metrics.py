"""Value, Step and Damage against examples worked out by hand, and the bootstrap against exact distributions."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from hazard_ms.evaluation.metrics import Fate, Tally, damage, scores, step, value
from hazard_ms.evaluation.result import DecisionRecord, EpisodeResult


def fate(value: float, frame: int | None, damaged: bool = False) -> Fate:
    return Fate("thing", "bottle", value, frame is not None, damaged, frame)


FIRST = Tally.of([fate(5, 100), fate(5, 400, damaged=True), fate(1, 250), fate(1, None), fate(5, None, damaged=True)])
SECOND = Tally.of([fate(1, None), fate(5, None)])
THIRD = Tally.of([fate(1, 600), fate(1, 90, damaged=True)])


def test_one_episode() -> None:
    """Rescued 5 + 5 / 2 + 1 of 17; last rescue at 400; one of three damaged.

    What burns unrescued does not count as damage.
    """
    assert FIRST == Tally(value_rescued=8.5, value_total=17.0, rescued=3, rescued_damaged=1, last_rescue=400)
    assert value([FIRST]) == pytest.approx(0.5)
    assert step([FIRST]) == pytest.approx(400 / 3)
    assert damage([FIRST]) == pytest.approx(1 / 3)


def test_several_episodes() -> None:
    """Value is a mean over episodes; Step and Damage are ratios of sums, without rescue nothing is added."""
    episodes = [FIRST, SECOND, THIRD]
    assert value(episodes) == pytest.approx((0.5 + 0.0 + 1.5 / 2) / 3)
    assert step(episodes) == pytest.approx((400 + 0 + 600) / 5)
    assert damage(episodes) == pytest.approx(2 / 5)


def test_nothing_rescued_leaves_step_and_damage_undefined() -> None:
    made = scores([SECOND, SECOND])
    assert made["value"].mean == 0.0 and (made["value"].low, made["value"].high) == (0.0, 0.0)
    for name in ("step", "damage"):
        assert (made[name].mean, made[name].low, made[name].high) == (None, None, None)


def test_equal_episodes_have_no_spread() -> None:
    made = scores([FIRST] * 7)
    assert (made["value"].low, made["value"].high) == (pytest.approx(0.5), pytest.approx(0.5))
    assert (made["step"].low, made["step"].high) == (pytest.approx(400 / 3), pytest.approx(400 / 3))


def test_interval_is_that_of_the_binomial() -> None:
    """Half of 100 episodes at value 1, half at 0: the resampled mean is Binomial(100, 1/2) / 100.

    Its 2.5 % and 97.5 % points are 0.40 and 0.60.
    """
    full, empty = Tally.of([fate(1, 10)]), Tally.of([fate(1, None)])
    made = scores([full, empty] * 50)["value"]
    assert made.mean == pytest.approx(0.5)
    assert made.low == pytest.approx(0.40, abs=0.011) and made.high == pytest.approx(0.60, abs=0.011)


def test_interval_of_a_ratio_pools_before_dividing() -> None:
    """Two episodes, 1 rescue at frame 100 and 3 rescues up to frame 600.

    A resample is (1, 1) -> 100 with chance 1/4, mixed -> 175 with 1/2, (3, 3) -> 200 with 1/4. So the interval goes
    from 100 to 200 around 175.
    """
    one = Tally.of([fate(1, 100)])
    three = Tally.of([fate(1, 600), fate(1, 50), fate(1, 70)])
    made = scores([one, three])["step"]
    assert (made.mean, made.low, made.high) == (pytest.approx(175), pytest.approx(100), pytest.approx(200))


def test_more_seeds_in_the_same_scenes_are_no_more_evidence() -> None:
    """Episodes at value 1 and at 0 in 100 scenes, four times each: the resampled mean is Binomial(100, 1/2) / 100."""
    full, empty = Tally.of([fate(1, 10)]), Tally.of([fate(1, None)])
    scenes = [f"park/{n:02d}" for n in range(100)]
    made = scores([full, empty] * 200, scenes * 4)["value"]
    assert (made.mean, made.low, made.high) == (0.5, pytest.approx(0.40, abs=0.011), pytest.approx(0.60, abs=0.011))
    assert scores([full, empty] * 50, scenes)["value"] == made


def test_same_seed_same_interval() -> None:
    episodes = [FIRST, SECOND, THIRD] * 4
    assert scores(episodes, seed=3, resamples=500) == scores(episodes, seed=3, resamples=500)
    assert scores(episodes, seed=3, resamples=500) != scores(episodes, seed=4, resamples=500)


def test_contradictions_are_refused() -> None:
    with pytest.raises(ValueError, match="thing"):
        Fate("thing", "bottle", 1.0, True, False, None)
    with pytest.raises(ValueError, match="target, got none"):
        Tally.of([])
    with pytest.raises(ValueError, match="episode, got none"):
        scores([])
    with pytest.raises(ValueError, match="scenes must be 3, one for each episode, got 2"):
        scores([FIRST] * 3, ["a", "b"])


def test_a_result_survives_its_file(tmp_path: Path) -> None:
    made = EpisodeResult(
        env_id="HazardFire-v1",
        agent="greedy",
        seed=3,
        scene="kitchen_a/07",
        settings={"physics": "paper"},
        frames=700,
        max_frames=1500,
        ended="stopped",
        targets=(fate(5, 100), fate(1, None, damaged=True)),
        decisions=(DecisionRecord(0, "walk_to", "thing", False, "no_path", 40, "cost 1.0"),),
        command="hazard-ms play",
    )
    path = tmp_path / "result.json"
    made.write(path)
    assert EpisodeResult.read(path) == made
    assert made.to_dict()["score"] == {"value": pytest.approx(5 / 6), "step": 100.0, "damage": 0.0}
    assert made.versions["numpy"] == np.__version__ and made.versions["hazard-ms"]
    path.write_text(path.read_text().replace('"format": 3', '"format": 99'))
    with pytest.raises(ValueError, match="must be one of 2, 3, 4, got 99"):
        EpisodeResult.read(path)
