"""The check of scenes: silent about what is right, and a word for everything that was spoiled on purpose."""

from __future__ import annotations

import dataclasses
import re
from typing import Any

import numpy as np
import pytest

from hazard_ms.scenes.assets.index import asset
from hazard_ms.scenes.check import check
from hazard_ms.scenes.solids import corners_of, gap
from hazard_ms.scenes.splits import all_scene_names, scene
from hazard_ms.simulation import rest_check
from hazard_ms.spec import AgentStart, Body, Fixture, Partition, Room, SceneSpec

SPEC = scene("kitchen_a/03")
FIRST = tuple(n for n in all_scene_names() if n.endswith("/08"))


def with_body(spec: SceneSpec, which: str, /, **changes: Any) -> SceneSpec:
    """The scene with one body changed."""
    return dataclasses.replace(
        spec, bodies=tuple(dataclasses.replace(b, **changes) if b.name == which else b for b in spec.bodies)
    )


@pytest.mark.parametrize("name", FIRST)
def test_generated_scenes_are_right_and_at_rest(name: str) -> None:
    spec = scene(name)
    assert check(spec) == []
    moved = rest_check.settle(spec)
    assert set(moved) == {b.name for b in spec.bodies}
    assert max(moved.values()) <= 0.02


@pytest.mark.long
@pytest.mark.parametrize("name", all_scene_names())
def test_all_scenes_are_right_and_at_rest(name: str) -> None:
    assert check(scene(name)) == [] and rest_check.check(scene(name)) == []


def test_what_was_spoiled_is_found() -> None:
    target, other = SPEC.targets[0], SPEC.bodies[-1]
    table = next(f for f in SPEC.fixtures if f.category == "table")
    (w, d), at = SPEC.room.size, table.position
    corner = next(c for c in ((0.0, 0.0), (w, 0.0), (0.0, d), (w, d)))
    for spoiled, words in (
        (
            with_body(SPEC, other.name, position=target.position),
            f"{other.name} and {target.name} are inside each other",
        ),
        (
            with_body(SPEC, target.name, position=(at[0], at[1], 0.3)),
            f"{target.name}.*{table.name}|{table.name}.*{target.name}",
        ),
        (with_body(SPEC, target.name, position=(w + 1.0, 1.0, 0.0)), f"{target.name} at .* reaches out of the room"),
        (with_body(SPEC, target.name, position=(1.0, 1.0, -0.1)), f"{target.name} at .* reaches out of the room"),
        (
            with_body(SPEC, target.name, position=(*target.position[:2], 1.9)),
            f"height of {target.name} above the floor must be",
        ),
        (with_body(SPEC, target.name, mass=500.0), f"mass of {target.name} must be .* kg, got 500"),
        (with_body(SPEC, target.name, mass=1e-5), f"mass of {target.name} must be .* kg, got 0.0000"),
        (with_body(SPEC, target.name, scale=(40.0, 40.0, 40.0)), f"length of {target.name} must be"),
        (
            with_body(SPEC, target.name, asset="unobtainium_1"),
            f"asset of {target.name} must be one of the assets, got 'unobtainium_1'",
        ),
        (with_body(SPEC, target.name, name=other.name), "names of things must differ"),
        (dataclasses.replace(SPEC, fires=(at[:2],)), "something stands where it burns"),
        (dataclasses.replace(SPEC, agent_start=AgentStart(at[:2])), "the robot does not fit where it starts"),
        (dataclasses.replace(SPEC, agent_start=AgentStart(corner)), "the robot does not fit where it starts"),
        (dataclasses.replace(SPEC, flood_side="above"), "flood_side must be one of south"),
    ):
        problems = "\n".join(check(spoiled))
        assert re.search(words, problems), f"{words!r} is not in {problems!r}"


def test_a_wall_without_a_way_cuts_targets_off() -> None:
    flat = scene("flat_a/02")
    shut = dataclasses.replace(flat, room=dataclasses.replace(flat.room, openings=flat.room.openings[:0]))
    wall = flat.room.partitions[0].at
    beyond = {t.name for t in flat.targets if (t.position[0] < wall) != (flat.agent_start.position[0] < wall)}
    assert beyond, "a scene with targets in both rooms"
    found = {p.split(" of ")[1].split(",")[0] for p in check(shut) if p.startswith("the robot must get to within")}
    assert found == beyond


def test_what_stands_in_a_wall_is_found() -> None:
    walled = dataclasses.replace(SPEC.room, partitions=(Partition("partition_1", "y", SPEC.bodies[0].position[0]),))
    assert f"{SPEC.bodies[0].name} is inside a wall" in check(dataclasses.replace(SPEC, room=walled))


def test_open_places_pass_the_same_check() -> None:
    """Houses may reach out of an open place, things may not; carts must be in reach."""
    ground = Room((8.0, 8.0), 12.0, "tile", open_air=True, beyond=4.0)
    apple, house = asset("apple_1").extent, Fixture("fridge_1", "fridge", "fridge_1", (-6.0, 9.0, 0.0))
    assert max(apple) < 0.2
    body = Body("apple_1", "apple", "apple_1", (4.0, 4.0, 0.0))
    spec = SceneSpec("open/00", ground, (house,), (body,), ("apple",), (), AgentStart((2.0, 2.0)))
    assert check(spec) == []
    assert "reaches out" in check(with_body(spec, "apple_1", position=(13.0, 4.0, 0.0)))[0]
    cart = Fixture("cart_1", "cart", "bin_1", (-6.0, 4.0, 0.0))
    assert any("of cart_1" in p for p in check(dataclasses.replace(spec, fixtures=(cart,))))


def test_the_simulator_finds_what_floats_and_what_leans() -> None:
    target = SPEC.targets[0]
    x, y, z = target.position
    assert any(
        p.startswith(f"{target.name} must move at most")
        for p in rest_check.check(with_body(SPEC, target.name, position=(x, y, z + 0.3)))
    )
    tall = next(b for b in SPEC.bodies if asset(b.asset).extent[2] > 2.5 * min(asset(b.asset).extent[:2]))
    tilted = with_body(SPEC, tall.name, rotation=(float(np.cos(0.3)), float(np.sin(0.3)), 0.0, 0.0))
    assert any(p.startswith(f"{tall.name} must move at most") for p in rest_check.check(tilted))


def test_gaps_of_turned_boxes() -> None:
    """Two fridges: side by side, corner to face, and one inside the other, by hand."""
    wide, deep, high = asset("fridge_3").extent
    first = corners_of(Fixture("a", "fridge", "fridge_3", (0.0, 0.0, 0.0)))
    aside = corners_of(Fixture("b", "fridge", "fridge_3", (wide + 0.1, 0.0, 0.0)))
    assert gap(first, aside) == pytest.approx(0.1)
    turned = corners_of(
        Fixture("b", "fridge", "fridge_3", (2.0, 0.0, 0.0), (np.cos(np.pi / 8), 0.0, 0.0, np.sin(np.pi / 8)))
    )
    assert gap(first, turned) == pytest.approx(2.0 - wide / 2 - (wide + deep) / 2 / np.sqrt(2))
    above = corners_of(Fixture("b", "fridge", "fridge_3", (0.0, 0.0, high - 0.05)))
    assert gap(first, above) == pytest.approx(-0.05)
    assert first.min(0) == pytest.approx([-wide / 2, -deep / 2, 0.0]) and first.max(0) == pytest.approx(
        [wide / 2, deep / 2, high]
    )
