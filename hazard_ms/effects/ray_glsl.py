"""What ray_pack.py puts into SAPIEN's ray-tracing shaders, and the lines of them that it replaces."""

from __future__ import annotations

from hazard_ms.effects.glsl import CHAR, FIRE_FRAG, SHOWN
from hazard_ms.effects.water_glsl import IMMERSE
from hazard_ms.effects.wind_glsl import WIND_FRAG

EFFECT, WATER = 1000.0, 3000.0  # transmission_roughness: from here on quads of effects, water; charred things have up to 257
GLOW = "1.6"  # brightness of flames in linear light, before tones are mapped [ours]
PIXEL = 0.0015  # angle that a pixel sees, for the sharpness of textures [rad] [ours]
CAREFUL = 2  # bounces from which on effects are seen in mirrors, too
KEPT = 0.6  # share of paths that are followed after a bounce, at most [ours]
MOST_WATERS = 2  # the first hit of water's surface uses up no bounce
MOST_VEILS = 48  # quads of effects that one ray passes

HIT = (
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
  traceRayEXT(tlas, gl_RayFlagsTerminateOnFirstHitEXT | gl_RayFlagsSkipClosestHitShaderEXT, 0xff, 0, 0, 1, pos, 0.001, L, far - 0.001, 1);
  if (shadowRay.shadowed) return vec3(0);
  vec3 H = normalize(V + L);
  float dotNH = clamp(dot(normal, H), 1e-6, 1.0), dotVH = clamp(dot(V, H), 1e-6, 1.0);
  float dotNL = clamp(dot(normal, L), 1e-6, 1.0), dotNV = clamp(dot(normal, V), 1e-6, 1.0);
  vec3 seen = evalDiffuse(dotNL, dotNV, diffuse) + evalGGXReflection(dotNL, dotNV, dotNH, dotVH, roughness, specular);
  if (through > 1e-5) seen += evalGGXTransmission(normal, L, V, eta, roughness) * through;
  return seen * light * (total / share);
}
"""

VEIL = f"""
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

SCATTERED = "    attenuation = attenuation / diffuseProb;\n"
SMOOTH = 0.3  # roughness up to which a surface mirrors effects [ours]
MIRRORED = "    attenuation /= specularProb;\n"

LAST = """
  if (ray.depth >= maxDepth) ray.radiance += ambientLight * diffuseColor;
"""

SHADOW = f"""  if ((gl_IncomingRayFlagsEXT & gl_RayFlagsTerminateOnFirstHitEXT) != 0) {{
    if (mat.transmissionRoughness >= {EFFECT}) ignoreIntersectionEXT;
    return;
  }}
  bool veil = mat.transmissionRoughness >= {EFFECT} && mat.transmissionRoughness < {WATER};
  if (veil && (ray.dull || maxDepth < {CAREFUL} && ray.depth > 0)) ignoreIntersectionEXT;  // the fire's own lamp lights things
"""

GUIDE = f"""      if (ray.segmentation.w == 1u) {{  // a quad of an effect
        guideAlbedo += guideLeft * min(ray.albedo, vec3(1));
        guideLeft *= ray.attenuation;
        if (++veils < {MOST_VEILS}) ray.depth -= 1;
      }} else if (ray.segmentation.w == 2u) {{
        if (maxDepth >= {CAREFUL} && ++waters < {MOST_WATERS}) ray.depth -= 1;
        guideLeft *= 0.9;  // water: what lies below it guides, or what it mirrors
      }} else if (!labelled) {{
        guideAlbedo += guideLeft * min(ray.albedo, vec3(1));
        guideNormal += mat3(cameraBuffer.viewMatrix) * ray.normal;
      }}

"""

EACH = "  for (int i = 0; i < spp; ++i) {\n"
ANY = """
  vec3 attenuation = vec3(1.0), guideLeft = vec3(1.0);
  bool labelled = false, alive = false;
  int veils = 0, waters = 0;
  float turn = rnd(ray.seed);
  for (int i = 0; i < spp || alive;) {  // one loop for all bounces of all samples: a path that ends early makes room for the next
    if (!alive) {
"""
BOUNCES = "    vec3 attenuation = vec3(1.0);\n    for (ray.depth = 0; ray.depth <= maxDepth; ++ray.depth) {\n"
BEGUN = """
    attenuation = guideLeft = vec3(1.0);
    labelled = false;
    veils = waters = 0;
    ray.dull = false;
    ray.chance = fract((float(i) + rnd(ray.seed)) / spp + turn);
    alive = true;
    ++i;
    }
    {
"""
ENDED = "    // TODO: implement unterminated ray properly\n"
STEP = f"""
    ray.depth += 1;
    ray.chance = rnd(ray.seed);
    float left = max(attenuation.x, max(attenuation.y, attenuation.z));
    alive = ray.depth <= maxDepth && left > 1e-3;
    if (alive && ray.segmentation.w == 0u) {{  // what little is left is followed now and then, and counts for more
      float kept = clamp(left, 0.1, {KEPT});
      alive = rnd(ray.seed) < kept;
      attenuation /= kept;
    }}
"""
