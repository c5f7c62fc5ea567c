"""Scenes of the original benchmark: read, refused, written, and like their files where these are at hand."""

from __future__ import annotations

import copy
import json
import math
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from hazard_ms import plain
from hazard_ms.assets import asset
from hazard_ms.catalogue import CATEGORIES
from hazard_ms.cli import main
from hazard_ms.scenes.original import Found, read
from hazard_ms.scenes.original_axes import Corner, from_euler, our_rotation
from hazard_ms.scenes.schema import from_json, to_json
from hazard_ms.spec import Body, Fixture, SceneSpec
from tests.original_folders import FIRE_INFO, FLOOD, WIND_INFO, add, fixed, folder, kitchen, street, xyz
from tests.original_reference import commands, poses, rotation

ORIGINAL = Path(__file__).parents[2] / "shared" / "hazard_original"
published = pytest.mark.skipif(not ORIGINAL.exists(), reason="the original benchmark's scenes are not here")
CORNER = (-4.7169129848480225 / 2, -0.008186578750610352 - 5.927810192108154 / 2)  # x, z of mm_kitchen_2a's, from its table
SWAP = np.array([[1, 0, 0], [0, 0, 1], [0, 1, 0]])  # the original's axes in ours


def of_id(spec: SceneSpec, i: int) -> Body | Fixture:
    return next(t for t in spec.things if t.name.endswith(f"_{i}"))


def matrix(q: tuple[float, float, float, float]) -> np.ndarray:
    w, x, y, z = q
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + 2 * w * cross + 2 * cross @ cross


@pytest.fixture
def indoors(tmp_path: Path) -> SceneSpec:
    return read(folder(tmp_path / "mm_kitchen_2a-7", kitchen(), FIRE_INFO, FLOOD)).spec


@pytest.fixture
def outdoors(tmp_path: Path) -> SceneSpec:
    return read(folder(tmp_path / "suburb_scene_2023-1-7", street(), WIND_INFO)).spec


# ---------------------------------------------------------------------- a room


def test_what_is_parented_turns_with_its_parent(indoors: SceneSpec) -> None:
    """By hand: a turn of 90 degrees, clockwise from above, moves (0.2, 0.1) along x and z to (0.1, -0.2), (-0.1, -0.05) to (-0.05, 0.1)."""
    for i, (x, y, z) in {1: (1.0, 0.0, 2.0), 2: (1.1, 0.93, 1.8), 3: (0.95, 0.101, 2.1), 5: (0.0, 0.0, 0.0)}.items():
        assert of_id(indoors, i).position == pytest.approx((x - CORNER[0], z - CORNER[1], y), abs=1e-3)


def test_turns_change_their_sense(indoors: SceneSpec) -> None:
    """30 degrees clockwise from above are -30 about our z; tilted things as matrices."""
    assert matrix(of_id(indoors, 2).rotation)[:, 0] == pytest.approx([0, -1, 0], abs=1e-6)
    bottle = matrix(of_id(indoors, 5).rotation)[:, 2]
    assert bottle == pytest.approx([0, 0, 1], abs=1e-6)
    wanted = SWAP @ rotation(20, 30, 40)[:3, :3] @ SWAP
    assert matrix(our_rotation(from_euler((20.0, 30.0, 40.0)))) == pytest.approx(wanted, abs=1e-9)
    assert matrix(of_id(indoors, 4).rotation)[:, 2] == pytest.approx(wanted[:, 2], abs=1e-6)


def test_the_way_back() -> None:
    corner = Corner(-2.0, 0.02, 3.0)
    assert corner.ours((1.0, 2.0, 5.0)) == (3.0, 2.0, 1.98)
    assert corner.original(corner.ours((1.0, 2.0, 5.0))) == pytest.approx((1.0, 2.0, 5.0))


def test_what_moves_and_what_does_not(indoors: SceneSpec) -> None:
    assert {f.name: f.category for f in indoors.fixtures} == {"cabinet_1": "cabinet", "plate_4": "plate"}
    assert {b.name: b.category for b in indoors.bodies} == {"pot_2": "pot", "jar_3": "jar", "bottle_5": "bottle"}
    assert {b.name: (b.mass, b.friction) for b in indoors.bodies} == {"pot_2": (2.5, 0.45), "jar_3": (1.0, None), "bottle_5": (1.0, None)}
    assert [b.name for b in indoors.targets] == ["bottle_5"]


def test_targets_that_are_fixed_there_can_be_taken_here(tmp_path: Path) -> None:
    spec = read(folder(tmp_path / "a", kitchen(), {**FIRE_INFO, "targets": ["plate"]}, FLOOD)).spec
    assert [b.name for b in spec.targets] == ["plate_4"]


def test_room_agent_fires_and_flood(indoors: SceneSpec) -> None:
    assert indoors.name == "mm_kitchen_2a-7"
    assert (*indoors.room.size, indoors.room.height) == pytest.approx((4.71691, 5.92781, 2.89247), abs=1e-4)
    assert indoors.agent_start.position == pytest.approx((0.5 - CORNER[0], -2.25 - CORNER[1]), abs=1e-3)
    assert indoors.agent_start.heading == pytest.approx(math.pi / 2)
    assert np.array(indoors.fires) == pytest.approx(np.array([[1.0, -2.0], [-0.25, 1.0]]) - CORNER, abs=1e-3)
    assert indoors.flood_side == "east"


@pytest.mark.parametrize(("there", "here"), [("x_max", "east"), ("x_min", "west"), ("z_max", "north"), ("z_min", "south")])
def test_flood_sides(tmp_path: Path, there: str, here: str) -> None:
    assert read(folder(tmp_path / "a", kitchen(), FIRE_INFO, {"flood_source_from": there})).spec.flood_side == here


def test_sizes_are_those_of_the_table(indoors: SceneSpec) -> None:
    """The cabinet is turned by a quarter, and so is our model of it at most; sizes along its own axes, ours."""
    for i, size in {1: (0.9143, 0.64652, 0.92142), 2: (0.38652, 0.45764, 0.33737)}.items():
        thing = of_id(indoors, i)
        mine = np.array(asset(thing.asset).extent) * thing.scale
        assert sorted(mine[:2]) == pytest.approx(sorted(size[:2]), abs=5e-4) and mine[2] == pytest.approx(size[2], abs=5e-4)


def test_scale_factors_count_against_the_table(tmp_path: Path) -> None:
    """The table's apple, 0.101 m wide, is of scale factor 0.08862933: with twice that it is twice as large, then 3 times as high."""
    apple = add(6, "apple", "apple", (0.0, 0.0, 1.0), scale_factor=2 * 0.08862933)
    taller = {"$type": "scale_object", "id": 6, "scale_factor": xyz(1.0, 3.0, 1.0)}
    thing = of_id(read(folder(tmp_path / "a", [*kitchen(), apple, taller], FIRE_INFO, FLOOD)).spec, 6)
    assert np.array(asset(thing.asset).extent) * thing.scale == pytest.approx([0.2016, 0.2016, 0.5680], abs=1e-4)


def test_shelves_have_the_boards_of_the_original(tmp_path: Path) -> None:
    """Boards of 2 cm at 0.408 m and 0.805 m, and the top at 1.2 m, without the rim; the long side, z there, is open."""
    half, none = xyz(0.17, 0.005, 0.45), xyz(0, 0, 0)
    boards = [
        {
            "$type": "add_box_container",
            "id": 6,
            "container_id": n,
            "tag": "on",
            "position": xyz(0, z, 0),
            "half_extents": half,
            "rotation": none,
        }
        for n, z in enumerate((0.413, 0.81, 1.205))
    ]
    log = [*kitchen(), add(6, "4ft_shelf_metal", "bookshelf", (2.0, 0.0, -2.0)), fixed(6), *boards]
    shelf = of_id(read(folder(tmp_path / "a", log, FIRE_INFO, FLOOD)).spec, 6)
    edges = [int(v) / 1000 * 1.2 for v in shelf.asset.removeprefix("plain_rack_").replace("_", "-").split("-")]
    assert edges == pytest.approx([0.408, 0.785, 0.805, 1.18], abs=1e-3)
    assert shelf.scale == pytest.approx((0.94517, 0.38577, 1.2)) and abs(matrix(shelf.rotation)[0, 1]) == pytest.approx(1.0)


def test_what_stands_in_furniture_stands_in_a_hollow(indoors: SceneSpec) -> None:
    """The cabinet's collision boxes leave the jar's box free, which is 0.08 x 0.13 x 0.08 m, by hand."""
    cabinet, jar = of_id(indoors, 1), of_id(indoors, 3)
    turn = matrix(cabinet.rotation)
    centre = turn.T @ (np.array(jar.position) + [0, 0, 0.065] - cabinet.position)
    boxes = np.array(asset(cabinet.asset).boxes).reshape(-1, 2, 3) * np.array(cabinet.scale)
    apart = (np.abs(boxes[:, 0] - centre) >= boxes[:, 1] + [0.042, 0.042, 0.065]).any(1)
    assert len(boxes) >= 5 and apart.all()
    below = (boxes[:, 0, 2] + boxes[:, 1, 2])[np.abs(boxes[:, 0, 0]) + boxes[:, 1, 0] > 0.45].min()
    assert 0.0 <= jar.position[2] - below < 0.003  # its floor


# ---------------------------------------------------------------------- a street


def test_a_street(outdoors: SceneSpec) -> None:
    """The region's middle is (55, 0) and 18 m wide: its corner is (46, -9); the ground is 0.02 m high."""
    assert outdoors.room.open_air and outdoors.room.size == (18.0, 18.0) and outdoors.room.beyond > 0.0
    for i, (x, y) in {1: (12.0, 10.0), 2: (6.0, 6.0), 3: (4.0, 13.0), 4: (15.5, 1.25), 5: (9.0, 14.0)}.items():
        assert of_id(outdoors, i).position == pytest.approx((x, y, 0.0), abs=1e-3)
    assert [f.name for f in outdoors.containers] == ["cart_1", "cart_2"]
    assert [b.name for b in outdoors.targets] == ["bag_3", "bag_4", "soda_can_5"]
    assert [b.wind_resistance for b in outdoors.bodies] == [0.0, 1.0, 2.5]
    assert outdoors.wind == (1.5, -4.25) and outdoors.fires == ()
    assert outdoors.agent_start.position == (9.25, 11.0)
    bag = of_id(outdoors, 3)
    assert np.array(asset(bag.asset).extent)[2] * bag.scale[2] == pytest.approx(2 * 0.21746, abs=1e-4)


def test_what_surrounds_a_street_stands_outside(outdoors: SceneSpec) -> None:
    mine = [f for f in outdoors.fixtures if f.category != "cart"]
    for f in mine:
        half = np.array(asset(f.asset).extent)[:2].min() / 2 + 1.0
        x, y = f.position[:2]
        assert max(-x, x - 18.0, -y, y - 18.0) >= half


def test_what_hangs_over_a_cart_falls_into_it(tmp_path: Path) -> None:
    log = street()
    log[5]["position"] = xyz(52.0, 0.32, -3.0)
    spec = read(folder(tmp_path / "a-1-0", log, WIND_INFO)).spec
    cart = of_id(spec, 2)
    assert of_id(spec, 3).position[2] >= 0.85329 - 0.01 and cart.position[2] == 0.0


# ---------------------------------------------------------------------- what is not known


def test_unknown_models_rooms_and_categories_are_guessed_and_told(tmp_path: Path) -> None:
    log = [*kitchen(), add(6, "new_pot", "pot", (1.0, 0.0, -1.0)), add(7, "thing", "gizmo", (0.0, 0.0, -1.0))]
    log[1] = {**log[1], "name": "mm_bathroom_9z"}
    found = read(folder(tmp_path / "a", log, FIRE_INFO, FLOOD))
    assert len(found.notes) == 4
    assert any("'new_pot' is not in the table" in n and "line 2, command 10" in n for n in found.notes)
    assert any("room 'mm_bathroom_9z'" in n for n in found.notes)
    size = np.array(asset(of_id(found.spec, 6).asset).extent) * of_id(found.spec, 6).scale
    assert (size > 0.1).all() and (size < 0.6).all()  # like a pot
    assert of_id(found.spec, 7).category == "box"
    assert all(0.0 < t.position[k] < found.spec.room.size[k] for t in found.spec.things for k in (0, 1))


def test_a_region_that_is_not_published(tmp_path: Path) -> None:
    log = [{**c, "position": xyz(c["position"]["x"] + 200.0, 0.32, 70.0)} if "position" in c else c for c in street()]
    spec = read(folder(tmp_path / "suburb_scene_2023-3-11", log, {**WIND_INFO, "agent": [255.0, 0.02, 71.0]})).spec
    assert all(0.0 <= t.position[k] <= spec.room.size[k] for t in (*spec.bodies, *spec.containers) for k in (0, 1))
    assert of_id(spec, 1).position[0] - of_id(spec, 2).position[0] == pytest.approx(6.0)


def test_an_agent_in_the_furniture(tmp_path: Path) -> None:
    """An agent that starts in the cabinet is put beside it, and that is told."""
    found = read(folder(tmp_path / "a", kitchen(), {**FIRE_INFO, "agent": [1.0, 0.0, 2.0]}, FLOOD))
    moved = math.dist(found.spec.agent_start.position, (1.0 - CORNER[0], 2.0 - CORNER[1]))
    assert 0.5 < moved < 1.0 and any("agent starts" in n for n in found.notes)


# ---------------------------------------------------------------------- hostile input

Change = Callable[[list[dict[str, Any]], dict[str, Any], dict[str, Any]], Any]


def _at(i: int, **change: Any) -> Change:
    return lambda log, info, flood: log[i].update(change)


HOSTILE: list[tuple[Change, str]] = [
    (_at(2, position=xyz(0, 0, 1e99)), r"log.txt, line 1, command 3 \(add_object\), position: z is 1e\+99; allowed: a number between"),
    (_at(2, position=[0, 0]), "command 3.*position is .0, 0.; allowed: three numbers"),
    (_at(2, position=xyz(0, 0, True)), "z is True"),
    (_at(2, id="1"), "id is '1'; allowed: ids"),
    (_at(2, id=-4), "id is -4"),
    (_at(17, id=1), r"line 2, command 9 \(add_object\): the id 1 stands twice"),
    (_at(2, name=""), "name is ''; allowed: a text"),
    (_at(2, name="a\nb"), "printable"),
    (_at(2, scale_factor=0), "scale_factor is 0; allowed: a number above 0"),
    (_at(2, colour="red"), "line 1, command 3.*unknown key 'colour'; allowed: "),
    (lambda log, info, flood: log[2].pop("position"), "lacks 'position'; needed"),
    (_at(3, id=77), "no object has the id 77 here"),
    (_at(0, **{"$type": "launch_rocket"}), r"line 1, command 1 \(launch_rocket\): a command that is not known; known: add_scene"),
    (_at(0, **{"$type": 5}), "no object with a '.type'"),
    (_at(7, mass=-1), "mass is -1; allowed: a number above 0"),
    (_at(12, axis="up"), "axis is 'up'; allowed: pitch, yaw, roll"),
    (lambda log, info, flood: log.insert(11, {"$type": "parent_object_to_object", "id": 1, "parent_id": 2}), "its own parent"),
    (lambda log, info, flood: log.pop(1), "no command add_scene"),
    (lambda log, info, flood: info.update(task="earthquake"), "info.json, line 1: task is 'earthquake'; allowed: fire, flood, wind"),
    (lambda log, info, flood: info.update(extra=1), "unknown key 'extra'"),
    (lambda log, info, flood: info.pop("agent"), "lacks 'agent'"),
    (lambda log, info, flood: info.update(agent=[50, 0, 0]), "info.json, line 1: .*agent start at .* is outside of the room"),
    (lambda log, info, flood: info.update(targets=["unicorn"]), "no object of the category 'unicorn'; there are bottle"),
    (lambda log, info, flood: info.update(targets=[5]), "targets is .5.; allowed: a list of categories"),
    (lambda log, info, flood: info.update(other={"fire": [[9, 0, 0]]}), "fire at .* is outside of the room"),
    (lambda log, info, flood: flood.update(flood_source_from="up"), "flood.json, line 1: flood_source_from is 'up'; allowed: x_max"),
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
        ('[{"$type": "add_scene", "name": "x"}]\n[{"$type":', "log.txt, line 2, column 11: no JSON"),
        ('[]\n[]\n[{"$type": "a", "x": NaN}]', "line 3: NaN is no number"),
        ('[{"$type": "a", "x": 1e999}]', "line 1: 1e999 is no finite number"),
        ('[{"$type": "a", "$type": "b"}]', "stands twice"),
        ("{}", "line 1: {} is no list of commands"),
        ("[7]", "line 1, command 1: 7 is no object"),
        ("[" * 100_000, "line 1"),
        ("9" * 1000, "1000 digits"),
        ("", "no command add_scene"),
        ("This is a diary.", "line 1, column 1: no JSON"),
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
    with pytest.raises(ValueError, match="more than 8000000 bytes"):
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
        ({"targets": [3, 5]}, "targets are not all objects of their categories"),
        ({"targets": [3, 3, 4, 5]}, "each once"),
        ({"targets": [3, 4, 99]}, "no object of log.txt has the id 99"),
        ({"containers": [98]}, "no object of log.txt has the id 98"),
        ({"containers": "all"}, "containers is 'all'; allowed: ids"),
        ({"other": {"wind": [1, 0, float("inf")], "wind_resistence": {}}}, "Infinity is no number"),
        ({"other": {"wind": [100, 0, 0], "wind_resistence": {}}}, "wind .* at most 70"),
        ({"other": {"wind": [1, 0, 0], "wind_resistence": {"x": 1}}}, "'x' is no id"),
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


# ---------------------------------------------------------------------- plain shapes


def test_plain_shapes_fill_their_cube() -> None:
    name = plain.name_of("case", [(0.1, 0.5), (0.52, 0.98)])
    assert name == "plain_case_100-500_520-980"
    boxes = np.array(asset(name).boxes).reshape(-1, 2, 3)
    assert (boxes[:, 0] - boxes[:, 1]).min(0) == pytest.approx([-0.5, -0.5, 0.0])
    assert (boxes[:, 0] + boxes[:, 1]).max(0) == pytest.approx([0.5, 0.5, 1.0])
    for at, solid in {(0, 0, 0.05): 1, (0, 0, 0.3): 0, (0, -0.49, 0.3): 0, (0, 0.499, 0.3): 1, (0.499, 0, 0.7): 1, (0, 0, 0.51): 1}.items():
        assert (np.abs(boxes[:, 0] - at) < boxes[:, 1]).all(1).sum() == solid, at
    assert len(asset("plain_box").boxes) == 1
    for bad in ("plain_sphere", "plain_case", "plain_case_5-3", "plain_case_0-1001", "plain_case_1-2_2-3"):
        with pytest.raises(ValueError, match="no shape is called|must rise"):
            asset(bad)
    assert all(0.0 <= v <= 1.0 for c in CATEGORIES for v in plain.colour(c))


# ---------------------------------------------------------------------- the command


def test_import_writes_what_can_be_read(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    scenes, out = tmp_path / "scenes", tmp_path / "out"
    folder(scenes / "mm_kitchen_2a-7", kitchen(), FIRE_INFO, FLOOD)
    folder(scenes / "suburb_scene_2023-1-7", street(), WIND_INFO)
    assert main(["scenes", "import", str(scenes), "-o", str(out)]) == 0
    assert {p.name for p in out.iterdir()} == {"mm_kitchen_2a-7.json", "suburb_scene_2023-1-7.json"}
    assert from_json((out / "mm_kitchen_2a-7.json").read_text()) == read(scenes / "mm_kitchen_2a-7").spec
    assert "mm_kitchen_2a-7: 3 bodies, 2 fixtures, 1 targets, 0 containers" in capsys.readouterr().out
    folder(scenes / "broken-1", "[", FIRE_INFO)
    assert main(["scenes", "import", str(scenes), "-o", str(out)]) == 1
    assert "broken-1/log.txt, line 1" in capsys.readouterr().err


def test_import_writes_nothing_outside(tmp_path: Path) -> None:
    out, secret = tmp_path / "out", tmp_path / "secret.json"
    secret.write_text("mine")
    out.mkdir()
    (out / "a-1.json").symlink_to(secret)
    good = folder(tmp_path / "a-1", kitchen(), FIRE_INFO, FLOOD)
    assert main(["scenes", "import", str(good), "-o", str(out)]) == 0
    assert secret.read_text() == "mine" and not (out / "a-1.json").is_symlink()
    for bad in ("a b", ".hidden", "x\ny"):
        assert main(["scenes", "import", str(folder(tmp_path / bad, kitchen(), FIRE_INFO, FLOOD)), "-o", str(out)]) == 1
    assert [p.name for p in out.iterdir()] == ["a-1.json"]
    for nothing in (tmp_path / "none", out, secret):
        assert main(["scenes", "import", str(nothing), "-o", str(out)]) == 2
    assert main(["scenes", "import", str(good), "-o", str(secret)]) == 2


# ---------------------------------------------------------------------- the published scenes


@pytest.fixture(scope="module")
def all_found() -> dict[Path, Found]:
    before = time.process_time()
    found = {log.parent: read(log.parent) for log in sorted(ORIGINAL.glob("*/*/log.txt"))}
    assert len(found) == 156 and time.process_time() - before < 30.0
    return found


@published
def test_published_scenes_hold_what_their_files_hold(all_found: dict[Path, Found]) -> None:
    for where, found in all_found.items():
        log, info = commands(where / "log.txt"), json.loads((where / "info.json").read_text())
        added = {c["id"]: c for c in log if c["$type"] == "add_object"}
        spec = found.spec
        assert {int(t.name.rsplit("_", 1)[1]) for t in (*spec.bodies, *spec.fixtures[: len(added) - len(spec.bodies)])} == set(added)
        wanted = [i for i, c in added.items() if i in info["targets"] or c["category"] in info["targets"]]
        assert sorted(int(b.name.rsplit("_", 1)[1]) for b in spec.targets) == sorted(wanted), where
        assert sorted(int(f.name.rsplit("_", 1)[1]) for f in spec.containers) == sorted(info["containers"])
        assert len(spec.fires) == len(info["other"].get("fire", []))
        masses = {c["id"]: c["mass"] for c in log if c["$type"] == "set_mass"}
        assert all(b.mass == masses.get(int(b.name.rsplit("_", 1)[1]), 1.0) for b in spec.bodies)
        assert from_json(to_json(spec)) == spec
        assert not [n for n in found.notes if "agent starts" not in n]


@published
def test_published_things_are_where_they_were(all_found: dict[Path, Found]) -> None:
    """Positions to 1 mm; indoors against the room's corner, in the open, where things fall first, horizontally."""
    rooms = json.loads((ORIGINAL / "tdw_rooms.json").read_text())
    regions = {"0": (-9.0, -9.0), "1": (46.0, -9.0), "2": (-67.0, -18.0), "4": (-70.0, 46.0)}
    for where, found in all_found.items():
        world = poses(where / "log.txt")
        inside = where.parent.name == "indoor"
        if inside:
            room = rooms[where.name.rsplit("-", 1)[0]]
            corner = np.array([room["center_xyz_m"][k] - room["size_xyz_m"][k] / 2 for k in (0, 2)])
        else:
            corner = np.array(regions[where.name.split("-")[1]])
        for i, pose in world.items():
            thing = of_id(found.spec, i)
            assert thing.position[:2] == pytest.approx(pose[[0, 2], 3] - corner, abs=1e-3), (where.name, thing.name)
            assert not inside or thing.position[2] == pytest.approx(pose[1, 3], abs=1e-3)
            up = (SWAP @ pose[:3, :3] @ SWAP)[:, 2]
            assert matrix(thing.rotation)[:, 2] == pytest.approx(up, abs=1e-5)


@published
@pytest.mark.long
@pytest.mark.parametrize("number", range(0, 156, 20))
def test_published_scenes_come_to_rest(all_found: dict[Path, Found], number: int) -> None:
    """Most things stay where they are when left alone for a second, and no target leaves."""
    from hazard_ms.standalone import PHYSICS_RATE, build

    spec = list(all_found.values())[number].spec
    alone, count = build(spec), len(spec.bodies)
    alone.world.read()
    start, highest = alone.world.position[0, :count].clone(), 0.0
    for _ in range(PHYSICS_RATE):
        alone.step()
        alone.world.read()
        highest = max(highest, float((alone.world.position[0, :count] - start)[:, 2].max()))
    end = alone.world.position[0, :count]
    assert float((end - start).norm(dim=-1).median()) < 0.02
    assert highest < 0.3 and float((end - start)[:, :2].norm(dim=-1).max()) < 1.0  # nothing is thrown
    edge = end.new_tensor(spec.room.size) + spec.room.beyond
    assert bool(((end[:, :2] > -spec.room.beyond) & (end[:, :2] < edge) & (end[:, 2:] > -0.05)).all())
