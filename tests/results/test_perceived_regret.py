"""The table of what is lost with perception: shares add up, and files of regret take the place of rows of the CSV."""

from __future__ import annotations

import csv
from pathlib import Path

import pytest

from hazard_ms.evaluation.regret.causes import PARTS, EpisodeRegret
from results import perceived_regret as table

EPISODE = {"start": 0.9, "value": 0.4, "perception": 0.1, "memory": 0.05, "planning": 0.25, "execution": 0.1}
ANOTHER = {"start": 0.7, "value": 0.6, "unseen": 0.1}


def row(seed: int, numbers: dict[str, float], agent: str = "planner") -> table.Row:
    told = {"task": "fire", "agent": agent, "seed": str(seed), "scene": f"kitchen_b/{seed:02d}"}
    return told | {name: str(numbers.get(name, 0.0)) for name in ("start", "value", *table.SHOWN)}


def test_the_share_of_eyes_is_of_all_that_is_lost_in_all_episodes() -> None:
    # (0.1 + 0.05) / (0.9 - 0.4), and with an episode more that loses 0.1 to neither, 0.15 / 0.6
    assert table.share_of_eyes([row(0, EPISODE)]) == "30 [30, 30]"
    assert table.share_of_eyes([row(0, EPISODE), row(1, ANOTHER)]) == "25 [0, 30]"


def test_a_line_has_means_in_percent_in_the_order_of_the_head() -> None:
    cells = table.line("fire", "planner", [row(0, EPISODE), row(1, ANOTHER)]).strip("|\n ").split(" | ")
    head = table.HEAD.format(machine="", parts=" | ".join(table.SHOWN), rules="").splitlines()[-2]
    told = dict(zip(head.strip("| ").split(" | "), cells, strict=True))
    assert (told["best"], told["Value"], told["perception"], told["unseen"]) == ("80.0", "50.0", "5.0", "5.0")
    assert told["episodes"] == "2"
    lost = sum(float(told[part]) for part in table.SHOWN)
    assert lost == pytest.approx(80.0 - 50.0)


def test_an_episode_that_is_judged_here_takes_the_place_of_its_row(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(table, "RAW", tmp_path)
    monkeypatch.setattr(table, "FILE", tmp_path / "rows.csv")
    with table.FILE.open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, table.COLUMNS, lineterminator="\n")
        writer.writeheader()
        writer.writerows([row(0, EPISODE), row(1, EPISODE)])
    folder = tmp_path / "fire" / "planner"
    folder.mkdir(parents=True)
    lost = {part: ANOTHER.get(part, 0.0) for part in PARTS}
    EpisodeRegret("0" * 64, "planner", 1, "kitchen_b/01", 0.7, 0.6, lost, ()).write(folder / "one.regret.json")
    first, second = table.judged()
    assert (float(first["value"]), float(second["value"])) == (0.4, 0.6)
    assert float(second["unseen"]) == 0.1
    assert set(second) == set(table.COLUMNS)
