"""Shader packs with our effects, derived at run time from those of the installed SAPIEN: we ship no text of others.

A pack is a folder of GLSL. Ours is SAPIEN's own, with charring, water and haze added to its opaque pass and a third pass that draws
flames, smoke, the water's surface and what flies into the picture alone; the full one has two more, for foliage in the wind and for hot
air, and bends what is seen of them or through them when it puts the picture together. It is kept in the user's cache under a hash of all
that it is made of, so another SAPIEN makes another pack. If the installed files are not as expected, pictures are SAPIEN's own, without
effects, and labels stay right.
"""

from __future__ import annotations

import hashlib
import logging
import os
import re
import shutil
import tempfile
from dataclasses import replace
from functools import cache
from pathlib import Path

import sapien
import torch
from mani_skill.render import PREBUILT_SHADER_CONFIGS, ShaderConfig
from torch import Tensor

from hazard_ms.effects.glsl import CHAR, CHAR_DEFERRED, CHAR_FORWARD, EFFECT_FRAG, EFFECT_VERT
from hazard_ms.effects.shimmer_glsl import AIR_FRAG, AIR_VERT, BEND
from hazard_ms.effects.sway_glsl import STILL, SWAY_FRAG, SWAY_VERT
from hazard_ms.effects.water_glsl import IMMERSE, IMMERSE_DEFERRED, IMMERSE_FORWARD
from hazard_ms.rendering import home

NAMES = {"full": "hazard", "fast": "hazard-fast", "off": "default"}  # effects mode -> shader pack of the cameras
EFFECT_PASS = 2  # shading mode of effect geometry: no stock pack has this pass, so none draws it
SWAY_PASS = 3  # that of foliage, in the full pack alone
AIR_PASS = 4  # that of hot air, in the full pack alone; it comes last, since its quads would hide what is drawn after them
SETS = ("camera_set.glsl", "object_set.glsl", "material_set.glsl")
LABELS = "PositionLabel"  # the fast pack's own name: ManiSkill changes the pixel format of "PositionSegmentation" for the whole process

_log = logging.getLogger(__name__)
_warm: dict[str, tuple[sapien.Scene, sapien.render.RenderCameraComponent]] = {}


class UnknownSapienError(RuntimeError):
    """The installed shader files are not those that we know how to change."""


def shader_config(mode: str) -> str:
    """Name of the ManiSkill shader configuration for effects `mode` (full, fast, off), registered under that name."""
    if mode not in NAMES:
        raise ValueError(f"effects mode is {mode!r}; allowed: {', '.join(NAMES)}")
    register()
    return NAMES[mode]


def available(mode: str) -> bool:
    """Whether effects of this `mode` can be drawn."""
    return mode != "off" and _pack(NAMES[mode]) is not None


@cache
def register() -> None:
    """Make `shader_pack="hazard"` and `"hazard-fast"` known to ManiSkill."""
    full, fast = _pack("hazard"), _pack("hazard-fast")
    stock = PREBUILT_SHADER_CONFIGS["default"]
    bytes_or_float = {**stock.texture_transforms, "Color": colour}
    PREBUILT_SHADER_CONFIGS["hazard"] = replace(stock, shader_pack=full, texture_transforms=bytes_or_float) if full else stock
    PREBUILT_SHADER_CONFIGS["hazard-fast"] = _fast_config(fast) if fast else PREBUILT_SHADER_CONFIGS["minimal"]


def pack_folder(mode: str) -> str:
    """The pack of effects `mode` (full, fast, off) as SAPIEN's cameras take it: its folder."""
    return str(stock_packs() / PREBUILT_SHADER_CONFIGS[shader_config(mode)].shader_pack)  # an absolute path stays as it is


def keep_warm(mode: str, device: sapien.Device) -> None:
    """Compile the pack of `mode` once per process, not per scene: SAPIEN forgets a pack with its last camera, so one stays alive."""
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
    """Colours in bytes, of whatever format "Color" has in this process."""
    seen = data[..., :3]
    return {"rgb": seen if seen.dtype == torch.uint8 else (seen * 255).to(torch.uint8)}


def _labels(data: Tensor) -> dict[str, Tensor]:
    short = data.to(torch.int16)  # [mm], as ManiSkill gives depth and position
    return {"position": short[..., :3], "depth": -short[..., [2]], "segmentation": short[..., [3]]}


@cache
def _pack(name: str) -> str | None:
    """Folder of the pack, made if need be; None if the installed SAPIEN is unknown."""
    stock = stock_packs()
    try:
        base = stock / ("default" if name == "hazard" else "minimal")
        files = _texts(base) | {f"../common/{n}": t for n, t in _texts(stock / "common").items()}
        if name == "hazard":
            files = _full(files)
        else:
            files |= {n: t for n, t in _texts(stock / "default").items() if n in SETS}
            files = _fast(files)
        return str(_write(name, files))
    except (UnknownSapienError, OSError) as fault:
        _log.warning("no effects in pictures: cannot derive the shader pack %s from SAPIEN %s (%s)", name, sapien.__version__, fault)
        return None


def _full(files: dict[str, str]) -> dict[str, str]:
    """SAPIEN's deferred pack with charring, water, haze and the effect pass."""
    _known(files, "gbuffer1.frag", "gbuffer1.vert", "deferred.frag", *SETS)
    end = re.compile(r"\}\s*\Z")
    opaque = _insert(files, "gbuffer.frag", "void main() {", CHAR + IMMERSE)
    files = files | {"gbuffer.frag": opaque}
    _known_words(opaque, "outAlbedo", "outSpecular", "outEmission", "objectCoord", "transmissionRoughness")
    if not end.search(opaque):
        raise UnknownSapienError("gbuffer.frag does not end with its main function")
    files["gbuffer.frag"] = end.sub(lambda _: CHAR_DEFERRED + IMMERSE_DEFERRED + "}\n", opaque)
    files |= {"gbuffer2.vert": EFFECT_VERT, "gbuffer2.frag": EFFECT_FRAG}
    files |= {f"gbuffer{SWAY_PASS}.vert": SWAY_VERT, f"gbuffer{SWAY_PASS}.frag": SWAY_FRAG}
    files |= {f"gbuffer{AIR_PASS}.vert": AIR_VERT, f"gbuffer{AIR_PASS}.frag": AIR_FRAG}
    return files | {"composite0.frag": _bent(files)}


def _bent(files: dict[str, str]) -> str:
    """The full pack's last pass, which looks up the lit picture through hot air, and where foliage stands that sways."""
    name, straight = "composite0.frag", "texture(samplerLighting, inUV)"
    _insert(files, name, straight, "")
    text = files[name].replace(straight, "hazardSeen(inUV)")
    free = 1 + max(map(int, re.findall(r"set = 0, binding = (\d+)", text)), default=0)
    air = "".join(f"layout(set = 0, binding = {free + k}) uniform sampler2D sampler{n};\n" for k, n in enumerate(("Bend", "Air", "Sway")))
    _known_words(text, "samplerPositionRaw", "samplerSegmentation", name=name)
    return _insert({name: text}, name, "void main() {", air + BEND + STILL)


def _fast(files: dict[str, str]) -> dict[str, str]:
    """SAPIEN's single-pass pack with charring, water, haze and the effect pass, which here writes colours as they are shown."""
    _known(files, "gbuffer.vert", *SETS)
    forward = _insert(files, "gbuffer.frag", "void main() {", CHAR + "#define FAST\n" + IMMERSE)
    files = files | {"gbuffer.frag": forward}
    forward = _insert(files, "gbuffer.frag", "  vec3 diffuseAlbedo", _fast_char() + IMMERSE_FORWARD)
    _known_words(forward, "outColorRaw", "outPositionSegmentation", "objectCoord", "transmissionRoughness")
    files["gbuffer.frag"] = forward.replace("outPositionSegmentation", f"out{LABELS}")
    # Blending leaves alpha 1 - a + a^2 over something solid, never below 0.75, and a^2 over the sky: there the sky shines through.
    seen, mended = "mix(bg, color.rgb, color.a)", "depth < 1.0 && color.a > 0.745 ? color.rgb : color.rgb + (1.0 - sqrt(color.a)) * bg"
    files["composite0.frag"] = _insert(files, "composite0.frag", seen, "").replace(seen, mended)
    files |= {"gbuffer1.vert": files["gbuffer.vert"], "gbuffer1.frag": files["gbuffer.frag"]}
    shown = EFFECT_FRAG.replace("outLighting = colour", "outLighting = vec4(pow(min(colour.rgb, 1.0), vec3(1.0 / 2.2)), colour.a)")
    return files | {"gbuffer2.vert": EFFECT_VERT, "gbuffer2.frag": shown.replace("outLighting", "outColorRaw")}


def _fast_char() -> str:
    """In the single pass `frm` is already copied when the light is computed, and emission has no strength of its own."""
    text = CHAR_FORWARD.replace("emission.rgb * emission.a", "emission.rgb")
    return text.replace("frm.x, frm.y", "specular, roughness")


def stock_packs() -> Path:
    """The installed SAPIEN's own packs."""
    return Path(sapien.__file__).parent / "vulkan_shader"


def _texts(folder: Path) -> dict[str, str]:
    return {f.name: f.read_text(encoding="utf-8") for f in sorted(folder.iterdir()) if f.is_file()}


def _known(files: dict[str, str], *names: str) -> None:
    missing = [n for n in names if n not in files]
    if missing:
        raise UnknownSapienError(f"there is no {', '.join(missing)}")


def _known_words(text: str, *words: str, name: str = "gbuffer.frag") -> None:
    missing = [w for w in words if w not in text]
    if missing:
        raise UnknownSapienError(f"{name} does not mention {', '.join(missing)}")


def _insert(files: dict[str, str], name: str, before: str, text: str) -> str:
    """The file `name` with `text` put before the only place where `before` stands."""
    _known(files, name)
    if files[name].count(before) != 1:
        raise UnknownSapienError(f"{name} has {before!r} {files[name].count(before)} times, not once")
    return files[name].replace(before, text + before)


def _write(name: str, files: dict[str, str]) -> Path:
    """The folder with these files, whole or not at all, even when several processes write it at once."""
    digest = hashlib.sha256("\0".join(f"{n}\0{t}" for n, t in sorted(files.items())).encode()).hexdigest()[:16]
    folder = home() / "shaders" / digest
    if not folder.is_dir():
        folder.parent.mkdir(parents=True, exist_ok=True)
        draft = Path(tempfile.mkdtemp(dir=folder.parent))
        for sub in (name, "common"):
            (draft / sub).mkdir()
        for file, text in files.items():
            (draft / name / file).resolve().write_text(text, encoding="utf-8")
        try:
            os.rename(draft, folder)
        except OSError:  # another process was faster
            shutil.rmtree(draft, ignore_errors=True)
            if not folder.is_dir():
                raise
    return folder / name
