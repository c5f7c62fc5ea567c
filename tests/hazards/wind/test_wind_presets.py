"""The wind of every preset: batches, seeds, the agent, and parameters that are refused."""

from __future__ import annotations

import dataclasses
import math

import pytest
import torch

from hazard_ms.hazards.presets import _WIND, wind
from hazard_ms.robots.fetch import HazardFetch
from tests.worlds.fire_worlds import about_z
from tests.worlds.wind_worlds import Block, Thing, begin, run, street

EVERY = pytest.mark.parametrize("preset", _WIND)


@pytest.fixture(params=[1, 64])
def copies(request: pytest.FixtureRequest) -> int:
    return request.param


@EVERY
def test_one_and_64_environments_agree_bit_for_bit(preset: str) -> None:
    things = [
        Thing((0.1 + 0.05 * k, 0.2, 0.1), 0.1 + k, (5.0 + k, 6.0, 0.0), about_z(0.3 * k), category="bottle")
        for k in range(7)
    ]
    blocks = [Block("hedge", (4.0, 6.0, 0.0), (0.5, 3.0, 1.5)), Block("cart", (9.0, 6.0, 0.0), (0.53, 0.93, 1.03))]
    law, made = wind(preset), []
    for copies in (1, 64):
        world = street(things, (0.0, 0.0), blocks, copies=copies)
        state = begin(law, world)
        world.velocity[:] = torch.linspace(-2, 2, 27).reshape(1, 9, 3)
        run(law, state, world, 20)
        got = law.force(state, world, 1 / 120)
        made.append({**state.save(), "force": got.force, "torque": got.torque})
    for name, value in made[0].items():
        assert torch.equal(value[0], made[1][name][0]), name


@EVERY
def test_a_scene_without_wind_draws_one_by_its_seed(preset: str) -> None:
    law = wind(preset)
    state = begin(law, street([Thing()], (0.0, 0.0), copies=4000))
    speed = state.speed / law.scale
    assert 2.5 <= float(speed.min()) < 2.51 and 4.99 < float(speed.max()) <= 5.0
    assert float(speed.mean()) == pytest.approx(3.75, abs=4 * 2.5 / math.sqrt(12 * 4000))
    assert torch.allclose(state.heading.norm(dim=1), torch.ones(4000))
    assert float(state.heading.mean(0).norm()) < 4 / math.sqrt(4000)
    again = begin(law, street([Thing()], (0.0, 0.0), copies=3))
    assert torch.equal(again.heading, state.heading[:3])
    assert torch.allclose(begin(law, street([Thing()], (-3.0, 1.5))).heading, torch.tensor([[-0.894427, 0.447214]]))


@EVERY
def test_wind_damages_nothing_and_the_image_is_its_speed(preset: str) -> None:
    law = dataclasses.replace(wind(preset), gust_intensity=0.0)
    world = street([Thing(resistance=3.0)], (3.0, 4.0))
    state = begin(law, world)
    assert not law.damaged(state, world).any()
    points = torch.tensor([[[3.0, 3.0, 10.0], [90.0, -50.0, 10.0]]])
    assert law.image(state, world, points)[0].tolist() == pytest.approx([5.0 * law.scale] * 2, rel=1e-5)


@EVERY
@pytest.mark.parametrize("u", [2.5, 5.0])
def test_the_agent_is_slowed_against_the_flow_and_never_outruns_it(preset: str, u: float) -> None:
    """With its own velocity v it moves at k v + (1 - k) u: 1 - k grows with the square of the wind.

    In `realistic` its friction, 0.6 x 115 kg x g, holds it up to 39.7 m/s, so nothing is added to k v.
    """
    law = wind(preset, "moderate" if preset == "realistic" else "severe")
    law = dataclasses.replace(law, by_split=False, gust_intensity=0.0, roughness=0.0)
    world = street([Thing()], (0.6 * u, -0.8 * u), copies=3)
    world.agent_build = HazardFetch.build
    state = begin(law, world)
    kept, flow = law.slow(state, world)[:, 0], law.slow(state, world)[:, 1:]
    air = u * law.scale
    added = torch.zeros(3, 1) if preset == "realistic" else ((1 - kept) * air)[:, None]
    assert torch.allclose(flow, added * torch.tensor([0.6, -0.8]), atol=1e-6)
    assert 0.6 < float(kept[0]) < 1.0
    weak = begin(law, street([Thing()], (0.3 * u, -0.4 * u), copies=3))
    assert float((1 - kept[0]) / (1 - law.slow(weak, world)[0, 0])) == pytest.approx(4.0, rel=1e-3)
    storm = begin(dataclasses.replace(law, scale=60.0), world)
    fast = 60.0 * u - 39.7335 if preset == "realistic" else 60.0 * u
    assert torch.allclose(law.slow(storm, world), torch.tensor([0.0, 0.6 * fast, -0.8 * fast]), rtol=1e-4)
    assert law.agent_info(state, world)["agent_wind"].tolist() == pytest.approx([air] * 3, rel=1e-5)


@pytest.mark.parametrize(
    ("field", "value"),
    [
        ("scale", 0.0),
        ("gain", -1.0),
        ("gust_time", 0.0),
        ("turbulence", -0.1),
        ("roughness", 10.0),
        ("gain", math.nan),
        ("torque", math.nan),
    ],
)
def test_impossible_parameters_are_refused_by_name(field: str, value: float) -> None:
    with pytest.raises(ValueError, match=f"{field} must be .*, got {value}"):
        dataclasses.replace(wind("paper"), **{field: value})


def test_an_unknown_preset_is_refused() -> None:
    with pytest.raises(ValueError, match="physics must be one of paper, shipped, realistic, got 'real'"):
        wind("real")
