"""What one robot of a team has put down, another one takes: a tool on the floor, and a target on a table."""

from __future__ import annotations

import dataclasses

import pytest

from hazard_ms.skills.decision import Action, Result
from hazard_ms.skills.failures import UNFINISHED
from hazard_ms.skills.team import TeamSkills
from hazard_ms.spec import Body, Fixture
from tests.worlds.fire_fights import room, task_in
from tests.worlds.registering import registered_task

TABLE = Fixture("table_0", "table", "plain_box", (3.0, 5.5, 0.0), scale=(1.0, 0.8, 0.72))
MUG = Body("mug_0", "book", "plain_box", (6.0, 4.5, 0.0), scale=(0.08, 0.08, 0.2), mass=0.4)


def done(env: TeamSkills, name: str, action: Action) -> Result:
    """The outcome of an action of the robot `name`, once it is free; the others say again and again that they wait."""
    results: dict[str, Result] = {}
    begun = False
    while not begun or name not in results or results[name].reason in UNFINISHED:
        begun = begun or name in env.free
        asked = {robot: action if robot == name else Action("tell", "I wait") for robot in env.free}
        results = env.step(asked)[3]["results"]
    return results[name]


@pytest.mark.parametrize("left", [pytest.param(Action("drop"), marks=pytest.mark.long), Action("put_on", "table_0")])
def test_what_one_robot_puts_down_another_one_takes(left: Action) -> None:
    thing = "powder_0" if left.verb == "drop" else "mug_0"
    scene = room("handing", (11.5, 7.5), (6.0, 3.5), [(1.0, 1.0)])
    scene = dataclasses.replace(scene, bodies=(*scene.bodies, MUG), fixtures=(TABLE,))
    task = task_in(scene)
    with registered_task("Handing-v1", lambda p: dataclasses.replace(task(p), mitigations=("extinguish", "put_on"))):
        env = TeamSkills.make("Handing-v1", ("fetch", "fetch"), effects="off", affects_agent=False)
        env.reset(seed=0)
        first, second = env.names
        for action in (Action("explore"), Action("walk_to", thing), Action("pick_up", thing)):
            assert done(env, first, action).ok
        held = [int(member.hand.held[0]) for member in env.base.members]
        assert held == [env.base.world.index(0, thing), -1]
        assert not done(env, second, Action("pick_up", thing)).ok, "it is in another hand"
        for action in (left, Action("walk_to", "book_0"), Action("tell", f"{thing} is free")):
            result = done(env, first, action)
            assert result.ok, (action, result)
        for action in (Action("walk_to", thing), Action("pick_up", thing)):
            result = done(env, second, action)
            assert result.ok, (action, result)
        assert [int(member.hand.held[0]) for member in env.base.members] == [-1, held[0]]
        env.close()
