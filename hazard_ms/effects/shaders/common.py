"""Our own shader text for the pass that draws flames, scorch marks, smoke, embers, water and what flies.

Effect geometry is a set of quads whose four corners coincide; only EFFECT_VERT spreads them out. So every other shader
(shadows, labels, ray tracing, SAPIEN's stock packs) sees triangles without area, that is: nothing. A corner carries

    position  anchor in the entity's frame [m]
    normal    (half width [m], height [m], kind + seed), seed in [0, 1)
    uv        (-1 or 1, 0 or 1): the corner

and the material's otherwise unused scalars carry transmission = strength 0..1 and transmission_roughness = time [s]. Of
water, uv is the place in the room [m], and normal (path length of the water [m], its direction [rad], kind); see
shaders/water.py, shaders/wind.py and shaders/soot.py.
"""

from __future__ import annotations

from hazard_ms.effects.shaders.soot import SOOT_FRAG
from hazard_ms.effects.shaders.water import WATER as WATER_FRAG
from hazard_ms.effects.shaders.wind import WIND_FRAG, WIND_VERT

FLAME, SCORCH, SMOKE, EMBER, WATER, LEAF, PAPER, STREAK, SOOT = range(9)  # kinds of quads
# from floor to ceiling [s]; an entity's turn about z tells the phase, since only poses reach the vertex shader
SMOKE_PERIOD = 4.0

_SETS = """
#define SET_NUM 0
#include "./camera_set.glsl"
#undef SET_NUM
#define SET_NUM 1
#include "./object_set.glsl"
#undef SET_NUM
"""

QUAD_VERT = (  # what each vertex shader for quads begins with
    "#version 450\n"
    + _SETS
    + """
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec2 uv;
layout(location = 3) in vec3 tangent;
layout(location = 4) in vec3 bitangent;
"""
)

FRAG_SETS = """#version 450
#define SET_NUM 0
#include "./camera_set.glsl"
#undef SET_NUM
#define SET_NUM 2
#include "./material_set.glsl"
#undef SET_NUM
"""

EFFECT_VERT = (
    QUAD_VERT
    + """
layout(location = 0) out vec2 outCorner;
layout(location = 1) out vec4 outLife;  // kind; seed; age, light, way or extent [m]; seen near the camera 0..1
layout(location = 2) out vec3 outPlace;  // world frame [m]
"""
    + WIND_VERT
    + """
void show(vec3 place, vec2 corner, vec4 life) {
  outCorner = corner;
  outLife = life;
  outPlace = place;
  gl_Position = cameraBuffer.projectionMatrix * (cameraBuffer.viewMatrix * vec4(place, 1));
}

void main() {
  mat4 model = objectTransformBuffer.modelMatrix;
  mat4 camera = cameraBuffer.viewMatrixInverse;
  vec3 anchor = (model * vec4(position, 1)).xyz, toEye = camera[3].xyz - anchor, aloft = vec3(0, 0, 1);
  float kind = floor(normal.z), seed = fract(normal.z), age = 0.0;
  vec3 across, up;
  vec2 size = normal.xy;
  if (kind > 7.5) {  // soot before a wall or the ceiling
    show(vec3(normal.xy, uv.x) + model[3].xyz, vec2(0), vec4(kind, seed, uv.y, 1.0));
    return;
  }
  if (kind > 4.5) {  // what the wind carries
    float shade;
    carry(kind, seed, position, model, camera[3].xyz, anchor, across, up, shade);
    vec3 place = anchor + across * uv.x * size.x + up * (2.0 * uv.y - 1.0) * size.y;
    float seen = smoothstep(0.3, 0.9, distance(camera[3].xyz, anchor)) * step(0.0, model[3].z);
    show(place, vec2(uv.x, 2.0 * uv.y - 1.0), vec4(kind, seed, shade, seen));
    return;
  }
  if (kind > 3.5) {  // water: the entity's height is the level at its source, its turn the slope
    float fall = model[0].y / max(model[0].x, 1e-3);
    show(vec3(uv, model[3].z - fall * normal.x), vec2(cos(normal.y), sin(normal.y)), vec4(kind, seed, normal.x, 1.0));
    return;
  }
  if (kind > 1.5) {  // smoke and embers rise from the anchor and start again
    float phase = atan(model[0].y, model[0].x) * 0.15915494;
    float turns = kind > 2.5 ? 1.0 + floor(seed * 3.0) : 1.0;
    age = fract(phase * turns + seed * 7.0);
    float rise = max(normal.y - model[3].z, 0.3);
    float sway = 6.2831853 * (seed * 5.0 + age);
    vec3 origin = model[3].xyz + position;  // the turn tells the phase and must not turn the column
    anchor = origin + vec3(0.10 * age * cos(sway), 0.10 * age * sin(sway), rise * (kind > 2.5 ? 0.8 * age : sqrt(age)));
    if (kind > 2.5) anchor.xy += 0.35 * age * vec2(cos(seed * 40.0), sin(seed * 57.0));
    size = kind > 2.5 ? vec2(normal.x * (1.0 - 0.6 * age)) : vec2(normal.x * (0.35 + 1.3 * age));
    toEye = camera[3].xyz - anchor;
    across = camera[0].xyz;
    up = camera[1].xyz;
  } else if (kind > 0.5) {  // scorch lies on the floor
    across = vec3(cos(seed * 6.28), sin(seed * 6.28), 0);
    up = cross(aloft, across);
    size.y = size.x;
  } else {  // flames stand upright, and lean back a little for those who look from above
    up = normalize(aloft + 0.45 * camera[1].xyz);
    across = normalize(cross(up, toEye));
    anchor += normalize(toEye) * min(0.6 * size.x, 0.3 * length(toEye));  // not cut by the thing that burns
  }
  float y = kind > 0.5 ? 2.0 * uv.y - 1.0 : uv.y;
  vec3 place = anchor + across * uv.x * size.x + up * y * size.y;
  show(place, vec2(uv.x, y), vec4(kind, seed, age, smoothstep(0.15, 0.50, length(toEye))));
}
"""
)

FIRE_FRAG = """
vec4 flame(vec2 p, float seed, float time, float strength) {
  p /= vec2(mix(0.5, 1.0, strength), max(strength, 0.02));
  if (p.y > 1.0) return vec4(0);
  vec2 drift = vec2(seed * 17.3, seed * 5.1);
  float broad = noise(vec2(p.x * 0.16, p.y * 0.26 - 0.42 * time) + drift) - 0.5;
  float fine = noise(vec2(p.x * 0.42, p.y * 0.62 - 0.95 * time) + drift.yx) - 0.5;
  float x = p.x + (2.2 * broad + 0.7 * fine) * pow(p.y, 0.8);
  float tongues = 0.22 * cos(p.x * 9.0 + seed * 31.0 + 3.0 * broad) * p.y;  // several tips rather than one
  float width = 0.80 * pow(1.0 - p.y, 0.8) * smoothstep(-0.10, 0.20, p.y);
  float heat = 1.0 - abs(x) / max(width, 1e-3) + (0.5 + 1.5 * p.y) * fine + tongues - 0.3 * p.y * p.y;
  heat *= clamp((1.0 - abs(p.x)) * 5.0, 0.0, 1.0) * clamp((1.0 - p.y) * 4.0, 0.0, 1.0) * smoothstep(-0.02, 0.10, p.y);
  heat = clamp(heat, 0.0, 1.0);
  vec3 colour = mix(vec3(0.80, 0.07, 0.0), vec3(1.0, 0.27, 0.02), smoothstep(0.05, 0.32, heat));
  colour = mix(colour, vec3(1.1, 0.62, 0.09), smoothstep(0.30, 0.70, heat));
  colour = mix(colour, vec3(1.4, 1.15, 0.5), smoothstep(0.72, 1.1, heat));
  return vec4(colour, 0.94 * smoothstep(0.03, 0.38, heat));
}

vec4 scorch(vec2 p, float seed, float time, float strength) {
  float grain = noise(p * 0.18 + seed * 9.0);
  float reach = length(p) / (0.35 + 0.65 * strength);
  float alpha = 0.9 * smoothstep(1.0, 0.35, reach + 1.1 * (grain - 0.5));
  float cell = noise(p * 0.55 + seed * 3.0);
  float glow = smoothstep(0.60, 0.72, cell) * smoothstep(0.8, 0.2, reach) * (0.7 + 0.3 * sin(time * 3.0 + seed * 40.0));
  return vec4(mix(vec3(0.012, 0.010, 0.009), vec3(1.0, 0.20, 0.02), glow * strength), alpha);
}

vec4 smoke(vec2 p, float seed, float age, float strength) {
  float grain = noise(p * 0.14 + vec2(seed * 11.0, seed * 5.0 - 0.25 * age));
  float body = smoothstep(1.0, 0.15, length(p) + 1.3 * (grain - 0.5));
  float alpha = body * strength * smoothstep(0.0, 0.12, age) * pow(1.0 - age, 0.8);
  return vec4(mix(vec3(0.05, 0.045, 0.04), vec3(0.16), age) * (0.5 + grain), alpha);
}

"""

SHOWN = """
vec4 shown(vec2 corner, vec4 life, vec3 place, float time, float strength, vec3 air) {
  vec4 colour;
  if (life.x > 7.5) return soot(place, life.z, strength) * vec4(air, 1.0);
  if (life.x < 0.5) colour = flame(corner, life.y, time, strength);
  else if (life.x < 1.5) colour = scorch(corner, life.y, time, strength);
  else if (life.x < 2.5) colour = smoke(corner, life.y, life.z, strength);
  else if (life.x < 3.5) colour = vec4(1.6, 0.55, 0.08, step(length(corner), 1.0) * step(life.z, 0.95) * step(0.05, \
strength));
  else if (life.x < 4.5) colour = water(place, corner, life.z, time, strength);
  else if (life.x < 5.5) colour = leaf(corner, life.y, life.z);
  else if (life.x < 6.5) colour = paper(corner, life.y, life.z);
  else colour = streak(corner, strength);
  if (life.x > 4.5) colour.a *= step(life.y, strength);  // a weak wind carries less
  if (life.x > 1.5 && (life.x < 2.5 || life.x > 3.5)) colour.rgb *= air;  // light falls on what does not glow
  colour.a *= life.w;
  return colour;
}
"""

EFFECT_FRAG = (
    FRAG_SETS
    + """
layout(location = 0) in vec2 corner;
layout(location = 1) in vec4 life;
layout(location = 2) in vec3 place;
layout(location = 0) out vec4 outLighting;  // the only target: labels, depth and normals stay those of the solid scene

float noise(vec2 p) { return texture(colorTexture, p).r; }
"""
    + FIRE_FRAG
    + WATER_FRAG
    + WIND_FRAG
    + SOOT_FRAG
    + SHOWN
    + """
void main() {
  vec3 air = materialBuffer.baseColor.rgb;
  vec4 colour = shown(corner, life, place, materialBuffer.transmissionRoughness, materialBuffer.transmission, air);
  if (colour.a < (life.x < 0.5 ? 0.10 : 0.02)) discard;  // what is drawn hides flames behind it: do not draw faint rims
  outLighting = colour;
}
"""
)
