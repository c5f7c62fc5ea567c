"""Turbulence and the random torque of the wind: W-12 to W-15 of docs/physics.md 2.3."""

from __future__ import annotations

import math

import pytest
import torch

from hazard_ms.hazards.presets import wind
from hazard_ms.hazards.wind.wind import Wind
from hazard_ms.simulation.world import World
from tests.worlds.wind_worlds import Thing, begin, run, street

HEAVY = 1e9  # so heavy that the step is of no account [kg]


def draws(law: Wind, dt: float = 0.01) -> tuple[World, torch.Tensor, torch.Tensor]:
    """Forces and torques, [N, 3], of a main force of 1 N along +y on many bodies of height 0.3."""
    height = 0.3
    world = street([Thing((0.3, 0.2, height), HEAVY)] * 50, (0.0, 5.0), copies=2000)
    state = begin(law, world)
    run(law, state, world, 2, dt)
    got = law.force(state, world, dt)
    assert got.torque is not None
    main = got.force[..., 1].mean()
    return world, got.force.reshape(-1, 3) / main, got.torque.reshape(-1, 3) / main


@pytest.mark.parametrize("name", ["shipped", "paper"])
def test_moments_of_turbulence_and_torque(name: str) -> None:
    """W-12, W-13, W-14: n = 1e5: means 6.3e-4, variances 1.8 %. Across the wind only; in the paper no longer than L =
    0.0866.
    """
    law = wind(name)
    _, force, torque = draws(law)
    assert (force[:, 1] - 1.0).abs().max() < 1e-5 and (torque[:, 1] == 0).all()
    across = force[:, [0, 2]]
    assert float(across.mean(0).abs().max()) < 6.3e-4
    assert across.var(0).tolist() == pytest.approx([0.0025] * 2, rel=0.018)
    size = across.norm(dim=1)
    mean = 0.06267 if name == "shipped" else math.pi / 4 * 0.0866
    assert float(size.mean()) == pytest.approx(mean, rel=0.01)
    assert float(size.square().mean().sqrt()) == pytest.approx(0.07071, rel=0.01)
    if name == "paper":
        assert float(size.max()) <= 0.0866 * (1 + 1e-5) and float(size.max()) > 0.086
    else:
        angle = torch.rad2deg(torch.atan(size))
        assert float(angle.mean()) == pytest.approx(3.58, rel=0.01)
        assert float(angle.quantile(0.99)) == pytest.approx(8.62, rel=0.02)
    assert torque[:, [0, 2]].std(0).tolist() == pytest.approx([0.015] * 2, rel=0.01)
    both = torch.stack([across[:, 0], across[:, 1], torque[:, 0], torque[:, 2]])
    off = torch.corrcoef(both) - torch.eye(4)
    assert float(off.abs().max()) < 4 / math.sqrt(1e5)


@pytest.mark.parametrize("dt", [0.0025, 0.04])
def test_longer_frames_draw_weaker_turbulence(dt: float) -> None:
    """W-15: A force held for dt gives a random walk of variance dt times time: it is scaled with sqrt(0.01 / dt)."""
    _, force, torque = draws(wind("shipped"), dt)
    assert force[:, 0].std() == pytest.approx(0.05 * math.sqrt(0.01 / dt), rel=0.01)
    assert torque[:, 2].std() == pytest.approx(0.015 * math.sqrt(0.01 / dt), rel=0.01)


def test_turbulence_differs_from_frame_to_frame_body_to_body_and_seed_to_seed() -> None:
    law, world = wind("paper"), street([Thing(), Thing()], copies=2)
    state = begin(law, world)
    assert (state.sway == 0).all()
    run(law, state, world, 1)
    first = state.sway.clone()
    run(law, state, world, 1)
    assert (first != state.sway).any(2).all()
    assert not torch.equal(first[0], first[1]) and not torch.equal(first[0, 0], first[0, 1])
