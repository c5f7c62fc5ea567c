"""Ray-traced pictures: their shader pack, their light, and the denoiser."""

from __future__ import annotations

import logging
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import sapien

from hazard_ms.effects.raytracing import denoise
from hazard_ms.effects.raytracing import pack as ray_pack
from hazard_ms.effects.raytracing import still as camera
from hazard_ms.effects.raytracing.cutouts import mark_cutouts
from hazard_ms.effects.raytracing.geometry import dress
from hazard_ms.effects.raytracing.surfaces import side_by_side
from hazard_ms.effects.shaders.pack import UnknownSapienError
from hazard_ms.machine.render_backend import DEVICES, backend


def test_an_unknown_sapien_gives_its_own_pack(
    monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    def fail(_: Any) -> Any:
        raise UnknownSapienError("other files")

    assert ray_pack.shows_effects()
    monkeypatch.setattr(ray_pack, "_derive", fail)
    with caplog.at_level(logging.WARNING):
        assert Path(ray_pack.ray_pack.__wrapped__()) == Path(sapien.__file__).parent / "vulkan_shader" / "rt"
    assert "no effects in ray-traced pictures" in caplog.text
    monkeypatch.setattr(ray_pack, "ray_pack", ray_pack.ray_pack.__wrapped__)
    assert not ray_pack.shows_effects()
    # else its pictures would show panes of glass
    assert dress(None, sapien.Pose(), 0.0) == [] and mark_cutouts(None) == 0
    with pytest.raises(UnknownSapienError):
        ray_pack._before({"a": "x x"}, "a", "x", "y")


def test_developing_keeps_black_and_order() -> None:
    light = np.linspace(0.0, 20.0, 200, dtype=np.float32)[None, :, None].repeat(3, -1)
    shown = denoise.developed(light).astype(int)[0, :, 0]
    assert shown[0] == 0 and shown[-1] == 255 and (np.diff(shown) >= 0).all()
    half = denoise.developed(np.full((1, 1, 3), 0.5, np.float32))[0, 0, 0]
    assert half == round(255 * 0.5 ** (1 / 2.2))


def test_denoising_smooths_noise() -> None:
    pytest.importorskip("pyoidn")
    draw = np.random.default_rng(0)
    flat = np.full((64, 64, 3), 0.5, np.float32)
    noisy = flat + draw.normal(0.0, 0.2, flat.shape).astype(np.float32)
    calm = denoise.denoised(noisy, flat, np.zeros_like(flat) + np.float32([0.0, 0.0, 1.0]))
    assert np.abs(calm - flat).mean() < 0.2 * np.abs(noisy - flat).mean()


def test_without_the_denoiser_pictures_keep_their_grain_and_one_line_says_so(
    monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    monkeypatch.setattr(denoise, "DENOISER", "no_such_denoiser")
    denoise.denoiser.cache_clear()
    light = np.random.default_rng(0).random((8, 8, 3), np.float32)
    with caplog.at_level(logging.WARNING):
        for _ in range(3):
            np.testing.assert_array_equal(denoise.denoised(light, light, light), light)
    denoise.denoiser.cache_clear()
    assert [r.levelname for r in caplog.records] == ["WARNING"]
    assert "pip install no_such_denoiser" in caplog.text


def test_denoising_keeps_edges_of_the_guides_and_bright_light() -> None:
    """Left and right differ in albedo alone; the light goes up to 8, and rows stay rows."""
    pytest.importorskip("pyoidn")
    draw = np.random.default_rng(1)
    albedo = np.full((48, 96, 3), 0.1, np.float32)
    albedo[:, 48:] = 0.9
    albedo[24:] *= 0.5
    truth = albedo * 8.0 / 0.9
    noisy = truth * draw.gamma(4.0, 0.25, truth.shape[:2])[..., None].astype(np.float32)
    calm = denoise.denoised(noisy, albedo, np.zeros_like(truth) + np.float32([0.0, 0.0, 1.0]))
    assert calm.shape == truth.shape
    assert np.abs(calm - truth).mean() < 0.25 * np.abs(noisy - truth).mean()


def test_halves_of_side_by_side_points_lie_on_either_side_of_a_plane() -> None:
    points = np.random.default_rng(2).random((37, 3))
    order = side_by_side(points)
    assert sorted(order) == list(range(37))
    first, rest = points[order[:32]], points[order[32:]]
    assert (first.max(0) <= rest.min(0)).any()
    assert (points[order[:16]].max(0) <= points[order[16:32]].min(0)).any()
    assert len(side_by_side(np.zeros((0, 3)))) == 0 and list(side_by_side(np.zeros((1, 3)))) == [0]


def box_under_two_lights() -> sapien.Scene:
    scene = sapien.Scene([sapien.physx.PhysxCpuSystem(), sapien.render.RenderSystem(sapien.Device(DEVICES[backend()]))])
    scene.set_ambient_light([0.0, 0.0, 0.0])
    for half, at in (
        ([2.0, 2.0, 0.1], [0.0, 0.0, -0.1]),
        ([0.3, 0.3, 0.3], [0.0, 0.0, 0.3]),
        ([0.1, 2.0, 2.0], [1.5, 0.0, 0.0]),
    ):
        builder = scene.create_actor_builder()
        builder.add_box_visual(
            half_size=half, material=sapien.render.RenderMaterial(base_color=[0.8, 0.6, 0.4, 1.0], roughness=0.6)
        )
        builder.initial_pose = sapien.Pose(at)
        builder.build_static("box")
    scene.add_directional_light([0.3, 0.2, -1.0], [0.6, 0.6, 0.6])
    scene.add_point_light([-1.0, 1.0, 1.5], [1.0, 0.5, 0.2])
    return scene


@pytest.mark.render
@pytest.mark.long
def test_drawn_lights_and_ended_paths_give_the_light_of_sapiens_own_pack() -> None:
    scene, means = box_under_two_lights(), []
    view = camera.Viewpoint(sapien.Pose([-3.0, 0.0, 1.2], [0.985, 0.0, 0.174, 0.0]), 0.8, 24, 24)
    for pack in (ray_pack.ray_pack(), str(Path(sapien.__file__).parent / "vulkan_shader" / "rt")):
        eye = camera._camera(scene, view, pack)
        light, _, _ = denoise.exposed(scene, eye, 3, 256)
        means.append(light.mean((0, 1)))
        scene.remove_entity(eye.entity)
    assert means[1].min() > 0.01
    np.testing.assert_allclose(means[0], means[1], rtol=0.03)
