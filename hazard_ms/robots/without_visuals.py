"""A robot's description without its visual shapes, for machines where nothing can draw."""

from __future__ import annotations

from functools import cache
from pathlib import Path
from xml.etree import ElementTree

from hazard_ms.spec.storage.cache import kept_folder


def without_visuals(urdf: Path) -> Path:
    """A copy of a robot's description (URDF) that keeps bodies, joints and collision shapes only.

    SAPIEN's loader makes a material for each visual shape, which fails without a Vulkan device.
    """
    return kept_folder("robots", _bare(urdf)) / urdf.name


@cache
def _bare(urdf: Path) -> dict[str, str]:
    """The files of that copy, text by name: derived once, since a robot is built for every scene."""
    tree = ElementTree.parse(urdf)
    for link in tree.getroot().iter("link"):
        for visual in link.findall("visual"):
            link.remove(visual)
    for mesh in tree.getroot().iter("mesh"):
        mesh.set("filename", str((urdf.parent / mesh.get("filename", "").removeprefix("package://")).resolve()))
    files = {urdf.name: ElementTree.tostring(tree.getroot(), encoding="unicode")}
    collisions = urdf.with_suffix(".srdf")  # pairs of links that may overlap; the loader reads it from beside the URDF
    if collisions.exists():
        files[collisions.name] = collisions.read_text(encoding="utf-8")
    return files
