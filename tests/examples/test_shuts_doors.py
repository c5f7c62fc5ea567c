"""The example of an agent that shuts doors: which, how many, and that the other agent decides afterwards."""

from __future__ import annotations

import dataclasses
from pathlib import Path

from hazard_ms.agents.base import agent
from hazard_ms.sensing.door_memory import KnownOpening
from hazard_ms.skills.decision import Action, Decision, Result
from tests.worlds.playground import Playground, brief

FILE = Path(__file__).parents[2] / "examples" / "shuts_doors.py"
IN_A_HOME = dataclasses.replace(brief("HazardHouseFlood-v1"), mitigations=("open", "shut"))


def decision(last: Action | None = None, reason: str = "", shut: tuple[str, ...] = ()) -> Decision:
    """Doors at 1, 2, 3 m, a doorway at 0.5 m and a window at 0.6 m; those of `shut` cannot be shut again."""
    ground = Playground({"cup": (1.0, 0.0)}, {"cup": 1.0})
    ground.look()
    kinds = {"door_1": 1.0, "door_2": 2.0, "door_3": 3.0, "doorway_4": 0.5, "window_5": 0.6}
    seen = [
        KnownOpening(n, k, n.split("_")[0], (x, 0.0, 1.0), 0.9, 1.0, False, 0) for k, (n, x) in enumerate(kinds.items())
    ]
    offered = tuple(Action("shut", n) for n in kinds if n not in (*shut, "doorway_4"))
    result = None if last is None else Result(not reason, reason, 10)
    made = ground.decision()
    return dataclasses.replace(
        made, openings=tuple(seen), available=(*made.available, *offered), last_action=last, last_result=result
    )


def test_it_shuts_the_nearest_doors_and_then_rescues() -> None:
    player = agent(f"{FILE}:ShutsDoors:doors=2")
    player.reset(IN_A_HOME)
    look, first, second = Action("explore"), Action("shut", "door_1"), Action("shut", "door_2")
    assert player.act(decision()) == look
    assert player.act(decision(look)) == first
    assert player.act(decision(first, "max_frames")) == first, "it goes on where time ran out"
    assert player.act(decision(first, "", ("door_1",))) == second
    third = player.act(decision(second, "in_the_swing", ("door_1",)))
    assert third == Action("shut", "door_3"), "what failed does not count, and is not tried again"
    greedy = agent("greedy")
    greedy.reset(IN_A_HOME)
    last = decision(third, "", ("door_1", "door_3"))
    assert player.act(last) == greedy.act(last)


def test_where_doors_cannot_be_shut_the_other_agent_decides_alone() -> None:
    player, other = agent(f"{FILE}:ShutsDoors"), agent("greedy")
    for each in (player, other):
        each.reset(brief())
    assert player.act(decision()) == other.act(decision())
