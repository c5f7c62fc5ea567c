"""Shader text for the town around a street: a pass that writes colours alone, lit and hazed like the solid scene.

What the pass draws is hidden by the solid scene and hides it in turn, but leaves labels, depth and normals alone. A
corner's normal carries in its length, beyond 1, how far the wind moves it [m]; SKY_LAYER marks clouds, which drift,
and PUDDLE water that mirrors the sky.
The entity's pose is the wind, as in shaders/sway.py: x, y its heading times its strength 0..1, z the time [s]. What
stands firmly has the pose of the world, and nothing in it moves.
"""

from __future__ import annotations

from hazard_ms.effects.shaders.common import QUAD_VERT
from hazard_ms.effects.shaders.water import IMMERSE

PUDDLE, SKY_LAYER = 5.0, 9.0  # lengths of the normals of puddles and of clouds, beyond 1
CLOUD_PACE = 0.02  # by which clouds drift, in widths of their texture a second, in a strong wind [ours]

DRESS_VERT = (
    QUAD_VERT
    + f"""
const float puddle = {PUDDLE - 0.5}, skyLayer = {SKY_LAYER - 0.5}, cloudPace = {CLOUD_PACE};
"""
    + """
layout(location = 0) out vec3 outPlace;  // world frame [m]
layout(location = 1) out vec3 outFacing;
layout(location = 2) out vec2 outUV;
layout(location = 3) out flat float outKind;  // 0: solid, 1: puddle, 2: cloud

void main() {
  vec3 wind = objectTransformBuffer.modelMatrix[3].xyz;
  float loose = max(length(normal) - 1.001, 0.0), strength = min(length(wind.xy), 1.0), turn = 6.2831853 * wind.z;
  vec2 along = wind.xy / max(strength, 1e-6);
  outPlace = position;
  outUV = uv;
  outKind = step(puddle, loose) + step(skyLayer, loose);
  if (outKind > 1.5) {
    outUV -= wind.xy * wind.z * cloudPace;
  } else if (outKind < 0.5 && loose > 0.0) {
    float wave = dot(position, vec3(1.7, 1.3, 0.9)) - 1.1 * turn;
    float gust = 0.55 + 0.35 * sin(0.37 * turn - 0.4 * dot(position.xy, along)) + 0.20 * sin(wave);
    vec2 way = along * gust + vec2(-along.y, along.x) * 0.45 * sin(0.7 * wave + 1.0);
    outPlace += loose * strength * vec3(way, 0.25 * sin(0.9 * wave + 2.0));
  }
  outFacing = normal / max(length(normal), 1e-6);
  gl_Position = cameraBuffer.projectionMatrix * (cameraBuffer.viewMatrix * vec4(outPlace, 1));
}
"""
)

DRESS_FRAG = (  # follows the declarations of the pack's own forward pass
    """
layout(location = 0) in vec3 place;
layout(location = 1) in vec3 facing;
layout(location = 2) in vec2 uv;
layout(location = 3) in flat float kind;
#ifdef FAST
layout(location = 0) out vec4 outColorRaw;
#else
layout(location = 0) out vec4 outLighting;
#endif

void hazardPaint(vec3 colour, float alpha) {
#ifdef FAST
  outColorRaw = vec4(pow(clamp(colour, 0.0, 1.0), vec3(1.0 / 2.2)), alpha);
#else
  outLighting = vec4(colour, alpha);
#endif
}
"""
    + IMMERSE
    + """
float hazardSunlit(vec3 place) {  // 1 in the sun, 0 in a shadow
  if (NUM_DIRECTIONAL_LIGHT_SHADOWS == 0) return 1.0;
  vec4 seen = shadowBuffer.directionalLightBuffers[0].projectionMatrix * \
(shadowBuffer.directionalLightBuffers[0].viewMatrix * vec4(place, 1));
  vec3 at = seen.xyz / seen.w;
  at.xy = at.xy * 0.5 + 0.5;
  if (any(greaterThan(abs(at.xy - 0.5), vec2(0.49)))) return 1.0;
  return step(at.z, textureLod(samplerDirectionalLightDepths[0], at.xy, 0.0).x + 0.001);
}

void main() {
  vec4 albedo = texture(colorTexture, uv);
  vec3 eye = cameraBuffer.viewMatrixInverse[3].xyz, aloft = normalize(facing), toEye = eye - place;
  if (kind > 1.5) {  // lit by the sky that it hides
    float far = length(toEye.xy);
    vec3 sky = textureLod(samplerEnvironment, vec3(0.0, 1.0, 0.0), 4.0).rgb;
    hazardPaint(sky * albedo.rgb, albedo.a * smoothstep(56.0, 24.0, far));
    return;
  }
  if (albedo.a < 0.5) discard;
  if (dot(aloft, toEye) < 0.0) aloft = -aloft;
  vec3 glow = materialBuffer.emission.rgb * materialBuffer.emission.a;
  if ((materialBuffer.textureMask & 16) != 0) glow *= texture(emissionTexture, uv).rgb;
  if (kind > 0.5) {
    toEye = normalize(toEye);
    vec2 ripple = 0.02 * vec2(sin(31.0 * place.x + 17.0 * place.y), sin(23.0 * place.y - 19.0 * place.x));
    vec3 seen = reflect(-toEye, normalize(vec3(ripple, 1.0)));
    float mirror = 0.04 + 0.96 * pow(1.0 - max(toEye.z, 0.0), 4.0);
    glow = mirror * textureLod(samplerEnvironment, vec3(seen.x, abs(seen.z), seen.y), 1.0).rgb;
    albedo.rgb *= 1.0 - mirror;
  }
  float specular = 0.0, roughness = 1.0;
  if (hazardSurrounded()) hazardImmerse(albedo.rgb, glow, specular, roughness, place, eye, aloft.z);
  vec3 light = textureLod(samplerEnvironment, aloft.xzy, 5.0).rgb + sceneBuffer.ambientLight.rgb;
  for (int i = 0; i < NUM_DIRECTIONAL_LIGHTS; ++i) {
    float facing = dot(aloft, -sceneBuffer.directionalLights[i].direction.xyz);
    if (facing > 0.0) light += sceneBuffer.directionalLights[i].emission.rgb * facing * hazardSunlit(place) / 3.1416;
  }
  for (int i = 0; i < NUM_POINT_LIGHTS; ++i) {
    if (sceneBuffer.pointLights[i].emission.r <= 0.0) continue;  // a lamp that is off
    vec3 ray = sceneBuffer.pointLights[i].position.xyz - place;
    float far = dot(ray, ray);
    light += sceneBuffer.pointLights[i].emission.rgb * max(dot(aloft, ray), 0.0) / (3.1416 * far * sqrt(far) + 1e-4);
  }
  hazardPaint(glow + albedo.rgb * light, 1.0);
}
"""
)

SKY_FIRST = """
  if (texture(samplerGbufferDepth, inUV).x == 1.0) {  // the sky: no shadow falls on it
    vec4 hazardFarthest = cameraBuffer.projectionMatrixInverse * vec4(inUV * 2 - 1, 1.0, 1);
    hazardFarthest /= hazardFarthest.w;
    outLighting = vec4(getBackgroundColor((cameraBuffer.viewMatrixInverse * hazardFarthest).xyz), 0.f);
    return;
  }
"""
