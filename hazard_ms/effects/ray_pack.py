"""The ray-tracing shader pack with our effects, derived at run time from that of the installed SAPIEN, like those of shader_pack.py.

What changes: shadow rays pass flames, smoke and water; quads of effects show what they show in raster pictures, let through the rest, and
use up no bounce; opaque things char, get wet and are dimmed by water, haze and smoke, piece by piece of each path; the last bounce sees
ambient light, so that closed rooms have some; albedo and normals for the denoiser are means over all samples, those behind effects.

A quad of ray_geometry.py carries in its normals (kind + seed, age or light, strength), in uv the corner, and its material's
transmission_roughness is EFFECT + time [s]; of water it is WATER.
"""

from __future__ import annotations

import logging
from functools import cache

import sapien

from hazard_ms.effects import shader_pack
from hazard_ms.effects.glsl import CHAR, FIRE_FRAG, SHOWN
from hazard_ms.effects.shader_pack import UnknownSapienError
from hazard_ms.effects.water_glsl import IMMERSE
from hazard_ms.effects.wind_glsl import WIND_FRAG

NAME = "rt_hazard"
EFFECT, WATER = 1000.0, 3000.0  # transmission_roughness: from here on quads of effects, water; charred things have up to 257
GLOW = "1.6"  # brightness of flames in linear light, before tones are mapped [ours]
PIXEL = 0.0015  # angle that a pixel sees, for the sharpness of textures [rad] [ours]
CAREFUL = 4  # bounces from which on effects are seen in mirrors, too, and their glow counts: half as quick
MOST_VEILS = 48  # quads of effects that one ray passes

_log = logging.getLogger(__name__)

_HIT = (
    """
Material materialBuffer;  // what the text shared with the raster packs calls so
vec3 objectCoord;
struct { mat4 modelMatrix; } objectTransformBuffer;
struct { mat4 viewMatrix; mat4 viewMatrixInverse; } cameraBuffer;
int hazardTexture;
#define transmissionTexture textures[nonuniformEXT(hazardTexture)]

float noise(vec2 p) { return texture(textures[nonuniformEXT(hazardTexture)], p).r; }
vec4 water(vec3 place, vec2 flow, float way, float time, float strength) { return vec4(0); }  // here it is glass
"""
    + FIRE_FRAG
    + WIND_FRAG
    + SHOWN
    + CHAR
    + IMMERSE
)

_VEIL = f"""
  if (mat.transmissionRoughness >= {EFFECT} && mat.transmissionRoughness < {WATER}) {{
    hazardTexture = ti.diffuse;
    vec3 life = n0 * b0 + n1 * b1 + n2 * b2;
    vec4 veil = shown(uv, vec4(floor(life.x), fract(life.x), life.y, 1.0), worldPosition, mat.transmissionRoughness - {EFFECT},
                      life.z, mat.baseColor.rgb);
    if (veil.a < (life.x < 1.0 ? 0.05 : 0.02)) veil.a = 0.0;
    veil.rgb *= life.x < 1.0 || floor(life.x) == 3.0 ? {GLOW} : 1.0;
    ray.radiance = veil.rgb * veil.a;
    ray.attenuation = vec3(1.0 - veil.a);
    ray.albedo = veil.rgb * veil.a;
    ray.origin = worldPosition;
    ray.segmentation = uvec4(0, 0, 0, 1);
    return;
  }}
"""

_SHARPNESS = f"""
  float sharpness = 0.0;  // level of the texture: as many metres as a pixel shows, else what is far sparkles
  if (ti.diffuse >= 0) {{
    mat3 model = mat3(gl_ObjectToWorldEXT);
    float area = length(cross(model * (p1 - p0), model * (p2 - p0)));
    vec2 a = (uv1 - uv0) * mat.textureTransforms[0].zw, b = (uv2 - uv0) * mat.textureTransforms[0].zw;
    vec2 texels = vec2(textureSize(textures[nonuniformEXT(ti.diffuse)], 0));
    float density = abs(a.x * b.y - a.y * b.x) * texels.x * texels.y / max(area, 1e-12);
    float slant = max(abs(dot(worldGeometricNormal, gl_WorldRayDirectionEXT)), 0.05);
    sharpness = max(0.5 * log2(max(density, 1e-12) / slant) + log2({PIXEL} * gl_HitTEXT), 0.0);
  }}
"""

_SOLID = f"""
  materialBuffer = mat;
  objectCoord = p0 * b0 + p1 * b1 + p2 * b2;
  objectTransformBuffer.modelMatrix = mat4(vec4(gl_ObjectToWorldEXT[0], 0), vec4(gl_ObjectToWorldEXT[1], 0),
                                           vec4(gl_ObjectToWorldEXT[2], 0), vec4(gl_ObjectToWorldEXT[3], 1));
  if (mat.transmissionRoughness < {EFFECT}) {{
    if (hazardTouched()) hazardChar(baseColor, emission, specular, roughness, hazardPlace());
    if (ti.transmission >= 0) {{
      hazardTexture = ti.transmission;
      float up = worldShadingNormal.z;
      hazardImmerse(baseColor, emission, specular, roughness, worldPosition, gl_WorldRayOriginEXT, up);
    }}
  }}
"""

_LAST = """
  if (ray.depth >= maxDepth) ray.radiance += ambientLight * diffuseColor;
"""

_SHADOW = f"""  if ((gl_IncomingRayFlagsEXT & gl_RayFlagsTerminateOnFirstHitEXT) != 0) {{
    if (mat.transmissionRoughness >= {EFFECT}) ignoreIntersectionEXT;
    return;
  }}
  bool veil = mat.transmissionRoughness >= {EFFECT} && mat.transmissionRoughness < {WATER};
  if (veil && maxDepth < {CAREFUL} && ray.depth > 0) ignoreIntersectionEXT;  // the fire's own lamp lights things; mirrors can wait
"""

_GUIDE = f"""      if (ray.segmentation.w == 1u) {{  // a quad of an effect
        guideAlbedo += guideLeft * min(ray.albedo, vec3(1));
        guideLeft *= ray.attenuation;
        if (++veils < {MOST_VEILS}) ray.depth -= 1;
      }} else if (ray.segmentation.w == 2u) {{
        guideLeft *= 0.9;  // water: what lies below it guides, or what it mirrors
      }} else if (!labelled) {{
        guideAlbedo += guideLeft * min(ray.albedo, vec3(1));
        guideNormal += mat3(cameraBuffer.viewMatrix) * ray.normal;
      }}

"""


@cache
def ray_pack() -> str:
    """The pack as SAPIEN's cameras take it: its folder, made if need be; SAPIEN's own where that is unknown to us."""
    stock = shader_pack._stock()
    try:
        return str(shader_pack._write(NAME, _derive(shader_pack._texts(stock / "rt"))))
    except (UnknownSapienError, OSError) as fault:
        _log.warning("no effects in ray-traced pictures: cannot derive a shader pack from SAPIEN %s (%s)", sapien.__version__, fault)
        return str(stock / "rt")


def _derive(files: dict[str, str]) -> dict[str, str]:
    """SAPIEN's files with our text in them. Raises UnknownSapienError where they are not as expected."""
    shadow = "gl_RayFlagsTerminateOnFirstHitEXT | gl_RayFlagsOpaqueEXT |"
    files = _all(files, "shading.glsl", shadow, shadow.replace(" gl_RayFlagsOpaqueEXT |", ""))
    dark = "    vec3 emission = light.rgb;\n"
    files = _all(files, "shading.glsl", dark, dark + "    if (maxVec3(light.rgb) <= 0.0) continue;\n")
    toward = "    vec3 V = normalize(-ray.direction);\n"
    files = _all(files, "shading.glsl", toward, toward + "    if (dot(normal, L) <= 0.0 && transmissionWeight <= 1e-5) continue;\n")
    files = _before(files, "camera.rahit", "  bool isInside", _SHADOW)
    files = _before(files, "camera.rchit", "void main() {", _HIT)
    files = _before(files, "camera.rchit", "  if (ti.diffuse >= 0) {", _SHARPNESS)
    files = _all(
        files,
        "camera.rchit",
        "baseColorAlpha = texture(textures[nonuniformEXT(ti.diffuse)]",
        "baseColorAlpha = textureLod(textures[nonuniformEXT(ti.diffuse)]",
    )
    files = _all(
        files, "camera.rchit", "mat.textureTransforms[0].xy);\n    baseColor =", "mat.textureTransforms[0].xy, sharpness);\n    baseColor ="
    )
    files = _before(files, "camera.rchit", "  float metallic = mat.metallic;", _VEIL)
    files = _before(files, "camera.rchit", "  transmission = clamp(transmission, 0.0, 1.0);", _SOLID)
    files = _before(files, "camera.rchit", "  ray.origin = worldPosition;\n  ray.direction = L;", _LAST)
    mark = f"  ray.segmentation.w = mat.transmissionRoughness >= {WATER} ? 2u : 0u;\n"
    files = _before(files, "camera.rchit", "  ray.attenuation = attenuation;", "") | {
        "camera.rchit": files["camera.rchit"].replace(
            "  ray.segmentation = obj.segmentation;\n", "  ray.segmentation = obj.segmentation;\n" + mark
        )
    }
    return _generation(files)


def _generation(files: dict[str, str]) -> dict[str, str]:
    """The paths' beginnings: guides for the denoiser are means over all samples, behind effects."""
    name = "camera.rgen"
    files = _before(files, name, "  ray.seed = seed;", "  vec3 guideAlbedo = vec3(0.0), guideNormal = vec3(0.0);\n")
    files = _before(
        files,
        name,
        "    vec3 attenuation = vec3(1.0);",
        "    vec3 guideLeft = vec3(1.0);\n    bool labelled = false;\n    int veils = 0;\n",
    )
    files = _before(files, name, "      if (first) {", _GUIDE)
    files = _all(files, name, "      if (first) {", "      if (!labelled && ray.segmentation.w == 0u) {\n        labelled = true;")
    for word in ("Normal", "Albedo"):
        lines = [line for line in files[name].splitlines() if f"imageStore(out{word}," in line]
        if len(lines) != 1:
            raise UnknownSapienError(f"{name} stores {word} {len(lines)} times, not once")
        files = _all(files, name, lines[0] + "\n", "")
    stores = "".join(f"  imageStore(out{word}, ivec2(gl_LaunchIDEXT.xy), vec4(guide{word} / spp, 1.0));\n" for word in ("Normal", "Albedo"))
    return _before(files, name, "  radiance /= spp;", stores)


def _before(files: dict[str, str], name: str, mark: str, text: str) -> dict[str, str]:
    return files | {name: shader_pack._insert(files, name, mark, text)}


def _all(files: dict[str, str], name: str, old: str, new: str) -> dict[str, str]:
    if old not in files.get(name, ""):
        raise UnknownSapienError(f"{name} has no {old!r}")
    return files | {name: files[name].replace(old, new)}
