"""Ignition, burning and overheating against the tables of docs/physics.md 2.1, F-12 to F-18."""

from __future__ import annotations

import math

import pytest
import torch

from hazard_ms.hazards.fire.fire import BURNING, BURNT, NORMAL, Fire
from hazard_ms.hazards.presets import fire
from tests.worlds.fire_worlds import (
    begin,
    begin_without_spread,
    one_source,
    room_world,
    run,
    updates,
)

IGNITION_DISTANCES = {60: 1.8371, 100: 1.25, 200: 0.7454, 300: 0.5175, 400: 0.3627, 500: 0.2282, 560: 0.1361}


@pytest.mark.parametrize("sources", [1, 2, 4])
def test_things_ignite_inside_their_distance_only(preset: Fire, sources: int) -> None:
    """F-12: Just inside it a thing ignites, just outside never. The closed form holds where the weight is not
    clipped.
    """
    cases = [
        (threshold, share * limit * math.sqrt(sources), share < 1.0)
        for threshold, limit in IGNITION_DISTANCES.items()
        for share in (0.99, 1.01)
        if share * limit * math.sqrt(sources) > (0.5 if preset == fire("paper") else 0.1)
    ]
    assert len(cases) >= 8
    world = one_source([distance for _, distance, _ in cases], sources)
    state = begin_without_spread(preset, world)
    state.threshold[:, 0] = torch.tensor([float(t) for t, _, _ in cases])
    updates(preset, state, world, 500)
    assert (state.status[:, 0] != NORMAL).tolist() == [burns for _, _, burns in cases]


IGNITION_UPDATES = {  # F-13: threshold -> distance -> updates, None: never
    60: {0.1: 3, 0.22: 3, 0.3: 4, 0.5: 5, 0.7: 8},
    100: {0.1: 6, 0.22: 6, 0.3: 7, 0.5: 11, 0.7: 18},
    200: {0.1: 13, 0.22: 16, 0.3: 19, 0.5: 32, 0.7: 83},
    300: {0.1: 23, 0.22: 29, 0.3: 36, 0.5: 111, 0.7: None},
    400: {0.1: 38, 0.22: 51, 0.3: 73, 0.5: None, 0.7: None},
    500: {0.1: 65, 0.22: 145, 0.3: None, 0.5: None, 0.7: None},
}


def ignition_updates(preset: Fire, thresholds: list[float], distances: list[float]) -> list[int | None]:
    """The update at which a thing ignites, per environment, None if not within 300."""
    world = one_source(distances)
    state = begin_without_spread(preset, world)
    state.threshold[:, 0] = torch.tensor(thresholds)
    seen: list[int | None] = [None] * len(distances)
    for update in range(1, 301):
        updates(preset, state, world, 1)
        for e in (state.status[:, 0] == BURNING).nonzero().flatten().tolist():
            seen[e] = seen[e] or update
    return seen


@pytest.mark.parametrize("repeats", [1, 3])
def test_things_ignite_after_so_many_updates(preset: Fire, repeats: int) -> None:
    """F-13 of docs/physics.md."""
    cases = [(t, d) for t, row in IGNITION_UPDATES.items() for d in row] * repeats
    expected = [IGNITION_UPDATES[t][max(d, 0.5 if preset == fire("paper") else 0.1)] for t, d in cases]
    assert ignition_updates(preset, [float(t) for t, _ in cases], [d for _, d in cases]) == expected


def test_a_thing_alone_ignites_at_the_same_update(preset: Fire) -> None:
    """F-13 of docs/physics.md."""
    assert ignition_updates(preset, [200.0], [0.7]) == [83]
    assert ignition_updates(preset, [300.0], [0.5]) == [111]


@pytest.mark.parametrize(("name", "ignites"), [("paper", True), ("shipped", False)])
def test_ignition_exactly_at_the_threshold_is_for_paper_only(name: str, ignites: bool) -> None:
    world = room_world([("pan", (10.0, 10.0, 0.0))])
    preset = fire(name)
    state = begin(preset, world)
    state.threshold[:] = 20.0  # an unheated thing is at exactly 20 C
    updates(preset, state, world, 1)
    assert (state.status.item() == BURNING) == ignites


def test_thresholds_of_600_and_above_never_ignite(preset: Fire) -> None:
    """F-14 of docs/physics.md."""
    world = one_source([0.05], sources=60)
    state = begin_without_spread(preset, world)
    state.threshold[:] = 600.0
    updates(preset, state, world, 400)
    assert state.status.item() == NORMAL
    assert 590.0 < state.temperature.item() < 600.0


def test_burning_lasts_300_updates(preset: Fire, copies: int) -> None:
    """F-16 of docs/physics.md."""
    world = room_world([("book", (10.0, 10.0, 0.0))], copies=copies)
    state = begin(preset, world)
    state.temperature[:] = 300.0
    updates(preset, state, world, 1)
    assert (state.status == BURNING).all() and (state.temperature == 600.0).all()
    run(preset, state, world, 1499)
    assert (state.status == BURNING).all() and (state.temperature == 600.0).all()
    run(preset, state, world, 1)
    assert (state.status == BURNT).all()
    updates(preset, state, world, 10)
    afterwards = (
        600.0 if preset == fire("shipped") else 20.0 + 580.0 * 0.97**10
    )  # R3: paper cools, shipped stays a source
    assert torch.allclose(state.temperature, torch.tensor(afterwards), rtol=1e-4)
    updates(preset, state, world, 300)
    assert (state.status == BURNT).all()  # nothing burns twice


@pytest.mark.parametrize(("distance", "update"), [(0.5, 5), (1.0, 14), (1.5, 39), (2.0, None)])
def test_when_the_agent_is_overheated(preset: Fire, copies: int, distance: float, update: int | None) -> None:
    """F-18 of docs/physics.md."""
    world = room_world([], [(10.0, 10.0)], copies=copies, agent=(10.0 + distance, 10.0))
    state = begin_without_spread(preset, world)
    hot = []
    for n in range(1, 101):
        updates(preset, state, world, 1)
        if preset.agent_info(state, world)["agent_overheated"].all():
            hot.append(n)
    assert (hot[0] if hot else None) == update


def test_heat_comes_from_a_burning_neighbour(preset: Fire) -> None:
    """A burning book 1 m away is a source of 600 C: F-1 at 1 m."""
    world = room_world([("book", (10.0, 10.0, 0.0)), ("pan", (11.0, 10.0, 0.0))])
    state = begin(preset, world)
    state.temperature[0, 0] = 300.0
    updates(preset, state, world, 1)
    start = state.temperature[0, 1].item()
    updates(preset, state, world, 60)
    assert state.temperature[0, 1].item() == pytest.approx(136.0 + (start - 136.0) * 0.97**60, rel=1e-4)
