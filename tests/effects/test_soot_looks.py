"""Soot grows on walls, ceiling and furniture above what burns, over labels that stay those of the scene."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from hazard_ms.cli.costs.effects import go_on
from hazard_ms.effects.soot import FAINT, _sheets
from hazard_ms.scenes.splits import scene
from tests.worlds.watching import made, seen

SCENE = "kitchen_a/03"


def soot_of(env: Any) -> Any:
    return env.observer.display.effects._parts["fire"]._scenes[0].soot


@pytest.mark.parametrize("name", (SCENE, "flat_a/00"))
def test_sheets_lie_inside_the_room_beside_openings_and_cover_the_ceiling(name: str) -> None:
    room = scene(name).room
    quads = np.array([quad for sheet in _sheets(room) for quad in sheet])
    assert (
        (quads[..., :2] >= 0.0).all()
        and (quads[..., :2] <= room.size).all()
        and (quads[..., 2] < room.height + 1e-9).all()
    )
    edges = np.ptp(quads, axis=1)
    flat = edges[:, 2] < 1e-6
    assert (edges[flat, 0] * edges[flat, 1]).sum() == pytest.approx(room.size[0] * room.size[1])
    walls = edges[~flat, :2].max(1) * edges[~flat, 2]
    holes = sum((2 if o.kind == "doorway" else 1) * o.width * o.height for o in room.openings)
    whole = 2 * (sum(room.size) + len(room.partitions) * room.size[1]) * room.height
    assert walls.sum() == pytest.approx(whole - holes)


@pytest.mark.render
def test_soot_only_grows_above_the_fire_and_labels_stay() -> None:
    env = made("HazardFire-v1", "full", width=96, height=96)
    plain = made("HazardFire-v1", "off", width=96, height=96)
    for one in (env, plain):
        one.reset(seed=3, options={"scene": SCENE})
    before, now = np.zeros((1, 1)), 0
    for frame in (330, 660, 990):
        for one in (env, plain):
            go_on(one, frame - now)
        now = frame
        pictures, labels = seen(env), seen(plain)
        for camera, modalities in pictures.items():
            for name in ("segmentation", "depth", "position"):
                np.testing.assert_array_equal(modalities[name], labels[camera][name], err_msg=f"{camera} {name}")
            known = np.isfinite(labels[camera]["normal"])  # `full` has its own where a model has none, or nearly so
            changed = modalities["normal"][known] != labels[camera]["normal"][known]
            assert known.mean() > 0.95 and changed.mean() < 1e-3, camera
        amount = soot_of(env).amount.copy()
        assert (amount >= before - 1e-9).all() and amount.max() > before.max()
        before = amount
    state = env.episode.states["fire"]
    burning = state.flame_place[0][state.flame_cell[0] >= 0].numpy()
    assert soot_of(env).above(burning).min() > 0.3
    corner = np.array([[x, y, 0.0] for x in (0.2, env.specs[0].room.size[0] - 0.2) for y in (0.2, 5.6)])
    assert soot_of(env).above(corner).min() < FAINT
    # the same state gives the same stains, whatever was shown before
    frame = int(env.world.frame[0])
    soot_of(env).show(burning[:1], np.array([3000]), 0)
    assert (soot_of(env).amount != before).any()
    env.observer.show()
    np.testing.assert_array_equal(soot_of(env).amount, before)
    assert frame == int(env.world.frame[0])
    for one in (env, plain):
        one.close()


@pytest.mark.render
def test_walls_and_ceiling_get_darker_where_soot_is() -> None:
    env = made("HazardFire-v1", "full", width=96, height=96)
    env.reset(seed=3, options={"scene": SCENE})
    soot, room = soot_of(env), env.specs[0].room
    place, never = np.array([[room.size[0] / 2, room.size[1] / 2, 0.0]]), np.array([0])
    light = {}
    for burnt in (0, 400, 4000):
        env.observer.show()
        soot.show(place, never + burnt, 0)
        env.scene.update_render(update_sensors=False, update_human_render_cameras=True)
        (camera,) = env._human_render_cameras.values()
        camera.capture()
        rgb = camera.get_obs(rgb=True, depth=False, position=False, segmentation=False)["rgb"][0].cpu().numpy()
        light[burnt] = rgb.astype(float)
    some, more = light[0] - light[400], light[0] - light[4000]
    assert some.min() > -3.0 and more.min() > -3.0  # soot makes nothing brighter
    assert 0.0 < (some > 10.0).mean() < (more > 10.0).mean() < 0.9
    env.close()
