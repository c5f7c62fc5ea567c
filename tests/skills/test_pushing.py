"""The skill `push` in real physics: a cart, a wall that is in its way, things in the basket, and the force on it."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator

import numpy as np
import pytest

import hazard_ms  # noqa: F401 registers the environments
from hazard_ms.skills import failures
from hazard_ms.skills.decision import Result
from hazard_ms.skills.executor import SkillEnv
from hazard_ms.skills.mitigations.carts import SHORT
from hazard_ms.skills.pushing import THERE, cart_ways, push
from hazard_ms.spec import AgentStart, Body, Fixture, Room, SceneSpec, Task
from hazard_ms.tasks.gale import hazard_gale
from hazard_ms.tasks.wind import hazard_wind
from tests.worlds.registering import registered_task

pytestmark = pytest.mark.render
LOT = SceneSpec(  # a cart 2 m ahead of the robot, 3 m beyond it a wall across its way, and a bottle in its basket
    name="test/lot",
    room=Room((12.0, 12.0), 12.0, "asphalt", "plaster", open_air=True, beyond=4.0),
    fixtures=(
        Fixture("cart_1", "cart", "cart_1", (5.0, 6.0, 0.0), (0.7071068, 0.0, 0.0, 0.7071068)),
        Fixture("shed_1", "shed", "plain_box", (9.0, 6.0, 0.0), scale=(0.4, 3.0, 1.5)),
    ),
    bodies=(Body("bottle_1", "bottle", "plain_box", (5.0, 6.0, 0.47), scale=(0.1, 0.1, 0.2), mass=1.0),),
    target_categories=("bottle",),
    fires=(),
    agent_start=AgentStart((3.0, 6.0)),
    wind=(0.001, 0.0),
)


def lot(of: object, spec: SceneSpec = LOT) -> object:
    def task(physics: str) -> Task:
        return dataclasses.replace(of(physics), scenes=lambda split: (spec.name,), build=lambda name: spec)  # type: ignore[operator]

    return task


@pytest.fixture(scope="module")
def env() -> Iterator[SkillEnv]:
    with registered_task("HazardLot-v1", lot(hazard_gale)):
        made = SkillEnv.make("HazardLot-v1", reward_mode="none")
        yield made
        made.close()


def pushed(env: SkillEnv, goal: tuple[float, float]) -> Result:
    env.reset(seed=0)
    return env.run(push(env.stage, env.labeller.index("cart_1"), goal))


def place(env: SkillEnv, name: str = "cart_1") -> np.ndarray:
    return env.base.world.position[0, env.base.world.index(0, name)].numpy().astype(float)


@pytest.mark.parametrize("goal", [(7.0, 6.0), (5.6, 7.6), (4.0, 6.0)], ids=["ahead", "aside", "back"])
def test_a_cart_goes_where_it_is_pushed(env: SkillEnv, goal: tuple[float, float]) -> None:
    """And what lies in its basket goes with it, and stays safe."""
    result = pushed(env, goal)
    assert result.ok, result
    assert np.hypot(*(place(env)[:2] - goal)) <= THERE
    assert bool(env.base.world.safe[0, env.base.world.index(0, "bottle_1")])
    assert np.hypot(*(place(env, "bottle_1") - place(env))[:2]) < 0.45 and place(env, "bottle_1")[2] > 0.45
    gap = np.hypot(*(place(env)[:2] - env.stage.robot.base()[:2]))
    assert gap > 0.45  # it has drawn back


def test_it_stops_where_the_cart_is_held_fast(env: SkillEnv) -> None:
    """The wall, which is wiped off the map, is at 8.8 m; the cart is 0.93 m long: its middle gets to 8.33 m at most."""
    env.reset(seed=0)
    env.seen.clear(np.stack(np.meshgrid(np.arange(8.0, 10.0, 0.05), np.arange(3.0, 9.0, 0.05)), -1).reshape(-1, 2))
    result = env.run(push(env.stage, env.labeller.index("cart_1"), (9.5, 6.0)))
    assert (result.ok, result.reason) == (False, failures.BLOCKED)
    assert 8.0 < place(env)[0] < 8.40


def test_it_goes_round_what_the_map_shows(env: SkillEnv) -> None:
    """Beyond the wall, 3 m wide from 8.8 to 9.2 m: its end is at 7.5 m, where the cart needs 0.5 m more."""
    env.reset(seed=0)
    env.seen.tell(np.zeros_like(env.seen.height), np.ones_like(env.seen.explored))
    path = cart_ways(env.seen, np.array([5.0, 6.0]), [np.array([10.5, 6.0])], 0.2)[0]
    assert path is not None and 6.2 < path.length < 8.0  # through (9, 8) it is 2 x 4.5 m less what two corners save
    at = np.vstack([[5.0, 6.0], path.points])
    xs = np.linspace(0.0, 1.0, 50)[:, None, None]
    along = (at[:-1] + xs * np.diff(at, axis=0)).reshape(-1, 2)
    beside = along[(along[:, 0] > 8.8) & (along[:, 0] < 9.2)]
    assert len(beside) and (np.abs(beside[:, 1] - 6.0) > 1.9).all()


def test_it_draws_a_cart_from_before_it_and_pushes_it_from_behind(env: SkillEnv) -> None:
    """The robot is 2 m west of the cart: to the west it draws and is there first, to the east the cart is."""
    for goal, first in (((3.0, 6.0), True), ((7.0, 6.0), False)):
        assert pushed(env, goal).ok
        robot = np.array(env.stage.robot.base()[:2])
        beyond = (robot - place(env)[:2]) @ (np.array(goal) - (5.0, 6.0))
        assert bool(beyond > 0.0) is first, goal


def test_a_cart_that_is_there_is_left_alone(env: SkillEnv) -> None:
    assert pushed(env, (5.1, 6.0)) == Result(True)


def test_an_unfinished_push_leaves_no_grip(env: SkillEnv) -> None:
    """It is broken off while it pushes: the cart then stays where it is as the robot drives away."""
    env.reset(seed=0)
    doing = push(env.stage, env.labeller.index("cart_1"), (8.0, 6.0))
    action = next(doing)
    while place(env)[0] < 5.5:
        env.base.advance(action)
        action = next(doing)
    doing.close()
    for _ in range(30):
        env.base.advance(env.stage.act(0.0))
    before = place(env)
    for _ in range(40):
        env.base.advance(env.stage.act(-1 / 62))
    assert np.abs(place(env) - before).max() < 0.01


def test_goals_must_be_finite(env: SkillEnv) -> None:
    env.reset(seed=0)
    with pytest.raises(ValueError, match="finite"):
        next(push(env.stage, env.labeller.index("cart_1"), (np.nan, 0.0)))


def test_a_cart_that_is_too_heavy_stays() -> None:
    """At a friction of 0.5, 196 N move 40 kg: 22 kg of the cart and 10 kg in it, but not 30 kg."""
    found = []
    for mass in (10.0, 30.0):
        (body,) = LOT.bodies
        spec = dataclasses.replace(LOT, bodies=(dataclasses.replace(body, mass=mass),))
        with registered_task("HazardLoad-v1", lot(hazard_gale, spec)):
            env = SkillEnv.make("HazardLoad-v1", reward_mode="none")
            result = pushed(env, (7.0, 6.0))
            found.append((result.ok, result.reason, bool(place(env)[0] > 5.2)))
            env.close()
    assert found == [(True, "", True), (False, failures.BLOCKED, False)]


def test_carts_that_stand_fast_are_not_pushed() -> None:
    with registered_task("HazardStill-v1", lot(hazard_wind)):
        env = SkillEnv.make("HazardStill-v1", reward_mode="none")
        assert pushed(env, (7.0, 6.0)) == Result(False, failures.NOT_MOVABLE)
        env.close()


def test_agents_push_a_cart_to_what_they_must_rescue(env: SkillEnv) -> None:
    """It is left 1.6 m short of the thing; where nothing is far from it no push is offered."""
    decision, _ = env.reset(seed=0)
    assert not [a for a in decision.available if a.verb == "push"]  # the bottle lies in the cart


def test_a_push_is_offered_and_ends_near_the_thing() -> None:
    far = dataclasses.replace(LOT.bodies[0], position=(7.5, 7.2, 0.0))
    spec = dataclasses.replace(LOT, name="test/far", bodies=(far,))
    with registered_task("HazardFarLot-v1", lot(hazard_gale, spec)):
        env = SkillEnv.make("HazardFarLot-v1", reward_mode="none")
        try:
            decision, _ = env.reset(seed=0)
            (action,) = [a for a in decision.available if a.verb == "push"]
            assert action.target == "bottle_1"
            *_, info = env.step(action)
            assert info["result"].ok, info["result"]
            assert 1.0 < np.hypot(*(place(env)[:2] - (7.5, 7.2))) <= SHORT + THERE
        finally:
            env.close()
