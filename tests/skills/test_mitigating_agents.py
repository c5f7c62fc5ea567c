"""Agents of a task with mitigations: what decisions tell them, and that doors they open let them through."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

import hazard_ms
from hazard_ms.skills import failures
from hazard_ms.skills.decision import EXPLORE, PICK_UP, VERBS, WALK_TO, Action, Decision
from hazard_ms.skills.executor import SkillEnv
from hazard_ms.spec import Body
from tests.worlds.registering import registered_task
from tests.worlds.two_rooms import AT, spec

FAR_BOX = Body("box_0", "box", "box_2", (5.6, 2.0, 0.0), mass=1.0)
TOOL = Body("powder_0", "fire_extinguisher", "fire_extinguisher_2", (1.5, 3.2, 0.0), mass=3.3)


def acted(env: SkillEnv, action: Action) -> Decision:
    for _ in range(8):
        decision = env.step(action)[0]
        result = decision.last_result
        assert result is not None
        if result.reason != failures.MAX_FRAMES:
            break
    return decision


def test_a_door_is_known_once_seen_and_the_room_behind_it_once_it_is_open() -> None:
    scene = spec(bodies=(FAR_BOX, TOOL))

    def maker(preset: str) -> Any:
        made = hazard_ms.rescue([hazard_ms.hazard("fire", preset)])
        verbs = ("open", "shut", "extinguish")
        return replace(made, scenes=lambda split: (scene.name,), build=lambda name: scene, mitigations=verbs)

    with registered_task("HazardDoors-v0", maker) as name:
        env = SkillEnv.make(name)
        decision, _ = env.reset(seed=0)
        assert env.brief().mitigations == ("open", "shut", "extinguish")
        (tool,) = decision.tools
        assert (tool.name, tool.kind, tool.left, tool.held) == ("powder_0", "powder", 1.0, False)
        decision = acted(env, Action(EXPLORE))
        (door,) = decision.openings
        assert (door.name, door.kind, door.open, door.broken) == ("door_0", "door", 0.0, False)
        np.testing.assert_allclose(door.position, (AT, 2.0, 2.05 / 2), atol=1e-6)
        assert Action("open", "door_0") in decision.available and Action("shut", "door_0") not in decision.available
        assert Action(PICK_UP, "powder_0") in decision.available
        assert "box_0" not in {decision.names[i] for i in decision.map.objects}
        decision = acted(env, Action("open", "door_0"))
        assert decision.last_result is not None and decision.last_result.ok, decision.last_result
        assert decision.openings[0].open == 1.0 and Action("shut", "door_0") in decision.available
        decision = acted(env, Action(EXPLORE))
        assert "box_0" in {decision.names[i] for i in decision.map.objects}
        decision = acted(env, Action(WALK_TO, "box_0"))
        assert decision.last_result is not None and decision.last_result.ok, decision.last_result
        assert decision.agent_position[0] > AT + 0.5
        decision = acted(env, Action("shut", "door_0"))
        assert decision.last_result is not None and decision.last_result.ok, decision.last_result
        assert float(env.base.world.openings.share[0, 0]) == 0.0 and decision.agent_position[0] > AT
        assert {action.verb for action in decision.available} <= {*VERBS, "open", "shut", "extinguish"}
        env.close()
