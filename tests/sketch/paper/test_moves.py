"""The six actions in the sketch: what each does, what it costs, and what is punished, worked out by hand."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from hazard_ms.sketch.environments.choices import choices
from hazard_ms.sketch.environments.rewarded import Rewarded
from hazard_ms.sketch.paper.moves import SixSketch
from hazard_ms.sketch.rescues.state import TRAINING
from hazard_ms.skills.options.environment import IDLE
from hazard_ms.skills.options.paper_actions import COUNT, LET_GO, LOOK, TAKE, TO_CART, TO_TARGET, WANDER
from tests.worlds.sketch_scenes import (
    BAG_FRAMES,
    CART_FRAMES,
    LOOK_FRAMES,
    PICK_FRAMES,
    chancy_times,
    random_scene,
    scene,
    sure_times,
)

FIRE = [(20.0, 600.0)]
WALK, SETTLE = 62.0, 3.0  # of a walk [frames/m], [frames]
AHEAD: dict[str, Any] = {"position": [(0.0, 0.0), (4.0, 0.0)], "targets": [1]}
BEHIND: dict[str, Any] = {"position": [(0.0, 0.0), (-4.0, 0.0)], "targets": [1]}
NEAR: dict[str, Any] = {"position": [(0.0, 0.0), (2.0, 0.0)], "targets": [1]}
TWO: dict[str, Any] = {"position": [(0.0, 0.0), (2.0, 0.0), (4.5, 0.0)], "targets": [1, 2]}
CART: dict[str, Any] = {"position": [(0.0, 0.0), (2.0, 0.0), (5.0, 0.0)], "targets": [1], "cart_site": [2]}
LATER: dict[str, Any] = {"position": [(0.0, 0.0), (2.0, 0.0), (-5.0, 0.0)], "targets": [1], "cart_site": [2]}
BAG_SITUATIONS = {
    # what is done: scene, actions before, action, whether it can be done, reward
    "a step to a target 4 m ahead": (AHEAD, [], TO_TARGET, True, 10.0 - 0.1),
    "a step to a target that was never seen": (BEHIND, [], TO_TARGET, False, -5.1),
    "a step to a cart where there is none": (AHEAD, [], TO_CART, False, -5.1),
    "4 m away is too far to pick up": (AHEAD, [], TAKE, False, -5.1),
    "2 m away is not: 20 for the way, -10 for holding": (NEAR, [], TAKE, True, 9.9),
    "hands are full": (TWO, [TAKE], TAKE, False, -5.1),
    "hands are empty": (NEAR, [], LET_GO, False, -5.1),
    "into the bag: 20, and no more holding": (NEAR, [TAKE], LET_GO, True, 29.9),
    "a look around": (NEAR, [], LOOK, True, -0.1),
    "a look around with full hands": (NEAR, [TAKE], LOOK, True, -0.1),
    "nothing in sight to walk to": (BEHIND, [], WANDER, False, -5.1),
    "nothing left to walk to": (NEAR, [TAKE], WANDER, False, -5.1),
}
CART_SITUATIONS = {
    "a step to the cart, on which the target comes nearer": (CART, [], TO_CART, True, 9.9),
    "a step to a cart that was never seen": (LATER, [], TO_CART, False, -5.1),
    "picking up 2 m ahead: from 20 to the target to 35 to the cart": (CART, [], TAKE, True, -15.1),
    "a step to the cart with full hands": (CART, [TAKE], TO_CART, True, 9.9),
    "the cart is 3.5 m away": (CART, [TAKE], LET_GO, False, -5.1),
    "the cart is 1.5 m away: 15, and 20": (CART, [TAKE, TO_CART, TO_CART], LET_GO, True, 34.9),
    "no cart is known": (LATER, [TAKE], LET_GO, False, -5.1),
    "a cart, and empty hands": (CART, [], LET_GO, False, -5.1),
    "a cart, and full hands": (CART, [TAKE], TAKE, False, -5.1),
    "the only target is in the hand": (CART, [TAKE], TO_TARGET, False, -5.1),
    "looking for a cart": (LATER, [TAKE], LOOK, True, -0.1),
    "a step to the target": (CART, [], TO_TARGET, True, 9.9),
}


def rescue(made: dict[str, Any], **more: Any) -> Rewarded:
    """One rescue in a scene of `made`, just begun."""
    kinds = {k: np.array(v) if k == "cart_site" else v for k, v in made.items()}
    play = Rewarded(choices("paper", [scene(**kinds, **more)], FIRE, sure_times(), 1), "paper")
    play.reset([0], [0])
    return play


@pytest.mark.parametrize("what", [*BAG_SITUATIONS, *CART_SITUATIONS])
def test_what_an_action_is_worth(what: str) -> None:
    made, before, action, can, wanted = {**BAG_SITUATIONS, **CART_SITUATIONS}[what]
    play = rescue(made)
    for number in before:
        assert play.step([number])[3].allowed.all()
    start = int(play.sketch.state.frame[0])
    reward, _, _, played = play.step([action])
    assert bool(played.allowed[0]) is can and bool(played.ok[0]) is can
    assert float(reward[0]) == pytest.approx(wanted, abs=0.2)  # ways begin at the middles of cells
    if not can:
        assert float(reward[0]) == pytest.approx(-5.1) and int(play.sketch.state.frame[0]) == start + IDLE


def test_a_rescue_in_pieces_takes_as_long_as_one_option() -> None:
    """Two metres of walking, a pick-up and the bag, however it is cut; only the settling is shared out."""
    whole = round(WALK * 1.5 + SETTLE) + PICK_FRAMES + BAG_FRAMES
    play = rescue(NEAR)
    for action in (TO_TARGET, TAKE, LET_GO):
        reward, terminated, truncated, _ = play.step([action])
    assert terminated.tolist() == [True] and truncated.tolist() == [False]
    assert whole <= int(play.sketch.state.frame[0]) <= whole + SETTLE + 1
    carried = rescue(CART)
    for action in (TAKE, TO_CART, TO_CART, LET_GO):
        assert not carried.sketch.state.over[0]
        carried.step([action])
    want = round(WALK * 1.5 + SETTLE) + PICK_FRAMES + round(WALK * 3.0 + SETTLE) + CART_FRAMES
    assert want <= int(carried.sketch.state.frame[0]) <= want + 2 * SETTLE + 2


def test_a_walk_to_a_thing_in_sight_goes_on_until_it_is_there() -> None:
    """Almost seven metres take four walks of 100 frames; the thing stays the same though others come into sight."""
    sites = [(0.0, 0.0), (7.0, 0.0), (6.0, 3.0), (3.0, -5.0)]
    play = rescue({"position": sites, "targets": [1]}, landmark_site=np.array([2, 3]))
    state = play.sketch.state
    state.known[0] = [False, True, False]
    play.step([WANDER])
    assert state.goal[0] == 1 and 95 <= int(state.frame[0]) <= 101
    state.known[0] = True
    walks = 1
    while state.goal[0] >= 0:
        assert state.goal[0] == 1 and walks < 6
        play.step([WANDER])
        walks += 1
    assert np.hypot(*(state.place[0] - (6.0, 3.0))) == pytest.approx(0.5, abs=0.1) and walks == 4
    assert play.step([LOOK])[3].ok.all() and int(state.frame[0]) > LOOK_FRAMES


def test_what_is_lost_on_the_way_lies_where_the_robot_was() -> None:
    """Into a bag that always misses, a step away from the target."""
    from hazard_ms.sketch.skill_times import SKILLS, SkillRow, SkillTimes

    times = SkillTimes("fetch", tuple(SkillRow(s, 1, float(s != "bag"), (10.0,), (10.0,)) for s in SKILLS))
    made = scene([(0.0, 0.0), (1.0, 0.0), (9.0, 0.0), (5.0, 0.0)], [1, 2], landmark_site=np.array([3]))
    sketch = SixSketch([made], times, 1)
    sketch.reset([0], [0])
    for action in (TAKE, TO_TARGET, TO_TARGET, TO_TARGET, TO_TARGET):
        assert sketch.act([action])[1].all()
    assert sketch.state.place[0, 0] == pytest.approx(4.5, abs=0.2)
    sketch.act([LET_GO])
    assert not sketch.worked[0] and sketch.state.held[0] == -1 and sketch.state.laid[0].tolist() == [3, -1]
    assert sketch.possible()[0, TAKE]  # it is near


@pytest.mark.parametrize("carts", [0, 2])
def test_a_rescue_goes_the_same_alone_as_among_many(carts: int) -> None:
    scenes = [random_scene(seed, carts=carts, moving=True) for seed in range(4)]
    many, seeds, chance = SixSketch(scenes, chancy_times(), 24, TRAINING), np.arange(24), np.random.default_rng(0)
    many.reset(seeds % 4, seeds)
    alone = [SixSketch([scenes[n % 4]], chancy_times(), 1, TRAINING) for n in range(24)]
    for n, one in enumerate(alone):
        one.reset([0], [n])
    for _ in range(30):
        action = chance.integers(0, COUNT, 24)
        gained, allowed, over = many.act(action)
        for n, one in enumerate(alone):
            want = [float(part[0]) for part in one.act(action[n : n + 1])]
            assert want == pytest.approx([gained[n], float(allowed[n]), float(over[n])])
            assert int(one.state.frame[0]) == int(many.state.frame[n])
            np.testing.assert_allclose(one.state.place[0], many.state.place[n])


@pytest.mark.parametrize("carts", [0, 2])
def test_the_rewards_of_episodes_add_up_to_their_value(carts: int) -> None:
    """And what masks allow is never punished."""
    scenes = [random_scene(seed, carts=carts, moving=True) for seed in range(6)]
    made = choices("paper", scenes, FIRE, chancy_times(), 48, masked=True, domain=TRAINING)
    play, seeds, chance, total = Rewarded(made), np.arange(48), np.random.default_rng(0), np.zeros(48)
    play.reset(seeds % 6, seeds)
    state = play.sketch.state
    while not state.over.all():
        running, mask = ~state.over, made.mask
        reward, _, _, played = play.step((chance.random(mask.shape) * mask).argmax(axis=1))
        assert played.allowed[running].all() and not mask[~running].any()
        total += reward
    worth = np.where(state.spoiled, 0.5, 1.0) * state.value * (state.rescued_at >= 0)
    assert total == pytest.approx(worth.sum(axis=1) / state.value.sum(axis=1)) and 0.02 < total.mean() < 0.95


def test_anything_but_numbers_of_actions_is_refused() -> None:
    sketch = SixSketch([random_scene(0)], chancy_times(), 2)
    sketch.reset([0, 0], [0, 1])
    for wrong in (np.array([0]), np.array([0, COUNT]), np.array([-1, 0]), np.array([0.0, 1.0])):
        with pytest.raises(ValueError, match="action must be"):
            sketch.act(wrong)
