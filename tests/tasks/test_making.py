"""How tasks are made: their lengths, their places, and the order of their hazards."""

from __future__ import annotations

import dataclasses

import pytest

from hazard_ms.tasks import task_of


@pytest.mark.parametrize(
    ("name", "frames"), [("HazardFire-v1", 1500), ("HazardFlood-v1", 1500), ("HazardWind-v1", 3000)]
)
def test_a_task_has_its_own_length(name: str, frames: int) -> None:
    """docs/benchmark.md 1."""
    assert task_of(name, "paper").max_frames == frames
    assert task_of(name, "paper").name == name


@pytest.mark.parametrize(
    ("hazards", "place", "first"),
    [
        (("fire", "flood"), "bag", "kitchen_a/00"),
        (("fire", "wind"), "cart", "street/00"),
        (("wind", "flood", "fire"), "cart", "street/00"),
    ],
)
def test_one_hazard_that_needs_the_open_takes_all_outside(hazards: tuple[str, ...], place: str, first: str) -> None:
    task = task_of("HazardCompound-v1", "paper", hazards)
    assert task.safe_place.name == place
    assert task.scenes("train")[0] == first
    assert task.build(first).room.open_air is (place == "cart") and place in task.text


@pytest.mark.parametrize("hazards", [("fire", "flood", "wind"), ("wind", "fire", "flood")])
def test_what_tells_others_something_advances_before_them(hazards: tuple[str, ...]) -> None:
    names = [h.name for h in task_of("HazardCompound-v1", "paper", hazards).hazards]
    assert sorted(names) == ["fire", "flood", "wind"] and names[-1] == "fire"  # it uses the water and the air


def test_water_of_paper_in_homes_is_slower_flatter_and_comes_through_doors_and_nothing_else_differs() -> None:
    """docs/benchmark.md 1.1."""
    for physics in ("paper", "shipped", "realistic"):
        (home,), (room,) = (task_of(f"Hazard{kind}Flood-v1", physics).hazards for kind in ("House", ""))
        slower = {"every": 40, "slope": 1.0, "through_doors": True} if physics == "paper" else {}
        assert room.every == 10
        assert home == dataclasses.replace(room, **slower), physics
