"""Effects change colours and nothing else, the same state gives the same pixels, and unknown SAPIENs show none."""

from __future__ import annotations

import logging
import shutil
import subprocess
import sys
from functools import cache
from pathlib import Path

import numpy as np
import pytest
import sapien
import torch

from hazard_ms.effects import meshes
from hazard_ms.effects.fire import FireEffects
from hazard_ms.effects.shaders import pack as shader_pack
from hazard_ms.effects.shaders.pack import shader_config
from hazard_ms.effects.textures import noise
from hazard_ms.hazards.fire.fire import BURNT, Fire, FireState
from hazard_ms.simulation.world import World
from tests.worlds.alone import alone
from tests.worlds.burning_room import BOX, EXTENTS, SPEC, TABLE, BurningRoom, picture_hash

ROOT = Path(__file__).parents[2]
LABELS = ("segmentation", "depth", "position", "normal")


@cache
def burning(mode: str, pack: str | None = None) -> dict[str, np.ndarray]:
    """A picture of the room in full blaze, through the pack of `mode` or `pack`."""
    room = BurningRoom(mode, pack)
    room.ignite(TABLE)
    room.ignite(BOX)
    return room.picture(230)


@pytest.mark.render
@pytest.mark.parametrize(("mode", "stock"), [("full", "default"), ("fast", "minimal")])
@pytest.mark.long
@alone
def test_labels_are_those_without_effects(mode: str, stock: str) -> None:
    with_effects, without = burning(mode), burning("off", stock)
    assert set(with_effects) == set(without)
    for name in set(LABELS) & set(without):
        np.testing.assert_array_equal(with_effects[name], without[name], err_msg=name)
    changed = (with_effects["rgb"] != without["rgb"]).any(-1)
    assert changed.mean() > 0.1


@pytest.mark.render
def test_a_pack_without_our_pass_draws_no_effect() -> None:
    """Shadows, ray tracing and stock packs see quads without area: not even a shadow remains."""
    np.testing.assert_array_equal(burning("fast", "default")["rgb"], burning("off", "default")["rgb"])


@pytest.mark.render
@pytest.mark.parametrize("mode", ["full", "fast"])
def test_flames_stand_where_things_burn(mode: str) -> None:
    room = BurningRoom(mode)
    room.fire.flame_cell[:] = -1  # nothing burns on the floor
    before = room.picture(50)
    room.ignite(BOX, 30)
    after = room.picture(50)
    red, green, blue = after["rgb"].astype(int).transpose(2, 0, 1)
    fiery = (red > 220) & (green > 70) & (blue < 0.75 * red)
    assert fiery.sum() > 40
    labels = before["segmentation"][..., 0]
    box = labels == labels[_pixel_of(room, (2.4, 1.5, 0.3))]
    rows, columns = np.nonzero(box)
    found_rows, found_columns = np.nonzero(fiery)
    assert columns.min() - 8 < np.median(found_columns) < columns.max() + 8
    assert found_rows.min() < rows.min()  # they rise above it


@pytest.mark.render
@pytest.mark.parametrize("mode", ["full", "fast"])
@pytest.mark.parametrize("thing", [TABLE, BOX], ids=["plain", "textured"])
def test_what_has_burnt_is_black(mode: str, thing: int) -> None:
    room = BurningRoom(mode)
    room.fire.flame_cell[:] = -1
    before = room.picture(50)
    x, y, _ = SPEC.bodies[thing].position
    labels = before["segmentation"][..., 0]
    mask = labels == labels[_pixel_of(room, (x, y, 0.3))]
    room.ignite(thing, 300, BURNT)
    after = room.picture(50)
    assert after["rgb"][mask].mean() < 0.4 * before["rgb"][mask].mean()
    np.testing.assert_array_equal(after["rgb"][~mask], before["rgb"][~mask])


@pytest.mark.render
def test_a_picture_depends_on_the_present_state_alone() -> None:
    room = BurningRoom("full")
    room.ignite(TABLE, 20)
    first = room.picture(230)["rgb"]
    room.ignite(BOX, 90)
    room.world.safe[0, TABLE] = True
    assert (room.picture(700)["rgb"] != first).any()
    room.fire.status[0, BOX] = room.fire.burn_updates[0, BOX] = 0
    room.fire.temperature[0, BOX] = 20.0
    room.world.safe[0, TABLE] = False
    np.testing.assert_array_equal(room.picture(230)["rgb"], first)


@pytest.mark.render
def test_flames_move_from_frame_to_frame() -> None:
    room = BurningRoom("full")
    room.ignite(TABLE)
    assert (room.picture(230)["rgb"] != room.picture(231)["rgb"]).any()


@pytest.mark.render
@pytest.mark.long
def test_two_processes_draw_the_same_pixels() -> None:
    command = [sys.executable, "-m", "tests.worlds.burning_room"]
    child = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True, timeout=300)
    assert child.stdout.split()[-1] == picture_hash()


@pytest.mark.render
def test_an_update_touches_neither_world_nor_fire() -> None:
    room = BurningRoom("full")
    room.ignite(TABLE)
    kept = {**room.fire.save(), **{k: v.clone() for k, v in vars(room.world).items() if isinstance(v, torch.Tensor)}}
    room.effects.update(room.world, room.fire, room.world.frame)
    for name, value in kept.items():
        now = getattr(room.fire, name, None)
        assert torch.equal(value, now if now is not None else getattr(room.world, name)), name


def test_an_unknown_mode_is_refused() -> None:
    with pytest.raises(ValueError, match="effects must be one of full, fast, off, got 'pretty'"):
        shader_config("pretty")


def test_without_a_renderer_nothing_happens() -> None:
    world = World.of((SPEC,), [EXTENTS], [[1.0, 1.0]])
    fire = FireState.allocate({"E": 1, "B": 2} | Fire().sizes(world), "cpu")
    scene = sapien.Scene([sapien.physx.PhysxCpuSystem()])
    FireEffects.build([scene], (SPEC,), world, "full").update(world, fire, world.frame)
    assert len(scene.entities) == 0


@pytest.mark.parametrize("name", ["hazard", "hazard-fast"])
def test_an_unknown_sapien_costs_the_effects_only(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    stock = Path(sapien.__file__).parent / "vulkan_shader"
    for sub in ("default", "minimal", "common"):
        shutil.copytree(stock / sub, tmp_path / "vulkan_shader" / sub)
        for file in (tmp_path / "vulkan_shader" / sub).glob("gbuffer.frag"):
            file.write_text(file.read_text().replace("void main()", "void start()"))
    monkeypatch.setattr(sapien, "__file__", str(tmp_path / "__init__.py"))
    monkeypatch.setenv("HAZARD_MS_HOME", str(tmp_path / "home"))
    with caplog.at_level(logging.WARNING):
        assert shader_pack._pack.__wrapped__(name) is None
    assert "no effects" in caplog.text


def test_a_pack_is_written_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("HAZARD_MS_HOME", str(tmp_path))
    first, second = (shader_pack._pack.__wrapped__("hazard") for _ in range(2))
    assert first == second
    assert first is not None and Path(first).is_relative_to(tmp_path)
    assert [p.name for p in (tmp_path / "shaders").iterdir()] == [Path(first).parent.name]  # and no drafts are left


def test_noise_tiles_and_fills_its_range() -> None:
    field = noise(64)
    steps = np.abs(np.diff(field, axis=1)).max()
    assert np.abs(field[:, 0] - field[:, -1]).max() <= steps  # no seam
    assert field.min() == 0.0 and field.max() == 1.0 and 0.35 < field.mean() < 0.65


def test_flames_stand_on_upper_faces() -> None:
    """Of a plate of 1 m x 1 m, all flames stand on the upper side, apart from each other."""
    corners = np.array([[x, y, z] for z in (0.0, 1.0) for y in (-0.5, 0.5) for x in (-0.5, 0.5)])
    faces = np.array([[4, 5, 7], [4, 7, 6], [0, 3, 1], [0, 2, 3]])  # the top, facing up; the underside, facing down
    spots = meshes.spots(corners, faces, 6)
    assert (spots[:, 2] > 0.99).all()
    gaps = np.linalg.norm(spots[:, None] - spots[None], axis=-1)[np.triu_indices(6, 1)]
    assert gaps.min() > 0.2


def _pixel_of(room: BurningRoom, point: tuple[float, float, float]) -> tuple[int, int]:
    """Row and column at which the camera sees `point` [m]."""
    x, y, z = room.camera.get_extrinsic_matrix()[:3] @ np.array([*point, 1.0])
    intrinsic = room.camera.get_intrinsic_matrix()
    return int(intrinsic[1, 1] * y / z + intrinsic[1, 2]), int(intrinsic[0, 0] * x / z + intrinsic[0, 2])
