"""Skill times: what is drawn of a table, what a fit makes of attempts, and which files are refused."""

from __future__ import annotations

import dataclasses
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from hazard_ms.sketch import fit_times, skill_times
from hazard_ms.sketch.fit_times import Attempt, attempt, fit
from hazard_ms.sketch.skill_times import BAG, CART, EXPLORE, NO_PATH, PICK_UP, SKILLS, SkillRow, SkillTimes
from hazard_ms.skills import failures
from tests.worlds.sketch_scenes import sure_times

MANY = 20_000


def evenly(count: int = MANY) -> np.ndarray:
    """Pairs of independent uniform numbers, [n, 2]."""
    return np.random.default_rng(3).random((count, 2))


def drawn(times: SkillTimes, skill: str, height: float = 0.0, clearance: float = 0.0, ease: float = 1.0) -> Any:
    """Whether each of many attempts works, and their frames."""
    one = np.ones(MANY)
    return times.draw(skill, evenly(), one * height, one * clearance, one * ease)


def two_bands() -> SkillTimes:
    """Low things are quick and sure to get, high ones slow and not sure."""
    low = SkillRow(PICK_UP, 10, 0.9, (40.0, 60.0), (20.0,), height=(-np.inf, 0.5))
    high = SkillRow(PICK_UP, 30, 0.5, (100.0, 100.0, 200.0), (50.0, 70.0), height=(0.5, np.inf))
    return SkillTimes("fetch", (low, high, *(row for row in sure_times().rows if row.skill != PICK_UP)), "by hand")


def test_draws_follow_the_row_of_the_band() -> None:
    worked, frames = drawn(two_bands(), PICK_UP, height=0.1)
    assert worked.mean() == pytest.approx(0.9, abs=0.01)
    assert frames[worked].mean() == pytest.approx(50.0, abs=0.3)
    assert set(frames[~worked]) == {20.0}
    worked, frames = drawn(two_bands(), PICK_UP, height=0.5)
    assert worked.mean() == pytest.approx(0.5, abs=0.02)
    assert frames[worked].mean() == pytest.approx((100.0 + 150.0) / 2, abs=1.0)
    assert np.median(frames[worked]) == pytest.approx(100.0, abs=1.5)
    assert frames[~worked].min() >= 50.0 and frames[~worked].max() <= 70.0


def test_ease_scales_how_often_it_works() -> None:
    worked, _ = drawn(two_bands(), PICK_UP, height=0.1, ease=0.5)
    assert worked.mean() == pytest.approx(0.45, abs=0.02)


def test_typical_numbers_weigh_bands_by_their_attempts() -> None:
    success, frames, failed = two_bands().typical(PICK_UP)
    assert success == pytest.approx((10 * 0.9 + 30 * 0.5) / 40)
    assert frames == pytest.approx((10 * 50 + 30 * 125) / 40)
    assert failed == pytest.approx((10 * 20 + 30 * 60) / 40)


def test_a_height_outside_of_all_bands_is_refused() -> None:
    rows = (SkillRow(PICK_UP, 1, 1.0, (5.0,), (5.0,), height=(0.0, 1.0)), *sure_times().rows[1:])
    with pytest.raises(ValueError, match=r"got 2\.0 m"):
        drawn(SkillTimes("fetch", rows), PICK_UP, height=2.0)


@pytest.mark.parametrize(
    ("change", "told"),
    [
        ({"skill": "jump"}, "skill must be one of"),
        ({"success": 1.2}, "success of pick_up must be from 0 to 1, got 1.2"),
        ({"frames": ()}, "frames of pick_up must be sorted"),
        ({"frames": (9.0, 3.0)}, "frames of pick_up must be sorted"),
        ({"failed": (-1.0,)}, "failed of pick_up must be sorted"),
        ({"failed": (float("nan"),)}, "failed of pick_up must be sorted"),
        ({"height": (1.0, 0.0)}, "height of pick_up must be a band"),
    ],
)
def test_rows_that_cannot_be_are_refused(change: dict[str, Any], told: str) -> None:
    with pytest.raises(ValueError, match=told):
        dataclasses.replace(sure_times().rows[0], **change)


def test_the_shipped_tables_are_whole_and_come_back_from_their_file(tmp_path: Path) -> None:
    tables = skill_times.read(skill_times.SHIPPED)
    assert {"fetch", "g1"} <= set(tables)
    for times in tables.values():
        assert times.source
        assert {row.skill for row in times.rows} == set(SKILLS)
        everywhere = np.array([[h, c] for h in (-0.5, 0.25, 0.9, 3.0) for c in (0.0, 0.4, 0.7, 5.0)])
        times.draw(PICK_UP, evenly(16), everywhere[:, 0], everywhere[:, 1], np.ones(16))
    path = tmp_path / "times.json"
    path.write_text(skill_times.as_json(tables))
    assert {k: t.rows for k, t in skill_times.read(path).items()} == {k: t.rows for k, t in tables.items()}


@pytest.mark.parametrize(
    "content", ["", "[]", "{}", '{"format": 0, "robots": {}}', '{"format": 1, "robots": {"a": 1}}']
)
def test_damaged_files_are_refused_by_name(tmp_path: Path, content: str) -> None:
    path = tmp_path / "times.json"
    path.write_text(content)
    with pytest.raises(ValueError, match=r"times\.json must hold skill times, got"):
        skill_times.read(path)


def test_a_robot_without_tables_is_refused_with_those_that_have_some() -> None:
    with pytest.raises(ValueError, match="fetch"):
        skill_times.load("wheelbarrow")


def test_a_skill_without_rows_is_refused() -> None:
    with pytest.raises(ValueError, match="must have a row for no_path"):
        SkillTimes("fetch", sure_times().rows[:-1])


# ---------------------------------------------------------------------- fitting


def test_a_fit_finds_the_tables_that_attempts_were_drawn_from() -> None:
    chance, made = np.random.default_rng(1), []
    for height in (0.1, 1.2):
        one = np.ones(4000)
        worked, frames = two_bands().draw(PICK_UP, chance.random((4000, 2)), height * one, 0.5 * one, one)
        made += [Attempt(PICK_UP, bool(w), round(float(f)), height, 0.5) for w, f in zip(worked, frames, strict=True)]
    found = fit("fetch", made, sure_times(), "drawn")
    for height, success, frames in ((0.1, 0.9, 50.0), (1.2, 0.5, 125.0)):
        worked, lasted = drawn(found, PICK_UP, height, 0.5)
        assert worked.mean() == pytest.approx(success, abs=0.03)
        assert lasted[worked].mean() == pytest.approx(frames, rel=0.03)


def test_a_band_with_few_attempts_takes_the_numbers_of_all() -> None:
    made = [Attempt(PICK_UP, True, 50, 0.1, 0.5)] * 99 + [Attempt(PICK_UP, False, 20, 1.2, 0.5)]
    worked, _ = drawn(fit("fetch", made, sure_times(), ""), PICK_UP, 1.2, 0.5)
    assert worked.mean() == pytest.approx(0.99, abs=0.01)


def test_a_skill_with_few_attempts_keeps_its_rows() -> None:
    found = fit("fetch", [Attempt(CART, False, 5)] * (fit_times.FEWEST - 1), two_bands(), "")
    assert set(found.rows) == set(two_bands().rows)


@pytest.mark.parametrize(
    ("verb", "reason", "carts", "skill"),
    [
        ("pick_up", "", False, PICK_UP),
        ("pick_up", failures.UNREACHABLE, False, PICK_UP),
        ("pick_up", failures.TOO_FAR, False, None),
        ("pick_up", failures.EPISODE_OVER, False, None),
        ("drop", "", False, BAG),
        ("drop", failures.NOT_RESCUED, True, CART),
        ("explore", "", False, EXPLORE),
        ("walk_to", "", False, None),
        ("walk_to", failures.MAX_FRAMES, False, None),
        ("walk_to", failures.NO_PATH, False, NO_PATH),
        ("stop", "", False, None),
    ],
)
def test_decisions_count_for_the_skill_behind_them(verb: str, reason: str, carts: bool, skill: str | None) -> None:
    made = attempt(verb, not reason, reason, 9, carts)
    assert (made and made.skill) == skill


def test_rows_of_the_probe_are_read_but_for_what_cannot_be_reached(tmp_path: Path) -> None:
    row = {"robot": "g1", "verb": "pick_up", "height": 0.3, "clearance": 0.5, "distance": 0.7, "frames": 40}
    rows = [
        {**row, "ok": True, "reason": "", "reachable": True},
        {**row, "ok": False, "reason": "unreachable", "reachable": False},
        {**row, "ok": True, "reason": "", "verb": "drop", "distance": 0.0, "frames": 4},
        {**row, "ok": True, "reason": "", "verb": "drop", "distance": 0.9, "frames": 150},
    ]
    path = tmp_path / "rows.jsonl"
    path.write_text("".join(json.dumps(each) + "\n" for each in rows))
    place = {"height": 0.3, "clearance": 0.5}
    assert list(fit_times.probed(path)) == [
        ("g1", Attempt(PICK_UP, True, 40, **place)),
        ("g1", Attempt(BAG, True, 4, **place)),
        ("g1", Attempt(CART, True, 150, **place)),
    ]
    path.write_text("{}")
    with pytest.raises(ValueError, match=r"rows\.jsonl must hold rows"):
        list(fit_times.probed(path))
