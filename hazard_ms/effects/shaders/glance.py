"""Shaders of a glance: a picture without colours, only of where and which each thing is.

There are no lights, shadows or effects in it, which are three quarters of the time of a full picture, but the same
triangles: labels are those of the full picture, and so are positions, but for rounding. Only the sets of uniforms are
SAPIEN's own text.
"""

from __future__ import annotations

import logging
from functools import cache

import sapien

from hazard_ms.effects.shaders.common import QUAD_VERT
from hazard_ms.effects.shaders.pack import SETS, UnknownSapienError, stock_packs, texts, write

TEXTURES = ("Position", "Segmentation")  # what a glance has of the textures of ManiSkill's full pictures

VERT = (
    QUAD_VERT
    + """
layout(location = 0) out vec4 outPlace;  // in the camera's frame [m]
layout(location = 1) out vec2 outUV;
layout(location = 2) out flat uvec4 outLabels;

void main() {
  mat4 seen = cameraBuffer.viewMatrix * objectTransformBuffer.modelMatrix;
  outPlace = seen * vec4(position, 1);
  outUV = uv;
  outLabels = objectDataBuffer.segmentation;
  gl_Position = cameraBuffer.projectionMatrix * outPlace;
}
"""
)

# SAPIEN asks for a set of lights, though nothing here reads it, and for a last pass
FRAG = """#version 450
#define SET_NUM 0
#include "./camera_set.glsl"
#undef SET_NUM
#define SET_NUM 1
#include "./object_set.glsl"
#undef SET_NUM
#define SET_NUM 2
#include "./material_set.glsl"
#undef SET_NUM
struct PointLight { vec4 position; vec4 emission; };
struct DirectionalLight { vec4 direction; vec4 emission; };
struct SpotLight { vec4 position; vec4 direction; vec4 emission; };
layout(set = 3, binding = 0) uniform SceneBuffer {
  vec4 ambientLight;
  DirectionalLight directionalLights[3];
  SpotLight spotLights[10];
  PointLight pointLights[10];
  SpotLight texturedLights[1];
} sceneBuffer;
layout(location = 0) in vec4 place;
layout(location = 1) in vec2 uv;
layout(location = 2) in flat uvec4 labels;
layout(location = 0) out vec4 outPositionRaw;
layout(location = 1) out uvec4 outSegmentation;

void main() {
  vec4 onTexture = materialBuffer.textureTransforms[0];
  bool textured = (materialBuffer.textureMask & 1) != 0;
  float alpha = textured ? texture(colorTexture, uv * onTexture.zw + onTexture.xy).a : materialBuffer.baseColor.a;
  if (alpha * SOLID == 0) discard;
  outPositionRaw = place;
  outSegmentation = labels;
}
"""

LAST = """#version 450
layout(set = 0, binding = 0) uniform sampler2D samplerPositionRaw;
layout(location = 0) in vec2 inUV;
layout(location = 0) out vec4 outPosition;

void main() { outPosition = texture(samplerPositionRaw, inUV); }
"""


@cache
def glance_pack() -> str | None:
    """The folder of the pack, made if need be; None if the installed SAPIEN is unknown."""
    try:
        stock = texts(stock_packs() / "default")
        files = {name: stock[name] for name in (*SETS, "composite.vert")}
        files |= {"gbuffer.vert": VERT, "gbuffer.frag": FRAG.replace("SOLID", "1.0"), "composite0.frag": LAST}
        through = FRAG.replace("SOLID", "(1.0 - objectDataBuffer.transparency)")
        files |= {"gbuffer1.vert": VERT, "gbuffer1.frag": through}  # of what light passes, as in the full pack
        return str(write("hazard-glance", files))
    except (KeyError, UnknownSapienError, OSError) as fault:
        logging.getLogger(__name__).warning(
            "looks take three times as long: cannot derive shaders without colours from SAPIEN %s (%s)",
            sapien.__version__,
            fault,
        )
        return None
