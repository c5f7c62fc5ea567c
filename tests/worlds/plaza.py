"""A large empty room with boxes around the robot, all in plain view, of which few can be fetched in time."""

from __future__ import annotations

import dataclasses

import numpy as np

from hazard_ms.spec import AgentStart, Body, Room, SceneSpec, Task
from hazard_ms.tasks.fire import hazard_fire

TASK = "HazardPlaza-v1"
FRAMES = 700  # of an episode: for about half of the boxes
BOXES = 11
DEAR, CHEAP = "book", "box"  # categories of value 5 and 1
DEAR_ONES = 3
HALF = 6.0  # of the room's sides [m]; the robot starts in its middle
NEAR, FAR = 1.3, 3.0  # distances of the boxes from there [m]
APART = 0.8  # of the boxes from each other, at least [m]
SIZE = (0.15, 0.15, 0.3)  # of a box [m]: some 35 pixels at 3 m
LAYOUTS = 6


def plaza(number: int) -> SceneSpec:
    """The scene with one of the layouts; a small fire burns far off, in a corner."""
    random, places = np.random.default_rng(number), list[np.ndarray]()
    while len(places) < BOXES:
        far, angle = random.uniform(NEAR, FAR), random.uniform(-np.pi, np.pi)
        place = HALF + far * np.array([np.cos(angle), np.sin(angle)])
        if all(np.hypot(*(place - other)) >= APART for other in places):
            places.append(place)
    kinds = [DEAR] * DEAR_ONES + [CHEAP] * (BOXES - DEAR_ONES)
    return SceneSpec(
        name=f"plaza/{number:02d}",
        room=Room((2 * HALF, 2 * HALF)),
        fixtures=(),
        bodies=tuple(
            Body(f"{kind}_{k}", kind, "plain_box", (float(x), float(y), 0.0), scale=SIZE, mass=0.4)
            for k, (kind, (x, y)) in enumerate(zip(kinds, places, strict=True))
        ),
        target_categories=(DEAR, CHEAP),
        fires=((0.4, 0.4),),
        agent_start=AgentStart((HALF, HALF)),
    )


def task(physics: str) -> Task:
    """The task of rescuing the boxes in frames that do not suffice for all."""
    names = {f"plaza/{number:02d}": number for number in range(LAYOUTS)}
    return dataclasses.replace(
        hazard_fire(physics), scenes=lambda split: tuple(names), build=lambda name: plaza(names[name])
    )
