"""Water in whole scenes: its volume, its energy and its speed are those that came in through the doors."""

from __future__ import annotations

import pytest
import torch

from hazard_ms.scenes.splits import scene
from hazard_ms.spec.severity import SEVERITIES
from tests.worlds.flood_balance import GRAVITY, Flooding, drawn

SPLITS = ("train", "test", "large", "new_objects", "hard")


def check(flooding: Flooding, frames: int, every: int = 1) -> None:
    """Flood a scene from outside: no more energy than that of the water outside, no faster than a dam break's tip.

    Looks at it once in `every` so many frames.
    """
    head, name = flooding.law.outside, flooding.world.specs[0].name
    energy, came = 0.0, 0.0
    for frame in range(frames):
        flooding.step()
        if frame % every:
            continue
        speed, gained, more = flooding.speed, flooding.energy - energy, flooding.came - came
        assert speed < 2.0 * (GRAVITY * head) ** 0.5, (name, frame, speed)
        assert gained <= GRAVITY * head * more + 1e-5 * (energy + 1.0), (name, frame)
        energy, came = energy + gained, came + more
    assert flooding.volume == pytest.approx(flooding.came, rel=1e-5), name
    assert bool(torch.isfinite(flooding.state.surface).all()) and came > 0.0, name


def check_closed(flooding: Flooding, frames: int, every: int = 1) -> None:
    """Let a metre of water in a third of a scene run into the rest: energy is lost, and nothing else changes."""
    state, name = flooding.state, flooding.world.specs[0].name
    state.inlet[:] = -1
    bed = flooding.grid("bed")
    behind = torch.arange(bed.shape[0])[:, None] < bed.shape[0] // 3
    state.depth[0] = torch.where(behind & (bed < 50.0), (1.0 - bed).clamp(min=0.0), 0.0).flatten().float()
    state.signal[:] = (2.0 * GRAVITY) ** 0.5
    volume, start = flooding.volume, flooding.energy
    energy = start
    for frame in range(frames):
        flooding.step()
        if frame % every:
            continue
        now = flooding.energy
        assert now < energy + 5e-4 * start, (name, frame)  # velocities and depths are known half a step apart
        assert flooding.speed < 2.0 * GRAVITY**0.5, (name, frame)
        energy = now
    assert energy < 0.7 * start and flooding.volume == pytest.approx(volume, rel=1e-6), name


@pytest.mark.parametrize("split", SPLITS)
def test_scenes_hold_the_water_that_came_in_and_no_more_energy(split: str) -> None:
    """One scene of each split."""
    (spec,) = drawn(split, 1)
    check(Flooding.of(spec), 300)
    check_closed(Flooding.of(spec), 150)


@pytest.mark.parametrize(("name", "frames"), [("craft_room_a/05", 400), ("living_room_a/21", 600)])
def test_films_on_drowned_furniture_run_no_faster_than_the_head_drives_them(name: str, frames: int) -> None:
    check(Flooding.of(scene(name)), frames)


@pytest.mark.parametrize("severity", SEVERITIES)
@pytest.mark.parametrize("split", SPLITS)
@pytest.mark.long
@pytest.mark.timeout(3600)
def test_many_scenes_hold_the_water_that_came_in_and_no_more_energy(split: str, severity: str) -> None:
    """Fifty scenes of each split."""
    for spec in drawn(split, 50):
        check(Flooding.of(spec, severity), 900, 5)
        if severity == "extreme":  # the others begin alike
            check_closed(Flooding.of(spec, severity), 300, 5)
