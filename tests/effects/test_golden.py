"""Each task looks as it did.

Pictures resemble those in tests/golden, and would not if a part of what is seen were missing.

`python -m tests.effects.golden_pictures` makes the pictures anew, after a wanted change of looks; look at them before
you commit them.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
import sapien

from hazard_ms.effects.entities import solid_materials
from tests.effects.golden_pictures import MOMENTS, Likeness, golden, likeness, pictures, started

pytestmark = pytest.mark.render

STRUCTURE = 0.985  # least SSIM: all shifted by 0.1 pixels gives 0.987
COLOUR = 4.5  # greatest difference of a square's mean colour: all 2 % brighter gives 3.3, no smoke over a fire 8.6
GREY = [0.5, 0.5, 0.5, 1.0]
STREAKS = 2  # number of the streaks among what the wind carries


@pytest.mark.parametrize("env_id", MOMENTS)
def test_a_task_looks_as_it_did(env_id: str) -> None:
    for moment, found in zip(MOMENTS[env_id], likenesses(env_id, started(env_id)), strict=True):
        assert is_alike(found), f"{env_id} at frame {moment}: {found}"


@pytest.mark.long
@pytest.mark.parametrize("env_id", MOMENTS)
@pytest.mark.parametrize(
    ("effects", "lighting"), [("off", "day"), ("full", "night"), ("full", "evening"), ("full", "failing")]
)
def test_another_look_or_light_is_noticed(env_id: str, effects: str, lighting: str) -> None:
    assert not any(map(is_alike, likenesses(env_id, started(env_id, effects, lighting))))


@pytest.mark.long
@pytest.mark.parametrize("env_id", MOMENTS)
def test_missing_textures_are_noticed(env_id: str) -> None:
    env = started(env_id)
    for material in solid_materials(env.scene.sub_scenes[0]):
        if material.base_color_texture is not None:
            material.base_color_texture, material.base_color = None, GREY
    assert not any(map(is_alike, likenesses(env_id, env)))


@pytest.mark.long
@pytest.mark.parametrize("env_id", MOMENTS)
def test_missing_shadows_are_noticed(env_id: str, monkeypatch: pytest.MonkeyPatch) -> None:
    add = sapien.Scene.add_directional_light
    monkeypatch.setattr(
        sapien.Scene, "add_directional_light", lambda *args, **kw: add(*args, **{**kw, "shadow": False})
    )
    assert not any(map(is_alike, likenesses(env_id, started(env_id))))


@pytest.mark.long
@pytest.mark.parametrize(
    ("env_id", "part"),
    [
        ("HazardFire-v1", "show_floor"),
        ("HazardFire-v1", "show_smoke"),
        ("HazardFire-v1", "show_light"),
        ("HazardFlood-v1", "_surface"),
        ("HazardFlood-v1", "_around"),
        ("HazardWind-v1", "_around"),
    ],
    ids=lambda name: name.strip("_"),
)
def test_a_missing_effect_is_noticed(env_id: str, part: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Flames, smoke, firelight; the water's surface, and what is seen through water; haze."""
    env = started(env_id)
    (effects,) = env.observer.display.effects._parts.values()
    (shown,) = effects._scenes
    nothing: Callable[..., None] = lambda *_: None  # noqa: E731
    if part.startswith("show_"):
        monkeypatch.setattr(shown, part, nothing)
    else:
        monkeypatch.setattr(getattr(shown, part), "show", nothing)
    assert not any(map(is_alike, likenesses(env_id, env)))


def test_streaks_in_the_wind_are_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    """They are too thin for the likeness to tell: without them single pixels change, 0.2 % of a picture."""
    env = started("HazardWind-v1")
    (shown,) = next(iter(env.observer.display.effects._parts.values()))._scenes
    monkeypatch.setattr(shown._parts[STREAKS], "show", lambda *_: None)
    for moment, without in zip(MOMENTS["HazardWind-v1"], pictures(env, "HazardWind-v1"), strict=True):
        changed = np.abs(golden("HazardWind-v1", moment).astype(int) - without.astype(int)).max(-1) > 20
        assert changed.mean() > 0.001, moment
    env.close()


def test_likeness_is_that_of_its_definition() -> None:
    """A picture and itself; a flat picture and a brighter one, for which SSIM is a fraction by hand.

    A picture without its pattern.
    """
    draw = np.random.default_rng(0).integers(0, 256, (128, 192, 3), dtype=np.uint8)
    assert likeness(draw, draw) == pytest.approx((1.0, 0.0))
    dark, bright = np.full_like(draw, 100), np.full_like(draw, 120)
    steady = (0.01 * 255) ** 2
    assert likeness(dark, bright) == pytest.approx(((2 * 100 * 120 + steady) / (100**2 + 120**2 + steady), 20.0))
    assert likeness(draw, np.full_like(draw, 127)).structure < 0.1


def likenesses(env_id: str, env: Any) -> list[Likeness]:
    """Of what is seen at the moments of `env_id` from now on, to the pictures as they should be. Closes `env`."""
    try:
        return [likeness(golden(env_id, m), p) for m, p in zip(MOMENTS[env_id], pictures(env, env_id), strict=True)]
    finally:
        env.close()


def is_alike(found: Likeness) -> bool:
    """Whether two pictures of this likeness may show the same."""
    return found.structure >= STRUCTURE and found.colour <= COLOUR
