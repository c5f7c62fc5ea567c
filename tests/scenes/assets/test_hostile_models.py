"""Files and indices that mean harm, or are broken: each is refused with a word about why, and nothing is written."""

from __future__ import annotations

import json
import struct
from pathlib import Path

import numpy as np
import pytest
import trimesh

from hazard_ms.scenes.assets.intake import reading
from hazard_ms.scenes.assets.intake.shaping import frame, shaped
from hazard_ms.scenes.assets.intake.supports import largest
from tests.worlds.files.model_files import TRIANGLE, glb, gltf, stl, texture, uri

INF, NAN = float("inf"), float("nan")
CASES: dict[str, tuple[str, dict[str, bytes], str]] = {  # the file to read, all files, what the refusal says
    "upwards": ("m.gltf", {"m.gltf": uri("../secret.bin")}, "must lie beside it"),
    "upwards, encoded": ("m.gltf", {"m.gltf": uri("%2e%2e/secret.bin")}, "must lie beside it"),
    "upwards, backslash": ("m.gltf", {"m.gltf": uri("..\\secret.bin")}, "must lie beside it"),
    "absolute": ("m.gltf", {"m.gltf": uri("/etc/passwd")}, "must lie beside it"),
    "file address": ("m.gltf", {"m.gltf": uri("file:///etc/passwd")}, "must lie beside it"),
    "web address": ("m.gltf", {"m.gltf": uri("http://127.0.0.1:9/x.bin")}, "must lie beside it"),
    "absent buffer": ("m.gltf", {"m.gltf": uri("none.bin")}, "no file none.bin"),
    "must be base64": ("m.gltf", {"m.gltf": uri("data:application/octet-stream;base64,@@@")}, "must be base64"),
    "texture upwards": ("m.obj", texture("../secret.png"), "must lie beside it"),
    "texture absolute": ("m.obj", texture("/etc/passwd"), "must lie beside it"),
    "texture from a drive": ("m.obj", texture("C:\\x.png"), "must lie beside it"),
    "absent texture": ("m.obj", texture("none.png"), "no file none.png"),
    "billions of corners": (
        "m.glb",
        {"m.glb": glb(gltf(accessors=[{"componentType": 5126, "count": 4 * 10**9, "type": "VEC3"}]))},
        "simplify",
    ),
    "negative count": (
        "m.glb",
        {"m.glb": glb(gltf(accessors=[{"componentType": 5126, "count": -3, "type": "VEC3"}]))},
        "at most",
    ),
    "many nodes": ("m.glb", {"m.glb": glb(gltf(nodes=[{"mesh": 0}] * 20_000))}, "got 20000"),
    "compression": ("m.glb", {"m.glb": glb(gltf(extensionsRequired=["KHR_draco_mesh_compression"]))}, "KHR_draco"),
    "deep JSON": ("m.gltf", {"m.gltf": b"[" * 100_000}, "must be a valid glTF"),
    "not valid JSON": ("m.glb", {"m.glb": glb(b"{]]]")}, "must be a valid glTF"),
    "list": ("m.gltf", {"m.gltf": b"[1, 2]"}, "must be a valid glTF"),
    "version 1": ("m.glb", {"m.glb": glb(gltf(), version=1)}, "version 2"),
    "cut off": ("m.glb", {"m.glb": glb(gltf())[:60]}, "complete JSON chunk"),
    "empty": ("m.glb", {"m.glb": b""}, "must be a GLB"),
    "no mesh": ("m.glb", {"m.glb": glb(gltf(meshes=[], nodes=[{}]))}, "m.glb"),
    "must be finite": ("m.stl", {"m.stl": stl(0, 0, 0, 1, 0, 0, 0, NAN, 0)}, "must be finite"),
    "placed nowhere": (
        "m.glb",
        {"m.glb": glb(gltf(nodes=[{"mesh": 0, "translation": [1e39, 0, 0]}])).replace(b"1e+39", b"1e999")},
        "m.glb",
    ),
    "infinite": ("m.stl", {"m.stl": stl(0, 0, 0, 1, 0, 0, 0, INF, 0)}, "must be finite"),
    "corners that are not there": ("m.obj", {"m.obj": b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n"}, "m.obj"),
    "lying STL": ("m.stl", {"m.stl": bytes(80) + struct.pack("<I", 2**31) + bytes(50)}, "got neither"),
    "PLY of billions": (
        "m.ply",
        {"m.ply": b"ply\nformat binary_little_endian 1.0\nelement vertex 3\nelement face 4000000000\nend_header\n"},
        "4000000000",
    ),
    "PLY of corners": (
        "m.ply",
        {"m.ply": b"ply\nformat binary_little_endian 1.0\nelement vertex 9000000000\nelement face 1\nend_header\n"},
        "9000000000",
    ),
    "many faces": ("m.obj", {"m.obj": b"v 0 0 0\nv 1 0 0\nv 0 1 0\n" + b"f 1 2 3\n" * 200_001}, "got 200001"),
    "archive": ("m.zip", {"m.zip": b"PK\x03\x04"}, "got m.zip"),
    "no file": ("m.glb", {}, "no file m.glb"),
}


@pytest.mark.parametrize("case", CASES)
@pytest.mark.filterwarnings("ignore:invalid value encountered")
def test_a_hostile_file_is_refused(case: str, tmp_path: Path) -> None:
    name, files, word = CASES[case]
    folder = tmp_path / "folder"
    folder.mkdir()
    (tmp_path / "secret.bin").write_bytes(TRIANGLE)
    (tmp_path / "secret.png").write_bytes(b"\x89PNG")
    for file, data in files.items():
        (folder / file).write_bytes(data)
    with pytest.raises(ValueError, match="m\\.") as refusal:
        reading.read_model(folder / name)
    assert word in str(refusal.value)


def test_the_same_file_without_the_harm_is_read(tmp_path: Path) -> None:
    """What the cases change is what is refused."""
    (tmp_path / "m.gltf").write_text(json.dumps(gltf()))
    (tmp_path / "m.glb").write_bytes(glb(gltf()))
    (tmp_path / "beside.gltf").write_bytes(uri("in/side%20.bin"))
    (tmp_path / "in").mkdir()
    (tmp_path / "in/side .bin").write_bytes(TRIANGLE)
    (tmp_path / "m.stl").write_bytes(stl(0, 0, 0, 1, 0, 0, 0, 1, 0))
    for name in ("m.gltf", "m.glb", "beside.gltf", "m.stl"):
        assert reading.read_model(tmp_path / name).bounds[1].tolist() == [1, 1, 0], name


def test_links_that_lead_out_are_refused(tmp_path: Path) -> None:
    (tmp_path / "secret.bin").write_bytes(TRIANGLE)
    (tmp_path / "folder").mkdir()
    (tmp_path / "folder/link.bin").symlink_to(tmp_path / "secret.bin")
    (tmp_path / "folder/m.gltf").write_bytes(uri("link.bin"))
    with pytest.raises(ValueError, match="leads out of"):
        reading.read_model(tmp_path / "folder/m.gltf")


@pytest.mark.parametrize("name", ["m.gltf", "m.glb", "m.obj"])
def test_a_file_of_100_megabytes_is_refused_unread(name: str, tmp_path: Path) -> None:
    with (tmp_path / name).open("wb") as file:
        file.truncate(100_000_000)
    with pytest.raises(ValueError, match="at most 64000000 bytes, got 100000000"):
        reading.read_model(tmp_path / name)


def test_the_words_of_a_glb_are_limited_too(tmp_path: Path) -> None:
    (tmp_path / "m.glb").write_bytes(glb(b'{"extras": "' + b"x" * 9_000_000 + b'"}'))
    with pytest.raises(ValueError, match="the JSON of m.glb must have"):
        reading.read_model(tmp_path / "m.glb")


def test_the_frame_turns_up_to_z_and_front_to_minus_y() -> None:
    for up in ("x", "-x", "y", "-y", "z", "-z"):
        for front in ("x", "-x", "y", "-y", "z", "-z"):
            if up[-1] == front[-1]:
                with pytest.raises(ValueError, match="one axis"):
                    frame(up, front)
                continue
            turn = frame(up, front)[:3, :3]
            axis = {word: np.eye(3)["xyz".index(word[-1])] * (-1 if word[0] == "-" else 1) for word in (up, front)}
            np.testing.assert_allclose(turn @ axis[up], [0, 0, 1])
            np.testing.assert_allclose(turn @ axis[front], [0, -1, 0])
            assert np.linalg.det(turn) == pytest.approx(1.0)


@pytest.mark.parametrize("edges", [(0.0, 0.0, 0.0), (1.0, 1.0, 0.0), (1e-5, 1e-5, 1e-5), (0.1, 0.1, 40.0)])
def test_sizes_that_nothing_has_are_refused(edges: tuple[float, float, float]) -> None:
    corners = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]) * edges
    with pytest.raises(ValueError, match="of the model must be"):
        shaped(trimesh.Scene(trimesh.Trimesh(corners, [[0, 1, 2], [0, 1, 3]], process=False)), None)


def test_the_largest_rectangle_is_the_largest() -> None:
    """Against all rectangles, one by one."""
    draw = np.random.default_rng(3)
    for _ in range(60):
        mask = draw.random(draw.integers(1, 8, 2)) < 0.7
        areas = [
            (b - a) * (d - c)
            for a in range(mask.shape[0])
            for b in range(a + 1, mask.shape[0] + 1)
            for c in range(mask.shape[1])
            for d in range(c + 1, mask.shape[1] + 1)
            if mask[a:b, c:d].all()
        ]
        x0, x1, y0, y1 = largest(mask)
        assert (x1 - x0) * (y1 - y0) == max(areas, default=0) and mask[x0:x1, y0:y1].all()
