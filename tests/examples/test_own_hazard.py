"""A hazard from outside the package is played, filmed, rendered and validated, alone and together with others."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import gymnasium as gym
import numpy as np
import pytest
import torch
from PIL import Image

from hazard_ms.cli.__main__ import main
from hazard_ms.spec.registry import HAZARDS
from hazard_ms.validation import report
from hazard_ms.validation.outcome import check
from tests.examples.stopping import FRAMES
from tests.hazards import test_hazard_contract as contract
from tests.worlds.registering import loaded

EXAMPLE = Path(__file__).parents[2] / "examples" / "own_hazard.py"
TASK = "HazardEarthquake-v1"
SHORT = "tests.examples.stopping:Stopping"


@pytest.fixture(scope="module", autouse=True)
def example() -> Iterator[Any]:
    with loaded(EXAMPLE) as module:
        yield module
    assert TASK not in gym.registry and "earthquake" not in HAZARDS


@pytest.fixture(scope="module")
def env() -> Iterator[Any]:
    made = gym.make(TASK, obs_mode="state", render_backend="none")
    yield made
    made.close()


def shaken(env: Any, frames: int) -> Any:
    """How far all things have moved [m], [B], after this many frames."""
    env.reset(seed=3)
    world = env.unwrapped.world
    start = world.position.clone()
    for _ in range(frames):
        *_, info = env.step(None)
        assert not bool(info["sim_error"])
    return (world.position - start).norm(dim=-1)[0]


def test_it_is_small() -> None:
    assert len(EXAMPLE.read_text().splitlines()) < 150


def test_loose_things_slide_and_fixtures_stand(env: Any, example: Any) -> None:
    """At 8.18 m/s^2 and a friction of 0.5 most things slide; an earthquake of 1 m/s^2 moves nothing."""
    moved = shaken(env, 240)
    world = env.unwrapped.world
    loose = world.movable[0]
    assert float((moved[loose] > 0.02).float().mean()) > 0.5 and float(moved[~loose].max()) == 0.0
    assert torch.equal(moved, shaken(env, 240))
    law, state = env.unwrapped.task.hazards[0], env.unwrapped.episode.states["earthquake"]
    state.scale *= 1.0 / law.peak
    weak = example.ground(state, example.RECORD).norm(dim=-1)
    assert float(weak.max()) == pytest.approx(1.0, rel=1e-4)
    push = law.force(state, world, 1 / 120)
    assert torch.equal(push.force[0, :, :2], -world.mass[0, :, None] * state.acceleration)


def test_it_keeps_the_contract_of_hazards(example: Any) -> None:
    hazard = example.Earthquake()
    contract.test_every_quantity_is_declared(hazard)
    contract.test_looking_changes_nothing_and_advancing_only_its_state(hazard)
    contract.test_a_reset_of_some_rows_touches_no_other(hazard)
    contract.test_restoring_a_state_restores_the_future(hazard)


def test_things_that_fall_are_damaged_and_things_in_a_hand_are_not(example: Any) -> None:
    world = contract.scene(1)
    law = example.Earthquake()
    state = contract.begin(law, world)
    world.position[0, 0, 2] += 1.0
    state.height[0, 0] += 1.0
    assert not law.damaged(state, world).any()
    world.position[0, 0, 2] -= 0.9  # falls
    assert law.damaged(state, world)[0].tolist() == [True] + [False] * (world.num_bodies - 1)
    world.held[0, 0] = True
    law.advance(state, world, 1 / 30)
    assert not law.damaged(state, world).any()


def test_its_cases_pass_and_the_command_says_so(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["validate", "--hazard", "earthquake"]) == 0
    said = capsys.readouterr().out
    assert "2 of 2 cases pass" in said and "E-2" in said
    assert {case.id for _, case in report.chosen("earthquake")} == {"E-1", "E-2"}
    assert all(check(case).passed for name, case in report.chosen(None, quick=True) if name == "earthquake")


@pytest.mark.render
def test_it_is_filmed(tmp_path: Path) -> None:
    film = tmp_path / "quake.mp4"
    words = ["play", "--load", str(EXAMPLE), "-e", TASK, "--agent", SHORT, "--output", str(film), "--every", "10"]
    assert main(words) == 0
    result = json.loads(film.with_suffix(".json").read_text())
    assert result["ended"] == "stopped" and result["frames"] >= FRAMES
    assert film.stat().st_size > 10_000


@pytest.mark.long
@pytest.mark.render
def test_it_is_rendered_with_its_dust(tmp_path: Path) -> None:
    """120 frames on, the room is hazier than without effects: darker things are brighter."""
    darkest = {}
    for effects in ("full", "off"):
        picture = tmp_path / f"{effects}.png"
        words = ["render", "--load", str(EXAMPLE), "-e", TASK, "--frame", "120", "--size", "128", "-o", str(picture)]
        assert main([*words, "--effects", effects]) == 0
        darkest[effects] = float(np.percentile(np.asarray(Image.open(picture).convert("L")), 2))
    assert darkest["full"] > darkest["off"] + 5.0


@pytest.mark.render
def test_together_with_a_fire_the_camera_has_one_image_for_each() -> None:
    made = gym.make("HazardCompound-v1", hazards=["earthquake", "fire"], obs_mode="rgb+depth")
    made.reset(seed=0)
    for _ in range(5):
        obs, *_ = made.step(None)
    image, states = obs["sensor_data"]["head"]["hazard"], made.unwrapped.episode.states
    assert [h.name for h in made.unwrapped.task.hazards] == ["fire", "earthquake"] and image.shape[-1] == 2
    acceleration = float(states["earthquake"].acceleration.norm())
    assert image[..., 1].unique().tolist() == pytest.approx([acceleration]) and float(image[..., 0].min()) >= 20.0
    made.close()
