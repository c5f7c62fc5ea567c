"""Models that users add: what they become, that scenes can use them, and that nothing shipped changes."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import trimesh
from PIL import Image

from hazard_ms.cli.__main__ import main
from hazard_ms.scenes.assets import shipped
from hazard_ms.scenes.assets.index import asset, asset_ids, asset_path
from hazard_ms.scenes.assets.rows import Asset
from hazard_ms.scenes.schema import from_json, to_json
from hazard_ms.spec import AgentStart, Body, Fixture, Room, SceneSpec
from hazard_ms.spec.catalogue import CATEGORIES
from tests.worlds.files.user_models import BODY, DESK, RADIUS


def mesh_of(file: str) -> trimesh.Trimesh:
    return trimesh.util.concatenate(trimesh.load_scene(file).dump())


def hulls_of(a: Asset) -> list[trimesh.Trimesh]:
    return list(trimesh.load(a.hulls, force="mesh", process=False).split(only_watertight=False))


def test_the_model_is_turned_scaled_and_put_on_its_base(filled: Path) -> None:
    a = asset("my_flask")
    half = 0.5  # of its size: it was 0.28 m high
    np.testing.assert_allclose(a.extent, [2 * RADIUS * half, 2 * RADIUS * half, 0.14], atol=1e-4)
    low, high = mesh_of(a.visual).bounds
    np.testing.assert_allclose(
        [*low, *high], [-a.extent[0] / 2, -a.extent[1] / 2, 0, a.extent[0] / 2, a.extent[1] / 2, 0.14], atol=1e-4
    )
    points = mesh_of(a.visual).vertices  # the neck is up: above BODY nothing is as wide as the body
    assert np.abs(points[points[:, 2] > half * (BODY + 0.01), :2]).max() < half * 0.02
    assert (a.mass, a.licence, a.author, a.source) == (0.5, "CC-BY-4.0", "Ada", "somewhere")
    image = next(iter(trimesh.load_scene(a.visual).geometry.values())).visual.material.baseColorTexture
    assert max(image.size) == 512 and image.size[0] == 2 * image.size[1]


def test_collision_shapes_keep_the_limits(filled: Path) -> None:
    for name in ("my_flask", "desk"):
        a = asset(name)
        hulls = hulls_of(a)
        assert 1 <= len(hulls) <= 8
        assert all(
            len(h.vertices) <= 64 and h.convex_hull.volume == pytest.approx(abs(h.volume), rel=0.02) for h in hulls
        )
        low, high = trimesh.util.concatenate(hulls).bounds
        half = np.array(a.extent[:2]) / 2 + 0.005
        assert (low[:2] >= -half).all() and (high[:2] <= half).all() and low[2] == pytest.approx(0, abs=1e-3)
        assert high[2] == pytest.approx(a.extent[2], abs=0.005)


def test_the_desk_has_room_on_top_and_below(filled: Path) -> None:
    a = asset("desk")
    np.testing.assert_allclose(a.extent, DESK, atol=1e-3)
    top = max(a.supports, key=lambda s: s.z)
    assert top.z == pytest.approx(DESK[2], abs=0.003)
    np.testing.assert_allclose([*top.min, *top.max], [-0.59, -0.34, 0.59, 0.34], atol=0.03)
    inside = np.array([[0.0, 0.0, 0.3]])
    assert not any(h.contains(inside)[0] for h in hulls_of(a)), "one can reach below it"
    volume = sum(h.volume for h in hulls_of(a))
    assert a.mass == pytest.approx(volume * CATEGORIES["table"].density, rel=0.02)


def test_the_flask_comes_to_rest_upright_where_it_is_dropped(filled: Path) -> None:
    import sapien

    from hazard_ms.simulation.building import add_collision

    a = asset("my_flask")
    scene = sapien.Scene([sapien.physx.PhysxCpuSystem()])
    scene.set_timestep(1 / 120)
    scene.add_ground(0.0, render=False)
    builder = scene.create_actor_builder()
    add_collision(builder, a, (1.0, 1.0, 1.0))
    builder.initial_pose = sapien.Pose([0, 0, 0.02])
    entity = builder.build()
    body = entity.find_component_by_type(sapien.physx.PhysxRigidDynamicComponent)
    body.set_mass(a.mass)
    for _ in range(360):
        scene.step()
    matrix = entity.pose.to_transformation_matrix()
    assert np.linalg.norm(body.linear_velocity) < 0.005 and abs(matrix[2, 3]) < 0.005
    assert matrix[2, 2] > np.cos(np.radians(5))


def room_with_user_assets() -> SceneSpec:
    table, flask = (
        Fixture("desk_1", "table", "desk", (2.0, 2.0, 0.0)),
        Body("flask_1", "bottle", "my_flask", (2.0, 2.0, DESK[2] + 0.01)),
    )
    return SceneSpec("kitchen_a/00", Room((4.0, 4.0)), (table,), (flask,), ("bottle",), (), AgentStart((0.7, 0.7)))


def test_a_scene_file_can_use_them(filled: Path) -> None:
    """Built without pictures, the flask stays on the desk; its mass and size are those of the index."""
    import sapien
    import torch
    from mani_skill.envs.scene import ManiSkillScene
    from mani_skill.envs.utils.system.backend import parse_sim_and_render_backend

    from hazard_ms.simulation.building import build_scenes, make_world

    spec = from_json(to_json(room_with_user_assets()))
    world = make_world((spec,), torch.device("cpu"))
    assert world.mass[0, 0] == 0.5 and world.extent[0, 0, 2] == pytest.approx(0.14, abs=1e-4)
    backend = parse_sim_and_render_backend("physx_cpu", "none")
    scene = ManiSkillScene([sapien.Scene([sapien.physx.PhysxCpuSystem()])], device=torch.device("cpu"), backend=backend)
    rows = build_scenes(scene, (spec,))
    for _ in range(120):
        scene.sub_scenes[0].step()
    assert rows[0][0]._objs[0].pose.p[2] == pytest.approx(DESK[2], abs=0.006)


def test_without_the_model_the_scene_says_so(filled: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    import torch

    from hazard_ms.simulation.building import make_world

    text = to_json(room_with_user_assets())
    monkeypatch.setenv("HAZARD_MS_ASSETS", str(tmp_path))
    with pytest.raises(ValueError, match="'my_flask'.*hazard-ms assets add"):
        make_world((from_json(text),), torch.device("cpu"))


def test_nothing_shipped_changes(filled: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Users' models are there when asked for.

    Generated scenes are the same with and without them, even with a broken index.
    """
    from hazard_ms.scenes import splits

    assert set(asset_ids(users=True)) - set(asset_ids()) == {"my_flask", "desk"}
    assert "my_flask" in asset_ids(category="bottle", users=True) and "my_flask" not in asset_ids(category="bottle")
    with_them = to_json(splits.scene("kitchen_a/00"))
    (tmp_path / "index.json").write_text("[{]")
    monkeypatch.setenv("HAZARD_MS_ASSETS", str(tmp_path))
    splits.scene.cache_clear()
    assert to_json(splits.scene("kitchen_a/00")) == with_them
    assert asset_path(asset("bottle_1").visual).is_relative_to(shipped.root())
    with pytest.raises(ValueError, match="index.json must be valid JSON"):
        asset("my_flask")


def test_the_list_names_them_and_what_is_yours(filled: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["assets", "list", "--category", "bottle"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert [line.split()[0] for line in lines] == [*asset_ids(category="bottle"), "my_flask"]
    assert [str(filled) in line for line in lines] == [*([False] * len(asset_ids(category="bottle"))), True]
    assert main(["assets", "list", "--category", "unicorn"]) == 2


@pytest.mark.render
def test_a_preview_lies_beside_it(filled: Path) -> None:
    image = np.asarray(Image.open(filled / "models/my_flask/preview.png").convert("RGB")).astype(int)
    picture = image[:220]
    middle, corner = picture[55:-55, 55:-55].reshape(-1, 3), picture[:8, :8].reshape(-1, 3)
    assert (np.abs(middle - corner.mean(axis=0)).max(axis=1) > 20).mean() > 0.05
