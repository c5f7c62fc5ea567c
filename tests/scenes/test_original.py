"""Scenes of the original benchmark are read as they are: places, turns, sizes, targets, surroundings."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from hazard_ms.scenes.assets.index import asset
from hazard_ms.scenes.original.axes import SouthWestCorner, from_euler, our_rotation
from hazard_ms.scenes.original.read import read
from hazard_ms.scenes.original.start import START_HEADING, start
from hazard_ms.spec import AgentStart, Fixture, Room, SceneSpec
from tests.worlds.files.original_folders import (
    FIRE_INFO,
    FLOOD,
    SWAP,
    WIND_INFO,
    add,
    fixed,
    folder,
    kitchen,
    matrix,
    of_id,
    street,
    xyz,
)
from tests.worlds.files.original_reference import rotation

# x, z of mm_kitchen_2a's, from its table
CORNER = (-4.7169129848480225 / 2, -0.008186578750610352 - 5.927810192108154 / 2)


@pytest.fixture
def indoors(tmp_path: Path) -> SceneSpec:
    return read(folder(tmp_path / "mm_kitchen_2a-7", kitchen(), FIRE_INFO, FLOOD)).spec


@pytest.fixture
def outdoors(tmp_path: Path) -> SceneSpec:
    return read(folder(tmp_path / "suburb_scene_2023-1-7", street(), WIND_INFO)).spec


# ---------------------------------------------------------------------- a room


def test_what_is_parented_turns_with_its_parent(indoors: SceneSpec) -> None:
    """By hand: a turn of 90 degrees, clockwise from above, moves (0.2, 0.1) along x and z to (0.1, -0.2).

    It moves (-0.1, -0.05) to (-0.05, 0.1).
    """
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
    corner = SouthWestCorner(-2.0, 0.02, 3.0)
    assert corner.ours((1.0, 2.0, 5.0)) == (3.0, 2.0, 1.98)
    assert corner.original(corner.ours((1.0, 2.0, 5.0))) == pytest.approx((1.0, 2.0, 5.0))


def test_what_moves_and_what_does_not(indoors: SceneSpec) -> None:
    assert {f.name: f.category for f in indoors.fixtures} == {"cabinet_1": "cabinet", "plate_4": "plate"}
    assert {b.name: b.category for b in indoors.bodies} == {"pot_2": "pot", "jar_3": "jar", "bottle_5": "bottle"}
    assert {b.name: (b.mass, b.friction) for b in indoors.bodies} == {
        "pot_2": (2.5, 0.45),
        "jar_3": (1.0, None),
        "bottle_5": (1.0, None),
    }
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


@pytest.mark.parametrize(
    ("there", "here"), [("x_max", "east"), ("x_min", "west"), ("z_max", "north"), ("z_min", "south")]
)
def test_flood_sides(tmp_path: Path, there: str, here: str) -> None:
    assert read(folder(tmp_path / "a", kitchen(), FIRE_INFO, {"flood_source_from": there})).spec.flood_side == here


def test_sizes_are_those_of_the_table(indoors: SceneSpec) -> None:
    """The cabinet is turned by a quarter, and so is our model of it at most; sizes along its own axes, ours."""
    for i, size in {1: (0.9143, 0.64652, 0.92142), 2: (0.38652, 0.45764, 0.33737)}.items():
        thing = of_id(indoors, i)
        mine = np.array(asset(thing.asset).extent) * thing.scale
        assert sorted(mine[:2]) == pytest.approx(sorted(size[:2]), abs=5e-4) and mine[2] == pytest.approx(
            size[2], abs=5e-4
        )


def test_scale_factors_count_against_the_table(tmp_path: Path) -> None:
    """The table's apple, 0.101 m wide, is of scale factor 0.08862933.

    With twice that it is twice as large, then 3 times as high.
    """
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
    assert shelf.scale == pytest.approx((0.94517, 0.38577, 1.2)) and abs(matrix(shelf.rotation)[0, 1]) == pytest.approx(
        1.0
    )


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


def test_an_agent_shut_in_by_furniture() -> None:
    """In the corner behind two cabinets a robot would have room to stand, but no way out."""
    walls = [
        Fixture(f"cabinet_{k}", "cabinet", "plain_box", (*at, 0.0), scale=size)
        for k, (at, size) in enumerate((((1.0, 0.5), (0.2, 1.0, 0.9)), ((0.55, 1.1), (1.1, 0.2, 0.9))))
    ]
    found, note = start((0.45, 0.5), Room((4.0, 4.0)), walls)
    assert "agent starts" in note and (found.position[0] > 1.1 + 0.28 or found.position[1] > 1.2 + 0.28)
    assert math.dist(found.position, (0.45, 0.5)) < 1.1
    assert start((0.45, 0.5), Room((4.0, 4.0)), walls[:1]) == (AgentStart((0.45, 0.5), START_HEADING), "")
