"""Other collections, in small files of the layouts that their downloads have: listed, described, converted, built by ManiSkill."""

from __future__ import annotations

import gzip
import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import trimesh

from hazard_ms.cli import main
from hazard_ms.intake.worker import assembled
from hazard_ms.providers import PROVIDERS, provider
from hazard_ms.providers.partnet import parts

CABINET = "1000"  # an id of ManiSkill's metadata; its scale there
CABINET_SCALE = 0.6129399556808358
UID = "0123456789abcdef0123456789abcdef"
MUG = (0.1, 0.08, 0.09)  # [m]

BOX = '<geometry><mesh filename="textured_objs/box.obj"/></geometry>'
URDF = f"""<?xml version="1.0"?>
<robot name="partnet">
  <link name="base"/>
  <link name="link_0"><visual><origin xyz="0 0 0.5"/>{BOX}</visual><collision><origin xyz="0 0 0.5"/>{BOX}</collision></link>
  <link name="link_1">
    <visual><origin xyz="1 0 0" rpy="0 0 0"/>{BOX.replace("/></geometry>", ' scale="1 1 2"/></geometry>')}</visual>
    <collision>{BOX}</collision>
  </link>
  <joint name="j0" type="fixed">
    <origin rpy="1.570796326794897 0 -1.570796326794897" xyz="0 0 0"/><parent link="base"/><child link="link_0"/>
  </joint>
  <joint name="j1" type="revolute">
    <origin xyz="0 0 3"/><axis xyz="0 1 0"/><parent link="link_0"/><child link="link_1"/><limit lower="0" upper="1.57"/>
  </joint>
</robot>
"""


def write_box(path: Path, size: tuple[float, ...] = (1.0, 1.0, 1.0), up: float = 0.0) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    made = trimesh.creation.box(size, transform=trimesh.transformations.translation_matrix([0, 0, up]))
    made.export(path)


def write_json(path: Path, rows: object) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    text = json.dumps(rows).encode()
    path.write_bytes(gzip.compress(text) if path.suffix == ".gz" else text)


def write_ycb(data: Path) -> None:
    folder = data / "assets/mani_skill2_ycb"
    box = {"min": [-MUG[0] / 2, -MUG[1] / 2, -0.01], "max": [MUG[0] / 2, MUG[1] / 2, MUG[2] - 0.01]}
    rows = {i: {"bbox": box, "scales": [1.0], "density": 1000} for i in ("025_mug", "077_rubiks_cube", "013_apple", "../../etc")}
    write_json(folder / "info_pick_v0.json", rows)
    for name in ("025_mug", "077_rubiks_cube"):  # 013_apple was not downloaded
        write_box(folder / "models" / name / "textured.obj", MUG, MUG[2] / 2 - 0.01)
        write_box(folder / "models" / name / "collision.ply", MUG, MUG[2] / 2 - 0.01)


def write_partnet(data: Path) -> None:
    folder = data / "partnet_mobility/dataset" / CABINET
    write_box(folder / "textured_objs/box.obj")
    (folder / "mobility_cvx.urdf").write_text(URDF)


def write_replicacad(data: Path) -> None:
    folder = data / "scene_datasets/replica_cad_dataset"
    write_box(folder / "stages/frl_apartment_stage.glb", (8.0, 0.1, 8.0))
    write_box(folder / "objects/cup.glb", (0.1, 0.1, 0.1))
    write_box(folder / "objects/convex/cup_cv_decomp.glb", (0.1, 0.1, 0.1))
    asset = {"render_asset": "../../objects/cup.glb", "collision_asset": "../../objects/convex/cup_cv_decomp.glb"}
    write_json(folder / "configs/objects/cup.object_config.json", asset)
    place = {"translation": [1.0, 2.0, 3.0], "rotation": [1.0, 0.0, 0.0, 0.0]}
    things = [{"template_name": "objects/cup", "motion_type": kind, **place} for kind in ("DYNAMIC", "STATIC")]
    scene = {"stage_instance": {"template_name": "stages/frl_apartment_stage"}, "object_instances": things}
    write_json(folder / "configs/scenes/apt_3.scene_instance.json", {**scene, "articulated_object_instances": []})


def write_architecthor(data: Path) -> None:
    folder = data / "scene_datasets/ai2thor"
    write_json(folder / "ai2thor-hab/configs/object_semantic_id_mapping.json", {"Apple": 7, "Sofa": 9})
    write_box(folder / "ai2thor-hab/assets/stages/house.glb", (8.0, 0.1, 8.0))
    for name, number in (("Apple_1", 7), ("Sofa_1", 9)):
        write_json(folder / f"ai2thorhab-uncompressed/configs/objects/{name}.object_config.json", {"semantic_id": number})
        write_box(folder / f"ai2thorhab-uncompressed/assets/objects/{name}.glb", (0.1, 0.1, 0.1))
    place = {"translation": [1.0, 2.0, 3.0], "rotation": [1.0, 0.0, 0.0, 0.0]}
    things = [{"template_name": f"objects/{name}", **place} for name in ("Apple_1", "Sofa_1")]
    scene = {"stage_instance": {"template_name": "stages/house"}, "object_instances": things}
    write_json(folder / "ai2thor-hab/configs/scenes/ArchitecTHOR/ArchitecTHOR-Val-02.scene_instance.json", scene)


def write_robocasa(data: Path) -> None:
    folder = data / "scene_datasets/robocasa_dataset/assets/scenes"
    for file in ("kitchen_layouts/galley.yaml", "kitchen_layouts/L_shaped_small.yaml", "kitchen_styles/rustic.yaml"):
        (folder / file).parent.mkdir(parents=True, exist_ok=True)
        (folder / file).write_text("{}")


def write_objaverse(folder: Path, row: dict[str, object]) -> None:
    write_box(folder / f"glbs/000-023/{UID}.glb", (1.0, 3.0, 2.0))
    write_json(folder / "metadata/000-023.json.gz", {UID: {"uid": UID, **row}})
    write_json(folder / "lvis-annotations.json.gz", {"Sofa": ["f" * 32], "teddy_bear": [UID]})


@pytest.fixture
def data(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """ManiSkill's data folder, with a little of everything. ManiSkill itself, in this process, keeps reading its own."""
    import mani_skill  # noqa: F401  # before the variable is set

    monkeypatch.setenv("MS_ASSET_DIR", str(tmp_path / "ms"))
    monkeypatch.setenv("HAZARD_MS_ASSETS", str(tmp_path / "mine"))
    for write in (write_ycb, write_partnet, write_replicacad, write_architecthor, write_robocasa):
        write(tmp_path / "ms/data")
    return tmp_path / "ms/data"


def bounds(model: object) -> np.ndarray:
    """Lowest and highest corner of the model's parts in our frame [m], [2, 3]."""
    import dataclasses

    return assembled(dataclasses.asdict(model)).bounds  # type: ignore[call-overload]


@pytest.mark.parametrize("name", PROVIDERS)
def test_missing_data_name_the_command(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The command is one that ManiSkill's downloader takes: its ids are read here."""
    from mani_skill.utils.assets.data import DATA_GROUPS, DATA_SOURCES

    monkeypatch.setenv("MS_ASSET_DIR", str(tmp_path))
    monkeypatch.setenv("HAZARD_MS_OBJAVERSE", str(tmp_path))
    there = provider(name)
    with pytest.raises(ValueError, match="get them with") as refusal:
        there.ids()
    assert there.download in str(refusal.value) and str(tmp_path) in str(refusal.value)
    if name != "objaverse":
        command, _, uid = there.download.rpartition(" ")
        assert command == "python -m mani_skill.utils.download_asset" and uid in {**DATA_SOURCES, **DATA_GROUPS}
    assert main(["assets", "list", "--provider", name]) == 2


def test_ycb(data: Path) -> None:
    ycb = provider("ycb")
    assert ycb.ids() == ("025_mug", "077_rubiks_cube"), "what is listed and there"
    assert ycb.ids("mug") == ("025_mug",)
    model = ycb.model("025_mug")
    assert (model.category, model.licence) == ("mug", "CC-BY-4.0")
    assert model.mass == pytest.approx(0.5 * 1000 * np.prod(MUG))
    np.testing.assert_allclose(np.diff(bounds(model), axis=0)[0], MUG, atol=1e-6)
    with pytest.raises(ValueError, match="013_apple.*025_mug"):
        ycb.model("013_apple")


def test_a_ycb_object_becomes_a_model_of_ours(data: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Where nothing draws it has no preview."""
    from hazard_ms.assets import asset

    monkeypatch.setenv("HAZARD_MS_RENDER", "none")
    assert main(["assets", "add", "ycb:025_mug", "--name", "ycb_mug"]) == 0
    a = asset("ycb_mug")
    assert sorted(p.name for p in Path(a.visual).parent.iterdir()) == ["hulls.ply", "model.glb"]
    assert (a.category, a.licence, a.source) == ("mug", "CC-BY-4.0", "ManiSkill's YCB, 025_mug")
    np.testing.assert_allclose(a.extent, MUG, atol=1e-4)
    assert trimesh.load(a.visual, force="mesh").bounds[0, 2] == pytest.approx(0.0, abs=1e-4)


def test_partnet(data: Path) -> None:
    """The joints' frames are applied: the second box is 3 m along z of the first, which is turned."""
    partnet = provider("partnet-mobility")
    assert partnet.ids() == (CABINET,) == partnet.ids("cabinet") and partnet.ids("bottle") == ()
    model = partnet.model(CABINET)
    assert model.scale == CABINET_SCALE and "non-commercial" in model.licence
    # by hand: rpy (90, 0, -90) degrees takes x to -y, y to z, z to -x; ours then turns its front, -x, to -y: x to y, y to -x
    first = [[0, 0, 0.5], [0.5, 0.5, 0.5]]  # middle and half size in the frame of link_0
    second = [[1, 0, 3], [0.5, 0.5, 1.0]]
    corners = []
    for middle, half in (first, second):
        for sign in (-1, 1):
            x, y, z = np.array(middle) + sign * np.array(half)
            in_robot = np.array([-z, -x, y])
            corners.append(np.array([-in_robot[1], in_robot[0], in_robot[2]]))
    wanted = CABINET_SCALE * np.array([np.min(corners, axis=0), np.max(corners, axis=0)])
    np.testing.assert_allclose(bounds(model), wanted, atol=1e-6)


@pytest.mark.parametrize(
    ("old", "new", "word"),
    [
        ("textured_objs/box.obj", "../../../../../../etc/passwd", "leads out of"),
        ("textured_objs/box.obj", "/etc/passwd", "leads out of"),
        ('<?xml version="1.0"?>', '<?xml version="1.0"?><!DOCTYPE a [<!ENTITY b "c">]>', "entities"),
        ('xyz="0 0 3"', 'xyz="0 0 nan"', "three numbers"),
        ('<parent link="base"/>', '<parent link="link_1"/>', "hangs on itself"),
        ("</robot>", "", "cannot be read"),
        ("visual", "hidden", "0 files"),
    ],
)
def test_a_hostile_urdf_is_refused(old: str, new: str, word: str, tmp_path: Path) -> None:
    assert old in URDF
    (tmp_path / "mobility_cvx.urdf").write_text(URDF.replace(old, new))
    with pytest.raises(ValueError, match=word):
        parts(tmp_path / "mobility_cvx.urdf")


def test_objaverse(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("HAZARD_MS_OBJAVERSE", str(tmp_path))
    write_objaverse(tmp_path, {"license": "by-nc", "user": {"displayName": "Ada"}, "viewerUrl": "https://somewhere/1"})
    objaverse = provider("objaverse")
    assert objaverse.ids() == (UID,) == objaverse.ids("teddy_bear") and objaverse.ids("sofa") == ()
    model = objaverse.model(UID)
    assert (model.licence, model.author, model.category) == ("CC-BY-NC-4.0", "Ada", "teddy_bear")
    np.testing.assert_allclose(np.diff(bounds(model), axis=0)[0], (1.0, 2.0, 3.0), atol=1e-6)  # y was up


@pytest.mark.parametrize(
    ("row", "word"),
    [
        ({"user": {"displayName": "Ada"}}, "licence None"),
        ({"license": "", "user": {"displayName": "Ada"}}, "licence ''"),
        ({"license": "all rights reserved", "user": {"displayName": "Ada"}}, "all rights reserved"),
        ({"license": "by"}, "no author"),
    ],
)
def test_an_objaverse_object_without_licence_is_refused(
    row: dict[str, object], word: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("HAZARD_MS_OBJAVERSE", str(tmp_path))
    write_objaverse(tmp_path, row)
    with pytest.raises(ValueError, match=word):
        provider("objaverse").model(UID)


def test_a_packed_bomb_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from hazard_ms.providers import base

    monkeypatch.setattr(base, "LARGEST_JSON", 1_000_000)
    (tmp_path / "x.json.gz").write_bytes(gzip.compress(b" " * 2_000_000))
    with pytest.raises(ValueError, match="more than 1000000 bytes"):
        base.read_json(tmp_path / "x.json.gz")


def test_scenes_are_listed_when_they_are_there(data: Path) -> None:
    assert provider("replicacad").ids() == ("apt_3",)
    assert provider("architecthor").ids() == ("ArchitecTHOR-Val-02",)
    assert provider("robocasa").ids() == ("l_shaped_small/rustic", "galley/rustic")
    assert main(["assets", "add", "replicacad:apt_3", "--category", "box"]) == 2, "a whole scene is no model"


def test_numbers_of_robocasas_kitchens_are_maniskills() -> None:
    from mani_skill.utils.scene_builder.robocasa.utils.scene_registry import get_layout_path, get_style_path

    kitchens = PROVIDERS["robocasa"]()
    numbers = kitchens.numbers()
    assert sorted(numbers.values()) == list(range(120))
    for name, number in numbers.items():
        layout, style = kitchens.files(name)
        assert str(get_layout_path(number // 12)).endswith(layout) and str(get_style_path(number % 12)).endswith(style)


SCENE = """
import json, sys, sapien, torch
from types import SimpleNamespace
from mani_skill.envs.scene import ManiSkillScene
from mani_skill.envs.utils.system.backend import parse_sim_and_render_backend
from hazard_ms.providers import provider
from hazard_ms.rendering import DEVICES, backend
def scene(draw):
    systems = [sapien.physx.PhysxCpuSystem(), *([sapien.render.RenderSystem(sapien.Device(DEVICES[backend()]))] if draw else [])]
    info = parse_sim_and_render_backend("physx_cpu", backend() if draw else "none")
    return ManiSkillScene([sapien.Scene(systems)], device=torch.device("cpu"), backend=info)
"""
MODELS = """
made = scene(draw=False)
builder = provider("ycb").build(made, "025_mug")
builder.initial_pose = sapien.Pose([0, 0, 1])
mug = builder.build("mug")
cabinet = provider("partnet-mobility").build(made, "1000")
cabinet.initial_pose = sapien.Pose([0, 0, 2])
cabinet = cabinet.build("cabinet")
try:
    provider("replicacad").build(SimpleNamespace(scene=made), "apt_3")
except ValueError as error:
    print("OUT" + json.dumps({"mug": mug.pose.p.tolist(), "joints": [j.name for j in cabinet.active_joints], "error": str(error)}))
"""
SCENES = """
out = {}
for name, which in (("replicacad", "apt_3"), ("architecthor", "ArchitecTHOR-Val-02")):
    env = SimpleNamespace(scene=scene(draw=True), num_envs=1, robot_uids="fetch", _custom_human_render_camera_configs={})
    built = provider(name).build(env, which)
    out[name] = {"all": sorted(built.scene_objects), "movable": {k: v.initial_pose.p.tolist() for k, v in built.movable_objects.items()}}
print("OUT" + json.dumps(out))
"""


def with_maniskill(code: str, data: Path) -> dict[str, object]:
    """What `code` prints in a process of its own: ManiSkill reads its folder when it is imported."""
    env = {**os.environ, "MS_ASSET_DIR": str(data.parent)}
    words = [sys.executable, "-c", SCENE + code]
    done = subprocess.run(words, capture_output=True, text=True, env=env, timeout=200, cwd=Path(__file__).parents[1])
    assert done.returncode == 0, done.stderr[-3000:]
    return json.loads(done.stdout.partition("OUT")[2])


def test_maniskill_builds_models(data: Path) -> None:
    out = with_maniskill(MODELS, data)
    assert out["mug"] == [[0.0, 0.0, 1.0]] and out["joints"] == ["j1"]
    assert "only where it can draw" in str(out["error"])


@pytest.mark.render
def test_maniskill_builds_scenes(data: Path) -> None:
    """An environment's four attributes are all that these builders look at."""
    out = with_maniskill(SCENES, data)
    for name, moves, height in (("replicacad", "cup-0", 2.0), ("architecthor", "Apple_1_0", 2.005)):
        assert len(out[name]["all"]) == 2  # type: ignore[index]
        ((which, where),) = out[name]["movable"].items()  # type: ignore[index]
        assert which.endswith(moves)
        np.testing.assert_allclose(np.ravel(where), [1.0, -3.0, height], atol=1e-5)  # y up to z up


def test_a_folder_that_maniskill_does_not_read_is_refused(data: Path) -> None:
    """Here ManiSkill was imported before its folder was set."""
    import mani_skill

    assert mani_skill.ASSET_DIR != data
    with pytest.raises(ValueError, match="set MS_ASSET_DIR before"):
        provider("ycb").build(None, "025_mug")


def test_unknown_providers_are_refused() -> None:
    with pytest.raises(ValueError, match="'shapenet'.*ycb"):
        provider("shapenet")
