"""Maps of what robots in the sketch know: as those of decisions, but for what needs depth images."""

from __future__ import annotations

import numpy as np

from hazard_ms.sketch.paper.maps import MISSING, MapMaker
from hazard_ms.sketch.paper.moves import SixSketch
from hazard_ms.sketch.rescues.state import TRAINING
from hazard_ms.skills.options.paper_actions import COUNT, TAKE
from hazard_ms.skills.options.paper_map import AGENT, EXPLORED, HEIGHT, LEVEL, THING, MapLayout
from tests.worlds.playground import Playground
from tests.worlds.sketch_scenes import chancy_times, random_scene, scene, sure_times

FIRE = (20.0, 600.0)
SITES = [(0.0, 0.0), (1.1, 0.0), (0.6, 2.6), (3.1, -1.1), (2.0, 2.0)]


def sketch() -> SixSketch:
    """Two targets, a cart and a landmark, all ahead; the level over targets is 120."""
    made = scene(SITES, [1, 2], cart_site=np.array([3]), landmark_site=np.array([4]), level=np.full((1, 2, 1), 120.0))
    rescue = SixSketch([made], sure_times(), 1)
    rescue.reset([0], [0])
    rescue.state.known[:] = True
    rescue.state.seen_site[0] = [1, 2]
    return rescue


def test_things_and_the_agent_are_drawn_as_in_the_simulator() -> None:
    """There, the same things were seen from the same place; afterwards the first target is in the hand."""
    places = dict(zip(("mug", "book", "cart_1", "shelf"), SITES[1:], strict=True))
    ground = Playground(places, {"mug": 5.0, "book": 5.0}, carts=("cart_1",), sight=9.0)
    ground.look()
    rescue, layout = sketch(), MapLayout([FIRE])
    for _ in range(2):
        ours, want = MapMaker([FIRE]).draw(rescue)[0], layout.encode(ground.decision())
        for plane in (THING, AGENT):
            np.testing.assert_array_equal(ours[plane], want[plane])
        assert layout.space().contains(ours)
        rescue.act([TAKE])
        ground.held, ground.at = "mug", tuple(rescue.state.place[0].tolist())
    assert rescue.state.held[0] == 0 and rescue.state.place[0, 0] > 0.4


def test_levels_are_known_where_targets_were_seen_and_heights_nowhere() -> None:
    rescue = sketch()
    rescue.state.seen_level[0, :, 0, 0] = [120.0, 320.0]
    made = MapMaker([FIRE]).draw(rescue)[0]
    assert sorted(made[LEVEL][made[LEVEL] != 0.0]) == [np.float32(np.log1p(100.0)), np.float32(np.log1p(300.0))]
    assert made[LEVEL][made[THING] == 0.0].tolist() == [np.float32(np.log1p(100.0))]
    assert MISSING == (HEIGHT,) and not made[HEIGHT].any()


def test_explored_floor_lies_around_landmarks_of_which_it_was_seen() -> None:
    """Sixteen blocks of 0.75 m around the landmark cover most of a circle of 2 m; with none seen, only the own cell."""
    rescue = sketch()
    rescue.state.spots[0] = 0
    assert MapMaker([FIRE]).draw(rescue)[0, EXPLORED].sum() == 1.0
    rescue.state.spots[0] = 2**16 - 1
    made = MapMaker([FIRE]).draw(rescue)[0, EXPLORED]
    y, x = np.nonzero(made)
    away = np.hypot((x + 0.5) * 0.25 - 8.0 - 2.0, (y + 0.5) * 0.25 - 8.0 - 2.0)
    assert 0.6 * np.pi * 4.0 < made.sum() * 0.0625 < 1.1 * np.pi * 4.0 and np.sort(away)[-2] < 2.6


def test_a_map_shows_nothing_but_what_is_known() -> None:
    """Over whole episodes, among them of things that move: each mark is of a thing that is known or in the hand."""
    scenes = [random_scene(seed, carts=2 * (seed % 2), moving=True) for seed in range(4)]
    rescue, maker, chance = SixSketch(scenes, chancy_times(), 16, TRAINING), MapMaker([FIRE]), np.random.default_rng(0)
    rescue.reset(np.arange(16) % 4, np.arange(16))
    space = maker.layout.space()
    for _ in range(25):
        made, known = maker.draw(rescue), rescue.known()
        targets = rescue.state.value.shape[1]
        for n in range(16):
            assert space.contains(made[n])
            shown = {round(32 * mark) for mark in made[n, THING][(made[n, THING] >= 0.0) & (made[n, THING] < 1.0)]}
            assert shown <= {*np.flatnonzero(known[n, :targets]).tolist(), int(rescue.state.held[n])} - {-1}
        rescue.act(chance.integers(0, COUNT, 16))
