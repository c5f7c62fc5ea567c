"""The action `look_at`: as near as 256 pixels take and no nearer, faced, and only where a detector tells of things."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest

from hazard_ms.skills.actions import skill
from hazard_ms.skills.decision import WALK_TO, Action, Result
from hazard_ms.skills.executor import SkillEnv
from hazard_ms.skills.mitigations.looking import sight_of
from hazard_ms.skills.motor.motion import wrap
from hazard_ms.spec import AgentStart, Body
from tests.worlds.two_rooms import TwoRooms, spec, two_rooms

AT = Action("look_at", "box_0")
BOX = Body("box_0", "box", "plain_box", (5.5, 2.0, 0.0), scale=(0.2, 0.2, 0.2), mass=3.0)  # 4 m ahead
MOST = np.deg2rad(3.0)  # by which a robot that faces a thing may look past it [rad]


def looked(rooms: TwoRooms, size: float, frames: int = 300) -> tuple[Result, float, float]:
    """Looks at a box of so many pixels at 1 m until done: the result, how far off it stands [m], and by which angle."""
    index, total = rooms.index("box_0"), 0
    while True:
        rooms.look()
        seen = rooms.stage.seen
        seen.objects = {**seen.objects, index: replace(seen.objects[index], size=size)}
        result = rooms.run(skill(rooms.stage, AT))
        total += result.frames
        if result.reason != "max_frames" or total > frames:
            break
    x, y, heading = rooms.stage.robot.base()
    away = rooms.world.position[0, index, :2].numpy() - (x, y)
    return result, float(np.hypot(*away)), abs(wrap(float(np.arctan2(away[1], away[0])) - heading))


@pytest.mark.parametrize("away", [1.2, 2.5])
def test_it_walks_until_the_thing_has_256_pixels_and_no_farther(away: float) -> None:
    """256 pixels at `away` are 256 away^2 at 1 m; a walk ends within a cell of the map, 0.15 m, of where it should."""
    with two_rooms(spec(door=None, bodies=(BOX,))) as rooms:
        result, far, off = looked(rooms, 256.0 * away**2)
        assert result.ok and away - 0.2 < far <= away + 0.02 and off < MOST


def test_what_is_near_enough_is_looked_at_from_where_the_robot_stands() -> None:
    """4.0 m are near enough; half a turn takes no longer than twice its time, as every turn."""
    with two_rooms(spec(door=None, bodies=(BOX,), start=AgentStart((1.5, 2.0), np.pi))) as rooms:
        result, far, off = looked(rooms, 256.0 * 4.1**2)
        assert result.ok and far == pytest.approx(4.0, abs=0.05) and off < MOST
        assert (
            np.pi / rooms.stage.robot.build.turn_step <= result.frames <= 2 * np.pi / rooms.stage.robot.build.turn_step
        )
        again = rooms.run(skill(rooms.stage, AT))
        assert again.ok and again.frames == 0, "what it faces already takes no time"


def test_what_is_too_small_is_walked_up_to_and_what_nobody_has_seen_is_unknown() -> None:
    with two_rooms(spec(door=None, bodies=(BOX,))) as rooms:
        seen = rooms.stage.seen.objects[rooms.index("box_0")]
        # arrival is at 0.5 m from its seen edge, which is half a diagonal of 0.2 m from its middle
        assert sight_of(replace(seen, size=1.0), 1.0) == pytest.approx(0.5 + 0.1 * np.sqrt(2.0))
        assert sight_of(replace(seen, size=1.0), 0.05) == pytest.approx(0.55)
        rooms.stage.seen.objects = {}
        assert rooms.run(skill(rooms.stage, AT)) == Result(False, "target_unknown")


@pytest.fixture(scope="module")
def env() -> Iterator[SkillEnv]:
    made = SkillEnv.make("HazardFire-v1", "noisy:eyes=512/120", effects="off")
    yield made
    made.close()


@pytest.mark.render
def test_a_look_shows_256_pixels_and_is_offered_for_targets_alone(env: SkillEnv) -> None:
    """The farthest target that was found: afterwards the camera shows it on so many pixels, before it did not."""
    env.reset(seed=3)
    decision, *_ = env.step(Action("explore"))
    offered = [a.target for a in decision.available if a.verb == "look_at"]
    seen = decision.map.objects
    assert offered == [t.name for t in decision.targets if t.index in seen] and len(offered) > 1
    name = min((n for n in offered if n), key=lambda n: seen[decision.index(n)].pixels)
    assert seen[decision.index(name)].pixels < 256
    for _ in range(6):
        decision, _, _, _, info = env.step(Action("look_at", name))
        if info["result"].reason != "max_frames":
            break
    sighting = decision.map.objects[decision.index(name)]
    assert info["result"].ok and sighting.frame == decision.frame and sighting.pixels >= 256
    away = sighting.position[:2] - decision.agent_position
    assert abs(wrap(float(np.arctan2(away[1], away[0])) - decision.agent_heading)) < MOST


@pytest.mark.render
def test_with_the_truth_there_is_nothing_to_look_at() -> None:
    made = SkillEnv.make("HazardFire-v1", sensor_configs={"width": 96, "height": 96}, effects="off")
    try:
        decision, _ = made.reset(seed=3)
        assert {a.verb for a in decision.available} <= {"explore", "stop", WALK_TO, "walk_one_step", "pick_up", "drop"}
        assert made.verbs == () and not made.brief().looks
        with pytest.raises(ValueError, match="verb must be one of walk_to, .*, stop, got 'look_at'"):
            made.step(Action("look_at", decision.names[0]))
    finally:
        made.close()
