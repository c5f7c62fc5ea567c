"""Shader text for what fills the space of a scene: water, haze, a layer of smoke.

See surroundings.py for the texture that it reads.

Two places use it. Opaque things are dimmed by what lies between them and the eye, pixel by pixel (IMMERSE): so the tint
grows with the depth, a camera below the surface sees fog, and what is under water is wet and shows ripples of light.
The surface itself (WATER) belongs to the effect pass and adds what it reflects, and foam where the water is shallow: at
its front.
"""

from __future__ import annotations

# index of refraction of SAPIEN's materials, which only ray tracing reads; ours say by their excess how wet they are
DRY_IOR = 1.45
WET_IOR = 0.2  # excess of a thing that is wet all over
CUT_IOR = 9.0  # instead of DRY_IOR where textures show where there is nothing: cut out leaves [ours]

FACTS = """
vec4 hazardFact(int k) { return texelFetch(transmissionTexture, ivec2(k, 0), 0); }

vec4 hazardMap(vec2 place) {  // y: level of the water [m], z: light on the ceiling above
  vec2 within = clamp((place - hazardFact(0).yz) / hazardFact(1).yz, 0.0, 1.0), count = \
vec2(textureSize(transmissionTexture, 0));
  return textureLod(transmissionTexture, (vec2(0.5, 1.5) + within * (count - vec2(1, 2))) / count, 0.0);
}
"""

IMMERSE = (
    FACTS
    + """
const vec3 hazardAbsorption = vec3(1.75, 0.95, 0.90);  // of muddy water [1/m]
const vec3 hazardMurk = vec3(0.075, 0.150, 0.145);

float hazardCaustics(vec2 p, float time) {  // light through waves: bright lines where sines that bend each other meet
#ifdef FAST
  return 0.0;
#else
  vec2 q = p * 5.0;
  float bright = 0.0;
  for (int k = 0; k < 3; ++k) {
    float t = time * (1.1 - 0.23 * float(k));
    q = p * 5.0 + vec2(cos(t - q.x) + sin(t + q.y), sin(t - q.y) + cos(t + q.x));
    bright += 1.0 / length(vec2(sin(q.x + t), cos(q.y + t)) * 9.0 + 0.35);
  }
  return min(bright * 1.1, 2.0) - 0.35;
#endif
}

float hazardSlant(float depth, float far, float above) {  // way through water of what is seen from above it [m]
#ifdef RAYS
  return far * min(depth / max(above, 1e-3), 1.0);
#else
  float across = max(1.0 - above * above / (far * far), 0.0);  // light is refracted, which rays do by themselves
  return depth * inversesqrt(1.0 - 0.5653 * across);  // 1 / 1.33^2
#endif
}

void hazardDrown(inout vec3 albedo, inout vec3 emission, inout float specular, inout float roughness, vec3 place, \
vec3 eye, float up) {
  float level = hazardMap(place.xy).y, depth = level - place.z, far = distance(place, eye);
  float time = hazardFact(0).w, sunk = hazardMap(eye.xy).y - eye.z, path = 0.0;
  float wet = clamp((materialBuffer.ior - (materialBuffer.ior > 8.5 ? 9.0 : 1.45)) * 5.0, 0.0, 1.0);
  float splashed = 0.035 + 0.015 * sin(place.x * 9.0 + 2.0 * sin(place.y * 7.0)) + 0.010 * sin(place.y * 23.0 + \
place.x * 19.0);
  if (level > 0.0) wet = max(wet, 1.0 - smoothstep(0.6 * splashed, splashed, -depth));
  albedo *= mix(1.0, 0.55, wet);
  specular = max(specular, 0.045 * wet);
  roughness = mix(roughness, min(roughness, 0.22), wet);
  if (depth > 0.0) path = sunk > 0.0 ? far : hazardSlant(depth, far, eye.z - place.z);
  else if (sunk > 0.0) path = far * min(sunk / max(place.z - eye.z, 1e-3), 1.0);
  float lit = smoothstep(0.0, 0.12, depth) * (0.35 + 0.65 * max(up, 0.0));
  if (depth > 0.0) albedo *= 1.0 + lit * hazardCaustics(place.xy + 0.3 * place.z, time);
  vec3 rim = vec3(0.29, 0.35, 0.35) * hazardFact(4).y;  // of the water
  emission += rim * smoothstep(0.010, 0.0, abs(depth - 0.002)) * step(0.03, level);
  vec3 seen = exp(-hazardAbsorption * path);
  albedo *= seen * exp(-hazardAbsorption * 0.5 * max(depth, 0.0));
  emission = emission * seen + hazardMurk * (1.0 - seen) * hazardFact(4).y / 0.55;  // as light as the air above
  specular *= seen.g * (depth > 0.0 ? 0.3 : 1.0);
}

float hazardDust(vec3 place, vec3 eye, float far) {  // how much dust the wind drives between eye and place, in \
clouds near the ground
#ifdef FAST
  return 0.0;
#else
  vec2 drift = vec2(hazardFact(2).w, hazardFact(3).w);
  float dust = 0.0, reach = min(far, 18.0);
  for (int k = 0; k < 3; ++k) {
    vec3 p = mix(eye, place, (0.2 + 0.35 * float(k)) * reach / far);
    vec2 q = p.xy - drift;
    float broad = sin(0.61 * q.x + 1.4 * sin(0.47 * q.y + 0.3 * q.x)) * sin(0.53 * q.y - 1.2 * sin(0.39 * q.x));
    float fine = sin(2.3 * q.x + 1.9 * q.y + 1.7 * p.z) * sin(2.1 * q.y - 1.6 * q.x);
    float gust = 1.0 + 0.6 * sin(0.42 * q.x + 0.31 * q.y);  // gusts carry more of it
    dust += max(broad + 0.45 * fine, 0.0) * gust * exp(-max(p.z, 0.0) / 0.7);
  }
  return dust * reach * 2.2;
#endif
}

void hazardVeil(inout vec3 albedo, inout vec3 emission, inout float specular, vec3 veil, float seen) {
  albedo *= seen;
  emission = emission * seen + veil * (1.0 - seen);
  specular *= seen;
}

void hazardImmerse(inout vec3 albedo, inout vec3 emission, inout float specular, inout float roughness, vec3 place, \
vec3 eye, float up) {
  vec4 air = hazardFact(2), smoke = hazardFact(3);
  float below = hazardFact(5).y;
  float far = distance(place, eye);
  if (air.y > 0.0) hazardDrown(albedo, emission, specular, roughness, place, eye, up);
  if (smoke.z > 0.0 || below > 0.0) {  // Beer and Lambert: what lies in the layer of smoke and below it
    float low = min(place.z, eye.z), high = max(place.z, eye.z);
    float share = clamp((high - smoke.y) / max(high - low, 1e-3), 0.0, 1.0);
    hazardVeil(albedo, emission, specular, vec3(0.045, 0.042, 0.040), exp(-(smoke.z * share + below * (1.0 - share)) * \
far));
  }
  if (air.z > 0.0) hazardVeil(albedo, emission, specular, hazardFact(4).yzw, exp(-air.z * (far + hazardDust(place, \
eye, far))));
}

bool hazardSurrounded() { return (materialBuffer.textureMask & 32) != 0; }

vec3 hazardWorld(vec4 view) { return (cameraBuffer.viewMatrixInverse * vec4(view.xyz, 1)).xyz; }

float hazardUp(vec3 normal) { return dot(normal, cameraBuffer.viewMatrix[2].xyz); }
"""
)

IMMERSE_DEFERRED = """
  if (hazardSurrounded()) {
    vec3 hazardGlow = outEmission.rgb * outEmission.a, hazardEye = cameraBuffer.viewMatrixInverse[3].xyz;
    hazardImmerse(outAlbedo.rgb, hazardGlow, outSpecular.r, outSpecular.g, hazardWorld(inPosition), hazardEye, \
hazardUp(outNormal.xyz));
    outEmission = vec4(hazardGlow, 1.0);
  }
"""

IMMERSE_FORWARD = """
  if (hazardSurrounded()) {
    vec3 hazardEye = cameraBuffer.viewMatrixInverse[3].xyz;
    hazardImmerse(albedo.rgb, emission.rgb, specular, roughness, hazardWorld(inPosition), hazardEye, hazardUp(normal));
  }
"""

WATER = (
    FACTS
    + """
vec3 mirrored(vec3 place, vec3 toward) {  // what the surface reflects: ceiling and walls, or the sky
  float ceiling = hazardFact(1).w;
  if (ceiling <= 0.0) {
    float sun = pow(max(dot(toward, normalize(vec3(-0.4, -0.6, 1.0))), 0.0), 220.0);
    return mix(vec3(0.50, 0.56, 0.62), vec3(0.30, 0.40, 0.55), smoothstep(0.0, 0.8, toward.z)) + 6.0 * sun;
  }
  vec2 corner = hazardFact(0).yz, size = hazardFact(1).yz;
  vec2 hit = place.xy + toward.xy * (ceiling - place.z) / max(toward.z, 0.04);
  vec2 beyond = max(corner - hit, hit - corner - size);
  float wall = smoothstep(0.0, 0.6, max(beyond.x, beyond.y));
  return mix(vec3(0.60, 0.62, 0.62) * hazardMap(hit).z, vec3(0.34, 0.33, 0.30), wall);
}

vec4 water(vec3 place, vec2 flow, float way, float time, float strength) {
  vec3 eye = cameraBuffer.viewMatrixInverse[3].xyz, toEye = normalize(eye - place);
  float depth = place.z, far = distance(eye, place), crest = 7.5 * way - 2.2 * time;
  vec4 broad = texture(colorTexture, place.xy * 0.27 + vec2(0.021, -0.034) * time);
  vec4 fine = texture(colorTexture, place.yx * 0.71 + vec2(-0.047, 0.039) * time);
  float front = depth - 0.008 * broad.b;
  if (front <= 0.0 || hazardMap(place.xy).y <= 0.0) return vec4(0);  // a surface at its mean is there where it is wet
  float calm = smoothstep(0.0, 0.05, depth);
  vec2 tilt = (0.30 * (broad.rg - 0.5) + 0.22 * (fine.gr - 0.5) + 0.022 * flow * cos(crest + 5.0 * broad.b)) * \
mix(0.5, 1.0, calm);
  vec3 normal = normalize(vec3(-tilt, 1.0));
  bool below = toEye.z < 0.0;
  float facing = max(dot(below ? -normal : normal, toEye), 0.0);
  float fresnel = 0.03 + 0.97 * pow(1.0 - facing, 5.0);
  vec3 murk = vec3(0.075, 0.150, 0.145);
  if (below) {
    float seen = exp(-0.95 * far);
    float window = smoothstep(0.62, 0.75, facing);  // beyond 41 degrees the surface is a mirror from below
    vec3 colour = mix(murk * 1.6, vec3(0.55, 0.68, 0.68), window * (0.4 + 0.6 * fine.b));
    return vec4(mix(murk, colour, seen), mix(0.93, 0.45, window * seen));
  }
  vec3 toward = reflect(-toEye, normal);
  toward.z = abs(toward.z);
  vec3 colour = mirrored(place, toward);
  float body = 0.04 + 0.10 * calm * (broad.b + fine.b - 0.6);  // scattered light in the crests
  float alpha = mix(body, 1.0, fresnel);
  colour = mix(vec3(0.20, 0.30, 0.30), colour, fresnel / max(alpha, 1e-3));
  float cells = texture(colorTexture, place.xy * 0.9 + flow * 0.12 * sin(time * 0.7) + 0.05 * tilt).b;
  float edge = 1.0 - smoothstep(0.0, 0.016, front);
  float trail = smoothstep(0.64, 0.80, cells + 0.10 * sin(crest)) * (1.0 - smoothstep(0.016, 0.075, depth));
  float foam = clamp(max(edge * smoothstep(0.15, 0.60, cells + 0.5 * edge), 0.75 * trail), 0.0, 1.0);
  colour = mix(colour, vec3(0.62, 0.66, 0.66) * (0.75 + 0.5 * cells), foam);
  alpha = mix(alpha, 0.88, foam) * smoothstep(0.0, 0.003, front);
  return vec4(colour, alpha * strength);
}
"""
)
