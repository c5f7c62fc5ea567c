"""Glances: depth and labels without colours are those of full pictures."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import torch

from hazard_ms import Action, Agent, SkillEnv
from hazard_ms.effects.shaders import glance, pack
from hazard_ms.evaluation.runner import Runner
from hazard_ms.evaluation.watchers import Watcher
from hazard_ms.sensing.camera import relabel
from hazard_ms.sensing.view import View
from hazard_ms.skills.brief import Brief
from hazard_ms.skills.decision import EXPLORE, STOP, Decision

pytestmark = pytest.mark.render
SMALL = {"width": 64, "height": 64}


def full_picture(env: SkillEnv) -> View:
    """What ManiSkill's own picture of the head camera shows now."""
    observer = env.base.observer
    observer.show()
    observer.display.scene.update_render(update_sensors=True, update_human_render_cameras=False)
    observer.camera.capture()
    seen, params = observer.camera.get_obs(), observer.camera.get_params()
    labels = relabel(seen["segmentation"], observer.labels)
    return View.of(seen["depth"], params["intrinsic_cv"], params["cam2world_gl"], labels)


@pytest.mark.parametrize(
    ("task", "effects"),
    [("HazardFire-v1", "full"), ("HazardFlood-v1", "fast"), ("HazardWind-v1", "full"), ("HazardWind-v1", "off")],
)
def test_labels_are_those_of_the_full_picture_and_depth_but_for_a_millimetre(task: str, effects: str) -> None:
    env = SkillEnv.make(task, effects=effects)
    env.colours = False
    env.reset(seed=3)
    compared, things = [], set[int]()

    def compare(action: Any) -> None:
        if env.frame % 20 == 0:
            seen = env.base.observer.glance()
            true = full_picture(env)
            assert seen.labels is not None and true.labels is not None
            things.update(np.unique(true.labels).tolist())
            np.testing.assert_array_equal(seen.labels, true.labels)
            np.testing.assert_allclose(seen.depth, true.depth, atol=0.0011)
            assert (seen.depth != true.depth).mean() < 2e-4
            compared.append(env.frame)

    env.watch = compare
    env.step(Action(EXPLORE))  # turns the robot round
    env.close()
    assert len(compared) >= 2 and len(things) > 4


def test_the_view_is_the_same_with_colours() -> None:
    env = SkillEnv.make("HazardFire-v1", sensor_configs=SMALL)
    env.reset(seed=3)
    one, (picture, other) = env.base.observer.glance(), env.base.observer.look()
    assert picture.shape == (64, 64, 3) and picture.dtype == torch.uint8 and picture.float().std() > 5.0
    for name in ("depth", "labels", "level", "cam2world"):
        np.testing.assert_array_equal(getattr(one, name), getattr(other, name))
    env.close()


def test_unknown_shaders_cost_time_and_nothing_else(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    glance.glance_pack.cache_clear()
    monkeypatch.setattr(glance, "stock_packs", lambda: tmp_path)
    assert glance.glance_pack() is None
    env = SkillEnv.make("HazardFire-v1", sensor_configs=SMALL)
    env.reset(seed=3)
    seen = env.base.observer.glance()
    np.testing.assert_array_equal(seen.depth, full_picture(env).depth)
    env.close()
    monkeypatch.undo()
    glance.glance_pack.cache_clear()
    assert glance.glance_pack() is not None


class Turns(Agent):
    """Looks around, then stops; keeps what it was shown."""

    def reset(self, brief: Brief) -> None:
        self.shown: list[Decision] = []

    def act(self, decision: Decision) -> Action:
        self.shown.append(decision)
        return Action(EXPLORE if len(self.shown) < 2 else STOP)


class ColourBlind(Turns):
    """The same, but reads no colours."""

    colours = False


class Artist(Watcher):
    """Reads colours."""

    colours = True


def test_decisions_have_colours_where_somebody_reads_them_and_are_else_the_same() -> None:
    env = SkillEnv.make("HazardFire-v1", sensor_configs=SMALL)
    told = []
    for player, watchers in ((Turns(), ()), (ColourBlind(), ()), (ColourBlind(), (Artist(),))):
        Runner(env, player, watchers).run(seed=3)
        told.append([decision.images for decision in player.shown])
    env.close()
    for seen, blind, watched in zip(*told, strict=True):
        assert seen is not None and blind is not None and watched is not None
        assert blind.rgb is None and seen.rgb is not None and watched.rgb is not None
        assert seen.rgb.std() > 5.0
        np.testing.assert_array_equal(seen.rgb, watched.rgb)
        for name in ("depth", "segmentation", "hazard"):
            np.testing.assert_array_equal(getattr(seen, name), getattr(blind, name))


def test_a_pack_that_lacks_a_file_is_unknown(monkeypatch: pytest.MonkeyPatch) -> None:
    glance.glance_pack.cache_clear()
    monkeypatch.setattr(
        glance, "texts", lambda folder: {n: t for n, t in pack.texts(folder).items() if n != "material_set.glsl"}
    )
    assert glance.glance_pack() is None
    glance.glance_pack.cache_clear()
