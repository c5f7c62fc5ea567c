"""Refuses glTF files from which the reader would take another shape than is meant: compressed, quantized or in parts.

The reader fills what it cannot unpack with zeros, and takes whole numbers for metres, without a word.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

FLOAT = 5126  # component type of 32-bit floating-point numbers
FAN = 6  # mode of primitives that the reader leaves out
READ = ("POSITION", "NORMAL", "TEXCOORD_0")  # attributes of corners that models here have
QUANTIZED = "KHR_mesh_quantization"
REMEDIES = {  # an extension -> what takes it out of a file
    "KHR_draco_mesh_compression": "gltf-transform copy",
    "EXT_meshopt_compression": "gltf-transform copy",
    QUANTIZED: "gltf-transform dequantize",
    "KHR_texture_basisu": "gltf-transform ktxdecompress",
}
ELSE = "the program that made it"
MALFORMED = (KeyError, IndexError, TypeError, AttributeError)

Tree = dict[str, Any]


def remedy(extensions: list[str]) -> str:
    """The advice to a user whose file needs these extensions."""
    tools = dict.fromkeys(REMEDIES.get(e, ELSE) for e in extensions or [""])
    return f"save it without, with {' and '.join(tools)}"


def keep_plain(tree: Tree, name: str) -> None:
    """Take out compressed shapes beside plain ones. Raises ValueError unless the glTF `name` has all as plain numbers.

    What is taken out would be read where DracoPy is installed, and not elsewhere.
    """
    try:
        for primitive in (p for mesh in tree.get("meshes", []) for p in mesh.get("primitives", [])):
            _check_primitive(tree, primitive, name)
            primitive.pop("extensions", None)
    except MALFORMED as error:
        raise ValueError(f"{name} must be a valid glTF, got {type(error).__name__}: {error!s:.200}") from None


def _check_primitive(tree: Tree, primitive: Tree, name: str) -> None:
    if primitive.get("mode") == FAN:
        raise ValueError(f"{name} must hold separate triangles or strips, got a triangle fan")
    for accessor in _numbers(tree, primitive):
        if not _plain(tree, accessor):
            packed = [*primitive.get("extensions", {}), *_packing(tree, accessor)]
            where = ", ".join(map(str, packed)) or "an accessor without a buffer"
            where = "a sparse accessor" if "sparse" in accessor else where
            raise ValueError(
                f"{name} must store its corners and triangles as plain numbers, got them in {where:.200}: "
                f"{remedy(packed)}"
            )
    for attribute in READ:
        at = primitive["attributes"].get(attribute)
        kind = FLOAT if at is None else tree["accessors"][at]["componentType"]
        if kind != FLOAT:
            raise ValueError(
                f"{attribute} of {name} must hold 32-bit floating-point numbers, got component type {kind!r:.20}, "
                f"as {QUANTIZED} has it: {remedy([QUANTIZED])}"
            )


def _numbers(tree: Tree, primitive: Tree) -> Iterator[Tree]:
    """The accessors of a primitive that are read."""
    attributes = primitive["attributes"]
    used = [attributes[a] for a in READ if a in attributes] + ([primitive["indices"]] if "indices" in primitive else [])
    yield from (tree["accessors"][at] for at in used)


def _packing(tree: Tree, accessor: Tree) -> list[str]:
    """The extensions in which the numbers of an accessor lie."""
    at = accessor.get("bufferView")
    return [] if at is None else list(tree["bufferViews"][at].get("extensions", {}))


def _plain(tree: Tree, accessor: Tree) -> bool:
    """Whether the numbers of an accessor lie in a buffer that has content, beside what extensions offer."""
    if "sparse" in accessor or "bufferView" not in accessor:
        return False
    number = tree["bufferViews"][accessor["bufferView"]]["buffer"]
    buffer = tree["buffers"][number]
    return "uri" in buffer or not buffer.get("extensions")
