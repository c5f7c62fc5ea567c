"""Shader packs with our effects, derived at run time from those of the installed SAPIEN: we ship no text of others.

A pack is a folder of GLSL. Ours is SAPIEN's own, with charring, water and haze added to its opaque pass and a third
pass that draws flames, smoke, the water's surface and what flies into the picture alone; the full one has two more, for
foliage in the wind and for hot air, and bends what is seen of them or through them when it puts the picture together.
It is kept in the user's cache under a hash of all that it is made of, so another SAPIEN makes another pack. If the
installed files are not as expected, pictures are SAPIEN's own, without effects, and labels stay right.
"""

from __future__ import annotations

import logging
import os
import re
from dataclasses import replace
from functools import cache
from pathlib import Path

import sapien
import torch
from mani_skill.render import ShaderConfig
from torch import Tensor

from hazard_ms.effects.shaders.char import CHAR, CHAR_DEFERRED, CHAR_FORWARD
from hazard_ms.effects.shaders.common import EFFECT_FRAG, EFFECT_VERT
from hazard_ms.effects.shaders.dressing import DRESS_FRAG, DRESS_VERT, SKY_FIRST
from hazard_ms.effects.shaders.facing import facing
from hazard_ms.effects.shaders.shadow import PCF, SOFT
from hazard_ms.effects.shaders.shimmer import AIR_FRAG, AIR_VERT, BEND
from hazard_ms.effects.shaders.sway import STILL, SWAY_FRAG, SWAY_VERT
from hazard_ms.effects.shaders.water import IMMERSE, IMMERSE_DEFERRED, IMMERSE_FORWARD
from hazard_ms.spec.checks import one_of
from hazard_ms.spec.storage.cache import kept_folder
from hazard_ms.spec.undocumented import PREBUILT_SHADER_CONFIGS

NAMES = {"full": "hazard", "fast": "hazard-fast", "off": "default"}  # effects mode -> shader pack of the cameras
DRESS_PASS = 2  # shading mode of the town around a street: no stock pack has this pass, so none draws it
EFFECT_PASS = 3  # that of effect geometry, which may hide the town
SWAY_PASS = 4  # that of foliage, in the full pack alone
# that of hot air, in the full pack alone; it comes last, since its quads would hide what is drawn after them
AIR_PASS = 5
SETS = ("camera_set.glsl", "object_set.glsl", "material_set.glsl")
# the fast pack's own name: ManiSkill changes the pixel format of "PositionSegmentation" for the whole process
LABELS = "PositionLabel"
MAIN = "void main() {"

_log = logging.getLogger(__name__)
_warm: dict[str, tuple[sapien.Scene, sapien.render.RenderCameraComponent]] = {}


class UnknownSapienError(RuntimeError):
    """Raised when the installed shader files are not those that we know how to change."""


def shader_config(mode: str) -> str:
    """ManiSkill's name of the shaders of effects `mode` (full, fast, off), registered. Raises ValueError for others."""
    one_of(mode, NAMES, "effects")
    register()
    return NAMES[mode]


def available(mode: str) -> bool:
    """Whether effects of this `mode` can be drawn."""
    return mode != "off" and _pack(NAMES[mode]) is not None


@cache
def register() -> None:
    """Register `shader_pack="hazard"` and `"hazard-fast"` with ManiSkill."""
    full, fast = _pack("hazard"), _pack("hazard-fast")
    stock = PREBUILT_SHADER_CONFIGS["default"]
    formats = {**stock.texture_transforms, "Color": colour}  # bytes or float
    ours = replace(stock, shader_pack=full, texture_transforms=formats) if full else stock
    PREBUILT_SHADER_CONFIGS["hazard"] = ours
    PREBUILT_SHADER_CONFIGS["hazard-fast"] = _fast_config(fast) if fast else PREBUILT_SHADER_CONFIGS["minimal"]


def pack_folder(mode: str) -> str:
    """The pack of effects `mode` (full, fast, off) as SAPIEN's cameras take it: its folder."""
    return str(stock_packs() / PREBUILT_SHADER_CONFIGS[shader_config(mode)].shader_pack)  # absolute stays as it is


def keep_warm(mode: str, device: sapien.Device) -> None:
    """Compile the pack of `mode` once per process, not per scene.

    SAPIEN forgets a pack with its last camera, so one stays alive.
    """
    pack = pack_folder(mode)
    if pack in _warm:
        return
    scene = sapien.Scene([sapien.physx.PhysxCpuSystem(), sapien.render.RenderSystem(device)])
    camera = sapien.render.RenderCameraComponent(16, 16, pack)
    entity = sapien.Entity()
    entity.add_component(camera)
    scene.add_entity(entity)
    scene.update_render()
    camera.take_picture()
    _warm[pack] = (scene, camera)


def _fast_config(pack: str) -> ShaderConfig:
    return ShaderConfig(
        shader_pack=pack,
        texture_names={"Color": ["rgb"], LABELS: ["position", "depth", "segmentation"]},
        texture_transforms={"Color": colour, LABELS: _labels},
    )


def colour(data: Tensor) -> dict[str, Tensor]:
    """The colours in bytes, [..., 3], whatever format the texture "Color", [..., 4], has in this process."""
    seen = data[..., :3]
    return {"rgb": seen if seen.dtype == torch.uint8 else (seen * 255).to(torch.uint8)}


def _labels(data: Tensor) -> dict[str, Tensor]:
    short = data.to(torch.int16)  # [mm], as ManiSkill gives depth and position
    return {"position": short[..., :3], "depth": -short[..., [2]], "segmentation": short[..., [3]]}


@cache
def _pack(name: str) -> str | None:
    """The folder of the pack, made if need be; None if the installed SAPIEN is unknown."""
    stock = stock_packs()
    try:
        base = stock / ("default" if name == "hazard" else "minimal")
        files = texts(base) | {f"../common/{n}": t for n, t in texts(stock / "common").items()}
        files["../common/shadow.glsl"] = insert(files, "../common/shadow.glsl", PCF, "").partition(PCF)[0] + SOFT
        files |= facing(files)
        if name == "hazard":
            files = _full(files)
        else:
            files |= {n: t for n, t in texts(stock / "default").items() if n in SETS}
            files = _fast(files)
        return str(write(name, files))
    except (UnknownSapienError, KeyError, ValueError, OSError) as fault:
        _log.warning(
            "no effects in pictures: cannot derive the shader pack %s from SAPIEN %s (%s)",
            name,
            sapien.__version__,
            fault,
        )
        return None


def _full(files: dict[str, str]) -> dict[str, str]:
    """SAPIEN's deferred pack with charring, water, haze and the effect pass."""
    _known(files, "gbuffer1.frag", "gbuffer1.vert", "deferred.frag", *SETS)
    end = re.compile(r"\}\s*\Z")
    opaque = insert(files, "gbuffer.frag", MAIN, CHAR + IMMERSE)
    files = files | {"gbuffer.frag": opaque}
    _known_words(opaque, "outAlbedo", "outSpecular", "outEmission", "objectCoord", "transmissionRoughness")
    if not end.search(opaque):
        raise UnknownSapienError("gbuffer.frag does not end with its main function")
    files["gbuffer.frag"] = end.sub(lambda _: CHAR_DEFERRED + IMMERSE_DEFERRED + "}\n", opaque)
    files["deferred.frag"] = insert(files, "deferred.frag", MAIN, "").replace(MAIN, MAIN + SKY_FIRST)
    files |= _town(files["gbuffer1.frag"])
    files |= {f"gbuffer{EFFECT_PASS}.vert": EFFECT_VERT, f"gbuffer{EFFECT_PASS}.frag": EFFECT_FRAG}
    files |= {f"gbuffer{SWAY_PASS}.vert": SWAY_VERT, f"gbuffer{SWAY_PASS}.frag": SWAY_FRAG}
    files |= {f"gbuffer{AIR_PASS}.vert": AIR_VERT, f"gbuffer{AIR_PASS}.frag": AIR_FRAG}
    return files | {"composite0.frag": _bent(files)}


def _bent(files: dict[str, str]) -> str:
    """The full pack's last pass, which looks up the lit picture through hot air and beside swaying foliage."""
    name, straight = "composite0.frag", "texture(samplerLighting, inUV)"
    insert(files, name, straight, "")
    text = files[name].replace(straight, "hazardSeen(inUV)")
    free = 1 + max(map(int, re.findall(r"set = 0, binding = (\d+)", text)), default=0)
    air = "".join(
        f"layout(set = 0, binding = {free + k}) uniform sampler2D sampler{n};\n"
        for k, n in enumerate(("Bend", "Air", "Sway"))
    )
    _known_words(text, "samplerPositionRaw", "samplerSegmentation", name=name)
    return insert({name: text}, name, MAIN, air + BEND + STILL)


def _fast(files: dict[str, str]) -> dict[str, str]:
    """SAPIEN's single-pass pack with charring, water, haze and the effect pass, which here writes final colours."""
    _known(files, "gbuffer.vert", *SETS)
    forward = insert(files, "gbuffer.frag", MAIN, CHAR + "#define FAST\n" + IMMERSE)
    files = files | {"gbuffer.frag": forward}
    forward = insert(files, "gbuffer.frag", "  vec3 diffuseAlbedo", _fast_char() + IMMERSE_FORWARD)
    _known_words(forward, "outColorRaw", "outPositionSegmentation", "objectCoord", "transmissionRoughness")
    files["gbuffer.frag"] = forward.replace("outPositionSegmentation", f"out{LABELS}")
    # Blending leaves alpha 1 - a + a^2 over something solid, never below 0.75, and a^2 over the sky: there the sky
    # shines through.
    seen, mended = (
        "mix(bg, color.rgb, color.a)",
        "depth < 1.0 && color.a > 0.745 ? color.rgb : color.rgb + (1.0 - sqrt(color.a)) * bg",
    )
    files["composite0.frag"] = insert(files, "composite0.frag", seen, "").replace(seen, mended)
    files |= {"gbuffer1.vert": files["gbuffer.vert"], "gbuffer1.frag": files["gbuffer.frag"]}
    shown = EFFECT_FRAG.replace(
        "outLighting = colour", "outLighting = vec4(pow(min(colour.rgb, 1.0), vec3(1.0 / 2.2)), colour.a)"
    )
    files |= _town(files["gbuffer.frag"], "#define FAST\n")
    return files | {
        f"gbuffer{EFFECT_PASS}.vert": EFFECT_VERT,
        f"gbuffer{EFFECT_PASS}.frag": shown.replace("outLighting", "outColorRaw"),
    }


def _town(forward: str, words: str = "") -> dict[str, str]:
    """The pass of the town around a street, with the declarations of the pack's `forward` pass."""
    head, mark, _ = forward.partition("layout(location = 0) in vec4 inPosition;")
    if not mark:
        raise UnknownSapienError("the forward pass has no position")
    _known_words(head, "NUM_DIRECTIONAL_LIGHT_SHADOWS", "NUM_POINT_LIGHTS", "samplerEnvironment", name="its head")
    return {f"gbuffer{DRESS_PASS}.vert": DRESS_VERT, f"gbuffer{DRESS_PASS}.frag": head + words + DRESS_FRAG}


def _fast_char() -> str:
    """The charring of the single pass, where `frm` is already copied and emission has no strength of its own."""
    text = CHAR_FORWARD.replace("emission.rgb * emission.a", "emission.rgb")
    return text.replace("frm.x, frm.y", "specular, roughness")


def stock_packs() -> Path:
    """The installed SAPIEN's own packs."""
    return Path(sapien.__file__).parent / "vulkan_shader"


def texts(folder: Path) -> dict[str, str]:
    """The texts of the files of a folder, by name."""
    return {f.name: f.read_text(encoding="utf-8") for f in sorted(folder.iterdir()) if f.is_file()}


def _known(files: dict[str, str], *names: str) -> None:
    missing = [n for n in names if n not in files]
    if missing:
        raise UnknownSapienError(f"there is no {', '.join(missing)}")


def _known_words(text: str, *words: str, name: str = "gbuffer.frag") -> None:
    missing = [w for w in words if w not in text]
    if missing:
        raise UnknownSapienError(f"{name} does not mention {', '.join(missing)}")


def insert(files: dict[str, str], name: str, before: str, text: str) -> str:
    """The file `name` with `text` before the only place where `before` stands. Raises UnknownSapienError otherwise."""
    _known(files, name)
    if files[name].count(before) != 1:
        raise UnknownSapienError(f"{name} has {before!r} {files[name].count(before)} times, not once")
    return files[name].replace(before, text + before)


def write(name: str, files: dict[str, str]) -> Path:
    """Write the files into the folder `name` of the cache, and return it."""
    return kept_folder("shaders", {os.path.normpath(f"{name}/{file}"): text for file, text in files.items()}) / name
