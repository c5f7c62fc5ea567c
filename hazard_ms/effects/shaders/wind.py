"""Shader text for what the wind carries: leaves, paper, streaks of fast air. All of it belongs to the effect pass.

What flies repeats itself every BOX metres, and each camera sees the copy around it: so the air is full everywhere, for
few corners. It is carried by the entity's pose, the one thing that reaches the vertex shader: x, y is how far the wind
has blown [m], z the time [s], the turn about z the heading.
"""

from __future__ import annotations

BOX = 18.0  # [m]

WIND_VERT = (
    f"""
const float box = {BOX};
"""
    + """
vec3 tumbling(float seed, float time, vec3 axis, out vec3 along) {  // an edge that turns about a turning axis
  vec3 side = normalize(cross(axis, vec3(0.3, 0.5, 0.81)));
  float angle = time * (2.0 + 4.0 * fract(seed * 53.0)) + 6.28 * fract(seed * 31.0);
  along = cross(axis, side) * cos(angle) + axis * sin(angle);
  return side;
}

float gustFront(vec2 at, vec2 drift, vec2 heading) {  // 0 to 1: gusts stand across the wind and travel with it
  vec2 way = at - drift;
  return 0.5 + 0.5 * sin(0.42 * dot(way, heading) + 1.2 * sin(0.23 * dot(way, vec2(-heading.y, heading.x))));
}

void carry(float kind, float seed, vec3 home, mat4 model, vec3 eye, out vec3 anchor, out vec3 across, out vec3 up, \
out float shade) {
  float time = model[3].z, one = fract(seed * 17.0), two = fract(seed * 43.0);
  vec2 heading = normalize(model[0].xy);
  float pace = kind > 6.5 ? 1.0 : 0.75 + 0.4 * one;
  vec2 at = home.xy + model[3].xy * pace;
  float swing = time * (1.1 + 1.3 * two) + 6.28 * one;
  float gust = kind > 6.5 ? 0.1 : 0.35;
  at += gust * vec2(sin(swing), cos(0.83 * swing + 2.0 * one));
  float height = home.z + (kind > 6.5 ? 0.05 : 0.16 + 0.25 * home.z * two) * (1.0 + sin(1.37 * swing)) * 0.5;
  at = eye.xy + mod(at - eye.xy + 0.5 * box, box) - 0.5 * box;
  anchor = vec3(at, height);
  if (fract(seed * 97.0) > 0.35 + 0.9 * gustFront(at, model[3].xy, heading)) anchor.z = -1e4;  // between two gusts
  vec3 toEye = normalize(eye - anchor), ahead = vec3(heading, 0.05 * sin(swing));
  shade = 1.0;
  if (kind > 6.5) {  // a streak lies along the wind
    across = normalize(cross(ahead, toEye));
    up = ahead;
    return;
  }
  vec3 axis = normalize(vec3(cos(swing * 0.7), sin(swing * 0.7), 0.6 * sin(swing * 0.31)));
  across = tumbling(seed, time, axis, up);
  vec3 normal = cross(across, up);
  shade = 0.45 + 0.55 * abs(dot(normal, vec3(-0.32, -0.49, 0.81)));
}
"""
)

WIND_FRAG = """
vec4 leaf(vec2 p, float seed, float shade) {
  float width = 0.55 * (1.0 - p.y * p.y) * (1.0 - 0.25 * p.y);
  float vein = 1.0 - 0.25 * smoothstep(0.07, 0.0, abs(p.x));
  float sort = fract(seed * 29.0);
  vec3 dead = sort < 0.35 ? vec3(0.30, 0.13, 0.03) : vec3(0.42, 0.26, 0.04);
  vec3 colour = sort < 0.6 ? dead : sort < 0.8 ? vec3(0.20, 0.24, 0.04) : vec3(0.33, 0.06, 0.03);
  return vec4(colour * vein * shade * (0.8 + 0.5 * fract(seed * 71.0)), step(abs(p.x), width));
}

vec4 paper(vec2 p, float seed, float shade) {
  float torn = 0.10 * (noise(p * 0.11 + seed * 7.0) - 0.5);
  float print = step(0.55, fract(p.y * 4.0)) * step(abs(p.x), 0.7) * step(abs(p.y), 0.75);
  return vec4(vec3(0.74, 0.72, 0.66) * shade * (1.0 - 0.22 * print), step(max(abs(p.x), abs(p.y)) + torn, 0.94));
}

vec4 streak(vec2 p, float strength) {
  return vec4(vec3(0.80, 0.80, 0.77), 0.42 * strength * (1.0 - p.x * p.x) * (1.0 - p.y * p.y));
}
"""
