"""Hot air above what burns bends the picture behind it.

Colours alone, as much as burns, and nothing that stands before it.
"""

from __future__ import annotations

import logging
import math
import shutil
from pathlib import Path

import numpy as np
import pytest
import sapien
import torch
from sapien.render import RenderMaterial, RenderShapeBox

from hazard_ms.effects.entities import HIDDEN
from hazard_ms.effects.shaders import pack
from hazard_ms.effects.shimmer import NAME
from tests.worlds.burning_room import BOX, SIDE, SPEC, TABLE, BurningRoom, _add

FRAME = 230
LABELS = {"segmentation", "depth", "position", "normal"}
EYE = np.array([0.2, 0.2])  # of the room's camera [m]
MOST = 0.02  # by which a thing seems to lie beside where it is, seen at the fire's distance [m]


def room(mode: str = "full", floor: bool = False) -> BurningRoom:
    """A room in which nothing burns yet, unless its `floor` does."""
    made = BurningRoom(mode)
    if not floor:
        made.fire.flame_cell[:] = -1
    return made


def cold(burning: BurningRoom, frame: int = FRAME) -> dict[str, np.ndarray]:
    """The picture at `frame` without hot air, all else equal."""
    burning.picture(frame)
    for air in burning.effects._scenes[0].air:
        air.material.transmission = 0.0
    burning.scene.update_render()
    burning.camera.take_picture()
    made: dict[str, torch.Tensor] = {}
    for name, transform in burning.transforms.items():
        made |= transform(torch.from_numpy(burning.camera.get_picture(name)))
    return {k: v.numpy() for k, v in made.items()}


def heat(burning: BurningRoom) -> list[float]:
    """Strengths of the columns of hot air that are shown."""
    burning.picture(FRAME)
    return [a.material.transmission for a in burning.effects._scenes[0].air if a.entity.pose.p[2] > HIDDEN.p[2]]


@pytest.mark.render
def test_the_picture_changes_behind_hot_air_and_labels_never() -> None:
    burning = room(floor=True)
    _add(
        burning.scene,
        "post",
        RenderShapeBox([0.04, 0.04, 1.5], RenderMaterial(base_color=[0.8, 0.8, 0.8, 1.0])),
        (0.75, 1.2, 0.0),
    )
    burning.ignite(TABLE)
    burning.ignite(BOX)
    warm = burning.picture(FRAME)
    distance = -burning.camera.get_picture("Position")[..., 2]
    places = [e.pose.p for e in burning.scene.entities if e.name.startswith(NAME) and e.pose.p[2] > HIDDEN.p[2]]
    nearest = min((burning.camera.get_extrinsic_matrix()[:3] @ [*p, 1.0])[2] for p in places)
    without = cold(burning)
    assert len(LABELS & set(warm)) >= 3
    for name in LABELS & set(warm):
        np.testing.assert_array_equal(warm[name], without[name], err_msg=name)
    changed = (warm["rgb"] != without["rgb"]).any(-1)
    assert 0.02 < changed.mean() < 0.6
    before = (distance > 0.0) & (distance < nearest - 0.8)  # air leans towards the camera, by less than this
    assert before[SIDE // 2, SIDE // 4 : -SIDE // 4].any() and not changed[before].any()


@pytest.mark.render
def test_a_straight_edge_wavers_to_both_sides_by_centimetres_at_most() -> None:
    burning = room()
    _edge_behind_the_table(burning)
    burning.ignite(TABLE)
    scene = burning.effects._scenes[0]
    scene.things = [None, None]  # no flames before the edge
    shifts = []
    for frame in (FRAME, FRAME + 5, FRAME + 10, FRAME + 15):
        warm, without = (_linear(shown) for shown in (burning.picture(frame), cold(burning, frame)))
        contrast = without.max(1) - without.min(1)
        shifts.append((warm - without).sum(1) / contrast)  # of the edge, per row [pixels]
    moved = np.array(shifts)
    fire = np.linalg.norm(np.array(SPEC.bodies[TABLE].position[:2]) - EYE)
    focus = SIDE / 2 / math.tan(burning.camera.fovy / 2)  # [pixels]
    assert moved.max() > 0.1 and moved.min() < -0.1
    assert np.abs(moved).max() < MOST / fire * focus * 1.25  # the column leans towards the camera
    assert (np.abs(np.diff(moved, axis=0)).max(1) > 0.1).all()  # from moment to moment


@pytest.mark.render
def test_air_is_as_hot_as_much_burns() -> None:
    burning = room()
    assert heat(burning) == []
    burning.ignite(BOX, 5)
    (weak,) = heat(burning)
    burning.ignite(BOX, 60)
    (small,) = heat(burning)
    burning.ignite(TABLE)
    assert 0.0 < weak < small < max(heat(burning)) <= 1.0
    assert len(heat(burning)) == 2


@pytest.mark.render
@pytest.mark.parametrize("mode", ["fast", "off"])
def test_only_full_effects_have_hot_air(mode: str) -> None:
    burning = room(mode, floor=True)
    burning.ignite(TABLE)
    burning.picture(FRAME)
    assert not [e for e in burning.scene.entities if e.name.startswith(NAME)]


@pytest.mark.parametrize("text", ["texture(samplerLighting, inUV)", "samplerPositionRaw", "void main() {"])
def test_an_unknown_last_pass_costs_the_effects_only(
    text: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    stock = Path(sapien.__file__).parent / "vulkan_shader"
    for sub in ("default", "common"):
        shutil.copytree(stock / sub, tmp_path / "vulkan_shader" / sub)
    last = tmp_path / "vulkan_shader" / "default" / "composite0.frag"
    last.write_text(last.read_text().replace(text, "another"))
    monkeypatch.setattr(sapien, "__file__", str(tmp_path / "__init__.py"))
    monkeypatch.setenv("HAZARD_MS_HOME", str(tmp_path / "home"))
    with caplog.at_level(logging.WARNING):
        assert pack._pack.__wrapped__("hazard") is None
    assert "no effects" in caplog.text


def _edge_behind_the_table(burning: BurningRoom) -> None:
    """Two high walls across the view, dark and light, that meet behind the middle of the table."""
    middle = np.array(SPEC.bodies[TABLE].position[:2])
    ahead = (middle - EYE) / np.linalg.norm(middle - EYE)
    beside = np.array([ahead[1], -ahead[0]])
    turn = [math.cos(math.atan2(*ahead[::-1]) / 2), 0.0, 0.0, math.sin(math.atan2(*ahead[::-1]) / 2)]
    for side, value in ((-1, 0.0), (1, 1.0)):
        wall = RenderMaterial(base_color=[0.0, 0.0, 0.0, 1.0], specular=0.0)
        wall.emission = [0.8 * value] * 3 + [1.0]
        name = f"wall_{side}"
        _add(burning.scene, name, RenderShapeBox([0.1, 4.0, 4.0], wall), (0.0, 0.0, 0.0))
        entity = next(e for e in burning.scene.entities if e.name == name)
        entity.set_pose(sapien.Pose([*(middle + 1.6 * ahead + side * 4.0 * beside), 0.0], turn))


def _linear(shown: dict[str, np.ndarray]) -> np.ndarray:
    """Green light of the upper half of a picture, above the table, [H/2, W]."""
    return np.power(shown["rgb"][: SIDE // 2, :, 1] / 255.0, 2.2)
