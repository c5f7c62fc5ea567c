"""glTF files as exporters really write them: textures twice, compression, whole numbers, several scenes, mirrors."""

from __future__ import annotations

import base64
import struct
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from hazard_ms.scenes.assets.intake.conversion import convert
from hazard_ms.scenes.assets.intake.reading import read_model
from hazard_ms.scenes.assets.intake.shaping import painted
from tests.worlds.files.model_files import glb, good
from tests.worlds.hostile import models, pictures

KTX2, DDS = b"\xabKTX 20\xbb\r\n\x1a\n" + bytes(68), b"DDS " + bytes(124)
DRACO, MESHOPT = "KHR_draco_mesh_compression", "EXT_meshopt_compression"
QUANTIZED, BASIS = "KHR_mesh_quantization", "KHR_texture_basisu"


def of(data: bytes) -> dict[str, Any]:
    return {"uri": "data:application/octet-stream;base64," + base64.b64encode(data).decode()}


def at(folder: Path, tree: dict[str, Any]) -> Path:
    (folder / "m.glb").write_bytes(glb(tree))
    return folder / "m.glb"


def read(folder: Path, **changes: Any) -> Any:
    """The scene of a tetrahedron's file with some entries replaced."""
    return read_model(at(folder, models.solid(**changes)))


def twin(extension: str, other: bytes, alone: bool = False) -> dict[str, Any]:
    """A tetrahedron whose texture is also, or alone, a picture of another format."""
    tree = models.solid(extensionsUsed=[extension])
    tree["images"].append(of(other))
    tree["textures"] = [{**({} if alone else {"source": 0}), "extensions": {extension: {"source": 1}}}]
    return tree


@pytest.mark.parametrize(
    ("extension", "other"), [("MSFT_texture_dds", DDS), (BASIS, KTX2), ("EXT_texture_webp", b"RIFF cut off")]
)
def test_a_png_with_a_twin_is_taken_as_readers_without_the_extension_do(
    extension: str, other: bytes, tmp_path: Path
) -> None:
    (mesh,) = read_model(at(tmp_path, twin(extension, other))).geometry.values()
    assert mesh.visual.material.baseColorTexture.size == (4, 4)


def test_a_webp_alone_is_taken_where_its_extension_is_required(tmp_path: Path) -> None:
    tree = twin("EXT_texture_webp", pictures.true_picture(6, "WEBP"), alone=True)
    (mesh,) = read_model(at(tmp_path, {**tree, "extensionsRequired": ["EXT_texture_webp"]})).geometry.values()
    assert mesh.visual.material.baseColorTexture.size == (6, 6)


@pytest.mark.parametrize("required", [True, False])
def test_a_picture_that_only_an_extension_has_is_refused_with_a_remedy(required: bool, tmp_path: Path) -> None:
    tree = twin(BASIS, KTX2, alone=True)
    with pytest.raises(ValueError, match=f"m.glb must be saved without.*{BASIS}.*gltf-transform ktxdecompress"):
        read_model(at(tmp_path, {**tree, **({"extensionsRequired": [BASIS]} if required else {})}))


def packed(extension: str) -> dict[str, Any]:
    """A tetrahedron that lies in `extension` alone, which is announced as used but not as required."""
    tree = models.solid(extensionsUsed=[extension])
    if extension == DRACO:
        for accessor in tree["accessors"]:
            del accessor["bufferView"]
        tree["meshes"][0]["primitives"][0]["extensions"] = {DRACO: {"bufferView": 0, "attributes": {"POSITION": 0}}}
    else:
        tree["buffers"].append({"byteLength": 72, "extensions": {MESHOPT: {"fallback": True}}})
        for view in tree["bufferViews"]:
            view |= {"extensions": {MESHOPT: {"buffer": 0, **view}}, "buffer": 1}
    return tree


@pytest.mark.parametrize("extension", [DRACO, MESHOPT])
def test_a_shape_that_only_an_extension_has_is_refused_by_name(extension: str, tmp_path: Path) -> None:
    with pytest.raises(
        ValueError, match=f"m.glb must store .* plain numbers, got them in {extension}: .*gltf-transform copy"
    ):
        read_model(at(tmp_path, packed(extension)))


def test_a_shape_beside_its_compressed_twin_is_read(tmp_path: Path) -> None:
    """As the extension has it: accessors without it are the fallback. DracoPy would stumble over these bytes."""
    tree = models.solid(extensionsUsed=[DRACO])
    tree["meshes"][0]["primitives"][0]["extensions"] = {DRACO: {"bufferView": 1, "attributes": {"POSITION": 0}}}
    assert read_model(at(tmp_path, tree)).extents.tolist() == [1, 1, 1]


@pytest.mark.parametrize("required", [True, False])
def test_a_quantized_shape_never_becomes_kilometres(required: bool, tmp_path: Path) -> None:
    corners = struct.pack("<12H", *(65535 * c for c in models.TETRAHEDRON))
    tree = models.solid(nodes=[{"mesh": 0, "scale": [0.07, 0.2, 0.07]}])
    tree["accessors"][0] |= {"bufferView": 2, "componentType": 5123, "normalized": True}
    tree["bufferViews"].append({"buffer": 1, "byteLength": 24})
    tree["buffers"].append({**of(corners), "byteLength": 24})
    with pytest.raises(ValueError, match=f"m.glb must.*{QUANTIZED}.*gltf-transform dequantize"):
        read_model(at(tmp_path, {**tree, **({"extensionsRequired": [QUANTIZED]} if required else {})}))


def test_texture_coordinates_in_whole_numbers_and_sparse_corners_are_refused(tmp_path: Path) -> None:
    """Core glTF allows both; the reader would turn the first into noise and leave out the second."""
    whole = models.solid()
    whole["accessors"].append({"bufferView": 0, "componentType": 5123, "normalized": True, "count": 4, "type": "VEC2"})
    whole["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_0"] = 2
    with pytest.raises(ValueError, match="TEXCOORD_0 of m.glb must hold 32-bit floating-point numbers"):
        read_model(at(tmp_path, whole))
    sparse = models.solid()
    sparse["accessors"][0]["sparse"] = {"count": 1}
    with pytest.raises(ValueError, match="got them in a sparse accessor"):
        read_model(at(tmp_path, sparse))


def test_only_the_scene_that_is_meant_is_read(tmp_path: Path) -> None:
    """Scene 1 holds a tetrahedron of 1 m, scene 0 one of 3 m, and node 2 lies in no scene."""
    nodes = [{"mesh": 0, "scale": [3, 3, 3]}, {"mesh": 0}, {"mesh": 0, "scale": [9, 9, 9]}]
    assert read(tmp_path, nodes=nodes, scenes=[{"nodes": [0]}, {"nodes": [1]}], scene=1).extents.tolist() == [1, 1, 1]
    tree = models.solid(nodes=nodes, scenes=[{"nodes": [1]}])
    del tree["scene"]
    assert read_model(at(tmp_path, tree)).extents.tolist() == [1, 1, 1]


def test_parts_with_one_name_are_all_read(tmp_path: Path) -> None:
    nodes = [{"mesh": 0, "name": "Cube"}, {"mesh": 0, "name": "Cube", "translation": [0, 1, 0]}]
    scene = read(tmp_path, nodes=nodes, scenes=[{"nodes": [0, 1]}])
    assert scene.extents.tolist() == [1, 2, 1] and len(scene.dump()) == 2


def test_a_mirrored_part_keeps_its_outside(tmp_path: Path) -> None:
    """A tetrahedron of three unit edges has a volume of 1/6; inside out, it would be negative."""
    for scale in ([1, 1, 1], [-1, 1, 1]):
        (part,) = painted(read(tmp_path, nodes=[{"mesh": 0, "scale": scale}])).geometry.values()
        assert part.volume == pytest.approx(1 / 6)
        across = np.cross(*(part.triangles[:, k] - part.triangles[:, 0] for k in (1, 2)))
        assert (np.einsum("ij,ikj->ik", across, part.vertex_normals[part.faces]) > 0.0).all()


def cup(radius: float = 0.04, height: float = 0.1, count: int = 24) -> dict[str, Any]:
    """An open cup without thickness, y up."""
    angle = 2 * np.pi * np.arange(count) / count
    ring = np.stack([radius * np.cos(angle), 0 * angle, radius * np.sin(angle)], 1)
    corners = np.vstack([ring, ring + [0, height, 0], [[0, 0, 0]]]).astype("<f4")
    k, next_one = np.arange(count), (np.arange(count) + 1) % count
    walls = [np.stack([k, next_one, count + next_one], 1), np.stack([k, count + next_one, count + k], 1)]
    faces = np.vstack([*walls, np.stack([0 * k + 2 * count, next_one, k], 1)]).astype("<u2")
    parts = [corners.tobytes(), faces.tobytes()]
    tree = models.solid(buffers=[{**of(b"".join(parts)), "byteLength": sum(map(len, parts))}])
    tree["bufferViews"] = [
        {"buffer": 0, "byteLength": len(parts[0])},
        {"buffer": 0, "byteOffset": len(parts[0]), "byteLength": len(parts[1])},
    ]
    for accessor, rows in zip(tree["accessors"], (len(corners), faces.size), strict=True):
        accessor["count"] = rows
    del tree["accessors"][0]["min"], tree["accessors"][0]["max"]
    return tree


def test_an_open_cup_without_thickness_becomes_a_thing(tmp_path: Path) -> None:
    """Its first corner is at -0.04 m, whose first byte is a line feed: SAPIEN's reader of binary files crashes."""
    facts = convert(good(at(tmp_path, cup())), tmp_path, None)
    assert facts["extent"] == pytest.approx([0.08, 0.08, 0.1], abs=2e-5) and facts["volume"] > 0.0
