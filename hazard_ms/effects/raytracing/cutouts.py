"""Leaves cut out of squares: rays must know which textures say where there is nothing; see raytracing/hits.py."""

from __future__ import annotations

import sapien

from hazard_ms.effects.entities import dry_ior, solid_materials
from hazard_ms.effects.raytracing.pack import shows_effects
from hazard_ms.effects.shaders.water import CUT_IOR


def mark_cutouts(scene: sapien.Scene) -> int:
    """Mark the materials in `scene` whose textures are transparent in places, by a scalar that raster pictures ignore.

    Returns their number; 0 if there is only SAPIEN's own pack, which would read the scalar as an index of refraction.
    """
    if not shows_effects():
        return 0
    count = 0
    for material in solid_materials(scene):
        texture = material.base_color_texture
        if (
            texture is not None
            and texture.channels == 4
            and material.transmission == 0.0
            and texture.download()[..., 3].min() == 0
        ):
            wetness = max(material.ior - dry_ior(material), 0.0)  # those of files have 1.01, less than ours
            material.ior = CUT_IOR + wetness
            count += 1
    return count
