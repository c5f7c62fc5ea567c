"""`severity`: it scales the danger of `realistic`, each number is that of its source, and it travels everywhere."""

from __future__ import annotations

import dataclasses
import math

import pytest
import torch

from hazard_ms.evaluation.choices import SEVERITIES as OFFERED
from hazard_ms.evaluation.options import EnvOptions, EpisodeOptions, SweepOptions
from hazard_ms.hazards import presets
from hazard_ms.hazards.fire.realistic.blaze import Blaze
from hazard_ms.hazards.flood.realistic.inundation import Inundation
from hazard_ms.spec.severity import SEVERITIES, USUAL
from hazard_ms.tasks import task_of
from tests.worlds.registering import registered_task
from tests.worlds.wind_worlds import Thing, begin, street

EVERY = pytest.mark.parametrize("severity", SEVERITIES)
STORMS = {"moderate": 17.0, "severe": 28.0, "extreme": 40.0}  # [m/s at 10 m]
MEGAWATT = {"moderate": 300.0, "severe": 150.0, "extreme": 75.0}  # time to 1,055 kW [s] [NFPA 204]


@EVERY
def test_storms_blow_at_10_m_as_fast_as_they_are_named(severity: str) -> None:
    """In the mean over streets without a wind of their own; none is weaker than 2/3 or stronger than 4/3 of it."""
    law = dataclasses.replace(presets.wind("realistic", severity), gust_intensity=0.0, sheltered=False)
    world = street([Thing()], (0.0, 0.0), copies=4000)
    speeds = law.image(begin(law, world), world, torch.tensor([[[8.0, 8.0, 10.0]]]))[:, 0]
    storm = STORMS[severity]
    assert float(speeds.mean()) == pytest.approx(storm, rel=4 * 0.193 / math.sqrt(4000))
    assert float(speeds.min()) >= 2 / 3 * storm * 0.999 and float(speeds.max()) <= 4 / 3 * storm * 1.001


@EVERY
def test_colours_of_a_storm_reach_from_calm_to_its_fastest_mean(severity: str) -> None:
    """4/3 of the usual storm, whole metres per second; what observations and learners are scaled by stays."""
    law = presets.wind("realistic", severity)
    assert law.shown_level.low == 0.0
    assert 0.0 <= law.shown_level.high - 4 / 3 * STORMS[severity] < 1.0
    assert law.level == presets.wind("paper").level
    assert [presets.wind(name).shown_level.high for name in ("paper", "shipped")] == [2.0, 5.0]
    assert presets.fire("realistic").shown_level == presets.fire("paper").level


def test_water_stands_outside_up_to_calf_knee_and_waist() -> None:
    depths = {name: presets.flood("realistic", name) for name in SEVERITIES}
    assert [law.outside for law in depths.values() if isinstance(law, Inundation)] == [0.3, 0.5, 1.0]


@EVERY
def test_fires_grow_to_a_megawatt_in_the_published_time(severity: str) -> None:
    assert SEVERITIES[severity].fire_growth * MEGAWATT[severity] ** 2 == pytest.approx(1055.0, rel=0.01)
    fire, usual = presets.fire("realistic", severity), presets.fire("realistic")
    assert isinstance(fire, Blaze) and isinstance(usual, Blaze)
    level = SEVERITIES[severity]
    first = {"first_release": level.fire_start, "first_base": level.fire_base, "first_height": level.fire_height}
    assert fire == dataclasses.replace(usual, growth=level.fire_growth, **first)


@pytest.mark.parametrize("make", [presets.fire, presets.flood, presets.wind])
def test_each_step_is_more_dangerous_and_only_realistic_has_them(make: object) -> None:
    assert callable(make)
    assert make("realistic") == make("realistic", USUAL) != make("realistic", "extreme")
    for preset in ("paper", "shipped"):
        assert make(preset, USUAL) == make(preset)
        with pytest.raises(
            ValueError, match="severity must be 'severe' for all physics but 'realistic', got 'extreme'"
        ):
            make(preset, "extreme")
    with pytest.raises(ValueError, match="severity must be one of moderate, severe, extreme, got 'mild'"):
        make("realistic", "mild")
    numbers = [dataclasses.astuple(SEVERITIES[name]) for name in STORMS]
    assert all(a < b < c for a, b, c in zip(*numbers, strict=True))


@pytest.mark.parametrize("name", ["HazardFire-v1", "HazardFlood-v1", "HazardWind-v1", "HazardCompound-v1"])
def test_every_rescue_hands_it_to_its_hazards(name: str) -> None:
    task = task_of(name, "realistic", None, "extreme")
    assert task.hazards == tuple(presets.hazard(h.name, "realistic", "extreme") for h in task.hazards)
    assert task.hazards != task_of(name, "realistic").hazards


def test_tasks_without_severities_refuse_all_but_the_usual_one() -> None:
    with registered_task("HazardMild-v0", lambda physics: task_of("HazardFire-v1", physics)):
        assert task_of("HazardMild-v0", "realistic", None, USUAL).hazards
        with pytest.raises(ValueError, match="severity must be 'severe' for HazardMild-v0, which has no other"):
            task_of("HazardMild-v0", "realistic", None, "extreme")


def test_options_name_it_where_physics_is_realistic() -> None:
    assert OFFERED == tuple(SEVERITIES)
    real = EpisodeOptions("HazardWind-v1", physics="realistic", severity="extreme")
    real.check()
    assert real.settings["severity"] == "extreme" and "--severity extreme" in real.command
    assert "severity" not in EpisodeOptions("HazardWind-v1").settings
    places = {SweepOptions().place(dataclasses.replace(real, severity=name)) for name in SEVERITIES}
    assert len(places) == len(SEVERITIES)
    with pytest.raises(ValueError, match="severity must be 'severe'"):
        EnvOptions(severity="moderate").check()
