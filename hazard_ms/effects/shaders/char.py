"""Shader text for charring: opaque things blacken patch by patch, and the rim of a patch glows.

The transmission_roughness of a thing's materials holds its char code: 0 untouched, else 1 + floor(255 char) + glow,
with char in 0..1 and glow in [0, 1).
"""

from __future__ import annotations

CHAR = """
float hazardHash(vec3 p) {
  p = fract(p * vec3(0.1031, 0.1030, 0.0973));
  p += dot(p, p.yzx + 33.33);
  return fract((p.x + p.y) * p.z);
}

float hazardNoise(vec3 p) {
  vec3 i = floor(p), f = fract(p);
  f = f * f * (3.0 - 2.0 * f);
  vec4 low = vec4(hazardHash(i), hazardHash(i + vec3(1, 0, 0)), hazardHash(i + vec3(0, 1, 0)), hazardHash(i + vec3(1, \
1, 0)));
  i.z += 1.0;
  vec4 high = vec4(hazardHash(i), hazardHash(i + vec3(1, 0, 0)), hazardHash(i + vec3(0, 1, 0)), hazardHash(i + \
vec3(1, 1, 0)));
  vec4 plane = mix(low, high, f.z);
  vec2 edge = mix(plane.xy, plane.zw, f.y);
  return mix(edge.x, edge.y, f.x);
}

// Blackens patch by patch; the rim of a patch glows.
void hazardChar(inout vec3 albedo, inout vec3 emission, inout float specular, inout float roughness, vec3 place) {
  float code = materialBuffer.transmissionRoughness - 1.0;
  float charred = floor(code) / 255.0, glow = fract(code);
  float patches = 0.62 * hazardNoise(place * 13.0 + 7.0) + 0.26 * hazardNoise(place * 31.0 + 3.0) + 0.12 * \
hazardNoise(place * 83.0);
  float front = charred * 1.25 - 0.12;
  float black = smoothstep(patches - 0.10, patches + 0.06, front);
  vec3 toasted = albedo * mix(vec3(1.0), vec3(0.55, 0.40, 0.28), smoothstep(0.0, 0.35, charred));
  albedo = mix(toasted, vec3(0.016, 0.014, 0.013) * (0.4 + 1.2 * patches), black);
  float rim = exp(-pow((front - patches) * 24.0, 2.0));
  emission += glow * (rim * vec3(1.3, 0.30, 0.03) + black * vec3(0.05, 0.010, 0.0));
  specular *= 1.0 - 0.8 * black;
  roughness = mix(roughness, 0.95, black);
}

bool hazardTouched() { return materialBuffer.transmissionRoughness >= 1.0; }

vec3 hazardPlace() {  // on the thing [m], whatever the scale of its mesh
  mat3 model = mat3(objectTransformBuffer.modelMatrix);
  return objectCoord * vec3(length(model[0]), length(model[1]), length(model[2]));
}
"""

CHAR_DEFERRED = """
  if (hazardTouched()) {
    vec3 hazardGlow = outEmission.rgb * outEmission.a;
    hazardChar(outAlbedo.rgb, hazardGlow, outSpecular.r, outSpecular.g, hazardPlace());
    outEmission = vec4(hazardGlow, 1.0);
  }
"""

CHAR_FORWARD = """
  if (hazardTouched()) {
    emission = vec4(emission.rgb * emission.a, 1.0);
    hazardChar(albedo.rgb, emission.rgb, frm.x, frm.y, hazardPlace());
  }
"""
