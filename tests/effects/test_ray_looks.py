"""What rays see of effects.

Quads that let light through, in their order, and cameras of ManiSkill's that are ray-traced.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import gymnasium as gym
import numpy as np
import pytest
import sapien
from mani_skill.render import PREBUILT_SHADER_CONFIGS

import hazard_ms  # noqa: F401 registers the environments
from hazard_ms.effects.raytracing import geometry, hits, surfaces
from hazard_ms.effects.raytracing.cutouts import mark_cutouts
from hazard_ms.effects.raytracing.denoise import exposed
from hazard_ms.effects.raytracing.pack import ray_pack
from hazard_ms.effects.raytracing.sensor import with_our_shaders
from hazard_ms.effects.raytracing.still import Viewpoint, _camera
from hazard_ms.effects.shaders.common import EMBER, PAPER, SMOKE
from hazard_ms.machine.render_backend import DEVICES, backend
from tests.worlds.watching import seen

PALE = np.array([0.74, 0.72, 0.66])  # linear light of paper in full light (shaders/wind.py)
GLOWING = np.array([1.6, 0.55, 0.08]) * float(hits.GLOW)  # of an ember (raytracing/hits.py)
SIDE = 24  # of the cameras [pixels]
ABOVE = slice(SIDE // 4, SIDE // 4 + 3)  # rows of pixels

pytestmark = pytest.mark.render


class Bench:
    """A camera at the origin that looks along x, or back, in the dark."""

    def __init__(self) -> None:
        self.scene = sapien.Scene(
            [sapien.physx.PhysxCpuSystem(), sapien.render.RenderSystem(sapien.Device(DEVICES[backend()]))]
        )
        self.scene.set_ambient_light([0.0, 0.0, 0.0])
        self.eye = _camera(self.scene, Viewpoint(sapien.Pose(), 0.3, SIDE, SIDE), ray_pack())

    def middle(
        self, *quads: tuple[float, float], walls: tuple[float, ...] = (), back: bool = False, rows: slice = ABOVE
    ) -> np.ndarray:
        """Linear light, [3], above the middle, where paper bears no print, with quads (kind, distance [m]) across it.

        `walls`: distances of solid ones, which come into the scene after the quads [m].
        """
        self.eye.entity.set_pose(sapien.Pose(q=[0, 0, 0, 1] if back else [1, 0, 0, 0]))
        side = -1.0 if back else 1.0
        added = [geometry._entity(self.scene, _quads(tuple((kind, side * x) for kind, x in quads)))] if quads else []
        added += [self.wall(x) for x in walls]
        light, _, _ = exposed(self.scene, self.eye, 3, 4)
        geometry.undress(self.scene, added)
        return light[rows, SIDE // 2 : SIDE // 2 + 3].mean((0, 1))

    def wall(self, distance: float) -> sapien.Entity:
        builder = self.scene.create_actor_builder()
        builder.add_box_visual(
            half_size=[0.01, 9.0, 9.0], material=sapien.render.RenderMaterial(base_color=[0.5, 0.5, 0.5, 1.0])
        )
        builder.initial_pose = sapien.Pose([distance, 0.0, 0.0])
        return builder.build_static("wall")


def _quads(rows: tuple[tuple[float, float], ...]) -> Any:
    places = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
    corners = np.array([[[x, -y, z] for y, z in places] for _, x in rows])
    lives = np.array([[kind + 0.25, 0.5 if kind in (SMOKE, EMBER) else 1.0, 1.0] for kind, _ in rows])
    return geometry._mesh(geometry.Quads(corners, np.tile(places, (len(rows), 1, 1)), lives), 0.0, np.ones(3))


@pytest.fixture(scope="module")
def bench() -> Iterator[Bench]:
    yield Bench()


def test_the_nearest_quad_is_seen_first_whatever_their_order(bench: Bench) -> None:
    for rows in (((PAPER, 1.0), (EMBER, 2.0)), ((EMBER, 2.0), (PAPER, 1.0))):
        np.testing.assert_allclose(bench.middle(*rows), PALE, rtol=2e-3)
    np.testing.assert_allclose(bench.middle((PAPER, 2.0), (EMBER, 1.0)), GLOWING, rtol=2e-3)


def test_smoke_dims_what_is_behind_it_alone(bench: Bench) -> None:
    np.testing.assert_allclose(bench.middle((PAPER, 1.0), (SMOKE, 2.0)), PALE, rtol=2e-3)
    smoke, dim = bench.middle((SMOKE, 1.0)), bench.middle((SMOKE, 1.0), (EMBER, 2.0))
    left = (dim - smoke) / GLOWING
    assert 0.05 < left.mean() < 0.95
    np.testing.assert_allclose(left, left.mean(), rtol=0.02)  # the same share of red, green and blue
    twice = bench.middle((SMOKE, 1.0), (SMOKE, 1.001), (EMBER, 2.0))
    np.testing.assert_allclose(twice, smoke + left.mean() * dim, rtol=0.02)


@pytest.mark.parametrize("back", (False, True))
def test_of_too_many_quads_the_nearest_are_kept(bench: Bench, back: bool) -> None:
    """Three puffs of smoke before many embers: rays meet the quads in one order, or, looking back, in the other."""
    puffs = ((SMOKE, 1.0), (SMOKE, 1.0005), (SMOKE, 1.001))
    crowd = tuple((EMBER, 2.0 + 0.01 * k) for k in range(hits.MOST_VEILS + 8))
    few = bench.middle(*puffs, (EMBER, 2.0), back=back)
    assert few.max() < 0.7 * GLOWING.max()
    np.testing.assert_allclose(bench.middle(*puffs, *crowd, back=back), few, rtol=5e-3)


def test_solid_things_hide_quads_and_get_light_through_them(bench: Bench) -> None:
    np.testing.assert_array_equal(bench.middle((EMBER, 2.0), walls=(1.5,)), 0.0)
    smoke = bench.middle((SMOKE, 1.0))
    # rays meet both quads first
    np.testing.assert_allclose(bench.middle((SMOKE, 1.0), (EMBER, 2.0), walls=(1.5,)), smoke, rtol=0.02)
    bench.scene.add_directional_light([1.0, 0.0, 0.0], [1.0, 1.0, 1.0])
    bare = bench.middle(walls=(1.5,))
    assert bare.min() > 0.05
    # between the wall and the light: no shadow
    np.testing.assert_allclose(bench.middle((PAPER, -0.5), walls=(1.5,)), bare, rtol=0.02)


@pytest.mark.parametrize("ior", [1.45, 1.01])
def test_rays_pass_where_a_texture_shows_nothing(bench: Bench, ior: float) -> None:
    """A card whose upper half is cut out: embers and a lit wall are seen through it as if it were not there.

    SAPIEN gives materials that are made an index of refraction of 1.45, and those of files 1.01.
    """
    picture = np.full((8, 8, 4), 255, np.uint8)
    picture[:4, :, 3] = 0
    material = sapien.render.RenderMaterial(roughness=1.0, specular=0.0)
    material.base_color_texture = sapien.render.RenderTexture2D(picture, "r8g8b8a8unorm", filter_mode="nearest")
    material.base_color = [1.0, 1.0, 1.0, 1.0]
    material.ior = ior
    corners = np.array([[1.0, 0.2, -0.2], [1.0, -0.2, -0.2], [1.0, -0.2, 0.2], [1.0, 0.2, 0.2]])
    places = np.array([[0.0, 1.0], [1.0, 1.0], [1.0, 0.0], [0.0, 0.0]])  # rows of a texture go down
    normals = np.tile([-1.0, 0.0, 0.0], (4, 1))
    faces = np.array([[0, 1, 2], [0, 2, 3]], np.uint32)
    card = geometry._entity(bench.scene, surfaces.shape(corners, faces, normals, places, material))
    card.name = "card"
    assert mark_cutouts(bench.scene) == 1
    above = bench.middle((EMBER, 2.0))
    np.testing.assert_allclose(above, GLOWING, rtol=2e-3)
    below = bench.middle((EMBER, 2.0), rows=slice(3 * SIDE // 4, 3 * SIDE // 4 + 3))
    assert below.max() < 0.9 * GLOWING.max()
    behind = bench.middle(walls=(1.5,))
    bench.scene.remove_entity(card)
    np.testing.assert_allclose(behind, bench.middle(walls=(1.5,)), rtol=0.02)
    assert mark_cutouts(bench.scene) == 0


@pytest.mark.long
def test_cameras_of_maniskill_are_ray_traced_with_effects() -> None:
    pictures, types, played = {}, {}, 60
    for name, effects, shader in (("raster", "full", None), ("rays", "full", "rt-fast"), ("bare", "off", "rt-fast")):
        camera = {"width": 64, "height": 48, **({} if shader is None else {"shader_pack": shader})}
        env: Any = gym.make(
            "HazardFlood-v1",
            obs_mode="none",
            control_mode="pd_joint_pos",
            render_mode="all",
            effects=effects,
            sensor_configs=camera,
            human_render_camera_configs=camera,
        ).unwrapped
        env.reset(seed=3)
        still = env.agent.action(0.0, 0.0, env.agent.tucked, True)
        for _ in range(played):
            env.advance(still)
        pictures[name] = seen(env)["render_camera"]
        raw = env._sensors["head"].get_obs(apply_texture_transforms=False)
        types[name] = {k: v.dtype for k, v in raw.items() if k != "Color"}
        if name == "rays":
            again, entities = seen(env)["render_camera"], [e.name for e in env.scene.sub_scenes[0].entities]
            for modality, image in again.items():
                np.testing.assert_array_equal(image, pictures[name][modality], modality)
            assert "picture" not in entities
            assert env.render().shape[0] == 1
        env.close()
    raster, rays, bare = pictures["raster"], pictures["rays"], pictures["bare"]
    assert {k: (v.shape, v.dtype) for k, v in rays.items()} == {k: (v.shape, v.dtype) for k, v in raster.items()}
    assert types["rays"] == types["raster"]
    for modality in ("depth", "position", "segmentation", "normal"):
        np.testing.assert_array_equal(rays[modality], raster[modality], modality)
    assert np.abs(rays["rgb"].astype(float) - bare["rgb"]).mean() > 2.0
    assert np.abs(rays["rgb"].astype(float) - raster["rgb"]).mean() < 40.0


@pytest.mark.parametrize("asked", ({"shader_pack": "rt"}, {"shader_config": PREBUILT_SHADER_CONFIGS["rt"]}))
def test_ray_tracing_is_for_one_environment_on_the_cpu(asked: dict[str, Any]) -> None:
    with pytest.raises(ValueError, match="num_envs must be 1 for ray-traced pictures .*='rt'.*, got 4"):
        with_our_shaders({"head": asked}, 4)
    with pytest.raises(ValueError, match="sim_backend must be 'cpu' for .*='rt'.*, got 'physx_cuda'"):
        with_our_shaders(asked, 1, "physx_cuda")


def test_shaders_become_ours_wherever_they_stand() -> None:
    given = {"shader_pack": "minimal", "head": {"shader_pack": "rt-med", "width": 9}, "far": 3.0}
    made = with_our_shaders(given, 1)
    config = made["head"].pop("shader_config")
    assert made == {"shader_pack": "minimal", "head": {"width": 9}, "far": 3.0}
    assert config.shader_pack == ray_pack() and config.shader_pack_config["ray_tracing_samples_per_pixel"] == 4
    assert given["head"] == {"shader_pack": "rt-med", "width": 9}
    assert PREBUILT_SHADER_CONFIGS["rt-med"].shader_pack == "rt"


def test_sapiens_own_ray_tracing_is_refused() -> None:
    with pytest.raises(ValueError, match="the camera 'head' must be 'rt'.* got SAPIEN's own"):
        gym.make("HazardFire-v1", obs_mode="none", shader_dir="rt-fast")
