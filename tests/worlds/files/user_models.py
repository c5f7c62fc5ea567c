"""A flask and a desk that a user might add, made for tests."""

from __future__ import annotations

import numpy as np
import trimesh
from PIL import Image

RADIUS, BODY, NECK = 0.04, 0.2, 0.08  # of the flask [m]
DESK = (1.2, 0.7, 0.75)  # [m]


def box(size: tuple[float, ...], middle: tuple[float, ...]) -> trimesh.Trimesh:
    return trimesh.creation.box(size, transform=trimesh.transformations.translation_matrix(middle))


def flask() -> trimesh.Trimesh:
    """A bottle, y up as glTF has it, far from its origin, painted with a picture that is too large."""
    parts = [trimesh.creation.cylinder(RADIUS, BODY), trimesh.creation.cylinder(0.015, NECK)]
    parts[1].apply_translation([0, 0, (BODY + NECK) / 2])
    made = trimesh.util.concatenate(parts)
    uv = np.random.default_rng(0).uniform(size=(len(made.vertices), 2))
    picture = Image.fromarray(np.random.default_rng(1).integers(0, 255, (700, 1400, 3), dtype=np.uint8))
    material = trimesh.visual.material.PBRMaterial(baseColorTexture=picture, metallicFactor=0.0, roughnessFactor=0.4)
    made.visual = trimesh.visual.TextureVisuals(uv=uv, material=material)
    made.apply_transform(trimesh.transformations.rotation_matrix(-np.pi / 2, [1, 0, 0]))
    made.apply_translation([3.0, -2.0, 7.0])
    return made


def desk() -> trimesh.Trimesh:
    """A table, z up, in millimetres."""
    x, y, z = DESK
    legs = [
        box((0.05, 0.05, z - 0.03), (sx * (x / 2 - 0.03), sy * (y / 2 - 0.03), (z - 0.03) / 2))
        for sx in (-1, 1)
        for sy in (-1, 1)
    ]
    made = trimesh.util.concatenate([box((x, y, 0.03), (0, 0, z - 0.015)), *legs])
    made.apply_scale(1000.0)
    return made
