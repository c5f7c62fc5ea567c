"""Shader text for heat shimmer: hot air above what burns bends the picture of what is behind it.

Colours only, and raster pictures only.

A pass of its own (AIR_VERT, AIR_FRAG) adds up, per pixel, how much hot air there is and which way it bends light; the
last pass of the pack then looks up the lit picture a little beside each such pixel (BEND). A shader cannot read the
picture that it draws to, so the pass that draws flames could not. Ray-traced pictures and the fast pack do without.

Blending multiplies what is written by its own alpha, and what was there by the rest: so with a small alpha layers add
up, whatever their order. Quads are drawn at the near plane, where none hides another; BEND leaves alone what is nearer
than the air. A corner carries what one of the effect pass does, see shaders/common.py.
"""

from __future__ import annotations

from hazard_ms.effects.shaders.common import FRAG_SETS, QUAD_VERT

AIR_VERT = (
    QUAD_VERT
    + """
layout(location = 0) out vec2 outCorner;  // -1..1, 0..1
layout(location = 1) out vec2 outPlace;  // in the quad [m]
layout(location = 2) out vec2 outLife;  // seed; distance along the camera's axis [m]

void main() {
  mat4 camera = cameraBuffer.viewMatrixInverse;
  vec3 anchor = objectTransformBuffer.modelMatrix[3].xyz + position;
  vec3 up = normalize(vec3(0, 0, 1) + 0.45 * camera[1].xyz);  // leans back a little, as flames do
  vec3 across = normalize(cross(up, camera[3].xyz - anchor));
  outCorner = uv;
  outPlace = uv * normal.xy;
  vec4 view = cameraBuffer.viewMatrix * vec4(anchor + across * outPlace.x + up * outPlace.y, 1);
  outLife = vec2(fract(normal.z), -view.z);
  gl_Position = cameraBuffer.projectionMatrix * view;
  gl_Position.z = 0.0;
}
"""
)

AIR_FRAG = (
    FRAG_SETS
    + """
layout(location = 0) in vec2 corner;
layout(location = 1) in vec2 place;
layout(location = 2) in vec2 life;
layout(location = 0) out vec4 outBend;  // x, y: how far beside itself what lies behind is seen [share of the picture]
layout(location = 1) out vec4 outAir;  // x: how much hot air, y: that times its distance [m]

const float bend = 0.018;  // of what is far behind the hottest air, as if it lay beside it [m]
const float rise = 1.3;  // of eddies [m/s]

vec2 eddies(vec2 p, float seed) {  // sines that bend each other: smooth, never the same twice; -1..1
  vec2 q = 1.4 * p + seed * vec2(37.0, 91.0);
  float x = sin(23.0 * q.y + 1.9 * sin(11.0 * q.x + 5.0 * q.y)) + 0.6 * sin(47.0 * q.y - 19.0 * q.x + 2.3 * sin(9.0 * \
q.y));
  float y = sin(17.0 * q.x + 2.1 * sin(13.0 * q.y - 4.0 * q.x)) + 0.6 * sin(31.0 * q.x + 29.0 * q.y);
  return vec2(x, 0.6 * y) / 1.6;
}

void main() {
  float body = 1.0 - corner.x * corner.x, strength = materialBuffer.transmission;
  float hot = strength * body * body * smoothstep(0.0, 0.12, corner.y) * (1.0 - corner.y) * smoothstep(0.3, 0.9, \
life.y);
  if (hot < 0.01) discard;
  vec2 eddy = eddies(place - vec2(0.0, rise * materialBuffer.transmissionRoughness), life.x);
  vec2 way = eddy * bend * 0.5 * vec2(cameraBuffer.projectionMatrix[0][0], cameraBuffer.projectionMatrix[1][1]) / \
life.y;
  const float alpha = 0.1;
  outBend = vec4(hot * way / alpha, 0.0, alpha);
  outAir = vec4(hot / alpha, hot * life.y / alpha, 0.0, alpha);
}
"""
)

BEND = """
float hazardFar(vec2 at) {  // distance of what is solid along the camera's axis [m]
  float z = texture(samplerPositionRaw, at).z;
  return z < 0.0 ? -z : 1000.0;
}

vec4 hazardLit(vec2 at) {  // between pixels, too
  ivec2 last = textureSize(samplerLighting, 0) - 1;
  vec2 pixel = at * vec2(last + 1) - 0.5;
  ivec2 low = ivec2(floor(pixel));
  vec2 part = pixel - vec2(low);
  ivec2 near = clamp(low, ivec2(0), last), far = clamp(low + 1, ivec2(0), last);
  vec4 upper = mix(texelFetch(samplerLighting, near, 0), texelFetch(samplerLighting, ivec2(far.x, near.y), 0), part.x);
  vec4 lower = mix(texelFetch(samplerLighting, ivec2(near.x, far.y), 0), texelFetch(samplerLighting, far, 0), part.x);
  return mix(upper, lower, part.y);
}

vec4 hazardBent(vec2 at) {  // the lit picture through hot air
  vec2 air = texture(samplerAir, at).xy;
  if (air.x <= 0.0) return texture(samplerLighting, at);
  float away = air.y / air.x, behind = clamp(hazardFar(at) - away, 0.0, 1.0);  // [m]: the longer the way from there, \
the more
  vec2 there = at + texture(samplerBend, at).xy * behind;
  if (behind <= 0.0 || hazardFar(there) < away) return texture(samplerLighting, at);
  return hazardLit(there);
}
"""
