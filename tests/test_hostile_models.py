"""Files and indices that mean harm, or are broken: each is refused with a word about why, and nothing is written."""

from __future__ import annotations

import base64
import dataclasses
import json
import struct
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh

from hazard_ms import assets
from hazard_ms.intake import adding, reading
from hazard_ms.intake.model import Model, model_of_file
from hazard_ms.intake.shaping import frame, shaped
from hazard_ms.intake.supports import largest

TRIANGLE = struct.pack("<9f", 0, 0, 0, 1, 0, 0, 0, 1, 0)
INSIDE = "data:application/octet-stream;base64," + base64.b64encode(TRIANGLE).decode()


def gltf(**changes: Any) -> dict[str, Any]:
    """A glTF of one triangle, with some entries replaced."""
    tree = {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0]}],
        "bufferViews": [{"buffer": 0, "byteLength": 36}],
        "buffers": [{"uri": INSIDE, "byteLength": 36}],
    }
    return {**tree, **changes}


def glb(tree: dict[str, Any] | bytes, version: int = 2) -> bytes:
    text = tree if isinstance(tree, bytes) else json.dumps(tree).encode()
    text += b" " * (-len(text) % 4)
    return struct.pack("<4sIIII", b"glTF", version, 20 + len(text), len(text), 0x4E4F534A) + text


def stl(*corners: float) -> bytes:
    return bytes(80) + struct.pack("<I", 1) + struct.pack("<12fH", 0, 0, 1, *corners, 0)


def uri(name: str) -> bytes:
    return json.dumps(gltf(buffers=[{"uri": name, "byteLength": 36}])).encode()


def texture(name: str) -> dict[str, bytes]:
    return {
        "m.obj": b"mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nusemtl a\nf 1/1 2/1 3/1\n",
        "m.mtl": f"newmtl a\nmap_Kd {name}\n".encode(),
    }


INF, NAN = float("inf"), float("nan")
CASES: dict[str, tuple[str, dict[str, bytes], str]] = {  # the file to read, all files, what the refusal says
    "upwards": ("m.gltf", {"m.gltf": uri("../secret.bin")}, "only files beside it"),
    "upwards, encoded": ("m.gltf", {"m.gltf": uri("%2e%2e/secret.bin")}, "only files beside it"),
    "upwards, backslash": ("m.gltf", {"m.gltf": uri("..\\secret.bin")}, "only files beside it"),
    "absolute": ("m.gltf", {"m.gltf": uri("/etc/passwd")}, "only files beside it"),
    "file address": ("m.gltf", {"m.gltf": uri("file:///etc/passwd")}, "only files beside it"),
    "web address": ("m.gltf", {"m.gltf": uri("http://127.0.0.1:9/x.bin")}, "only files beside it"),
    "absent buffer": ("m.gltf", {"m.gltf": uri("none.bin")}, "no file none.bin"),
    "no base64": ("m.gltf", {"m.gltf": uri("data:application/octet-stream;base64,@@@")}, "no base64"),
    "texture upwards": ("m.obj", texture("../secret.png"), "only files beside it"),
    "texture absolute": ("m.obj", texture("/etc/passwd"), "only files beside it"),
    "texture from a drive": ("m.obj", texture("C:\\x.png"), "only files beside it"),
    "absent texture": ("m.obj", texture("none.png"), "no file none.png"),
    "billions of corners": (
        "m.glb",
        {"m.glb": glb(gltf(accessors=[{"componentType": 5126, "count": 4 * 10**9, "type": "VEC3"}]))},
        "simplify",
    ),
    "negative count": ("m.glb", {"m.glb": glb(gltf(accessors=[{"componentType": 5126, "count": -3, "type": "VEC3"}]))}, "at most"),
    "many nodes": ("m.glb", {"m.glb": glb(gltf(nodes=[{"mesh": 0}] * 20_000))}, "20000 nodes"),
    "compression": ("m.glb", {"m.glb": glb(gltf(extensionsRequired=["KHR_draco_mesh_compression"]))}, "KHR_draco"),
    "deep JSON": ("m.gltf", {"m.gltf": b"[" * 100_000}, "is no glTF"),
    "no JSON": ("m.glb", {"m.glb": glb(b"{]]]")}, "is no glTF"),
    "list": ("m.gltf", {"m.gltf": b"[1, 2]"}, "is no glTF"),
    "version 1": ("m.glb", {"m.glb": glb(gltf(), version=1)}, "version 2"),
    "cut off": ("m.glb", {"m.glb": glb(gltf())[:60]}, "whole JSON chunk"),
    "empty": ("m.glb", {"m.glb": b""}, "no GLB"),
    "no mesh": ("m.glb", {"m.glb": glb(gltf(meshes=[], nodes=[{}]))}, "m.glb"),
    "not finite": ("m.stl", {"m.stl": stl(0, 0, 0, 1, 0, 0, 0, NAN, 0)}, "not finite"),
    "placed nowhere": (
        "m.glb",
        {"m.glb": glb(gltf(nodes=[{"mesh": 0, "translation": [1e39, 0, 0]}])).replace(b"1e+39", b"1e999")},
        "m.glb",
    ),
    "infinite": ("m.stl", {"m.stl": stl(0, 0, 0, 1, 0, 0, 0, INF, 0)}, "not finite"),
    "corners that are not there": ("m.obj", {"m.obj": b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n"}, "m.obj"),
    "lying STL": ("m.stl", {"m.stl": bytes(80) + struct.pack("<I", 2**31) + bytes(50)}, "neither"),
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
    "many faces": ("m.obj", {"m.obj": b"v 0 0 0\nv 1 0 0\nv 0 1 0\n" + b"f 1 2 3\n" * 200_001}, "200001 triangles"),
    "archive": ("m.zip", {"m.zip": b"PK\x03\x04"}, "ends with '.zip'"),
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
    with pytest.raises(ValueError, match="100000000 bytes; at most 64000000"):
        reading.read_model(tmp_path / name)


def test_the_words_of_a_glb_are_limited_too(tmp_path: Path) -> None:
    (tmp_path / "m.glb").write_bytes(glb(b'{"extras": "' + b"x" * 9_000_000 + b'"}'))
    with pytest.raises(ValueError, match="its JSON has"):
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
    with pytest.raises(ValueError, match="size"):
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


@pytest.fixture
def mine(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The user's folder, empty but for two files, of a model that does not convert itself."""
    folder = tmp_path / "mine"
    (folder / "models/thing").mkdir(parents=True)
    (folder / "models/thing/model.glb").write_bytes(glb(gltf()))
    (folder / "models/thing/hulls.ply").write_bytes(b"ply")
    (tmp_path / "outside.glb").write_bytes(glb(gltf()))
    monkeypatch.setenv("HAZARD_MS_ASSETS", str(folder))
    return folder


ROW = {
    "id": "thing",
    "kind": "object",
    "category": "bowl",
    "visual": "models/thing/model.glb",
    "hulls": "models/thing/hulls.ply",
    "licence": "CC-BY-SA-4.0",
    "author": "a",
    "source": "s",
    "changes": "",
    "extent": [0.1, 0.1, 0.1],
    "mass": 0.2,
}
ROWS: dict[str, tuple[Any, str]] = {
    "upwards": ({"visual": "../outside.glb"}, "outside.glb"),
    "absolute": ({"visual": "/etc/passwd"}, "/etc/passwd"),
    "backslash": ({"hulls": "..\\outside.glb"}, "outside.glb"),
    "absent file": ({"visual": "models/thing/none.glb"}, "no file"),
    "category": ({"category": "unicorn"}, "unicorn"),
    "kind": ({"kind": "fixture"}, "fixture"),
    "texture": ({"kind": "texture"}, "texture"),
    "key": ({"colour": "red"}, "colour"),
    "licence empty": ({"licence": ""}, "licence"),
    "licence with lines": ({"licence": "MIT\n\x1b[31m"}, "licence"),
    "licence a number": ({"licence": 3}, "licence"),
    "id upwards": ({"id": "../thing"}, "../thing"),
    "id with a space": ({"id": "a thing"}, "a thing"),
    "id in letters of elsewhere": ({"id": "thıng"}, "thıng"),
    "id of a shipped model": ({"id": "bottle_1"}, "bottle_1"),
    "mass": ({"mass": "heavy"}, "heavy"),
    "mass not finite": ({"mass": NAN}, "mass"),
    "extent": ({"extent": [0.1, 0.1]}, "3 numbers"),
    "boxes": ({"boxes": [[0, 0, 0, INF, 1, 1]]}, "not finite"),
    "boxes short": ({"boxes": [[0, 0]]}, "6 numbers"),
    "supports": ({"supports": [{"z": 0.1}]}, "min"),
    "supports no list": ({"supports": 7}, "cannot be read"),
}


def test_a_good_row_is_read(mine: Path) -> None:
    (mine / "index.json").write_text(json.dumps([ROW]))
    assert assets.asset("thing").visual == str(mine / "models/thing/model.glb")


@pytest.mark.parametrize("case", ROWS)
def test_a_hostile_row_is_refused_by_name(case: str, mine: Path) -> None:
    change, word = ROWS[case]
    (mine / "index.json").write_text(json.dumps([{**ROW, **change}]))
    with pytest.raises(ValueError, match="asset '") as refusal:
        assets.user_index()
    assert word in str(refusal.value)


@pytest.mark.parametrize("missing", ["licence", "id", "visual", "kind"])
def test_a_row_that_lacks_an_entry_is_refused(missing: str, mine: Path) -> None:
    (mine / "index.json").write_text(json.dumps([{k: v for k, v in ROW.items() if k != missing}]))
    with pytest.raises(ValueError, match=missing):
        assets.user_index()


@pytest.mark.parametrize(
    ("text", "word"),
    [
        ("[" * 100_000, "no JSON"),
        ("{", "no JSON"),
        ("{}", "a list of rows"),
        ("[7]", "7"),
        (json.dumps([ROW, ROW]), "twice"),
    ],
)
def test_an_index_that_is_none_is_refused(text: str, word: str, mine: Path) -> None:
    (mine / "index.json").write_text(text)
    with pytest.raises(ValueError, match=word):
        assets.user_index()


def test_an_index_of_100_megabytes_is_refused_unread(mine: Path) -> None:
    with (mine / "index.json").open("wb") as file:
        file.truncate(100_000_000)
    with pytest.raises(ValueError, match="100000000 bytes"):
        assets.user_index()


def test_links_out_of_the_folder_are_not_followed(mine: Path, tmp_path: Path) -> None:
    """Neither for reading, nor for writing, nor for deleting."""
    (mine / "models/thing/model.glb").unlink()
    (mine / "models/thing/model.glb").symlink_to(tmp_path / "outside.glb")
    (mine / "index.json").write_text(json.dumps([ROW]))
    with pytest.raises(ValueError, match="leads out of"):
        assets.user_index()
    outside = tmp_path / "elsewhere"
    outside.mkdir()
    (outside / "model.glb").write_bytes(b"precious")
    (mine / "models/linked").symlink_to(outside)
    (mine / "index.json").write_text(json.dumps([{**ROW, "id": "linked"}]))
    with pytest.raises(ValueError, match="leads out of"):
        adding.remove("linked")
    assert (outside / "model.glb").read_bytes() == b"precious"
    (mine / "index.json").unlink()
    (mine / "index.json").symlink_to(tmp_path / "index_elsewhere.json")
    with pytest.raises(ValueError, match="leads out of"):
        adding.remove("thing")
    assert not (tmp_path / "index_elsewhere.json").exists()


def test_a_hostile_row_can_be_removed_and_deletes_nothing_else(mine: Path, tmp_path: Path) -> None:
    (mine / "index.json").write_text(json.dumps([ROW, {**ROW, "id": "../../outside.glb", "visual": "/etc/passwd"}]))
    adding.remove("../../outside.glb")
    assert list(assets.user_index()) == ["thing"]
    assert (tmp_path / "outside.glb").exists()


def good(path: Path) -> Model:
    return dataclasses.replace(model_of_file(path), category="bowl", licence="own work")


ORDERS: dict[str, tuple[Callable[[Model], Model], dict[str, Any], str]] = {
    "category": (lambda m: dataclasses.replace(m, category="unicorn"), {}, "unicorn"),
    "no category": (lambda m: dataclasses.replace(m, category=""), {}, "category"),
    "licence": (lambda m: dataclasses.replace(m, licence=""), {}, "licence"),
    "id upwards": (lambda m: m, {"name": "../x"}, "../x"),
    "id hidden": (lambda m: m, {"name": ".x"}, "id"),
    "id empty": (lambda m: m, {"name": ""}, "id"),
    "id long": (lambda m: m, {"name": "x" * 41}, "id"),
    "id shipped": (lambda m: m, {"name": "bottle_1"}, "shipped"),
    "id to be shipped": (lambda m: m, {"name": "bottle_77"}, "shipped"),
    "mass": (lambda m: m, {"mass": NAN}, "mass"),
    "negative": (lambda m: m, {"mass": -1.0}, "mass"),
    "size": (lambda m: m, {"size": INF}, "size"),
    "up": (lambda m: dataclasses.replace(m, up="north"), {}, "north"),
    "hostile file": (lambda m: m, {}, "only files beside it"),
}


@pytest.mark.parametrize("case", ORDERS)
def test_what_cannot_be_added_leaves_the_folder_as_it_was(case: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    change, options, word = ORDERS[case]
    folder = tmp_path / "mine"
    monkeypatch.setenv("HAZARD_MS_ASSETS", str(folder))
    (tmp_path / "m.gltf").write_bytes(uri("/etc/passwd"))
    with pytest.raises(ValueError, match=".") as refusal:
        adding.add(change(good(tmp_path / "m.gltf")), **{"name": "x", **options})
    assert word in str(refusal.value)
    assert not folder.exists() or [p.name for p in folder.iterdir()] == [".lock"]


def test_what_is_in_the_way_is_not_deleted(mine: Path, tmp_path: Path) -> None:
    (tmp_path / "m.gltf").write_bytes(uri("/etc/passwd"))
    (mine / "models/mine").mkdir()
    (mine / "models/mine/thesis.txt").write_text("years of work")
    with pytest.raises(ValueError, match="is in the way"):
        adding.add(good(tmp_path / "m.gltf"), "mine")
    assert (mine / "models/mine/thesis.txt").read_text() == "years of work"


def test_a_model_without_a_row_gives_way(mine: Path) -> None:
    """An add that was killed before its last step leaves files that no index names."""
    assert adding._free_place(mine, "thing") == mine / "models/thing"
    assert not (mine / "models/thing").exists()
