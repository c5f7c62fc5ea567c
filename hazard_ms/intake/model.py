"""A model that lies somewhere on this machine: its files, how they stand, and whose work it is. Not read yet."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

Y_UP = (".glb", ".gltf", ".obj")  # glTF says so, OBJ files mostly are; the others are taken to be z up
FRONT = {"y": "z", "z": "-y"}  # where a model faces unless it is said, for the axis that is up; glTF: +z
UPRIGHT = (1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0)


@dataclass(frozen=True)
class Part:
    """One file, and where it stands in the model."""

    file: str
    matrix: tuple[float, ...] = UPRIGHT  # [4, 4], row by row: from the file's frame to the model's


@dataclass(frozen=True)
class Model:
    """What a provider, or the user, knows about a model."""

    parts: tuple[Part, ...]
    up: str = "z"  # axis of the model: x | -x | y | -y | z | -z
    front: str = "-y"  # where it faces, likewise
    scale: float = 1.0  # metres in one unit of the model
    category: str = ""  # a key of the catalogue; empty: the user must say
    mass: float | None = None  # [kg]; None: from volume and category
    licence: str = ""  # empty: the user must say
    author: str = ""
    source: str = ""


def model_of_file(path: Path, up: str | None = None, front: str | None = None) -> Model:
    """The model in one file; axes as its format has them, unless they are given."""
    axis = up or ("y" if path.suffix.lower() in Y_UP else "z")
    return Model((Part(str(path.absolute())),), axis, front or FRONT.get(axis, "-y"), source=path.name)
