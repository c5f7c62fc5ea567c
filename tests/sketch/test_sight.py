"""What a head camera sees: by hand, and against rays cast at boxes pixel by pixel."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from hazard_ms.scenes.assets.index import asset
from hazard_ms.sketch import sight as module
from hazard_ms.sketch.sight import FETCH, Sight
from hazard_ms.spec import AgentStart, Body, Fixture, Partition, Room, SceneSpec
from hazard_ms.spec.scene import Opening
from tests.worlds.rays import Block, cast, looking

ROOM = Room((8.0, 8.0))
HERE = (4.0, 4.0)  # where the robot is [m]
FACING = (0.7071068, 0.0, 0.0, 0.7071068)  # turned by 90 degrees
CAMERA = np.array([HERE[0] + FETCH.ahead, HERE[1], FETCH.height])  # while it faces +x


def spec(bodies: tuple[Body, ...] = (), fixtures: tuple[Fixture, ...] = (), room: Room = ROOM) -> SceneSpec:
    """A room with things, of which printers are targets."""
    return SceneSpec("test/sight", room, fixtures, bodies, ("printer",), (), AgentStart(HERE))


def printer(x: float, y: float, z: float = 0.0) -> Body:
    return Body("printer_1", "printer", "printer_1", (x, y, z))


def sees(scene: SceneSpec, heading: float = 0.0, thing: int = 0) -> bool:
    return bool(Sight(scene).visible([HERE], heading, [thing])[0, 0])


@pytest.mark.parametrize("heading", np.deg2rad([0.0, 90.0, 200.0]))
def test_what_is_ahead_is_seen_and_what_is_behind_is_not(heading: float) -> None:
    """Up to 60 degrees to each side, and a little more on the floor, because the camera looks down."""
    eye = np.array(HERE) + FETCH.ahead * np.array([np.cos(heading), np.sin(heading)])
    for off, seen in ((0, True), (55, True), (-55, True), (80, False), (-80, False), (180, False)):
        place = eye + 2.5 * np.array([np.cos(heading + np.deg2rad(off)), np.sin(heading + np.deg2rad(off))])
        here = spec((printer(*place),))
        assert sees(here, heading) == seen, off
        assert Sight(here).visible([HERE], None, [0]).all()


def test_what_stands_too_high_is_above_the_picture() -> None:
    """The camera looks 20 degrees down, so that the picture ends 40 degrees above the horizon."""
    for up, seen in ((30.0, True), (50.0, False)):
        height = CAMERA[2] + 2.0 * np.tan(np.deg2rad(up))
        assert sees(spec((printer(CAMERA[0] + 2.0, CAMERA[1], height - 0.1),))) == seen
        assert Sight(spec((printer(6.0, 4.0, height),))).visible([HERE], None, [0])[0, 0] == seen


def test_furniture_hides_what_is_behind_it_and_not_what_is_on_or_under_it() -> None:
    cabinet = Fixture("cabinet_1", "cabinet", "cabinet_1", (6.0, 4.0, 0.0), FACING)
    table = Fixture("table_1", "table", "table_1", (6.0, 4.0, 0.0))
    top = asset("table_1").extent[2]
    assert not sees(spec((printer(7.0, 4.0),), (cabinet,)))
    assert sees(spec((printer(6.0, 4.0, asset("cabinet_1").extent[2] - 0.3),), ()))
    assert sees(spec((printer(6.0, 4.0, top),), (table,)))
    assert sees(spec((printer(6.0, 4.0),), (table,)))
    assert sees(spec((printer(7.0, 4.0),), (cabinet,)), thing=1)
    assert sees(spec((printer(7.0, 4.0),), (replace(cabinet, position=(3.6, 4.0, 0.0)),)))  # behind the robot


def test_what_is_behind_a_chair_is_seen_through_its_back(monkeypatch: pytest.MonkeyPatch) -> None:
    chairs = tuple(Fixture(f"chair_{i}", "chair", "chair_3", (5.2, 3.7 + 0.3 * i, 0.0), FACING) for i in range(3))
    apple = Body("apple_1", "apple", "apple_1", (5.8, 4.0, 0.0))
    assert sees(spec((apple,), chairs))
    monkeypatch.setattr(module, "SEE_THROUGH", ())
    assert not sees(spec((apple,), chairs))


def test_walls_hide_what_is_behind_them_but_not_behind_their_doorways() -> None:
    wall, door = Partition("partition_1", "y", 5.5), Opening("doorway", "partition_1", 4.0, 1.2, 2.05)
    for openings, at, seen in (((), 4.0, False), ((door,), 4.0, True), ((door,), 6.5, False)):
        room = replace(ROOM, partitions=(wall,), openings=openings)
        assert sees(spec((printer(7.0, at),), room=room)) == seen
        assert Sight(spec(room=room)).clear([HERE], [(7.0, at, 0.0)])[0, 0] == seen


def test_bodies_block_the_view_unless_they_are_targets_or_left_out() -> None:
    key = Body("key_1", "key", "key_1", (6.5, 4.0, 0.0))
    box = Body("suitcase_1", "suitcase", "suitcase_1", (6.0, 4.0, 0.0), FACING)
    hidden = spec((key, box))
    assert not Sight(hidden).visible([(5.0, 4.0)], 0.0, [0]).any()
    assert Sight(hidden, bodies=()).visible([(5.0, 4.0)], 0.0, [0]).all()
    assert Sight(replace(hidden, target_categories=("suitcase",))).visible([(5.0, 4.0)], 0.0, [0]).all()


def test_things_are_seen_where_they_are_now() -> None:
    here = Sight(spec((printer(6.0, 4.0),)))
    now = np.array([[(2.0, 4.0, 0.1)], [(6.0, 4.0, 0.1)]])
    assert here.visible([HERE, HERE], 0.0, [0], now).ravel().tolist() == [False, True]
    assert here.visible([HERE, HERE], [np.pi, 0.0], [0], now[0]).ravel().tolist() == [True, False]


def test_places_of_another_shape_are_refused() -> None:
    with pytest.raises(ValueError, match=r"places must have shape \[P, 2\], got \[3\]"):
        Sight(spec()).visible((1.0, 2.0, 3.0), None, [])


def test_a_look_alone_is_that_of_many(monkeypatch: pytest.MonkeyPatch) -> None:
    scene, rng = cluttered(np.random.default_rng(3)), np.random.default_rng(1)
    places, heading = rng.uniform(1.0, 7.0, (40, 2)), rng.uniform(-np.pi, np.pi, 40)
    every = np.arange(len(scene.things))
    whole = Sight(scene).pixels(places, heading, every)
    monkeypatch.setattr(module, "AT_ONCE", 1)
    alone = np.concatenate([Sight(scene).pixels(p[None], h, every) for p, h in zip(places, heading, strict=True)])
    assert np.array_equal(whole, Sight(scene).pixels(places, heading, every))
    assert np.allclose(whole, alone, rtol=1e-4)


def test_boxes_that_are_left_out_block_no_line(monkeypatch: pytest.MonkeyPatch) -> None:
    """Only boxes that lie near a line are looked at."""
    places, every = np.random.default_rng(1).uniform(1.0, 7.0, (60, 2)), np.arange(15)
    scene = cluttered(np.random.default_rng(3))
    some = Sight(scene).pixels(places, None, every)
    monkeypatch.setattr(module, "_passing", lambda start, line, point: np.zeros(line.shape[:2]))
    assert np.array_equal(some, Sight(scene).pixels(places, None, every))


def cluttered(rng: np.random.Generator) -> SceneSpec:
    """A room with five cabinets and ten things on the floor, all along its walls' axes, none near the middle."""
    at = [p for p in np.mgrid[0.6:8.0:1.2, 0.6:8.0:1.2].reshape(2, -1).T if np.hypot(*(p - HERE)) > 1.2]
    spots = [(float(x), float(y), 0.0) for x, y in rng.permutation(at)[:15]]
    fixtures = tuple(Fixture(f"cabinet_{i}", "cabinet", "cabinet_8", p) for i, p in enumerate(spots[:5]))
    kinds = ("printer_1", "suitcase_1", "apple_1", "key_1", "bowl_1")
    bodies = tuple(
        Body(f"{kinds[i % 5]}_{i}", kinds[i % 5].split("_")[0], kinds[i % 5], p) for i, p in enumerate(spots[5:])
    )
    return spec(bodies, fixtures)


def block(thing: Body | Fixture, label: int) -> Block:
    half, (x, y, z) = np.array(asset(thing.asset).extent) / 2, thing.position
    return Block((x - half[0], y - half[1], z), (x + half[0], y + half[1], z + 2 * half[2]), label)


def test_it_agrees_with_rays_cast_at_boxes(monkeypatch: pytest.MonkeyPatch) -> None:
    """Here all things are boxes, so that they fill their outline."""
    monkeypatch.setattr(module, "FILLED", 1.0)
    real, sketch = [], []
    for seed in range(8):
        scene, heading = cluttered(np.random.default_rng(seed)), 0.5 * seed
        ahead = np.array([np.cos(heading), np.sin(heading), 0.0])
        eye = np.array([*HERE, FETCH.height]) + FETCH.ahead * ahead
        down = np.cos(FETCH.down) * ahead - np.array([0.0, 0.0, np.sin(FETCH.down)])
        blocks = tuple(block(thing, i) for i, thing in enumerate(scene.things))
        _, label = cast(looking(tuple(eye), tuple(eye + down)), FETCH.pixels, blocks, (8.0, 8.0, 3.0))
        real.append(np.bincount(label[label >= 0], minlength=len(blocks)))
        every = np.arange(len(blocks))
        sketch.append(Sight(scene, bodies=[b.name for b in scene.bodies]).pixels([HERE], heading, every)[0])
    truth, guess = np.concatenate(real), np.concatenate(sketch)
    seen = truth >= 3
    assert (guess[seen] >= 3).mean() > 0.93 and (truth[guess >= 3] >= 3).mean() > 0.93
    plain = (truth > 30) & (guess > 0)
    assert np.median(guess[plain] / truth[plain]) == pytest.approx(1.0, abs=0.05)
