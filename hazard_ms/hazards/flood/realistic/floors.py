"""The resistance of a floor to water that flows over it: Manning's law, and its coefficient for each material.

    S = n^2 u^2 / R^(4/3)          S: loss of head per length, R: hydraulic radius, the depth in wide water

so that the friction of the momentum equation is g n^2 u |u| / h^(4/3), and a uniform flow on a slope S runs at
R^(2/3) sqrt(S) / n.
"""

from __future__ import annotations

from hazard_ms.spec import SceneSpec

GRAVITY = 9.81  # [m/s^2]
USUAL = 0.012  # Manning's n of floors that the table lacks: smooth ones [s/m^(1/3)] [M: Chow]
MANNING = {  # of a room's floor, normal values [s/m^(1/3)]
    "wood": 0.012,  # planed [M: Chow]
    "parquet": 0.012,
    "light_wood": 0.012,
    "tile": 0.013,  # glazed brickwork [M: Chow]
    "dark_tile": 0.013,
    "concrete": 0.013,  # trowelled [M: Chow]
    "asphalt": 0.013,  # smooth [M: Chow]
    "brick": 0.015,  # in cement mortar [M: Chow]
    # a pile of 8 mm [ours] as sand: k^(1/6) / 26 [M: Strickler]
    "carpet": 0.017,
    "carpet_blue": 0.017,
}


def friction_of(spec: SceneSpec, roughness: float | None = None) -> float:
    """Friction g n^2 of a scene's floor [m^(1/3)]; `roughness`: Manning's n instead of the material's."""
    n = MANNING.get(spec.room.floor, USUAL) if roughness is None else roughness
    return GRAVITY * n * n
