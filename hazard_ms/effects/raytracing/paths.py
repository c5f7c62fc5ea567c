"""Shader text for the paths of light: pixels that are traced together, ends of paths, guides for the denoiser."""

from __future__ import annotations

from hazard_ms.effects.raytracing.hits import CAREFUL

LEAST_KEPT = 0.1  # however little light they carry [ours]
BLOCK, STRIDE = (4, 2), "61u"  # pixels that are traced in step; rows of them between one and the next, a prime [ours]
DOME = "120.0"  # how far the sky is [m]: as the far plane of pictures, on which raster pictures have it
SKY = "1.0e30"  # farther than anything
KEPT = 0.5  # share of paths that are followed after a bounce, for each part of light that they carry [ours]
MOST_WATERS = 2  # the first hit of water's surface uses up no bounce

FRONT = f"""
      for (int k = 0; k < ray.veils; ++k) {{  // effects before what the ray has hit, the nearest first
        int next = -1;
        float near = ray.far;
        for (int j = 0; j < ray.veils; ++j) {{
          if (ray.veilFar[j] < near) {{
            near = ray.veilFar[j];
            next = j;
          }}
        }}
        if (next < 0) break;
        ray.veilFar[next] = {SKY};
        vec2 alpha = unpackHalf2x16(ray.veilShown[next].y);
        vec3 veil = vec3(unpackHalf2x16(ray.veilShown[next].x), alpha.x) * alpha.y;
        radiance += attenuation * veil;
        attenuation *= 1.0 - alpha.y;
        if (!labelled) {{
          guideAlbedo += guideLeft * min(veil, vec3(1));
          guideLeft *= 1.0 - alpha.y;
        }}
      }}
"""

GUIDE = f"""      if (ray.segmentation.w == 2u) {{
        if (maxDepth >= {CAREFUL} && ++waters < {MOST_WATERS}) ray.depth -= 1;
        guideLeft *= 0.9;  // water: what lies below it guides, or what it mirrors
      }} else if (!labelled) {{
        guideAlbedo += guideLeft * min(ray.albedo, vec3(1));
        guideNormal += mat3(cameraBuffer.viewMatrix) * ray.normal;
      }}

"""

# Lanes that work in step take blocks of pixels, and threads, that get one part of the picture each, rows of blocks from
# all over it.
PIXEL_OF_RAY = f"""
  uvec2 hazardPixel = gl_LaunchIDEXT.xy, block = uvec2({BLOCK[0]}, {BLOCK[1]}), blocks = gl_LaunchSizeEXT.xy / block;
  if (gl_LaunchSizeEXT.xy == blocks * block && blocks.y % {STRIDE} != 0u) {{
    uint at = gl_LaunchIDEXT.y * gl_LaunchSizeEXT.x + gl_LaunchIDEXT.x, which = at / (block.x * block.y), lane = at % \
(block.x * block.y);
    hazardPixel = uvec2(which % blocks.x, which / blocks.x * {STRIDE} % blocks.y) * block + uvec2(lane % block.x, \
lane / block.x);
  }}
"""

EACH = "  for (int i = 0; i < spp; ++i) {\n"

ANY = """
  vec3 attenuation = vec3(1.0), guideLeft = vec3(1.0);
  bool labelled = false, alive = false;
  int waters = 0;
  float turn = rnd(ray.seed);
  for (int i = 0; i < spp || alive;) {  // one loop for all bounces of all samples: a path that ends early makes room \
for the next
    if (!alive) {
"""

BOUNCES = "    vec3 attenuation = vec3(1.0);\n    for (ray.depth = 0; ray.depth <= maxDepth; ++ray.depth) {\n"

BEGUN = """
    attenuation = guideLeft = vec3(1.0);
    labelled = false;
    waters = 0;
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
      float kept = clamp({KEPT} * left, {LEAST_KEPT}, 1.0);
      alive = rnd(ray.seed) < kept;
      attenuation /= kept;
    }}
"""
