"""Walls, doors and windows that do not fit are refused; grounds that overlap lie on each other."""

from __future__ import annotations

import dataclasses

import pytest

from hazard_ms.scenes.shell import PATCH_HEIGHT, shell
from hazard_ms.scenes.walls import check, on_wall
from hazard_ms.spec import Opening, Partition, Patch, Room

ROOM = Room((6.0, 4.0), partitions=(Partition("partition_1", "y", 3.0, 0.1),))


@pytest.mark.parametrize("at", [0.05, 5.95, -1.0, 6.0, 7.0])
def test_a_partition_stands_inside_of_the_room(at: float) -> None:
    with pytest.raises(ValueError, match="a place in the room of"):
        check(dataclasses.replace(ROOM, partitions=(Partition("partition_1", "y", at, 0.1),)))
    check(dataclasses.replace(ROOM, partitions=(Partition("partition_1", "y", 5.9, 0.1),)))


@pytest.mark.parametrize(("kind", "wall"), [("doorway", "south"), ("window", "partition_1")])
def test_only_partitions_have_holes_that_stay_open(kind: str, wall: str) -> None:
    with pytest.raises(ValueError, match="a doorway must be in a partition, a window in one of the walls"):
        check(dataclasses.replace(ROOM, openings=(Opening(kind, wall, 2.0, 0.9, 2.0),)))


@pytest.mark.parametrize("centre", [2.0, 2.5, 2.89])
def test_openings_of_a_wall_stand_beside_each_other(centre: float) -> None:
    first = Opening("door", "south", 2.0, 0.9, 2.0)
    with pytest.raises(ValueError, match="fit into the south wall, 6.0 m x 2.6 m, without overlapping others"):
        shell(dataclasses.replace(ROOM, openings=(first, Opening("window", "south", centre, 0.9, 1.0, 0.9))))
    shell(dataclasses.replace(ROOM, openings=(first, Opening("window", "south", 3.0, 0.9, 1.0, 0.9))))


def test_behind_a_wall_is_outside_of_the_room() -> None:
    places = {wall: on_wall(ROOM, wall, 1.0, 0.5, 0.1) for wall in ("south", "north", "west", "east")}
    assert places == {
        "south": (1.0, -0.1, 0.5),
        "north": (1.0, 4.1, 0.5),
        "west": (-0.1, 1.0, 0.5),
        "east": (6.1, 1.0, 0.5),
    }


def test_each_ground_lies_on_all_that_it_covers() -> None:
    """Equal heights would flicker: the crossing of two roads on a lawn is three layers high."""
    lawn = Patch("grass", (0.0, 0.0), (8.0, 8.0))
    roads = Patch("asphalt", (0.0, 3.0), (8.0, 5.0)), Patch("asphalt", (3.0, 0.0), (5.0, 8.0))
    apart = Patch("gravel", (9.0, 9.0), (9.5, 9.5))
    ground = Room((10.0, 10.0), floor="grass", patches=(lawn, *roads, apart), open_air=True)
    heights = [b.size[2] for b in shell(ground) if b.name.startswith("patch_")]
    assert heights == pytest.approx([PATCH_HEIGHT * layer for layer in (1, 2, 3, 1)])
