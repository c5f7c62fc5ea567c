"""Materials of floors, walls and ground: their colours, and which of them rooms are drawn with."""

from __future__ import annotations

from hazard_ms.spec import Vec3

# linear base colours [ours]; a material is also the name of a texture where the assets have one
MATERIALS: dict[str, Vec3] = {
    "wood": (0.30, 0.16, 0.08),
    "tile": (0.62, 0.60, 0.56),
    "carpet": (0.34, 0.32, 0.30),
    "plaster": (0.58, 0.53, 0.45),
    "paint_white": (0.78, 0.77, 0.74),
    "paint_green": (0.46, 0.53, 0.43),
    "paint_blue": (0.42, 0.50, 0.56),
    "ceiling": (0.85, 0.85, 0.84),
    "trim": (0.80, 0.80, 0.78),
    "door": (0.42, 0.26, 0.14),
    "metal": (0.55, 0.55, 0.57),
    "glass": (0.62, 0.78, 0.90),
    "parquet": (0.41, 0.23, 0.10),
    "light_wood": (0.48, 0.36, 0.22),
    "dark_tile": (0.06, 0.06, 0.07),
    "carpet_blue": (0.05, 0.10, 0.13),
    "wallpaper_stripes": (0.59, 0.53, 0.40),
    "wallpaper_flowers": (0.60, 0.64, 0.58),
    "brick": (0.28, 0.10, 0.07),
    "concrete": (0.35, 0.34, 0.31),
    "asphalt": (0.06, 0.06, 0.06),
    "pavement": (0.30, 0.29, 0.27),
    "grass": (0.09, 0.13, 0.03),
    "gravel": (0.13, 0.12, 0.10),
    "soil": (0.10, 0.05, 0.03),
    "line_white": (0.75, 0.75, 0.72),
    "line_yellow": (0.72, 0.48, 0.05),
}
