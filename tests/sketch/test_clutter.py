"""What stands on the floor now, and open leaves, bar ways that a map does not know to be barred."""

from __future__ import annotations

import dataclasses

import numpy as np
import torch

from hazard_ms.sensing.semantic_map import SemanticMap
from hazard_ms.simulation.building import make_world
from hazard_ms.simulation.world import World
from hazard_ms.sketch.futures.clutter import reached
from hazard_ms.spec import AgentStart, Body, Opening, Partition, Room, SceneSpec

HERE, PLACES = (1.0, 3.0), np.array([[2.0, 3.0], [6.5, 3.0]])  # in a hall 1.3 m wide, from y = 2.4 to 3.7 m
CRATE = Body("crate_0", "box", "plain_box", (4.0, 2.9, 0.0), scale=(0.6, 0.6, 0.5), mass=5.0)
BOOK = Body("book_0", "book", "plain_box", (7.5, 0.5, 0.0), scale=(0.1, 0.1, 0.05), mass=0.4)
HALL = SceneSpec(
    name="test/hall",
    room=Room(
        (8.0, 3.7),
        openings=(Opening("door", "hall", 4.0, 0.9, 2.0, open=1.0),),
        partitions=(Partition("hall", "x", 2.4),),
    ),
    fixtures=(),
    bodies=(),
    target_categories=("book",),
    fires=(),
    agent_start=AgentStart(HERE, 0.0),
)


def world(*bodies: Body, room: Room = HALL.room) -> World:
    return make_world((dataclasses.replace(HALL, bodies=(BOOK, *bodies), room=room),), torch.device("cpu"))


def seen(low: float = 2.4) -> SemanticMap:
    """A map that knows the walls of the hall and nothing else."""
    made = SemanticMap(HERE, np.zeros(8, bool))
    y, x = np.mgrid[0 : len(made.explored), 0 : len(made.explored)]
    x, y = made.origin[0] + (x + 0.5) * made.cell, made.origin[1] + (y + 0.5) * made.cell
    within = (x > 0.0) & (x < 8.0) & (y > low) & (y < 3.7)
    made.tell(np.where(within, 0.0, 2.0).astype(np.float32), np.ones_like(within))
    return made


def test_a_crate_that_drifted_into_a_hall_bars_it() -> None:
    assert reached(seen(), world(), HERE, PLACES, 0.29) == [True, True]
    assert reached(seen(), world(CRATE), HERE, PLACES, 0.29) == [True, False]
    low = dataclasses.replace(CRATE, scale=(0.6, 0.6, 0.1))
    assert reached(seen(), world(low), HERE, PLACES, 0.29) == [True, True]  # it is pushed aside


def test_the_leaf_of_an_open_door_stands_in_the_way() -> None:
    """It turns to the south, 0.9 m into a space of 1.3 m."""
    room = dataclasses.replace(HALL.room, partitions=(Partition("hall", "x", 3.64),))
    assert reached(seen(), world(room=room), HERE, PLACES, 0.29) == [True, False]
    shut = dataclasses.replace(room, openings=(dataclasses.replace(room.openings[0], open=0.0),))
    assert reached(seen(), world(room=shut), HERE, PLACES, 0.29) == [True, True]
