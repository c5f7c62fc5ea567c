"""Damage is for ever, and a rescue ends it (docs/benchmark.md 4)."""

from __future__ import annotations

import torch

from hazard_ms.hazards.presets import fire
from hazard_ms.tasks.episode.records import Damage, Rescue
from tests.worlds.fire_worlds import begin, room_world, run


def records(copies: int = 1):
    world = room_world([("book", (2.0, 2.0, 0.0)), ("apple", (3.0, 2.0, 0.0)), ("pan", (1.0, 1.0, 0.0))], copies=copies)
    sizes = {"E": copies, "B": 3}
    return world, Damage.allocate(sizes, "cpu"), Rescue.allocate(sizes, "cpu")


def test_damage_is_kept_with_its_first_frame() -> None:
    world, damage, _ = records()
    for frame, now in ((1, [False, True, False]), (2, [True, True, False]), (3, [False, False, False])):
        world.chance.frame[:] = frame
        damage.add(torch.tensor([now]), world)
    assert damage.damaged.tolist() == [[True, True, False]]
    assert damage.frame.tolist() == [[2, 1, -1]]


def test_what_is_safe_or_absent_is_not_damaged() -> None:
    world, damage, _ = records()
    world.safe[0, 0] = True
    world.exists[0, 1] = False
    damage.add(torch.ones(1, 3, dtype=torch.bool), world)
    assert damage.damaged.tolist() == [[False, False, True]]


def test_rescue_keeps_frame_and_damage_of_the_moment() -> None:
    world, damage, rescue = records(copies=3)
    world.chance.frame[:] = torch.tensor([7, 8, 9])
    damage.add(torch.tensor([[True, False, False]] * 3), world)
    rescue.mark(world, torch.tensor([[True, False, False], [False, True, False], [False, False, False]]), damage)
    assert rescue.safe.tolist() == [[True, False, False], [False, True, False], [False, False, False]]
    assert rescue.frame.tolist() == [[7, -1, -1], [-1, 8, -1], [-1, -1, -1]]
    assert rescue.damaged.tolist() == [[True, False, False], [False, False, False], [False, False, False]]
    assert torch.equal(world.safe, rescue.safe)


def test_a_second_rescue_changes_nothing() -> None:
    world, damage, rescue = records()
    world.chance.frame[:] = 5
    rescue.mark(world, torch.tensor([[False, True, False]]), damage)
    world.chance.frame[:] = 6
    damage.add(torch.tensor([[False, True, False]]), world)
    rescue.mark(world, torch.tensor([[False, True, False]]), damage)
    assert rescue.frame[0, 1].item() == 5 and not rescue.damaged[0, 1].item() and not damage.damaged[0, 1].item()


def test_fire_damages_what_burns_or_burnt_and_not_what_was_saved_before() -> None:
    world = room_world([("book", (2.0, 2.0, 0.0)), ("book", (2.3, 2.0, 0.0)), ("pan", (2.0, 2.3, 0.0))], [(2.1, 2.1)])
    preset = fire("shipped")
    state = begin(preset, world)
    damage, rescue = Damage.allocate({"E": 1, "B": 3}, "cpu"), Rescue.allocate({"E": 1, "B": 3}, "cpu")
    rescue.mark(world, torch.tensor([[False, True, False]]), damage)
    for _ in range(150):
        run(preset, state, world, 1)
        damage.add(preset.damaged(state, world), world)
    assert damage.damaged.tolist() == [[True, False, False]]
    assert damage.frame[0, 0].item() % 5 == 0
    run(preset, state, world, 1600)
    assert preset.damaged(state, world).tolist() == [[True, False, False]]  # burnt is damaged, too
