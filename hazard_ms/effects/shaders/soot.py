"""Shader text for soot on walls and ceiling, which belongs to the effect pass; see effects/soot.py.

Of a quad, normal is (x, y [m], kind) and uv (z [m], extent of the map [m]); the material's transmission is the height
of the ceiling [m], and its texture holds noise in red and the amount of soot, 0..1, over the floor in green.
"""

from __future__ import annotations

SOOT_FRAG = """
vec4 soot(vec3 place, float extent, float ceiling) {
  float amount = textureLod(colorTexture, place.xy / extent, 0.0).g;
  if (amount < 0.02) return vec4(0);
  bool above = place.z > ceiling - 0.02;
  vec2 at = above ? 0.13 * place.xy : vec2(0.13 * (place.x + place.y), 0.06 * place.z);  // streaks on walls
  float broad = textureLod(colorTexture, at, 0.0).r, fine = textureLod(colorTexture, 4.3 * at.yx + 0.37, 0.0).r;
  float grain = 0.65 * broad + 0.35 * fine;
  float low = ceiling * (1.0 - 0.95 * amount);  // on walls it hangs down from the ceiling, the deeper the more there is
  float hung = above ? 1.0 : smoothstep(low - 0.35, low + 0.75, place.z + 0.9 * (grain - 0.5));
  float alpha = clamp(1.5 * amount * (0.35 + grain) - 0.06, 0.0, 0.93) * hung;
  return vec4(vec3(0.020, 0.017, 0.015) * (0.6 + 0.8 * fine), alpha);
}
"""
