"""Checks what a glTF file, in words or binary, announces, and makes its pictures small, before anything is loaded."""

from __future__ import annotations

import base64
import binascii
import json
import struct
from collections.abc import Callable, Iterator
from typing import Any

from hazard_ms.scenes.assets.intake.gltf_shapes import keep_plain, remedy
from hazard_ms.scenes.assets.intake.textures import Textures

LARGEST_JSON = 8_000_000  # of what describes a glTF [bytes] [ours]
MOST_NODES = 10_000  # of a glTF [ours]
DEEPEST = 200  # a node below others [levels] [ours]
MOST_NUMBERS = 2_400_000  # of corners, indices and so on, in all accessors: 12 for each triangle [ours]
WEBP = "EXT_texture_webp"  # extension that names a picture beside or instead of a PNG or JPEG
EXTENSIONS = ("KHR_materials_", "KHR_lights_punctual", WEBP)  # that a glTF may require: they do not change its shape
UNUSED = ("normalTexture", "occlusionTexture", "emissiveTexture")  # pictures that models here do without
JSON_CHUNK, BINARY_CHUNK = 0x4E4F534A, 0x004E4942  # kinds of chunks of a GLB file
MALFORMED = (ValueError, RecursionError, AttributeError, KeyError, IndexError, TypeError, OverflowError)

Tree = dict[str, Any]
Get = Callable[[str], bytes]  # the content of a file beside the model


def prepared_glb(data: bytes, name: str, beside: Get, textures: Textures) -> bytes:
    """The GLB file with its pictures made small. Raises ValueError that names what is wrong with it."""
    if len(data) < 20 or data[:4] != b"glTF":
        raise ValueError(f"{name} must be a GLB file, got one that begins with {data[:4]!r}")
    version, _, length, chunk = struct.unpack("<IIII", data[4:20])
    if version != 2 or chunk != JSON_CHUNK or length > len(data) - 20:
        raise ValueError(
            f"{name} must be a GLB file of version 2 that begins with a complete JSON chunk, got something else"
        )
    rest = data[20 + length :]
    text = _prepared(data[20 : 20 + length], name, rest, beside, textures)
    text += b" " * (-len(text) % 4)
    head = struct.pack("<4sIIII", b"glTF", 2, 20 + len(text) + len(rest), len(text), JSON_CHUNK)
    return head + text + rest


def prepared_gltf(data: bytes, name: str, beside: Get, textures: Textures) -> bytes:
    """The glTF file with its pictures made small. Raises ValueError that names what is wrong with it."""
    return _prepared(data, name, b"", beside, textures)


def _prepared(data: bytes, name: str, rest: bytes, beside: Get, textures: Textures) -> bytes:
    if len(data) > LARGEST_JSON:
        raise ValueError(f"the JSON of {name} must have at most {LARGEST_JSON} bytes, got {len(data)}")
    try:
        tree = json.loads(data)
        needed = [e for e in tree.get("extensionsRequired", []) if not e.startswith(EXTENSIONS)]
        counts = [int(a["count"]) for a in tree.get("accessors", [])]
        nodes = len(tree.get("nodes", []))
        uris = [str(b["uri"]) for b in tree.get("buffers", []) if "uri" in b]
        images, (shown, alone) = list(tree.get("images", [])), _shown(tree)
    except MALFORMED as error:
        raise ValueError(f"{name} must be a valid glTF, got {type(error).__name__}: {error!s:.200}") from None
    if needed := [*dict.fromkeys([*needed, *alone])]:
        raise ValueError(
            f"{name} must be saved without compression and the like, got {', '.join(needed)!r:.200}: {remedy(needed)}"
        )
    if any(c < 0 for c in counts) or sum(counts) > MOST_NUMBERS:
        raise ValueError(
            f"{name} must have at most {MOST_NUMBERS} entries in its accessors, got {sum(counts)}: simplify it first"
        )
    if nodes > MOST_NODES:
        raise ValueError(f"{name} must have at most {MOST_NODES} nodes, got {nodes}")
    _check_nodes(tree, name)
    keep_plain(tree, name)
    for uri in uris:
        if uri.startswith("data:"):
            _decoded(uri, name)
    tree["images"] = [{} for _ in images]
    for i in sorted(shown):
        small = textures.small(_picture(tree, images[i], name, rest, beside), f"image {i} of {name}")
        tree["images"][i] = {"uri": f"data:image/png;base64,{base64.b64encode(small).decode()}"}
    return json.dumps(tree).encode()


def _check_nodes(tree: Tree, name: str) -> None:
    """Refuse nodes in circles, in long chains, and with several parents, as glTF does: they multiply without end."""
    try:
        below = [[int(c) for c in node.get("children", [])] for node in tree.get("nodes", [])]
        children = [c for each in below for c in each]
        strict = len(set(children)) == len(children)
        level, seen = sorted(set(range(len(below))) - set(children)) if strict else [], 0
        for _ in range(DEEPEST):
            seen, level = seen + len(level), [c for i in level for c in below[i]]
    except MALFORMED as error:
        raise ValueError(f"{name} must be a valid glTF, got {type(error).__name__}: {error!s:.200}") from None
    if not strict or level or seen < len(below):
        raise ValueError(f"nodes of {name} must form trees of at most {DEEPEST} levels, got a loop or more levels")


def _shown(tree: Tree) -> tuple[set[int], list[str]]:
    """Numbers of the images that materials still name once those in UNUSED are taken out of the tree.

    A texture keeps its PNG or JPEG if it has one, else its WebP; the extensions that alone hold another are returned.
    """
    textures = set()
    for material in tree.get("materials", []):
        for key in UNUSED:
            material.pop(key, None)
        textures |= {each["index"] for each in _entries(material) if "index" in each}
    found, alone = set(), []
    for texture in (tree["textures"][i] for i in textures):
        others = texture.pop("extensions", {})
        if "source" not in texture and WEBP in others:
            texture["source"] = others[WEBP]["source"]
        if "source" in texture:
            found.add(texture["source"])
        else:
            alone += [str(e) for e in others]
    if not all(isinstance(i, int) and 0 <= i < len(tree["images"]) for i in found):
        raise ValueError("a texture must name an image that exists")
    return found, alone


def _entries(material: Tree) -> Iterator[Tree]:
    """What may name a texture: entries of the material, of its metal and roughness, and of its extensions."""
    for place in (material, material.get("pbrMetallicRoughness", {}), *material.get("extensions", {}).values()):
        yield from (each for each in place.values() if isinstance(each, dict))


def _picture(tree: Tree, image: Tree, name: str, rest: bytes, beside: Get) -> bytes:
    """The file of an image, from wherever the glTF has it."""
    try:
        if "bufferView" not in image:
            return _of_uri(str(image["uri"]), name, beside)
        view = tree["bufferViews"][image["bufferView"]]
        buffer = tree["buffers"][view["buffer"]]
        data = _of_uri(str(buffer["uri"]), name, beside) if "uri" in buffer else _binary(rest)
        start, length = int(view.get("byteOffset", 0)), int(view["byteLength"])
    except (AttributeError, KeyError, IndexError, TypeError) as error:
        raise ValueError(f"images of {name} must be inside it or beside it, got {error!r:.200}") from None
    if start < 0 or length < 0 or start + length > len(data):
        raise ValueError(f"images of {name} must lie within its {len(data)} bytes, got {start} to {start + length}")
    return data[start : start + length]


def _of_uri(uri: str, name: str, beside: Get) -> bytes:
    return _decoded(uri, name) if uri.startswith("data:") else beside(uri)


def _decoded(uri: str, name: str) -> bytes:
    try:
        return base64.b64decode(uri.partition(",")[2], validate=True)
    except (binascii.Error, ValueError) as error:
        raise ValueError(f"data URIs of {name} must be base64: {error}") from None


def _binary(rest: bytes) -> bytes:
    """The first binary chunk among those that follow the JSON; empty if there is none."""
    at = 0
    while at + 8 <= len(rest):
        length, kind = struct.unpack_from("<II", rest, at)
        if kind == BINARY_CHUNK:
            return rest[at + 8 : at + 8 + length]
        at += 8 + length
    return b""
