"""Model files that mean harm or are broken, as many as are wanted, each decided by its number alone."""

from __future__ import annotations

import base64
import json
import random
import struct
from collections.abc import Callable
from typing import Any

from tests.worlds.files.model_files import TRIANGLE, glb, gltf, stl, texture, uri
from tests.worlds.hostile import pictures
from tests.worlds.hostile.junk import NUMBERS, WORDS, damaged, spoilt, text

Files = dict[str, bytes]  # the model first, then what lies beside it
TETRAHEDRON = (0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1)
FACES = (0, 2, 1, 0, 1, 3, 1, 2, 3, 0, 3, 2)
OBJ = b"mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nusemtl a\n" + (
    b"f 1/1 3/3 2/2\nf 1/1 2/2 4/4\nf 2/2 3/3 4/4\nf 1/1 4/4 3/3\n"
)
PLY_HEAD = (
    "ply\nformat {kind} 1.0\nelement vertex {corners}\nproperty float x\nproperty float y\nproperty float z\n"
    "element face {faces}\nproperty list uchar int vertex_indices\nend_header\n"
)


def solid(**changes: Any) -> dict[str, Any]:
    """A glTF of a tetrahedron with a material and a texture, with some entries replaced."""
    corners, faces = struct.pack("<12f", *TETRAHEDRON), struct.pack("<12H", *FACES)
    picture = base64.b64encode(pictures.true_picture(4)).decode()
    inside = base64.b64encode(corners + faces).decode()
    tree = gltf(
        meshes=[{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1, "material": 0}]}],
        accessors=[
            {"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3", "min": [0] * 3, "max": [1] * 3},
            {"bufferView": 1, "componentType": 5123, "count": 12, "type": "SCALAR"},
        ],
        bufferViews=[
            {"buffer": 0, "byteLength": 48},
            {"buffer": 0, "byteOffset": 48, "byteLength": 24},
        ],
        buffers=[{"uri": f"data:application/octet-stream;base64,{inside}", "byteLength": 72}],
        materials=[{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}],
        textures=[{"source": 0}],
        images=[{"uri": f"data:image/png;base64,{picture}"}],
    )
    return {**tree, **changes}


def good(draw: random.Random) -> Files:
    """A model that is as it should be, in any of the formats."""
    kind = draw.choice(("glb", "gltf", "obj", "stl", "ply"))
    if kind == "obj":
        return {"m.obj": OBJ, "m.mtl": b"newmtl a\nmap_Kd t.png\n", "t.png": pictures.true_picture(8)}
    if kind == "stl":
        return {"m.stl": stl(*TETRAHEDRON[:9])}
    if kind == "ply":
        return {"m.ply": ply("binary_little_endian", 4, 4, *_ply_body())}
    return {f"m.{kind}": glb(solid()) if kind == "glb" else text(solid())}


def ply(kind: str, corners: int, faces: int, *body: bytes) -> bytes:
    return PLY_HEAD.format(kind=kind, corners=corners, faces=faces).encode() + b"".join(body)


def _ply_body() -> list[bytes]:
    return [struct.pack("<12f", *TETRAHEDRON), *(struct.pack("<B3i", 3, *FACES[i : i + 3]) for i in range(0, 12, 3))]


def broken_bytes(draw: random.Random) -> Files:
    files = good(draw)
    victim = draw.choice(list(files))
    return {name: damaged(data, draw) if name == victim else data for name, data in files.items()}


def broken_words(draw: random.Random) -> Files:
    tree = text(spoilt(solid(), draw, draw.choice((1, 2, 8))))
    return {"m.gltf": tree} if draw.random() < 0.5 else {"m.glb": glb(tree)}


def counts(draw: random.Random) -> Files:
    tree = solid()
    for _ in range(draw.choice((1, 3))):
        entry = draw.choice(tree["accessors"] + tree["bufferViews"])
        entry[draw.choice(("count", "byteOffset", "byteLength", "byteStride", "componentType"))] = draw.choice(NUMBERS)
    return {"m.glb": glb(tree)}


def corners(draw: random.Random) -> Files:
    far = [draw.choice((float("nan"), float("inf"), 3e38, -3e38, 1e-42, 1e20, 0.0, 1.0)) for _ in range(9)]
    if draw.random() < 0.5:
        return {"m.stl": stl(*far)}
    inside = base64.b64encode(struct.pack("<9f", *far)).decode()
    return {"m.gltf": uri(f"data:application/octet-stream;base64,{inside}")}


def nodes(draw: random.Random) -> Files:
    """Many nodes, circles, long chains, and trees of which each level doubles."""
    many = draw.choice((30, 900, 3000, 9000))
    way = draw.randrange(4)
    chain = [{"mesh": 0, "children": [i + 1]} for i in range(many - 1)]
    made: list[dict[str, Any]] = {
        0: [{"mesh": 0, "scale": [draw.choice((0, -1, 1e30, 1))] * 3} for _ in range(many)],
        1: [*chain, {"mesh": 0}],
        2: [*chain, {"mesh": 0, "children": [draw.randrange(many)]}],
        3: [{"children": [i + 1, i + 1]} for i in range(many - 1)] + [{"mesh": 0}],
    }[way]
    return {"m.glb": glb(solid(nodes=made, scenes=[{"nodes": list(range(many)) if way == 0 else [0]}]))}


def instances(draw: random.Random) -> Files:
    """One mesh of many corners, placed many times."""
    count = draw.choice((10_000, 190_000))
    inside = base64.b64encode(TRIANGLE * (count // 3)).decode()
    entry = {"bufferView": 0, "componentType": 5126, "count": count // 3 * 3, "type": "VEC3"}
    view = {"buffer": 0, "byteLength": len(TRIANGLE) * (count // 3)}
    buffer = {"uri": f"data:application/octet-stream;base64,{inside}", "byteLength": view["byteLength"]}
    placed = [{"mesh": 0, "translation": [i, 0, 0]} for i in range(draw.choice((2, 5000)))]
    tree = gltf(accessors=[entry], bufferViews=[view], buffers=[buffer], nodes=placed)
    return {"m.glb": glb({**tree, "scenes": [{"nodes": list(range(len(placed)))}]})}


def names(draw: random.Random) -> Files:
    word = draw.choice((*WORDS, "t.png", "m.mtl", "m.obj", "m.gltf", "..", ".", "x" * 5000, "%2e%2e/x", "http://[::1]"))
    printed = word.encode("utf-8", "surrogatepass")
    way = draw.randrange(4)
    if way == 0:
        return {"m.obj": OBJ.replace(b"m.mtl", printed)}
    if way == 1:
        return {"m.obj": OBJ, "m.mtl": b"newmtl a\nmap_Kd " + printed + b"\n"}
    if way == 2:
        return {"m.gltf": text(solid(images=[{"uri": word}]))}
    return {"m.gltf": uri(word)}


def painted(draw: random.Random) -> Files:
    picture = pictures.hostile(draw)
    way = draw.randrange(4)
    if way == 0:
        return {**texture("t.png"), "m.obj": OBJ, "t.png": picture}
    if way == 1:
        coded = base64.b64encode(picture).decode()
        return {"m.gltf": text({**solid(), "images": [{"uri": f"data:image/png;base64,{coded}"}]})}
    if way == 2:
        head = PLY_HEAD.replace("element vertex", "comment TextureFile t.png\nelement vertex")
        body = b"".join(_ply_body())
        return {"m.ply": head.format(kind="binary_little_endian", corners=4, faces=4).encode() + body, "t.png": picture}
    return {"m.glb": embedded(picture)}


def embedded(picture: bytes) -> bytes:
    """A GLB whose texture, said to be a PNG, is `picture` in its binary chunk."""
    tree = solid()
    views = [*tree["bufferViews"], {"buffer": 1, "byteLength": len(picture)}]
    tree |= {"buffers": [{"byteLength": len(picture)}, *tree["buffers"]], "bufferViews": views}
    for view in views:
        view["buffer"] = 1 - view["buffer"]
    tree["images"] = [{"bufferView": 2, "mimeType": "image/png"}]
    words = glb(tree)
    padded = picture + bytes(-len(picture) % 4)
    whole = words + struct.pack("<II", len(padded), 0x004E4942) + padded
    return whole[:8] + struct.pack("<I", len(whole)) + whole[12:]


def many_materials(draw: random.Random) -> Files:
    many, strays = draw.choice((60, 500, 3000)), draw.choice((0.0, 0.0, 0.1))
    parts, library = [b"mtllib m.mtl\n"], []
    for i in range(many):
        file = f"t{i}.png" if draw.random() < strays else "t.png"
        library.append(f"newmtl a{i}\nmap_Kd {file}\n".encode())
        parts.append(f"v {i} 0 0\nv {i} 1 0\nv {i} 0 1\nvt 0 0\nusemtl a{i}\nf -3/-1 -2/-1 -1/-1\n".encode())
    return {"m.obj": b"".join(parts), "m.mtl": b"".join(library), "t.png": pictures.true_picture(4000)}


def lines(draw: random.Random) -> Files:
    """OBJ, PLY and STL files whose lines make no sense."""
    index = draw.choice((*NUMBERS, "nan", "1//", "1/2/3/4", "x", "1e9"))
    return draw.choice(
        (
            {"m.obj": b"v 0 0 0\nv 1 0 0\nv 0 1 0\n" + f"f 1 2 {index}\n".encode()},
            {"m.obj": b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf" + b" 1 2 3" * 100_000},
            {"m.obj": b"v 0 0 0\n" * 500_000 + b"f 1 2 3\n"},
            {"m.obj": b"\\\n" * 300_000 + OBJ},
            {"m.ply": ply("ascii", 3, 1, f"0 0 0\n1 0 0\n0 1 0\n{index} 0 1 2\n".encode())},
            {"m.ply": ply("binary_little_endian", 4, 4, b"\xff" * 5000)},
            {"m.ply": ply("ascii", 4, 4).replace(b"uchar", b"double")},
            {"m.stl": b"solid x\n" + b"facet normal 0 0 1\nouter loop\nvertex 0 0 x\nendloop\nendfacet\n" * 9},
            {"m.stl": b"solid " + b"x" * 1_000_000},
            {"m.stl": bytes(80) + struct.pack("<I", 4_000_000_000) + bytes(500)},
        )
    )


def deep(draw: random.Random) -> Files:
    depth = draw.choice((500, 990, 100_000))
    inner = b'{"a":' * depth + b"1" + b"}" * depth
    return {"m.gltf": json.dumps(solid()).encode()[:-1] + b', "extras": ' + inner + b"}"}


KINDS: tuple[Callable[[random.Random], Files], ...] = (
    painted,
    broken_bytes,
    nodes,
    broken_words,
    counts,
    names,
    corners,
    instances,
    many_materials,
    lines,
    deep,
    painted,
)


def model(number: int) -> tuple[str, Files]:
    """The hostile model of a number, 0, 1, ...: the name of its kind, and its files."""
    kind = KINDS[number % len(KINDS)]
    return kind.__name__, kind(random.Random(f"model {number}"))
