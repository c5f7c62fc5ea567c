"""Corners without a normal, which models from files have, are lit as what they belong to, and not as not a number."""

from __future__ import annotations

import numpy as np
import pytest
import sapien
from sapien.render import RenderMaterial, RenderShapeTriangleMesh

from hazard_ms.effects.shaders.facing import facing
from hazard_ms.effects.shaders.pack import pack_folder

pytestmark = pytest.mark.render

SIDE = 64  # of the picture [pixels]
CORNERS = np.array([[2.0, 0.8, -0.8], [2.4, -0.8, -0.8], [2.4, -0.8, 0.8], [2.0, 0.8, 0.8]], np.float32)
FACES = np.array([[0, 1, 2], [0, 2, 3]], np.uint32)
FLAT = np.cross(CORNERS[1] - CORNERS[0], CORNERS[3] - CORNERS[0])  # towards the camera


def seen(normals: np.ndarray, mode: str) -> np.ndarray:
    """The lit picture of a slanted card whose corners have these `normals`, [4, 3], through a pack, [S, S, 3]."""
    scene = sapien.Scene([sapien.physx.PhysxCpuSystem(), sapien.render.RenderSystem()])
    scene.set_ambient_light([0.05, 0.05, 0.05])
    scene.add_directional_light([1.0, 0.4, -0.3], [2.0, 2.0, 2.0])
    material = RenderMaterial(base_color=[0.6, 0.3, 0.2, 1.0], roughness=0.9, specular=0.1)
    body = sapien.render.RenderBodyComponent()
    body.attach(
        RenderShapeTriangleMesh(CORNERS, FACES, normals.astype(np.float32), np.zeros((4, 2), np.float32), material)
    )
    camera = sapien.render.RenderCameraComponent(SIDE, SIDE, pack_folder(mode))
    for component in (body, camera):
        entity = sapien.Entity()
        entity.add_component(component)
        scene.add_entity(entity)
    camera.set_fovy(0.6)
    scene.update_render()
    camera.take_picture()
    return np.asarray(camera.get_picture("Color"), np.float64)[..., :3]


@pytest.mark.parametrize("mode", ["full", "fast"])
def test_a_card_without_normals_is_lit_as_one_that_has_them(mode: str) -> None:
    right = seen(np.tile(FLAT / np.linalg.norm(FLAT), (4, 1)), mode)
    bare = seen(np.zeros((4, 3)), mode)
    assert np.isfinite(bare).all() and right[SIDE // 2, SIDE // 2].min() > 0.0
    np.testing.assert_allclose(bare, right, atol=0.02 * right.max())


def test_corners_with_a_normal_keep_it() -> None:
    """A corner without one takes that of the others of its triangle, as if it were not there."""
    tilted = np.tile([-0.8, 0.0, 0.6], (4, 1))
    whole, lame = seen(tilted, "full"), seen(np.where(np.arange(4)[:, None] == 1, 0.0, tilted), "full")
    upper = np.s_[SIDE // 2 - 8 : SIDE // 2, SIDE // 2 - 8 : SIDE // 2]  # of the triangle without that corner
    np.testing.assert_allclose(lame[upper], whole[upper], atol=0.02 * whole.max())


def test_another_text_is_refused() -> None:
    with pytest.raises(ValueError, match="gbuffer must have"):
        facing({"gbuffer.vert": "void main() {}", "gbuffer.frag": "void main() {}"})
