"""A model somewhere on this machine, not read yet: its files, how they stand, and whose work it is."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

Y_UP = (".glb", ".gltf", ".obj")  # glTF says so, OBJ files mostly are; the others are taken to be z up
FRONT = {"y": "z", "z": "-y"}  # where a model faces unless stated, for the axis that is up; glTF: +z
# the identity, row by row
UPRIGHT = (1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0)


@dataclass(frozen=True)
class ModelPart:
    """One file of a model, and its place in the model."""

    file: str
    matrix: tuple[float, ...] = UPRIGHT  # [4, 4], row by row: from the file's frame to the model's


@dataclass(frozen=True)
class Model:
    """A model as its provider, or the user, describes it."""

    parts: tuple[ModelPart, ...]
    up: str = "z"  # axis of the model: x | -x | y | -y | z | -z
    front: str = "-y"  # where it faces, likewise
    scale: float = 1.0  # metres in one unit of the model
    category: str = ""  # a key of the catalogue; empty: the user must say
    mass: float | None = None  # [kg]; None: from volume and category
    licence: str = ""  # empty: the user must say
    author: str = ""
    source: str = ""


def model_of_file(path: Path, up: str | None = None, front: str | None = None) -> Model:
    """The model in one file; its axes are those of its format unless they are given."""
    axis = up or ("y" if path.suffix.lower() in Y_UP else "z")
    return Model((ModelPart(str(path.absolute())),), axis, front or FRONT.get(axis, "-y"), source=path.name)
