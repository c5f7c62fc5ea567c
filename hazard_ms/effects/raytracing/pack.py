"""The ray-tracing shader pack with our effects, derived at run time from the installed SAPIEN's, like shaders/pack.py.

What changes: shadow rays pass flames, smoke and water; quads of effects let through what they do not show, all that a
ray meets in one traversal; opaque things char, get wet and are dimmed by water, haze and smoke, piece by piece of each
path, and leaves are cut out; the last bounce sees ambient light, so that closed rooms have some; albedo and normals for
the denoiser are means over all samples, those behind effects. Spot lights and shining surfaces, which no task has, give
no light.

For speed on a CPU, without bias: each hit asks one light, drawn by what it may give; paths that carry little end by
chance; all bounces of all samples are one loop, since pixels are traced in step and would wait for the longest path;
threads share the picture row by row.

A quad of raytracing/geometry.py carries in its normals (kind + seed, age or light, strength), in uv the corner, and its
material's transmission_roughness is EFFECT + time [s]; of water it is WATER.
"""

from __future__ import annotations

import logging
from functools import cache

import sapien

from hazard_ms.effects.raytracing import hits, paths
from hazard_ms.effects.shaders import pack
from hazard_ms.effects.shaders.pack import UnknownSapienError

NAME, STOCK = "rt_hazard", "rt"  # of our pack, and of SAPIEN's own

_log = logging.getLogger(__name__)


def shows_effects() -> bool:
    """Whether ray-traced pictures go through our pack; they do not if the installed SAPIEN is unknown to us."""
    return ray_pack() != str(pack.stock_packs() / STOCK)


@cache
def ray_pack() -> str:
    """The folder of the pack, as SAPIEN's cameras take it, made if need be; SAPIEN's own if that is unknown to us."""
    stock = pack.stock_packs()
    try:
        return str(pack.write(NAME, _derive(pack.texts(stock / STOCK))))
    except (UnknownSapienError, OSError) as fault:
        _log.warning(
            "no effects in ray-traced pictures: cannot derive a shader pack from SAPIEN %s (%s)",
            sapien.__version__,
            fault,
        )
        return str(stock / STOCK)


def _derive(files: dict[str, str]) -> dict[str, str]:
    """SAPIEN's files with our text in them. Raises UnknownSapienError where they are not as expected."""
    files = _passing(files)
    files = _before(files, "camera.rchit", "void main() {", hits.HIT + hits.LIT)
    files = _before(files, "camera.rchit", "  if (ti.diffuse >= 0) {", hits.SHARPNESS)
    files = _all(
        files,
        "camera.rchit",
        "baseColorAlpha = texture(textures[nonuniformEXT(ti.diffuse)]",
        "baseColorAlpha = textureLod(textures[nonuniformEXT(ti.diffuse)]",
    )
    files = _all(
        files,
        "camera.rchit",
        "mat.textureTransforms[0].xy);\n    baseColor =",
        "mat.textureTransforms[0].xy, sharpness);\n    baseColor =",
    )
    files = _before(files, "camera.rchit", "  transmission = clamp(transmission, 0.0, 1.0);", hits.SOLID)
    files = _before(files, "camera.rchit", "  ray.origin = worldPosition;\n  ray.direction = L;", hits.LAST)
    files = _all(files, "camera.rchit", hits.LIGHTS, f" + hazardLit({hits.SURFACE})")
    files = _before(files, "ray.glsl", "  uint seed;\n", hits.CARRIED)
    files = _all(files, "camera.rchit", hits.SCATTERED, hits.SCATTERED + "    ray.dull = true;\n")
    files = _all(files, "camera.rchit", hits.MIRRORED, hits.MIRRORED + f"    ray.dull = roughness > {hits.SMOOTH};\n")
    mark = f"  ray.segmentation.w = mat.transmissionRoughness >= {hits.WATER} ? 2u : 0u;\n"
    label = "  ray.segmentation = obj.segmentation;\n"
    files = _all(files, "camera.rchit", label, label + mark)
    return _generation(files)


def _passing(files: dict[str, str]) -> dict[str, str]:
    """Rays that pass quads of effects, and note what these show.

    Balls of point clouds, which no task has, shine by themselves.
    """
    name = "camera.rahit"
    own = "layout(set = 1, binding = 1) readonly buffer GeometryInstances"
    start, end = files.get(name, "").find(own), files.get(name, "").find("void main() {")
    if not 0 < start < end:
        raise UnknownSapienError(f"{name} has no {own!r} before its main function")
    files = files | {name: files[name][:start] + hits.PASSED + files[name][end:]}
    files = _before(files, name, "  bool isInside", hits.VEIL)
    files = _all(files, "point.rchit", f"emission{hits.LIGHTS}", "baseColor")
    main = "void main() {"
    for name, far in (("camera.rchit", "gl_HitTEXT"), ("point.rchit", "gl_HitTEXT"), ("camera.rmiss", paths.SKY)):
        files = _all(files, name, main, f"{main}\n  ray.far = {far};")
    sky = "vec3 dir = ray.direction"
    # the horizon where raster pictures have it
    return _all(files, "camera.rmiss", sky, f"{sky} * {paths.DOME} + gl_WorldRayOriginEXT")


def _generation(files: dict[str, str]) -> dict[str, str]:
    """The paths' beginnings: guides for the denoiser are means over all samples, behind effects."""
    name = "camera.rgen"
    pixel = files.get(name, "").replace("gl_LaunchIDEXT", "hazardPixel")
    files = _before(files | {name: pixel}, name, "  vec2 invScreen", paths.PIXEL_OF_RAY)
    files = _before(files, name, "      traceRayEXT(tlas,", "      ray.veils = 0;\n")
    files = _before(files, name, "      radiance += ray.radiance * attenuation;", paths.FRONT)
    files = _before(files, name, "  ray.seed = seed;", "  vec3 guideAlbedo = vec3(0.0), guideNormal = vec3(0.0);\n")
    for old, new in ((paths.EACH, paths.ANY), (paths.BOUNCES, paths.BEGUN), (paths.ENDED, paths.STEP)):
        files = _all(files, name, old, new)
    files = _before(files, name, "      if (first) {", paths.GUIDE)
    files = _all(
        files,
        name,
        "      if (first) {",
        "      if (!labelled && ray.segmentation.w == 0u) {\n        labelled = true;",
    )
    for word in ("Normal", "Albedo"):
        lines = [line for line in files[name].splitlines() if f"imageStore(out{word}," in line]
        if len(lines) != 1:
            raise UnknownSapienError(f"{name} stores {word} {len(lines)} times, not once")
        files = _all(files, name, lines[0] + "\n", "")
    place = "vec4(position.xyz, ndc.z / ndc.w)"
    # nothing is nowhere, as in raster pictures
    files = _all(files, name, place, f"ray.far < {paths.SKY} ? {place} : vec4(0.0)")
    stores = "".join(
        f"  imageStore(out{word}, ivec2(hazardPixel), vec4(guide{word} / spp, 1.0));\n" for word in ("Normal", "Albedo")
    )
    return _before(files, name, "  radiance /= spp;", stores)


def _before(files: dict[str, str], name: str, mark: str, text: str) -> dict[str, str]:
    return files | {name: pack.insert(files, name, mark, text)}


def _all(files: dict[str, str], name: str, old: str, new: str) -> dict[str, str]:
    if old not in files.get(name, ""):
        raise UnknownSapienError(f"{name} has no {old!r}")
    return files | {name: files[name].replace(old, new)}
