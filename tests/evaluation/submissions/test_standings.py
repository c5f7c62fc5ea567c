"""The leaderboard counts what signed reports of whole submissions cover, and its numbers are those of the episodes."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from hazard_ms.evaluation.submissions.faults import SCORE, Fault
from hazard_ms.evaluation.submissions.report import Sample, read_report
from hazard_ms.evaluation.submissions.site import write_site
from hazard_ms.evaluation.submissions.standings import apart, pooled, standings
from tests.worlds.files.html_pages import Reader
from tests.worlds.submissions import CARD, make_key, report_of, written

FIRE = [("HazardFire-v1", seed) for seed in range(8)]
WIND = [("HazardWind-v1", seed) for seed in range(4)]
BAD = "<img src=x onerror=alert(1)>"


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """Three submissions that count and five reports that do not."""
    anna, ben = make_key(tmp_path, "anna"), make_key(tmp_path, "ben")
    (tmp_path / "aside").mkdir()
    stranger = make_key(tmp_path / "aside", "stranger")
    good = report_of("good", dict.fromkeys(FIRE, 0.8), 1)
    poor = report_of(BAD, {place: 0.4 if place[1] % 2 else 0.6 for place in FIRE}, 0)
    seer = report_of("seer", dict.fromkeys(FIRE, 0.9), 2)
    seer = replace(seer, card=replace(seer.card or CARD, privileged=True))
    for report, key in ((good, anna), (poor, anna), (seer, ben)):
        written(report, tmp_path, key)
    (tmp_path / "again").mkdir()
    written(replace(good, date="2027-02-01T12:00:00Z"), tmp_path / "again", ben)
    written(report_of("unsigned", dict.fromkeys(FIRE, 1.0), 3), tmp_path, None)
    written(report_of("unknown", dict.fromkeys(FIRE, 1.0), 4), tmp_path, stranger)
    written(report_of("part", dict.fromkeys(FIRE, 1.0), 5, sample=Sample(8, 0), episodes=25), tmp_path, anna)
    written(report_of("false", dict.fromkeys(FIRE, 1.0), 6, faults=(Fault(SCORE, "a", "b"),)), tmp_path, anna)
    theft = replace(good, submission="f" * 64, date="2027-03-01T12:00:00Z")
    written(replace(theft, card=replace(CARD, name="thief", authors=("a thief",))), tmp_path, anna)
    return tmp_path


def test_only_signed_reports_of_whole_submissions_count(folder: Path) -> None:
    tracks, left_out = standings(folder)
    assert [row.title for row in tracks["trial"]] == ["seer", "good", BAD]
    assert [row.signers for row in tracks["trial"]] == [("ben",), ("anna", "ben"), ("anna",)]
    told = "\n".join(left_out)
    assert len(left_out) == 5
    for words in (
        r"unsigned-0003: there is no file .*\.sig",
        r"unknown-0004: .* must be signed by one of signers",
        r"part-0005: no fault in 8 of 25 episodes",
        r"false-0006: not verified: edited score",
        r"good-ffff: copied decisions: decisions: 8 of 8 episodes are those of 'good'",
    ):
        assert re.search(words, told), words


def test_a_folder_without_signers_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="folder must contain the file signers"):
        standings(tmp_path)


def test_a_verdict_that_its_parts_do_not_give_is_refused(tmp_path: Path) -> None:
    path = written(report_of("false", dict.fromkeys(FIRE, 1.0), 6, faults=(Fault(SCORE, "a", "b"),)), tmp_path, None)
    path.write_text(path.read_text().replace("not verified: edited score", "verified: all 8 episodes"))
    with pytest.raises(ValueError, match="verdict of .* must be 'not verified: edited score'"):
        read_report(path)


def test_the_score_is_the_mean_over_tasks_with_a_bootstrap_within_each() -> None:
    """Of 8 episodes in fire and 4 in wind each task has half of the weight; computed here by drawing one by one."""
    rng = np.random.default_rng(7)
    values = {place: float(rng.random()) for place in (*FIRE, *WIND)}
    scenes = {place: f"{place[0]} {place[1]}" for place in values}
    fire, wind = (np.array([values[p] for p in own]) for own in (FIRE, WIND))
    found = pooled(values, scenes)
    assert found.mean == pytest.approx((fire.mean() + wind.mean()) / 2)
    drawn = [(rng.choice(fire, 8).mean() + rng.choice(wind, 4).mean()) / 2 for _ in range(20_000)]
    low, high = np.quantile(drawn, [0.025, 0.975])
    assert found.low == pytest.approx(low, abs=0.01) and found.high == pytest.approx(high, abs=0.01)


def test_differences_are_paired(folder: Path) -> None:
    """The poor one is 0.2 or 0.4 below the good one in each episode, 0.3 in the mean."""
    tracks, _ = standings(folder)
    _, good, poor = tracks["trial"]
    found = apart(good, poor)
    assert found.mean == pytest.approx(0.3) and found.low is not None and 0.2 <= found.low < 0.3
    assert apart(poor, good).mean == pytest.approx(-0.3)


def test_the_site_is_whole_and_stands_alone(folder: Path, tmp_path: Path) -> None:
    film = folder / "good-0001" / "HazardFire-v1-0003.mp4"
    film.parent.mkdir()
    film.write_bytes(b"12345")
    (film.parent / "HazardFire-v1-0004.mp4").symlink_to("/etc/passwd")
    site = tmp_path / "a site"
    first = write_site(*standings(folder), site)
    pages = sorted(site.glob("*.html"))
    assert first in pages and len(pages) == 4 and len(list(site.glob("*.mp4"))) == 1
    for page in pages:
        reader, text = Reader(), page.read_text(encoding="utf-8")
        reader.feed(text)
        assert not reader.open and "<script" not in text and BAD not in text and "http" not in text
        assert all((site / link).is_file() for link in reader.links)
    reader = Reader()
    reader.feed(first.read_text(encoding="utf-8"))
    told = " ".join(reader.text.split())
    for words in ("90.0 [90.0, 90.0]", "+30.0 [", "-30.0 [", "takes the lead", "reference", "Not counted", BAD):
        assert words in told, words
    rows = re.findall(r'<td class="n">(\d*)</td>\s*<td class="who"><a', first.read_text())
    assert rows == ["", "1", "2"]  # who is privileged has no rank
