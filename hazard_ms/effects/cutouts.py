"""Leaves cut out of squares: rays must know which textures show where there is nothing, see ray_glsl.py."""

from __future__ import annotations

import sapien

from hazard_ms.effects import ray_glsl
from hazard_ms.effects.entities import solid_materials
from hazard_ms.effects.ray_pack import shows_effects


def mark_cutouts(scene: sapien.Scene) -> int:
    """Mark the materials of what stands in `scene` whose textures are see-through in places, by what raster pictures do not read.

    Returns their number: none where SAPIEN's own pack, which reads it as what it is, is all there is.
    """
    if not shows_effects():
        return 0
    count = 0
    for material in solid_materials(scene):
        texture = material.base_color_texture
        if texture is not None and texture.channels == 4 and material.transmission == 0.0 and texture.download()[..., 3].min() == 0:
            material.ior = ray_glsl.CUT
            count += 1
    return count
