"""Little copies of collections of models and scenes, in the formats of their downloads, for tests."""

from __future__ import annotations

import gzip
import json
from pathlib import Path

import trimesh

CABINET = "1000"  # an id of ManiSkill's metadata; its scale there
CABINET_SCALE = 0.6129399556808358
UID = "0123456789abcdef0123456789abcdef"
MUG = (0.1, 0.08, 0.09)  # [m]
BOX = '<geometry><mesh filename="textured_objs/box.obj"/></geometry>'
URDF = f"""<?xml version="1.0"?>
<robot name="partnet">
  <link name="base"/>
  <link name="link_0">
    <visual><origin xyz="0 0 0.5"/>{BOX}</visual><collision><origin xyz="0 0 0.5"/>{BOX}</collision>
  </link>
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
    rows = {
        i: {"bbox": box, "scales": [1.0], "density": 1000}
        for i in ("025_mug", "077_rubiks_cube", "013_apple", "../../etc")
    }
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
        write_json(
            folder / f"ai2thorhab-uncompressed/configs/objects/{name}.object_config.json", {"semantic_id": number}
        )
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
