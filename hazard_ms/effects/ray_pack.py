"""The ray-tracing shader pack with our effects, derived at run time from that of the installed SAPIEN, like those of shader_pack.py.

What changes: shadow rays pass flames, smoke and water; quads of effects let through what they do not show, all that a ray meets in one
traversal; opaque things char, get wet and are dimmed by water, haze and smoke, piece by piece of each path, and leaves are cut out; the
last bounce sees ambient light, so that closed rooms have some; albedo and normals for the denoiser are means over all samples, those
behind effects. Spot lights and shining surfaces, which no task has, give no light.

For speed on a CPU, without bias: each hit asks one light, drawn by what it may give; paths that carry little end by chance; all bounces of
all samples are one loop, since pixels are traced in step and would wait for the longest path; threads share the picture row by row.

A quad of ray_geometry.py carries in its normals (kind + seed, age or light, strength), in uv the corner, and its material's
transmission_roughness is EFFECT + time [s]; of water it is WATER.
"""

from __future__ import annotations

import logging
from functools import cache

import sapien

from hazard_ms.effects import ray_glsl as glsl
from hazard_ms.effects import shader_pack
from hazard_ms.effects.shader_pack import UnknownSapienError

NAME, STOCK = "rt_hazard", "rt"  # of our pack, and of SAPIEN's own

_log = logging.getLogger(__name__)


def shows_effects() -> bool:
    """Whether ray-traced pictures go through our pack, not through that of a SAPIEN that is unknown to us."""
    return ray_pack() != str(shader_pack.stock_packs() / STOCK)


@cache
def ray_pack() -> str:
    """The pack as SAPIEN's cameras take it: its folder, made if need be; SAPIEN's own where that is unknown to us."""
    stock = shader_pack.stock_packs()
    try:
        return str(shader_pack._write(NAME, _derive(shader_pack._texts(stock / STOCK))))
    except (UnknownSapienError, OSError) as fault:
        _log.warning("no effects in ray-traced pictures: cannot derive a shader pack from SAPIEN %s (%s)", sapien.__version__, fault)
        return str(stock / STOCK)


def _derive(files: dict[str, str]) -> dict[str, str]:
    """SAPIEN's files with our text in them. Raises UnknownSapienError where they are not as expected."""
    files = _passing(files)
    files = _before(files, "camera.rchit", "void main() {", glsl.HIT + glsl.LIT)
    files = _before(files, "camera.rchit", "  if (ti.diffuse >= 0) {", glsl.SHARPNESS)
    files = _all(
        files,
        "camera.rchit",
        "baseColorAlpha = texture(textures[nonuniformEXT(ti.diffuse)]",
        "baseColorAlpha = textureLod(textures[nonuniformEXT(ti.diffuse)]",
    )
    files = _all(
        files, "camera.rchit", "mat.textureTransforms[0].xy);\n    baseColor =", "mat.textureTransforms[0].xy, sharpness);\n    baseColor ="
    )
    files = _before(files, "camera.rchit", "  transmission = clamp(transmission, 0.0, 1.0);", glsl.SOLID)
    files = _before(files, "camera.rchit", "  ray.origin = worldPosition;\n  ray.direction = L;", glsl.LAST)
    files = _all(files, "camera.rchit", glsl.LIGHTS, f" + hazardLit({glsl.SURFACE})")
    files = _before(files, "ray.glsl", "  uint seed;\n", glsl.CARRIED)
    files = _all(files, "camera.rchit", glsl.SCATTERED, glsl.SCATTERED + "    ray.dull = true;\n")
    files = _all(files, "camera.rchit", glsl.MIRRORED, glsl.MIRRORED + f"    ray.dull = roughness > {glsl.SMOOTH};\n")
    mark = f"  ray.segmentation.w = mat.transmissionRoughness >= {glsl.WATER} ? 2u : 0u;\n"
    label = "  ray.segmentation = obj.segmentation;\n"
    files = _all(files, "camera.rchit", label, label + mark)
    return _generation(files)


def _passing(files: dict[str, str]) -> dict[str, str]:
    """Rays that pass quads of effects, and note what these show; balls of point clouds, which no task has, shine by themselves."""
    name = "camera.rahit"
    own = "layout(set = 1, binding = 1) readonly buffer GeometryInstances"
    start, end = files.get(name, "").find(own), files.get(name, "").find("void main() {")
    if not 0 < start < end:
        raise UnknownSapienError(f"{name} has no {own!r} before its main function")
    files = files | {name: files[name][:start] + glsl.PASSED + files[name][end:]}
    files = _before(files, name, "  bool isInside", glsl.VEIL)
    files = _all(files, "point.rchit", f"emission{glsl.LIGHTS}", "baseColor")
    main = "void main() {"
    for name, far in (("camera.rchit", "gl_HitTEXT"), ("point.rchit", "gl_HitTEXT"), ("camera.rmiss", glsl.SKY)):
        files = _all(files, name, main, f"{main}\n  ray.far = {far};")
    sky = "vec3 dir = ray.direction"
    return _all(files, "camera.rmiss", sky, f"{sky} * {glsl.DOME} + gl_WorldRayOriginEXT")  # the horizon where raster pictures have it


def _generation(files: dict[str, str]) -> dict[str, str]:
    """The paths' beginnings: guides for the denoiser are means over all samples, behind effects."""
    name = "camera.rgen"
    pixel = files.get(name, "").replace("gl_LaunchIDEXT", "hazardPixel")
    files = _before(files | {name: pixel}, name, "  vec2 invScreen", glsl.PIXEL_OF_RAY)
    files = _before(files, name, "      traceRayEXT(tlas,", "      ray.veils = 0;\n")
    files = _before(files, name, "      radiance += ray.radiance * attenuation;", glsl.FRONT)
    files = _before(files, name, "  ray.seed = seed;", "  vec3 guideAlbedo = vec3(0.0), guideNormal = vec3(0.0);\n")
    for old, new in ((glsl.EACH, glsl.ANY), (glsl.BOUNCES, glsl.BEGUN), (glsl.ENDED, glsl.STEP)):
        files = _all(files, name, old, new)
    files = _before(files, name, "      if (first) {", glsl.GUIDE)
    files = _all(files, name, "      if (first) {", "      if (!labelled && ray.segmentation.w == 0u) {\n        labelled = true;")
    for word in ("Normal", "Albedo"):
        lines = [line for line in files[name].splitlines() if f"imageStore(out{word}," in line]
        if len(lines) != 1:
            raise UnknownSapienError(f"{name} stores {word} {len(lines)} times, not once")
        files = _all(files, name, lines[0] + "\n", "")
    place = "vec4(position.xyz, ndc.z / ndc.w)"
    files = _all(files, name, place, f"ray.far < {glsl.SKY} ? {place} : vec4(0.0)")  # nothing is nowhere, as in raster pictures
    stores = "".join(f"  imageStore(out{word}, ivec2(hazardPixel), vec4(guide{word} / spp, 1.0));\n" for word in ("Normal", "Albedo"))
    return _before(files, name, "  radiance /= spp;", stores)


def _before(files: dict[str, str], name: str, mark: str, text: str) -> dict[str, str]:
    return files | {name: shader_pack._insert(files, name, mark, text)}


def _all(files: dict[str, str], name: str, old: str, new: str) -> dict[str, str]:
    if old not in files.get(name, ""):
        raise UnknownSapienError(f"{name} has no {old!r}")
    return files | {name: files[name].replace(old, new)}
