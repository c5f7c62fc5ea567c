"""Small model files, right and wrong, written by hand for tests."""

from __future__ import annotations

import base64
import dataclasses
import json
import struct
from pathlib import Path
from typing import Any

from hazard_ms.scenes.assets.intake.model import Model, model_of_file

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
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0]}
        ],
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


def good(path: Path) -> Model:
    return dataclasses.replace(model_of_file(path), category="bowl", licence="own work")
