"""Pictures and light: packs derive and compile, light and effects never touch an episode, the command writes files or refuses."""

from __future__ import annotations

import hashlib
import logging
import re
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import cv2
import gymnasium as gym
import numpy as np
import pytest
import sapien
import torch

import hazard_ms  # noqa: F401 registers the environments
from hazard_ms.cli import main
from hazard_ms.effects import ray_pack, ray_picture
from hazard_ms.effects.cutouts import mark_cutouts
from hazard_ms.effects.ray_geometry import dress, side_by_side
from hazard_ms.effects.shader_pack import UnknownSapienError
from hazard_ms.lighting import DRAWN, FIRST_FAILURE, LAST_FAILURE, LIGHTINGS, Lighting
from hazard_ms.pictures import camera
from hazard_ms.pictures.order import RenderOrder
from hazard_ms.pictures.stage import Stage
from hazard_ms.rendering import DEVICES, backend
from hazard_ms.tasks import TASKS

FRAMES = 40  # of an episode: the fire has spread by then


def bare(mode: str, count: int = 1) -> Lighting:
    """Light without a renderer, in `count` scenes."""
    task = TASKS["HazardFire-v1"]("paper")
    spec = task.build(task.scenes("train")[0])
    return Lighting(SimpleNamespace(can_render=lambda: False), (spec,) * count, mode)


def test_random_light_is_drawn_by_the_seed_alone() -> None:
    seeds = torch.arange(400)
    drawn = bare("random", 400).chosen(seeds)
    assert drawn == bare("random", 400).chosen(seeds)
    assert set(drawn) == set(DRAWN)
    assert all(60 < drawn.count(name) < 140 for name in DRAWN)  # 100 expected of each
    assert bare("random").chosen(seeds[7:8]) == drawn[7:8]  # alone as among others


def test_failing_lamps_shine_then_flicker_then_stay_dark() -> None:
    light, seed = bare("failing"), torch.tensor([5])
    course = torch.stack([light._failing(seed, torch.tensor([f]))[0] for f in range(LAST_FAILURE + 1)])
    for lamp in course.T:
        dark = int((lamp == 0.0).nonzero()[0])
        assert FIRST_FAILURE <= dark <= LAST_FAILURE
        assert (lamp[dark:] == 0.0).all()
        assert (lamp[: max(0, dark - 151)] == 1.0).all()
    assert ((course > 0.0) & (course < 1.0)).any()


def test_unknown_light_is_refused() -> None:
    with pytest.raises(ValueError, match="lighting 'dusk' is unknown.*day, evening, night, failing, random"):
        gym.make("HazardFire-v1", lighting="dusk")


def episode(lighting: str, effects: str, draw: bool) -> tuple[str, np.ndarray]:
    """Hash of all state after some frames, and the labels of the head camera."""
    made = gym.make("HazardFire-v1", obs_mode="none", render_mode="rgb_array", lighting=lighting, effects=effects)
    env: Any = made.unwrapped
    env.reset(seed=3)
    still = np.zeros(env.single_action_space.shape, np.float32)
    for frame in range(FRAMES):
        env.advance(still)
        if draw and frame == FRAMES // 2:
            env.render()
    digest = hashlib.sha256()
    _feed(digest, env.get_state_dict())
    camera = env._sensors[env.agent.head_camera]
    env.observer.show()
    env.scene.update_render(update_sensors=True, update_human_render_cameras=False)
    camera.capture()
    labels = camera.get_obs(rgb=False, depth=False, position=False, segmentation=True)["segmentation"]
    made.close()
    return digest.hexdigest(), labels.cpu().numpy()


def _feed(digest: Any, state: Any) -> None:
    if isinstance(state, dict):
        for key in sorted(state):
            digest.update(str(key).encode())
            _feed(digest, state[key])
    else:
        digest.update(np.ascontiguousarray(torch.as_tensor(state).cpu().numpy()).tobytes())


@pytest.mark.render
def test_light_and_effects_change_neither_episode_nor_labels() -> None:
    plain = episode("day", "full", draw=False)
    for lighting, effects in (("night", "full"), ("random", "off")):
        digest, labels = episode(lighting, effects, draw=True)
        assert digest == plain[0], lighting
        np.testing.assert_array_equal(labels, plain[1], err_msg=lighting)


@pytest.mark.render
@pytest.mark.long
@pytest.mark.parametrize("lighting", LIGHTINGS)
@pytest.mark.parametrize("effects", ["full", "fast", "off"])
def test_every_light_and_every_look_leaves_the_episode_alone(lighting: str, effects: str) -> None:
    assert episode(lighting, effects, draw=True)[0] == episode("day", "full", draw=False)[0]


def without_cameras(scene: sapien.Scene) -> list[sapien.Entity]:
    return [e for e in scene.entities if e.find_component_by_type(sapien.render.RenderCameraComponent) is None]


@pytest.mark.render
def test_pictures_of_both_kinds(tmp_path: Path) -> None:
    """Ray-traced and raster pictures show the same room; where it burns, both are fiery; the scene is left as it was."""
    order = RenderOrder(output=tmp_path / "x.png", seed=3, frame=500)
    with Stage(order) as stage:
        view = stage.view("third", 48, 32)
        count = len(without_cameras(stage._scene))
        raster, traced = stage.picture(view, "default", 1), stage.picture(view, "rt-fast", 1)
        assert len(without_cameras(stage._scene)) == count
    assert raster.shape == traced.shape == (32, 48, 3)
    small = [cv2.resize(p, (6, 4), interpolation=cv2.INTER_AREA).astype(float).ravel() for p in (raster, traced)]
    assert np.corrcoef(*small)[0, 1] > 0.7
    for picture in (raster, traced):
        red, _, blue = picture.astype(int).transpose(2, 0, 1)
        assert ((red > 180) & (blue < 0.7 * red)).any()


@pytest.mark.render
def test_the_command_writes_the_picture(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "out.png"
    assert main(["render", "-s", "3", "--frame", "5", "--size", "48x32", "--light", "evening", "--camera", "head", "-o", str(path)]) == 0
    assert cv2.imread(str(path)).shape == (32, 48, 3)
    assert re.search(r"48 x 32, raster: \d+\.\d s, \d+\.\d s of processor time", capsys.readouterr().out)
    assert [p.name for p in tmp_path.iterdir()] == ["out.png"]


@pytest.mark.parametrize(
    ("words", "fault"),
    [
        ([], "no file to write"),
        (["-o", "x.gif"], "x.gif"),
        (["-o", "no/such/folder/x.png"], "no folder"),
        (["-o", "x.png", "--shader", "pretty"], "'pretty'.*default, rt-fast, rt"),
        (["-o", "x.png", "--frame", "-1"], "frame is -1"),
        (["-o", "x.png", "--frame", "1501"], "frame is 1501"),
        (["-o", "x.png", "--size", "big"], "size is 'big'"),
        (["-o", "x.png", "--size", "8"], "width is 8"),
        (["-o", "x.png", "--spp", "0"], "spp is 0"),
        (["-o", "x.png", "--camera", "foot"], "camera 'foot'"),
        (["-o", "x.png", "--light", "noon"], "light 'noon'"),
        (["-o", "x.png", "-e", "HazardQuake-v1"], "'HazardQuake-v1'"),
        (["--turntable", "x.avi"], "x.avi"),
    ],
)
def test_bad_input_is_refused(words: list[str], fault: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: Any) -> None:
    monkeypatch.chdir(tmp_path)
    assert main(["render", *words]) == 2
    assert re.search(fault, capfd.readouterr().err)
    assert list(tmp_path.iterdir()) == []


def test_an_unknown_sapien_gives_its_own_pack(monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture) -> None:
    def fail(_: Any) -> Any:
        raise UnknownSapienError("other files")

    assert ray_pack.shows_effects()
    monkeypatch.setattr(ray_pack, "_derive", fail)
    with caplog.at_level(logging.WARNING):
        assert Path(ray_pack.ray_pack.__wrapped__()) == Path(sapien.__file__).parent / "vulkan_shader" / "rt"
    assert "no effects in ray-traced pictures" in caplog.text
    monkeypatch.setattr(ray_pack, "ray_pack", ray_pack.ray_pack.__wrapped__)
    assert not ray_pack.shows_effects()
    assert dress(None, sapien.Pose(), 0.0) == [] and mark_cutouts(None) == 0  # else its pictures would show panes of glass
    with pytest.raises(UnknownSapienError):
        ray_pack._before({"a": "x x"}, "a", "x", "y")


def test_developing_keeps_black_and_order() -> None:
    light = np.linspace(0.0, 20.0, 200, dtype=np.float32)[None, :, None].repeat(3, -1)
    shown = ray_picture.developed(light).astype(int)[0, :, 0]
    assert shown[0] == 0 and shown[-1] == 255 and (np.diff(shown) >= 0).all()
    half = ray_picture.developed(np.full((1, 1, 3), 0.5, np.float32))[0, 0, 0]
    assert half == round(255 * 0.5 ** (1 / 2.2))


def test_denoising_smooths_noise() -> None:
    pytest.importorskip("pyoidn")
    draw = np.random.default_rng(0)
    flat = np.full((64, 64, 3), 0.5, np.float32)
    noisy = flat + draw.normal(0.0, 0.2, flat.shape).astype(np.float32)
    calm = ray_picture.denoised(noisy, flat, np.zeros_like(flat) + np.float32([0.0, 0.0, 1.0]))
    assert np.abs(calm - flat).mean() < 0.2 * np.abs(noisy - flat).mean()


def test_without_the_denoiser_pictures_keep_their_grain_and_one_line_says_so(
    monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    monkeypatch.setattr(ray_picture, "DENOISER", "no_such_denoiser")
    ray_picture.denoiser.cache_clear()
    light = np.random.default_rng(0).random((8, 8, 3), np.float32)
    with caplog.at_level(logging.WARNING):
        for _ in range(3):
            np.testing.assert_array_equal(ray_picture.denoised(light, light, light), light)
    ray_picture.denoiser.cache_clear()
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
    calm = ray_picture.denoised(noisy, albedo, np.zeros_like(truth) + np.float32([0.0, 0.0, 1.0]))
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
    for half, at in (([2.0, 2.0, 0.1], [0.0, 0.0, -0.1]), ([0.3, 0.3, 0.3], [0.0, 0.0, 0.3]), ([0.1, 2.0, 2.0], [1.5, 0.0, 0.0])):
        builder = scene.create_actor_builder()
        builder.add_box_visual(half_size=half, material=sapien.render.RenderMaterial(base_color=[0.8, 0.6, 0.4, 1.0], roughness=0.6))
        builder.initial_pose = sapien.Pose(at)
        builder.build_static("box")
    scene.add_directional_light([0.3, 0.2, -1.0], [0.6, 0.6, 0.6])
    scene.add_point_light([-1.0, 1.0, 1.5], [1.0, 0.5, 0.2])
    return scene


@pytest.mark.render
@pytest.mark.long
def test_drawn_lights_and_ended_paths_give_the_light_of_sapiens_own_pack() -> None:
    scene, means = box_under_two_lights(), []
    view = camera.View(sapien.Pose([-3.0, 0.0, 1.2], [0.985, 0.0, 0.174, 0.0]), 0.8, 24, 24)
    for pack in (ray_pack.ray_pack(), str(Path(sapien.__file__).parent / "vulkan_shader" / "rt")):
        eye = camera._camera(scene, view, pack)
        light, _, _ = ray_picture.exposed(scene, eye, 3, 256)
        means.append(light.mean((0, 1)))
        scene.remove_entity(eye.entity)
    assert means[1].min() > 0.01
    np.testing.assert_allclose(means[0], means[1], rtol=0.03)
