"""Raster pictures and both ray-traced ones agree: on how clear water is, how bright embers are."""

from __future__ import annotations

import numpy as np
import pytest
import sapien

from hazard_ms.effects import meshes
from hazard_ms.effects.entities import make_effect, materials
from hazard_ms.effects.raytracing.still import Photographer, Viewpoint
from hazard_ms.effects.shaders.common import EMBER
from hazard_ms.effects.textures import noise_texture
from hazard_ms.machine.render_backend import DEVICES, backend
from tests.worlds.looking import STANDING, flooded
from tests.worlds.ray_views import SHADERS, Views

pytestmark = pytest.mark.render
FLOOR = np.s_[40:80, 20:76]  # rows and columns in which only the floor is seen
PALE = 0.6  # albedo of a floor that is not black


@pytest.mark.long
def test_water_lets_through_the_same_light_for_all_shaders() -> None:
    """Of a pale floor less a black one, wet over dry: what the water adds by itself cancels out."""
    place = flooded(0.3, view=STANDING)
    views = Views(place)
    (floor,) = (m for e in place.scene.entities if e.name == "floor" for m in materials(e))

    def passed(shader: str, level: float) -> np.ndarray:
        place.state.level[:] = level
        seen = []
        for albedo in (PALE, 0.0):
            floor.base_color = [albedo, albedo, albedo, 1.0]
            seen.append(views.light(shader, 30)[FLOOR].mean((0, 1)))
        return seen[0] - seen[1]

    through = {shader: passed(shader, 0.3) / passed(shader, 0.0) for shader in SHADERS}
    assert all((0.2 < t).all() and (t < 0.6).all() for t in through.values()), through
    assert all(t[0] < t[1] for t in through.values()), through  # red goes first
    mean = np.mean(list(through.values()), axis=0)
    for shader, t in through.items():
        np.testing.assert_allclose(t, mean, rtol=0.12, err_msg=shader)


@pytest.mark.long
def test_embers_are_as_bright_and_as_many_for_all_shaders() -> None:
    """Embers alone before a dark wall: the light that they add, and the pixels that glow, after denoising."""
    scene = sapien.Scene([sapien.physx.PhysxCpuSystem(), sapien.render.RenderSystem(sapien.Device(DEVICES[backend()]))])
    scene.set_ambient_light([0.3, 0.3, 0.3])
    builder = scene.create_actor_builder()
    dark = sapien.render.RenderMaterial(base_color=[0.05, 0.05, 0.05, 1.0])
    builder.add_box_visual(half_size=[0.01, 5.0, 5.0], material=dark)
    builder.initial_pose = sapien.Pose([6.0, 0.0, 0.0])
    builder.build_static("wall")
    draw = np.random.default_rng(0)
    anchors = np.column_stack([draw.uniform(-0.8, 0.8, (120, 2)), np.zeros(120)])
    sizes, seeds = np.tile([meshes.EMBER_SIZE, 2.5], (120, 1)), draw.random(120)
    effect = make_effect(
        scene, noise_texture(), lambda m: meshes.quads(anchors, sizes, np.full(120, EMBER), seeds, m), number=0
    )
    assert effect is not None
    effect.show(sapien.Pose([3.5, 0.0, -1.2]), 1.0, 0.3)
    photographer, added, glowing = Photographer(scene), {}, {}
    for shader in SHADERS:
        with photographer.ready(Viewpoint(sapien.Pose(), 0.9, 128, 128), shader, 0.3) as take:
            light = np.power(take(4) / 255.0, 2.2)
        excess = np.maximum(light[..., 0] - np.median(light[..., 0]), 0.0)
        added[shader], glowing[shader] = excess[excess > 0.05].sum(), int((excess > 0.5).sum())
    assert glowing["default"] >= 5
    assert set(glowing.values()) == {glowing["default"]}
    assert all(a == pytest.approx(added["default"], rel=0.1) for a in added.values()), added
