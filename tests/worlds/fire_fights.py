"""Rooms with a fire, an extinguisher and books, in which it helps to fight the fire, or is in vain."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable, Sequence

from hazard_ms.spec import AgentStart, Body, Room, SceneSpec, Task
from hazard_ms.tasks.fire import hazard_fire


def room(
    name: str, fire: tuple[float, float], tool: tuple[float, float], books: Sequence[tuple[float, float]]
) -> SceneSpec:
    """A room of 12 m by 8 m with things at these places [m], and the robot at (5, 4)."""
    return SceneSpec(
        name=f"test/{name}",
        room=Room((12.0, 8.0)),
        fixtures=(),
        bodies=(
            Body("powder_0", "fire_extinguisher", "plain_box", (*tool, 0.0), scale=(0.12, 0.12, 0.4), mass=3.3),
            *(
                Body(f"book_{k}", "book", "plain_box", (x, y, 0.0), scale=(0.12, 0.12, 0.2), mass=0.4)
                for k, (x, y) in enumerate(books)
            ),
        ),
        target_categories=("book",),
        fires=(fire,),
        agent_start=AgentStart((5.0, 4.0), 0.0),
    )


def around(fire: tuple[float, float], radius: float, count: int) -> list[tuple[float, float]]:
    """Places on a circle [m]."""
    angles = [2.0 * math.pi * k / count for k in range(count)]
    return [(fire[0] + radius * math.cos(a), fire[1] + radius * math.sin(a)) for a in angles]


def task_in(scene: SceneSpec) -> Callable[[str], Task]:
    """The maker of a task in a scene that counts what is averted, as tasks of homes do."""

    def maker(physics: str) -> Task:
        made = dataclasses.replace(hazard_fire(physics), mitigations=("extinguish",), averted=True, several_rooms=True)
        return dataclasses.replace(made, scenes=lambda split: (scene.name,), build=lambda name: scene)

    return maker
