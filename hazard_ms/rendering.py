"""What draws the pictures: `backend()` is "gpu", else "cpu" (Mesa's lavapipe), else "none".

SAPIEN is tried in a child process, so that a driver that crashes does not take the caller along. The answer is kept
until the next start of the machine or change of drivers, because a trial takes seconds. HAZARD_MS_RENDER=gpu|cpu|none
decides without a trial.

`python -m hazard_ms.rendering cpu|gpu [--draw]` is the child: it prints `drawn` at its end.
"""

from __future__ import annotations

import hashlib
import importlib.metadata
import json
import os
import subprocess
import sys
import tempfile
from collections.abc import Mapping
from functools import cache
from pathlib import Path
from xml.etree import ElementTree

from hazard_ms.machine import manifest_paths
from hazard_ms.vulkan import last_line

BACKENDS = ("gpu", "cpu", "none")
DEVICES = {"gpu": "cuda", "cpu": "cpu"}  # as SAPIEN calls them
TRIAL_TIMEOUT = 120.0  # [s]; lavapipe compiles its shaders in 10 s on two cores
VARIABLES = ("VK_DRIVER_FILES", "VK_ICD_FILENAMES", "VK_ADD_DRIVER_FILES", "LD_LIBRARY_PATH", "CUDA_VISIBLE_DEVICES")
IMAGE_SIZE = 16  # pixels of the trial's picture


def backend() -> str:
    """The `render_backend` to give to ManiSkill on this machine."""
    chosen = os.environ.get("HAZARD_MS_RENDER", "")
    if chosen:
        if chosen not in BACKENDS:
            raise ValueError(f"HAZARD_MS_RENDER={chosen!r} is none of {', '.join(BACKENDS)}")
        return chosen
    return kept_backend(machine_key(os.environ))


@cache
def kept_backend(key: str) -> str:
    """The answer of an earlier trial under the same `key`, else of one now."""
    place = home() / f"rendering-{key}.json"
    try:
        kept = json.loads(place.read_text(encoding="utf-8"))["backend"]
        if kept in BACKENDS:
            return str(kept)
    except (OSError, ValueError, KeyError, TypeError):
        pass  # none yet, or damaged: try again
    answer = try_backends()
    if answer != "none":  # what is missing may be installed at any time
        keep(place, answer)
    return answer


def home() -> Path:
    """The folder of everything that hazard_ms keeps outside the clone."""
    default = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "hazard_ms"
    return Path(os.environ.get("HAZARD_MS_HOME") or default)


def keep(place: Path, answer: str) -> None:
    """Keep the answer; a folder that cannot be written only costs the next process a trial."""
    try:
        place.parent.mkdir(parents=True, exist_ok=True)
        write_whole(place, json.dumps({"backend": answer}))
    except OSError:
        return


def machine_key(environ: Mapping[str, str]) -> str:
    """Changes with whatever may change the answer: start of the machine, drivers, variables, SAPIEN."""
    parts = [environ.get(name, "") for name in VARIABLES]
    parts += [read(Path("/proc/sys/kernel/random/boot_id")), read(Path("/proc/driver/nvidia/version"))]
    parts += [str(Path("/dev/nvidiactl").exists()), sys.executable, importlib.metadata.version("sapien")]
    for path in manifest_paths(Path("/"), environ):
        parts += [str(path), read(path), str(path.stat().st_mtime_ns if path.exists() else 0)]
    return hashlib.sha256("\n".join(parts).encode()).hexdigest()[:16]


def read(path: Path) -> str:
    """The text of a file, empty if there is none."""
    try:
        return path.read_text(encoding="utf-8", errors="replace")
    except OSError:
        return ""


def try_backends() -> str:
    """The best backend that works."""
    if Path("/dev/nvidiactl").exists() and not trial_fault("gpu", draw=True):
        return "gpu"
    return "none" if trial_fault("cpu") else "cpu"


def bare_robot(urdf: Path) -> Path:
    """A copy of a robot's description (URDF) without its looks, for where nothing draws.

    SAPIEN's loader makes a material for each look, which fails without a Vulkan device. Bodies, joints and collisions stay.
    """
    tree = ElementTree.parse(urdf)
    for link in tree.getroot().iter("link"):
        for visual in link.findall("visual"):
            link.remove(visual)
    for mesh in tree.getroot().iter("mesh"):
        mesh.set("filename", str((urdf.parent / mesh.get("filename", "").removeprefix("package://")).resolve()))
    text = ElementTree.tostring(tree.getroot(), encoding="unicode")
    folder = home() / f"robot-{hashlib.sha256(text.encode()).hexdigest()[:16]}"
    bare, pairs = folder / urdf.name, urdf.with_suffix(".srdf")  # the loader reads the pairs that may touch from beside it
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError:
        folder = Path(tempfile.mkdtemp(prefix="hazard_ms-robot-"))
        bare = folder / urdf.name
    if pairs.exists():
        write_whole(folder / pairs.name, pairs.read_text(encoding="utf-8"))
    write_whole(bare, text)
    return bare


def write_whole(place: Path, text: str) -> None:
    """Write a file whole or not at all."""
    new = place.with_name(f"{place.name}.{os.getpid()}")
    new.write_text(text, encoding="utf-8")
    new.replace(place)


def trial_fault(name: str, draw: bool = False, environ: Mapping[str, str] | None = None) -> str:
    """Why SAPIEN cannot render with backend `name` in a process with `environ`; empty if it can. `draw` makes a picture too."""
    command = [sys.executable, "-m", "hazard_ms.rendering", name] + (["--draw"] if draw else [])
    variables = dict(os.environ if environ is None else environ)
    try:
        child = subprocess.run(command, capture_output=True, text=True, timeout=TRIAL_TIMEOUT, check=False, env=variables)
    except subprocess.TimeoutExpired:
        return f"SAPIEN did not answer within {TRIAL_TIMEOUT:.0f} s"
    if child.returncode < 0:
        return f"SAPIEN crashed (signal {-child.returncode})"
    if child.returncode > 0 or "drawn" not in child.stdout:
        return last_line(child.stderr) or f"SAPIEN ended with code {child.returncode}"
    return ""


def try_here(name: str, draw: bool) -> None:
    """Start SAPIEN's renderer in this process and, if asked for, draw a white box."""
    import sapien  # takes most of a second

    renderer = sapien.render.RenderSystem(sapien.Device(DEVICES[name]))
    if not draw:
        return
    scene = sapien.Scene([sapien.physx.PhysxCpuSystem(), renderer])
    scene.set_ambient_light([1.0, 1.0, 1.0])
    builder = scene.create_actor_builder()
    builder.add_box_visual(half_size=[1.0, 1.0, 1.0], material=sapien.render.RenderMaterial(base_color=[1.0, 1.0, 1.0, 1.0]))
    builder.build_static("box")
    camera = scene.add_camera("camera", IMAGE_SIZE, IMAGE_SIZE, fovy=1.0, near=0.1, far=10.0)
    camera.set_entity_pose(sapien.Pose([-3.0, 0.0, 0.0]))
    scene.update_render()
    camera.take_picture()
    middle = camera.get_picture("Color")[IMAGE_SIZE // 2, IMAGE_SIZE // 2, :3]
    if float(middle.min()) <= 0.0:
        raise RuntimeError("SAPIEN's picture of a white box is black")


if __name__ == "__main__":
    try_here(sys.argv[1], "--draw" in sys.argv)
    print("drawn")
