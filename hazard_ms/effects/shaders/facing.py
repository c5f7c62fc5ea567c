"""Shader text for corners without a normal: what they belong to is lit as the flat triangle that it is.

Models from files have some: where leaves, or the sheets of a car, have a front and a back that share corners, the means
of their normals are zero, and SAPIEN's light on them is not a number, which is drawn as white, black or too dark.
"""

from __future__ import annotations

FUNCTION = """
vec3 hazardFacing(vec3 normal, vec3 place) {  // camera frame
  vec3 flatOne = -normalize(cross(dFdx(place), dFdy(place)));
  return dot(normal, normal) > 0.01 ? normalize(normal) : flatOne;
}

"""
MAIN = "void main() {"
CORNERS = "vec3 outNormal = normalize(normalMatrix * "  # in the vertex shader
ROUGH = "normalize(inTbn * vec3(0, 0, 1))"  # in the fragment shader
SMOOTH = "hazardFacing(inTbn[2], inPosition.xyz)"


def facing(files: dict[str, str]) -> dict[str, str]:
    """The opaque pass of a pack whose texts are `files`, changed. Raises ValueError where it is not as expected."""
    corners, surface = files["gbuffer.vert"], files["gbuffer.frag"]
    if corners.count(CORNERS) != 1 or surface.count(ROUGH) != 1 or surface.count(MAIN) != 1:
        raise ValueError(f"gbuffer must have {CORNERS!r} and {ROUGH!r} once each, got another text")
    before, _, after = corners.partition(CORNERS)
    name, _, rest = after.partition(");")
    mended = (
        f"vec3 outNormal = normalMatrix * {name};\n  outNormal = dot({name}, {name}) > 0.01 ? normalize(outNormal) : "
    )
    return {
        "gbuffer.vert": f"{before}{mended}vec3(0);{rest}",
        "gbuffer.frag": surface.replace(ROUGH, SMOOTH).replace(MAIN, FUNCTION + MAIN),
    }
