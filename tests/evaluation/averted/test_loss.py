"""What is lost and averted, against examples worked out by hand; how results, tables and files tell it."""

from __future__ import annotations

import csv
import dataclasses
import io
import json
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pytest

from hazard_ms.evaluation.averted import alone
from hazard_ms.evaluation.averted.loss import Loads, Loss, averted, averted_of_all, mean_loads, mean_score
from hazard_ms.evaluation.comparison import rows
from hazard_ms.evaluation.comparison.folders import groups
from hazard_ms.evaluation.comparison.summary import summary, table
from hazard_ms.evaluation.options import EnvOptions, EpisodeOptions, SweepOptions
from hazard_ms.evaluation.page import page
from hazard_ms.evaluation.report import averted_line
from hazard_ms.evaluation.result import EpisodeResult
from hazard_ms.evaluation.workers import Job, Outcome
from tests.worlds.results import result_of

ALONE = Loss(10.0, 16.0, 12.0, 20.0)


def test_what_is_gone_is_lost_whole_and_what_is_damaged_by_half() -> None:
    """Five things of value 5, 5, 1, 1, 5; the last is no target. Gone: the first; damaged: the first three, the last.

    Targets lose 5 + 2.5 + 0.5 of 12, all things 2.5 more of 17.
    """
    value = np.array([5.0, 5.0, 1.0, 1.0, 5.0])
    target = np.array([True, True, True, True, False])
    gone = np.array([True, False, False, False, False])
    damaged = np.array([True, True, True, False, True])
    assert Loss.of(value, target, gone, damaged) == Loss(8.0, 12.0, 10.5, 17.0)


@pytest.mark.parametrize(
    ("lost", "before", "share"),
    [(4.0, 10.0, 0.6), (0.0, 10.0, 1.0), (10.0, 10.0, 0.0), (15.0, 10.0, -0.5), (0.0, 0.0, None), (3.0, 0.0, None)],
)
def test_averted_is_the_share_of_what_would_be_lost(lost: float, before: float, share: float | None) -> None:
    now, then = Loss(lost, 16.0, 0.0, 0.0), Loss(before, 16.0, 0.0, 0.0)
    assert averted(now, then) == (share if share is None else pytest.approx(share))
    assert averted_of_all(Loss(0.0, 0.0, lost, 20.0), Loss(0.0, 0.0, before, 20.0)) == averted(now, then)
    assert averted(None, then) is None and averted(now, None) is None


def test_undefined_episodes_are_left_out_of_means() -> None:
    """0.5 and -0.1 have the mean 0.2; a resample of the two has 0.5, 0.2 or -0.1, the ends with a chance of 1/4."""
    found = mean_score([0.5, None, -0.1, None])
    assert (found.mean, found.low, found.high) == (pytest.approx(0.2), pytest.approx(-0.1), pytest.approx(0.5))
    assert mean_score([None]).mean is None and mean_score([]).mean is None


def test_scenes_are_drawn_with_all_their_episodes() -> None:
    """Scene a has 0 and 1, scene b 0.5 twice: every resample of scenes has the mean 0.5."""
    found = mean_score([0.0, 1.0, 0.5, 0.5], ["a", "a", "b", "b"])
    assert (found.low, found.high) == (pytest.approx(0.5), pytest.approx(0.5))


def test_loads_are_means_of_the_episodes_that_measured_them() -> None:
    found = mean_loads([Loads(heat=0.2, collisions=3), Loads(heat=None, collisions=4), None])
    assert found == {"heat": pytest.approx(0.2), "collisions": pytest.approx(3.5)}


def told(seed: int, lost: float, agent: str = "greedy") -> EpisodeResult:
    made = result_of(EpisodeOptions(agent=agent, seed=seed), True)
    own = Loss(lost, 16.0, lost, 20.0)
    return dataclasses.replace(made, scene=f"s/{seed}", lost=own, lost_alone=ALONE, loads=Loads(0.25, 3.0, 0.6, 2))


def test_a_result_keeps_what_was_lost(tmp_path: Path) -> None:
    made = told(0, 4.0)
    made.write(tmp_path / "one.json")
    assert EpisodeResult.read(tmp_path / "one.json") == made
    score = json.loads((tmp_path / "one.json").read_text())["score"]
    assert score["averted"] == pytest.approx(0.6) and score["averted_of_all"] == pytest.approx(8 / 12)


def test_results_of_format_2_are_still_read(tmp_path: Path) -> None:
    """As a sweep wrote them before: without the three fields that came with format 3."""
    row = result_of(EpisodeOptions(seed=3), True).to_dict()
    for name in ("lost", "lost_alone", "loads"):
        del row[name]
    (tmp_path / "old.json").write_text(json.dumps({**row, "format": 2}))
    found = EpisodeResult.read(tmp_path / "old.json")
    assert found.seed == 3 and found.lost is None and found.averted is None and found.loads is None


def test_tables_pages_and_csv_tell_it(tmp_path: Path) -> None:
    """Greedy averts 0.6 and 0.2, random 0.5 and 0.3: in the mean both 0.4, and the paired differences are +-0.1."""
    results = [told(0, 4.0), told(1, 8.0), told(0, 5.0, "random"), told(1, 7.0, "random")]
    for made in results:
        made.write(tmp_path / f"{made.agent}-{made.seed}.json")
    (group,), _ = groups([tmp_path])
    found = summary(group)
    assert found["agents"]["greedy"]["averted"]["mean"] == pytest.approx(0.4)
    assert found["agents"]["random"]["loads"] == {"heat": 0.25, "wading": 3.0, "water": 0.6, "collisions": 2.0}
    first = found["differences"][0]["averted"]
    assert (first["mean"], first["low"], first["high"]) == pytest.approx((0.0, -0.1, 0.1))
    assert "Averted" in table(found) and "40.0 [20.0, 60.0]" in table(found)
    assert "averted 40.0 [20.0, 60.0]" in averted_line("greedy", results[:2])
    assert "undefined" not in averted_line("greedy", results[:2]) and "2.0 collisions" in averted_line("g", results)
    none = dataclasses.replace(results[0], lost_alone=Loss(0.0, 16.0, 0.0, 20.0))
    assert "undefined in 1 of 2 episodes" in averted_line("greedy", [none, results[1]])
    assert averted_line("greedy", [result_of(EpisodeOptions())]) == ""
    read = list(csv.DictReader(io.StringIO(rows.table([group]))))
    assert {(row["agent"], row["seed"], row["averted"]) for row in read} >= {("greedy", "0", "0.6")}
    assert "60.0 %" in page(results[0]) and "2</b>" in page(results[0]) and "Averted" in page(results[0])
    assert "Averted" not in page(result_of(EpisodeOptions()))


def test_results_without_it_have_no_such_column(tmp_path: Path) -> None:
    result_of(EpisodeOptions()).write(tmp_path / "one.json")
    (group,), _ = groups([tmp_path])
    assert "Averted" not in table(summary(group))


@pytest.fixture
def played(monkeypatch: pytest.MonkeyPatch) -> list[Job]:
    """The jobs of episodes in which nobody acts, none of which is really played."""
    jobs: list[Job] = []

    @contextmanager
    def spread(given: Sequence[Job], *_: object) -> Iterator[Iterator[tuple[Job, Outcome]]]:
        jobs.extend(given)
        yield iter([(job, Outcome(dataclasses.replace(result_of(job.options), lost=ALONE))) for job in given])

    monkeypatch.setattr(alone, "spread", spread)
    return jobs


def test_episodes_without_anybody_are_played_once_for_all_agents(tmp_path: Path, played: list[Job]) -> None:
    options = SweepOptions(EnvOptions(split="test"), ("greedy", "random", "rule"), episodes=2, output=tmp_path)
    episodes = options.episode_options()
    assert alone.losses(options, episodes) == dict.fromkeys(episodes, ALONE)
    assert sorted(job.options.seed for job in played) == [0, 1]
    assert all(job.averted and job.actions == (("stop", None),) for job in played)
    assert alone.losses(options, episodes) == dict.fromkeys(episodes, ALONE) and len(played) == 2
    assert len(list(tmp_path.glob("*nobody*.alone.json"))) == 2


@pytest.mark.parametrize("change", [{"physics": "shipped"}, {"affects_agent": True}, {"robot_uids": "g1"}])
def test_other_settings_are_other_episodes(change: dict[str, object], tmp_path: Path, played: list[Job]) -> None:
    for made in ({}, change):
        options = SweepOptions(EnvOptions(split="test", **made), ("greedy",), episodes=1, output=tmp_path)  # type: ignore[arg-type]
        alone.losses(options, options.episode_options())
    assert len(played) == 2


@pytest.mark.parametrize("text", ["", "{}", '"hazard-ms": "0.0.1"', "seed"])
def test_files_that_are_damaged_or_of_other_versions_are_made_again(
    text: str, tmp_path: Path, played: list[Job]
) -> None:
    options = SweepOptions(EnvOptions(split="test"), ("greedy",), episodes=1, output=tmp_path)
    (episode,) = options.episode_options()
    alone.losses(options, [episode])
    path = alone.place(options, episode)
    row = json.loads(path.read_text())
    if text.startswith('"'):
        row["versions"]["hazard-ms"] = "0.0.1"
    if text == "seed":
        row["seed"] = 7
    path.write_text(text if text in ("", "{}") else json.dumps(row))
    assert alone.losses(options, [episode]) == {episode: ALONE} and len(played) == 2


def test_whether_it_is_asked_for() -> None:
    assert not alone.asked(SweepOptions()) and alone.asked(SweepOptions(averted="yes"))
    with pytest.raises(ValueError, match="averted"):
        alone.asked(SweepOptions(averted="perhaps"))
