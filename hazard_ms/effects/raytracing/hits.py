"""Shader text for surfaces that rays hit, which char and get wet, for quads of effects in their way, and for lamps."""

from __future__ import annotations

from hazard_ms.effects.shaders.char import CHAR
from hazard_ms.effects.shaders.common import FIRE_FRAG, SHOWN
from hazard_ms.effects.shaders.soot import SOOT_FRAG
from hazard_ms.effects.shaders.water import CUT_IOR, IMMERSE
from hazard_ms.effects.shaders.wind import WIND_FRAG

# transmission_roughness: from here on quads of effects, water; charred things have up to 257
EFFECT, WATER = 1000.0, 3000.0

CUT = CUT_IOR - 0.1  # index of refraction from which textures show where there is nothing, whatever rounding does
GLOW = "1.6"  # brightness of flames in linear light, before tones are mapped [ours]
PIXEL = 0.0015  # angle that a pixel sees, for the sharpness of textures [rad] [ours]
CAREFUL = 2  # bounces from which on effects are seen in mirrors, too
MOST_VEILS = 32  # quads of effects that one ray passes, the nearest ones

HIT = (
    """
Material materialBuffer;  // what the text shared with the raster packs calls so
vec3 objectCoord;
struct { mat4 modelMatrix; } objectTransformBuffer;
struct { mat4 viewMatrix; mat4 viewMatrixInverse; } cameraBuffer;
int hazardTexture;
#define transmissionTexture textures[nonuniformEXT(hazardTexture)]
"""
    + CHAR
    + "#define RAYS\n"
    + IMMERSE
)

CARRIED = f"""
  float chance;
  bool dull;
  float far;  // of what the ray has hit
  int veils;  // quads of effects that it has passed
  float veilFar[{MOST_VEILS}];
  uvec2 veilShown[{MOST_VEILS}];
"""

PASSED = (
    """
hitAttributeEXT vec3 attribs;

#include "./light.glsl"
#define SET_NUM 1
#include "./scene_set.glsl"
#undef SET_NUM

int hazardTexture;
#define colorTexture textures[nonuniformEXT(hazardTexture)]

float noise(vec2 p) { return texture(textures[nonuniformEXT(hazardTexture)], p).r; }
vec4 water(vec3 place, vec2 flow, float way, float time, float strength) { return vec4(0); }  // here it is glass
"""
    + FIRE_FRAG
    + WIND_FRAG
    + SOOT_FRAG
    + SHOWN
    + f"""
#define MOST_VEILS {MOST_VEILS}
"""
    + """
// Normal of the corners, and where the texture is looked up, at the place that is hit.
vec3 hazardCorners(int instance, out vec2 uv) {
  uint index = geometryInstances.i[instance].geometryIndex;
  vec3 normal = vec3(0), weight = vec3(1.0 - attribs.x - attribs.y, attribs.xy);
  uv = vec2(0);
  for (int k = 0; k < 3; ++k) {
    Vertex v = vertices[nonuniformEXT(index)].v[indices[nonuniformEXT(index)].i[3 * gl_PrimitiveID + k]];
    uv += weight[k] * vec2(v.u, v.v);
    normal += weight[k] * vec3(v.nx, v.ny, v.nz);
  }
  return normal;
}

float hazardSeen(int instance, Material mat, int which) {
  vec2 uv;
  hazardCorners(instance, uv);
  return textureLod(textures[nonuniformEXT(which)], uv * mat.textureTransforms[0].zw + mat.textureTransforms[0].xy, \
0.0).a;
}

// Note a quad that the ray passes; of too many the nearest.
void hazardPassed(vec4 veil) {
  for (int k = 0; k < ray.veils; ++k) {
    if (ray.veilFar[k] == gl_HitTEXT) return;  // graphics cards may ask for one hit twice
  }
  int place = ray.veils;
  if (place < MOST_VEILS) {
    ray.veils += 1;
  } else {
    place = 0;
    for (int k = 1; k < MOST_VEILS; ++k) {
      if (ray.veilFar[k] > ray.veilFar[place]) place = k;
    }
    if (ray.veilFar[place] < gl_HitTEXT) return;
  }
  ray.veilFar[place] = gl_HitTEXT;
  ray.veilShown[place] = uvec2(packHalf2x16(veil.rg), packHalf2x16(veil.ba));
}

"""
)

LIT = """
// One light, drawn by what it would give here if nothing stood between, so that each hit costs one shadow ray.
vec3 hazardLit(vec3 pos, vec3 normal, vec3 diffuse, vec3 specular, float roughness, float through, float eta) {
  vec3 V = normalize(-ray.direction), L = vec3(0), light = vec3(0);
  float total = 0.0, share = 1.0, far = 0.0, chance = ray.chance;
  for (int i = 0; i < pointLightCount + directionalLightCount; ++i) {
    vec3 d = vec3(0), rgb;
    float reach = 1.0e6;
    if (i < pointLightCount) {
      d = pointLights.l[i].position - pos;
      reach = max(length(d), 1e-3);
      rgb = pointLights.l[i].rgb / (reach * reach);
    } else {
      d = -directionalLights.l[i - pointLightCount].direction;
      rgb = directionalLights.l[i - pointLightCount].rgb;
    }
    d = normalize(d);
    float weight = maxVec3(rgb) * (through > 1e-5 ? 1.0 : max(dot(normal, d), 0.0));
    if (weight <= 0.0) continue;
    total += weight;
    float p = weight / total;
    if (chance < p) {
      chance /= p;
      L = d; light = rgb; far = reach; share = weight;
    } else {
      chance = (chance - p) / max(1.0 - p, 1e-6);
    }
  }
  if (total <= 0.0) return vec3(0);
  shadowRay.shadowed = true;
  traceRayEXT(tlas, gl_RayFlagsTerminateOnFirstHitEXT | gl_RayFlagsSkipClosestHitShaderEXT, 0xff, 0, 0, 1, pos, \
0.001, L, far - 0.001, 1);
  if (shadowRay.shadowed) return vec3(0);
  vec3 H = normalize(V + L);
  float dotNH = clamp(dot(normal, H), 1e-6, 1.0), dotVH = clamp(dot(V, H), 1e-6, 1.0);
  float dotNL = clamp(dot(normal, L), 1e-6, 1.0), dotNV = clamp(dot(normal, V), 1e-6, 1.0);
  vec3 seen = evalDiffuse(dotNL, dotNV, diffuse) + evalGGXReflection(dotNL, dotNV, dotNH, dotVH, roughness, specular);
  if (through > 1e-5) seen += evalGGXTransmission(normal, L, V, eta, roughness) * through;
  return seen * light * (total / share);
}
"""

SHARPNESS = f"""
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

SOLID = f"""
  if (mat.ior >= {CUT}) alpha = 1.0;
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

SURFACE = "worldPosition, worldShadingNormal, diffuseColor, specularColor, roughness, transmission, eta"
LIGHTS = "".join(f"\n    + trace{kind}Lights({SURFACE})" for kind in ("Point", "Directional", "Spot", "Parallelogram"))
SCATTERED = "    attenuation = attenuation / diffuseProb;\n"
SMOOTH = 0.3  # roughness up to which a surface mirrors effects [ours]
MIRRORED = "    attenuation /= specularProb;\n"

LAST = """
  if (ray.depth >= maxDepth) ray.radiance += ambientLight * diffuseColor;
"""

VEIL = f"""  if (mat.ior >= {CUT}) {{  // leaves are squares with two sides
    if (gl_HitKindEXT == gl_HitKindBackFacingTriangleEXT) ignoreIntersectionEXT;
    if (hazardSeen(instanceId, mat, textureIndices.t[materialIndex].diffuse) < 0.5) ignoreIntersectionEXT;
  }}
  if ((gl_IncomingRayFlagsEXT & gl_RayFlagsTerminateOnFirstHitEXT) != 0) {{
    if (mat.transmissionRoughness >= {EFFECT}) ignoreIntersectionEXT;
    return;
  }}
  // scattered light passes water as shadow rays do: glass would keep 44 % of it, which water under a whole sky does not
  if (ray.dull && mat.transmissionRoughness >= {WATER}) ignoreIntersectionEXT;
  if (mat.transmissionRoughness >= {EFFECT} && mat.transmissionRoughness < {WATER}) {{
    if (!ray.dull && (maxDepth >= {CAREFUL} || ray.depth == 0)) {{  // else the fire's own lamp lights things
      vec2 uv;
      vec3 life = hazardCorners(instanceId, uv);
      hazardTexture = textureIndices.t[materialIndex].diffuse;
      vec3 place = gl_WorldRayOriginEXT + gl_WorldRayDirectionEXT * gl_HitTEXT;
      vec4 veil = shown(uv, vec4(floor(life.x), fract(life.x), life.y, 1.0), place, mat.transmissionRoughness - \
{EFFECT}, life.z,
                        mat.baseColor.rgb);
      if (life.x < 1.0 || floor(life.x) == 3.0) veil.rgb *= {GLOW};
      if (veil.a >= (life.x < 1.0 ? 0.05 : 0.02)) hazardPassed(veil);
    }}
    ignoreIntersectionEXT;
  }}
"""
