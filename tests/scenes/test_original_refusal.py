"""Files of the original benchmark that are not as they must be are refused, with file, line and place."""

from __future__ import annotations

import copy
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from hazard_ms.scenes.original.read import read
from tests.worlds.files.original_folders import FIRE_INFO, FLOOD, WIND_INFO, folder, kitchen, street, xyz

Change = Callable[[list[dict[str, Any]], dict[str, Any], dict[str, Any]], Any]


def _at(i: int, **change: Any) -> Change:
    return lambda log, info, flood: log[i].update(change)


HOSTILE: list[tuple[Change, str]] = [
    (
        _at(2, position=xyz(0, 0, 1e99)),
        r"log.txt, line 1, command 3 \(add_object\), position: z must be a number between .*, got 1e\+99",
    ),
    (_at(2, position=[0, 0]), "command 3.*position must be three numbers x, y, z, got .0, 0."),
    (_at(2, position=xyz(0, 0, True)), "z must be a number .*, got True"),
    (_at(2, id="1"), "id must be ids, .*, got '1'"),
    (_at(2, id=-4), "id must be ids, .*, got -4"),
    (_at(17, id=1), r"line 2, command 9 \(add_object\): ids must differ, got 1 twice"),
    (_at(2, name=""), "name must be a text .*, got ''"),
    (_at(2, name="a\nb"), "printable"),
    (_at(2, scale_factor=0), "scale_factor must be a number above 0, got 0"),
    (_at(2, colour="red"), "line 1, command 3.*keys must be among .*, got 'colour'"),
    (lambda log, info, flood: log[2].pop("position"), "keys must include .*, got no 'position'"),
    (_at(3, id=77), "id must be the id of an object that exists here, got 77"),
    (
        _at(0, **{"$type": "launch_rocket"}),
        r"line 1, command 1 \(launch_rocket\): a command must be one of add_scene, .*, got 'launch_rocket'",
    ),
    (_at(0, **{"$type": 5}), "must be an object with a '.type', got"),
    (_at(7, mass=-1), "mass must be a number above 0, got -1"),
    (_at(12, axis="up"), "axis must be pitch, yaw, roll, got 'up'"),
    (
        lambda log, info, flood: log.insert(11, {"$type": "parent_object_to_object", "id": 1, "parent_id": 2}),
        "the parent of an object must not be attached to it, got [12] for [12]",
    ),
    (lambda log, info, flood: log.pop(1), "must have a command add_scene, got none"),
    (
        lambda log, info, flood: info.update(task="earthquake"),
        "info.json, line 1: task must be fire, flood, wind, got 'earthquake'",
    ),
    (lambda log, info, flood: info.update(extra=1), "keys must be among .*, got 'extra'"),
    (lambda log, info, flood: info.pop("agent"), "keys must include .*, got no 'agent'"),
    (
        lambda log, info, flood: info.update(agent=[50, 0, 0]),
        "info.json, line 1: .*agent start must be within the room",
    ),
    (
        lambda log, info, flood: info.update(targets=["unicorn"]),
        "targets must be among bottle, .*, got 'unicorn'",
    ),
    (lambda log, info, flood: info.update(targets=[5]), "targets must be a list of categories, got .5."),
    (lambda log, info, flood: info.update(other={"fire": [[9, 0, 0]]}), "fire must be within the room"),
    (
        lambda log, info, flood: flood.update(flood_source_from="up"),
        "flood.json, line 1: flood_source_from must be x_max, .*, got 'up'",
    ),
]


@pytest.mark.parametrize(("change", "message"), HOSTILE)
def test_hostile_scenes_are_refused(tmp_path: Path, change: Change, message: str) -> None:
    log, info, flood = copy.deepcopy((kitchen(), FIRE_INFO, FLOOD))
    change(log, info, flood)
    with pytest.raises(ValueError, match=message):
        read(folder(tmp_path / "a", log, info, flood))


@pytest.mark.parametrize(
    ("log", "message"),
    [
        ('[{"$type": "add_scene", "name": "x"}]\n[{"$type":', "log.txt, line 2, column 11: not valid JSON"),
        ('[]\n[]\n[{"$type": "a", "x": NaN}]', "line 3: numbers must be finite, got NaN"),
        ('[{"$type": "a", "x": 1e999}]', "line 1: numbers must be finite, got 1e999"),
        ('[{"$type": "a", "$type": "b"}]', "keys of an object must differ, got '.type' twice"),
        ("{}", "line 1: a line must be a list of commands, got {}"),
        ("[7]", "line 1, command 1: a command must be an object .*, got 7"),
        ("[" * 100_000, "line 1"),
        ("9" * 1000, "at most 30 digits, got 1000"),
        ("", "must have a command add_scene, got none"),
        ("This is a diary.", "line 1, column 1: not valid JSON"),
    ],
)
def test_what_is_no_log_is_refused(tmp_path: Path, log: str, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        read(folder(tmp_path / "a", log, FIRE_INFO, FLOOD))


def test_large_files_are_refused_at_once(tmp_path: Path) -> None:
    where = folder(tmp_path / "a", kitchen(), FIRE_INFO, FLOOD)
    with (where / "log.txt").open("wb") as file:
        file.truncate(100_000_000)
    before = time.process_time()
    with pytest.raises(ValueError, match="at most 8000000 bytes, got 100000000"):
        read(where)
    assert time.process_time() - before < 1.0


@pytest.mark.parametrize("name", ["log.txt", "info.json", "flood.json"])
def test_missing_and_unreadable_files(tmp_path: Path, name: str) -> None:
    where = folder(tmp_path / "a", kitchen(), FIRE_INFO, FLOOD)
    (where / name).write_bytes(b"\xff\xfe{}")
    with pytest.raises(ValueError, match=f"{name}, line 1: not UTF-8"):
        read(where)
    (where / name).unlink()
    with pytest.raises(ValueError, match=f"{name}: there is no such file"):
        read(where)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"targets": [3, 4]}, "soda_can|no object|ok"),
        ({"targets": [3, 5]}, "targets must be all objects of their categories"),
        ({"targets": [3, 3, 4, 5]}, "each once"),
        ({"targets": [3, 4, 99]}, "ids must be those of objects in log.txt, got 99"),
        ({"containers": [98]}, "ids must be those of objects in log.txt, got 98"),
        ({"containers": "all"}, "containers must be ids, .*, got 'all'"),
        ({"other": {"wind": [1, 0, float("inf")], "wind_resistence": {}}}, "numbers must be finite, got Infinity"),
        ({"other": {"wind": [100, 0, 0], "wind_resistence": {}}}, "wind must be at most 70"),
        ({"other": {"wind": [1, 0, 0], "wind_resistence": {"x": 1}}}, "keys must be ids, got 'x'"),
        ({"other": {"wind": [1, 0, 0], "wind_resistence": {"3": -1}}}, "numbers from 0"),
    ],
)
def test_hostile_streets_are_refused(tmp_path: Path, change: dict[str, Any], message: str) -> None:
    where = folder(tmp_path / "suburb_scene_2023-1-7", street(), {**WIND_INFO, **change})
    if change == {"targets": [3, 4]}:  # all bags, and no can: allowed
        assert [b.name for b in read(where).spec.targets] == ["bag_3", "bag_4"]
        return
    with pytest.raises(ValueError, match=message):
        read(where)
