"""A flat of two rooms with a burner in one of them, for tests of smoke."""

from __future__ import annotations

from hazard_ms.hazards.fire.realistic.blaze_state import BlazeState
from hazard_ms.simulation.world import World
from hazard_ms.spec import Opening, Partition, Room
from hazard_ms.validation.experiments.smoke_room import Burner, burn, fire_at, rooms


def flat(seconds: float, power: float = 300.0) -> tuple[BlazeState, World]:
    """Two rooms of 4 x 4 m with an open doorway, a burner in the first one, after so many seconds."""
    doorway = Opening("doorway", "partition_1", 2.0, 0.9, 2.0)
    door = Opening("door", "south", 6.0, 0.9, 2.0)
    room = Room((8.12, 4.0), 2.6, openings=(doorway, door), partitions=(Partition("partition_1", "y", 4.06),))
    state, world = rooms(room)
    burner = Burner(power)
    burn(state, world, burner, fire_at(2.0, 2.0, burner), seconds)
    return state, world
