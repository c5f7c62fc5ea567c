"""Shader text for foliage that sways in the wind. Colours only, and raster pictures only.

Trees and hedges are drawn a second time, bent (SWAY_VERT), in a pass of its own that writes, per pixel, how far beside
itself what is seen there stands when there is no wind; the last pass of the pack looks up the lit picture there
(STILL). Labels, depth and normals, which the other passes have written, stay those of a tree at rest. So do its shadow
and its light.

What a bent tree uncovers is not in the picture. There, the last pass shows what stands beside the tree: boxes around
trees, drawn behind all that is bent, tell it how far. Corners of both carry

    position  foot of the tree, world frame [m]: the corners coincide, so no other pass sees them
    normal    the place on the tree [m], from its foot
    uv        (height of the tree [m], its label, negative for the box around it)

and the entity's pose the wind: x, y its heading times its strength 0..1, z the time [s]; below HIDDEN there is no wind.
"""

from __future__ import annotations

from hazard_ms.effects.shaders.common import FRAG_SETS, QUAD_VERT

HIDDEN = -500.0  # [m]
REACH = (0.15, 0.04)  # by which the top of a tree bends at most [m], and as a share of its height [ours]

SWAY_VERT = (
    QUAD_VERT
    + f"""
const float hidden = {HIDDEN};
const vec2 reach = vec2({REACH[0]}, {REACH[1]});
"""
    + """
layout(location = 0) out vec4 outStill;  // where it is seen when there is no wind
layout(location = 1) out vec4 outBent;  // where the wind bends it to
layout(location = 2) out flat float outLabel;

vec3 bend(vec3 foot, vec3 place, float height, vec2 wind, float time) {  // [m]
  float strength = length(wind), rise = clamp(place.z / height, 0.0, 1.0), turn = 6.2831853 * time;
  vec2 along = wind / max(strength, 1e-6);
  float wave = 0.6 * dot(foot.xy, along);  // gusts run along the wind
  float slow = 0.30 + 0.43 * sin(0.37 * turn - wave) + 0.15 * sin(0.83 * turn - 1.7 * wave);
  float leaves = 0.12 * sin(2.3 * turn + dot(place, vec3(5.0, 7.0, 4.0)) - wave);
  float beside = 0.14 * sin(0.53 * turn - wave + 2.0) + 0.08 * sin(2.9 * turn + dot(place, vec3(6.0, -5.0, 7.0)));
  vec2 way = along * (slow + leaves) + vec2(-along.y, along.x) * beside;
  return vec3(way * strength * min(reach.x, reach.y * height) * pow(rise, 1.5), 0.0);
}

void main() {
  vec3 wind = objectTransformBuffer.modelMatrix[3].xyz, place = position + normal;
  mat4 seen = cameraBuffer.projectionMatrix * cameraBuffer.viewMatrix;
  outStill = seen * vec4(place, 1);
  outBent = seen * vec4(place + bend(position, normal, uv.x, wind.xy, wind.z), 1);
  outLabel = uv.y;
  gl_Position = uv.y > 0.0 ? outBent : outStill;
  gl_Position.z = gl_Position.z * 0.2 + (uv.y > 0.0 ? 0.0 : 0.25 * gl_Position.w);  // before all that is solid: \
STILL tells what hides it
  if (wind.z < hidden) gl_Position = vec4(0.0, 0.0, -1.0, 1.0);
}
"""
)

SWAY_FRAG = (
    FRAG_SETS
    + """
layout(location = 0) in vec4 still;
layout(location = 1) in vec4 bent;
layout(location = 2) in flat float label;
layout(location = 0) out vec4 outSway;  // x, y: how far beside itself it stands when still [share of the picture]; \
z: label

void main() {
  if (materialBuffer.transmission <= 0.0) discard;
  outSway = vec4(0.5 * (still.xy / still.w - bent.xy / bent.w), label, 1.0);
}
"""
)

STILL = """
int hazardLabel(vec2 at) { return int(texture(samplerSegmentation, at).y); }

vec2 hazardStill(vec2 at) {  // where what the wind shows here stands when it is still
  vec4 sway = texture(samplerSway, at);
  int tree = int(abs(sway.z) + 0.5);
  if (tree == 0) return at;
  vec2 there = at + sway.xy;
  bool here = hazardLabel(at) == tree, treeThere = hazardLabel(there) == tree;
  bool behind = hazardFar(at) > hazardFar(there);
  if (sway.z > 0.0) return treeThere && (here || behind) ? there : at;
  return here && !treeThere && !behind ? there : at;
}

vec4 hazardSeen(vec2 at) {
  vec2 there = hazardStill(at), size = vec2(textureSize(samplerLighting, 0));
  if (there == at) return hazardBent(at);
  vec2 pixel = there * size - 0.5, low = floor(pixel);
  return hazardLit((low + smoothstep(0.2, 0.8, pixel - low) + 0.5) / size);  // leaves stay sharp, and move smoothly
}
"""
