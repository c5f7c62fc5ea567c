"""Balances of `realistic` fire and flood in one scene: neither water nor wet doors add heat, and no water is lost."""

from __future__ import annotations

import pytest
import torch

from hazard_ms.hazards.fire.realistic.blaze_state import BlazeState
from hazard_ms.hazards.flood.realistic.floor_plan import CELL
from hazard_ms.hazards.flood.realistic.inundation_state import InundationState
from hazard_ms.scenes.splits import split_names
from hazard_ms.simulation.building import make_world
from hazard_ms.spec.severity import SEVERITIES
from hazard_ms.tasks import task_of
from hazard_ms.tasks.episode.episode import Episode
from tests.hazards.fire.test_smoke_balances import LACK, MASS, OXYGEN, PER_OXYGEN, kept
from tests.worlds.flood_balance import drawn

FRAME, EVERY, FASTER = 1 / 30, 5, 4.5  # of an episode [s]; frames of an update of heat; seconds of fire per second


def check(split: str, severity: str, scenes: int, frames: int) -> None:
    """Let nobody act in so many scenes at once, and hold the balances of gas, heat, oxygen and water in each."""
    task = task_of("HazardCompound-v1", "realistic", None, severity)
    world = make_world(tuple(drawn(split, scenes)), torch.device("cpu"))
    episode, rows = Episode(world, task.hazards, task.safe_place), torch.arange(scenes)
    episode.begin(rows, rows)
    episode.begin_hazards(rows)
    fire, water = episode.states["fire"], episode.states["flood"]
    assert isinstance(fire, BlazeState) and isinstance(water, InundationState)
    burnt, open_before = torch.zeros(scenes, dtype=torch.float64), fire.vents[..., 0].clone()
    volume = (fire.zone_area * fire.height[:, None]).sum(1).double()
    for frame in range(1, frames + 1):
        episode.advance(FRAME)
        if frame % EVERY:
            continue
        burnt += fire.heat_release * (EVERY * FRAME * FASTER)
        gas = fire.zone_smoke + fire.zone_air
        assert bool(gas.isfinite().all()) and float(gas[..., MASS].min()) >= 0.0, (split, severity, frame)
        assert bool((gas[..., LACK] <= OXYGEN * gas[..., MASS] + 1e-3).all()), (split, severity, frame)
        assert bool((kept(fire) <= burnt * 1.002 + 1.0).all()), (split, severity, frame)
        here = (water.depth.double() + water.depth_rest).sum(1) * CELL**2
        came = water.inflow.double() + water.inflow_rest
        assert torch.allclose(here, came, rtol=1e-5, atol=1e-6), (split, severity, frame)
    width, high = open_before, fire.vents[..., 2] - fire.vents[..., 1]
    area = torch.maximum(width, fire.vents[..., 3]) * high * ((fire.vent_to < 0) & (fire.vents[..., 3] > 0))
    reach = 0.52 * area.sum(1).double() * fire.height.double().sqrt()  # of air, at most, [kg/s] (Kawagoe)
    seconds = frames * FRAME * FASTER
    assert bool((burnt <= PER_OXYGEN * OXYGEN * (1.204 * volume + reach * seconds)).all())
    assert float(burnt.min()) > 0.0 and float(water.inflow.min()) > 0.0


@pytest.mark.parametrize("split", split_names())
def test_a_burning_and_flooded_scene_keeps_its_heat_and_water(split: str) -> None:
    check(split, "severe", 2, 300)


@pytest.mark.parametrize("severity", SEVERITIES)
@pytest.mark.parametrize("split", split_names())
@pytest.mark.long
@pytest.mark.timeout(3600)
def test_many_burning_and_flooded_scenes_keep_their_heat_and_water(split: str, severity: str) -> None:
    """Fifty scenes of each split, over a whole episode."""
    check(split, severity, 50, 1500)
