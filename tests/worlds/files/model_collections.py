"""Little copies of collections of models, in the formats of their downloads, for tests."""

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


def write_objaverse(folder: Path, row: dict[str, object]) -> None:
    write_box(folder / f"glbs/000-023/{UID}.glb", (1.0, 3.0, 2.0))
    write_json(folder / "metadata/000-023.json.gz", {UID: {"uid": UID, **row}})
    write_json(folder / "lvis-annotations.json.gz", {"Sofa": ["f" * 32], "teddy_bear": [UID]})
