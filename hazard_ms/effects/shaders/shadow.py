"""Shader text for soft shadows: what SAPIEN computes, from fewer looks at the shadow map.

SAPIEN takes the mean of 5 x 5 bilinear samples, one texel apart, with a look at four texels for each: 25 looks at 36
texels. These are the same 36 texels in 9 looks, each texel with the sum of its weights: along either axis 1 - t for the
first, t for the last, 1 for those between, where t is the place between two texels.
"""

from __future__ import annotations

PCF = "float ShadowMapPCF("  # where SAPIEN's function begins
SOFT = """float ShadowMapPCF(
    sampler2D shadowTex, vec3 projCoord, float resolution, float searchUV, float filterSize)
{
  vec2 t = fract(projCoord.xy * resolution + 0.5f);
  float shadow = 0.0f;
  for (int i = -2; i <= 2; i += 2) {
    vec2 across = vec2(i < 0 ? 1.0f - t.x : 1.0f, i > 0 ? t.x : 1.0f);
    for (int j = -2; j <= 2; j += 2) {
      vec2 along = vec2(j < 0 ? 1.0f - t.y : 1.0f, j > 0 ? t.y : 1.0f);
      vec4 lit = step(projCoord.z, textureGather(shadowTex, projCoord.xy + filterSize * vec2(i, j) * searchUV));
      shadow += dot(lit.wz, across) * along.x + dot(lit.xy, across) * along.y;
    }
  }
  return shadow / 25.0f;
}
"""
