"""The measure of pick-ups: its table, its file, and what it tells of real ones."""

from __future__ import annotations

import dataclasses
import json
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from hazard_ms.cli.costs.pickups import Handling, _floor, handlings, lines, report
from hazard_ms.robots.fetch import HazardFetch
from hazard_ms.scenes.splits import scene

ROW = Handling("fetch", "pick_up", "HazardFire-v1", "kitchen_a/00", "mug_1", 0.8, 0.5, 0.6, 40, True, "", True)


def made(*changes: dict[str, Any]) -> list[Handling]:
    return [dataclasses.replace(ROW, **change) for change in changes]


def test_the_table_counts_success_among_what_is_reachable_and_frames_by_reason() -> None:
    missed = {"ok": False, "reason": "unreachable"}
    rows = made(
        {"frames": 40},
        {"frames": 60},
        {"frames": 50},
        {"frames": 20, **missed},
        {"frames": 0, "reachable": False, **missed},
        {"verb": "drop", "frames": 4},
    )
    table = report(rows).splitlines()
    assert table == [
        "fetch pick_up: 5 tried, 3 of 4 reachable worked (75.0%); frames median 50, mean 50, most 60",
        "  unreachable: 2, 1 reachable; frames median 10, mean 10, most 20",
        "fetch drop: 1 tried, 1 of 1 reachable worked (100.0%); frames median 4, mean 4, most 4",
    ]


def test_the_file_holds_one_object_a_line() -> None:
    rows = made({}, {"frames": 7})
    read = [Handling(**json.loads(line)) for line in lines(rows).splitlines()]
    assert read == rows


@pytest.mark.parametrize(
    ("env_id", "robot", "count", "word"), [("HazardFire-v1", "atlas", 1, "fetch"), ("X", "g1", 1, "X")]
)
def test_unknown_names_and_no_pick_ups_are_refused(env_id: str, robot: str, count: int, word: str) -> None:
    with pytest.raises(ValueError, match=word):
        next(handlings(env_id, robot, count, 0))
    with pytest.raises(ValueError, match="count must be"):
        next(handlings("HazardFire-v1", "fetch", 0, 0))


def test_the_floor_goes_on_behind_gaps_in_which_there_is_no_room_to_spare() -> None:
    """Of all targets of this scene, `hazard-ms scenes reach` says that Fetch can get at them."""
    spec = scene("kitchen_a/06")
    env = SimpleNamespace(
        base=SimpleNamespace(specs=[spec]), stage=SimpleNamespace(robot=SimpleNamespace(build=HazardFetch.build))
    )
    floor = _floor(env)
    away = [float(np.hypot(*(floor - body.position[:2]).T).min()) for body in spec.targets]
    assert max(away) < HazardFetch.build.reach


@pytest.mark.long
@pytest.mark.render
def test_real_pick_ups_are_told_of_with_what_skill_times_need() -> None:
    rows = list(handlings("HazardFire-v1", "fetch", 6, 0))
    picked = [row for row in rows if row.verb == "pick_up"]
    assert len(picked) == 6 == len({(row.scene, row.target) for row in picked})
    assert sum(row.ok for row in picked) >= 3
    for row in picked:
        assert row.clearance <= row.distance + 0.05 and 0.0 <= row.height < 2.0
        assert row.ok == (row.reason == "") and (row.reachable or not row.ok)
    dropped = [row.target for row in rows if row.verb == "drop"]
    assert dropped == [row.target for row in picked if row.ok]
