"""The choice of renderer: `backend()` is "gpu", else "cpu" (Mesa's lavapipe), else "none".

SAPIEN is tried in a child process, so that a driver that crashes does not crash the caller. A trial takes seconds, so
its answer is kept until the machine restarts or its drivers change. HAZARD_MS_RENDER=gpu|cpu|none
decides without a trial.

`python -m hazard_ms.machine.render_backend cpu|gpu [--draw]` is the child: it prints `drawn` at its end.
"""

from __future__ import annotations

import hashlib
import importlib.metadata
import json
import os
import subprocess
import sys
from collections.abc import Mapping
from functools import cache
from pathlib import Path

from hazard_ms.machine.processes import environment
from hazard_ms.machine.survey import manifest_paths
from hazard_ms.machine.vulkan import last_line
from hazard_ms.spec.storage.cache import home
from hazard_ms.spec.storage.files import write

BACKENDS = ("gpu", "cpu", "none")
DEVICES = {"gpu": "cuda", "cpu": "cpu"}  # as SAPIEN calls them
TRIAL_TIMEOUT = 120.0  # [s]; lavapipe compiles its shaders in 10 s on two cores
VARIABLES = ("VK_DRIVER_FILES", "VK_ICD_FILENAMES", "VK_ADD_DRIVER_FILES", "LD_LIBRARY_PATH", "CUDA_VISIBLE_DEVICES")
IMAGE_SIZE = 16  # pixels of the trial's picture


def backend() -> str:
    """The `render_backend` to give to ManiSkill on this machine.

    Raises ValueError if HAZARD_MS_RENDER is set to anything but gpu, cpu or none.
    """
    chosen = os.environ.get("HAZARD_MS_RENDER", "")
    if chosen:
        if chosen not in BACKENDS:
            raise ValueError(f"HAZARD_MS_RENDER must be one of {', '.join(BACKENDS)}, got {chosen!r}")
        return chosen
    return kept_backend(machine_key(os.environ))


@cache
def kept_backend(key: str) -> str:
    """The answer of an earlier trial under the same `key`, or else of a new trial."""
    place = home() / f"rendering-{key}.json"
    for name in BACKENDS:
        if _holds(place, _content(name)):
            return name
    answer = try_backends()
    if answer != "none":  # what is missing may be installed at any time
        keep(place, answer)
    return answer


def keep(place: Path, answer: str) -> None:
    """Store the answer. Where the folder is read-only, the next process repeats the trial."""
    try:
        place.parent.mkdir(parents=True, exist_ok=True)
        write(place, _content(answer))
    except (OSError, ValueError):
        return


def _content(answer: str) -> bytes:
    return json.dumps({"backend": answer}).encode()


def _holds(place: Path, content: bytes) -> bool:
    """Whether a regular file holds that and no more; False where there is none, or it cannot be read."""
    try:
        if not place.is_file():
            return False
        with place.open("rb") as file:
            return file.read(len(content) + 1) == content
    except OSError:
        return False


def machine_key(environ: Mapping[str, str]) -> str:
    """A digest of everything that can change the answer: boot, drivers, variables, SAPIEN."""
    parts = [environ.get(name, "") for name in VARIABLES]
    parts += [read(Path("/proc/sys/kernel/random/boot_id")), read(Path("/proc/driver/nvidia/version"))]
    parts += [str(Path("/dev/nvidiactl").exists()), sys.executable, importlib.metadata.version("sapien")]
    for path in manifest_paths(Path("/"), environ):
        parts += [str(path), read(path), str(path.stat().st_mtime_ns if path.exists() else 0)]
    return hashlib.sha256("\n".join(parts).encode()).hexdigest()[:16]


def read(path: Path) -> str:
    """The text of a file, empty if it cannot be read."""
    try:
        return path.read_text(encoding="utf-8", errors="replace")
    except OSError:
        return ""


def try_backends() -> str:
    """The best backend that works here, found by trying them."""
    if Path("/dev/nvidiactl").exists() and not trial_fault("gpu", draw=True):
        return "gpu"
    return "none" if trial_fault("cpu") else "cpu"


def trial_fault(name: str, draw: bool = False, environ: Mapping[str, str] | None = None) -> str:
    """The reason why SAPIEN cannot render with backend `name` in a process with `environ`; empty if it can.

    With `draw` the trial also takes a picture.
    """
    command = [sys.executable, "-m", "hazard_ms.machine.render_backend", name] + (["--draw"] if draw else [])
    variables = environment(environ)
    try:
        child = subprocess.run(
            command, capture_output=True, text=True, timeout=TRIAL_TIMEOUT, check=False, env=variables
        )
    except subprocess.TimeoutExpired:
        return f"SAPIEN did not answer within {TRIAL_TIMEOUT:.0f} s"
    if child.returncode < 0:
        return f"SAPIEN crashed (signal {-child.returncode})"
    if child.returncode > 0 or "drawn" not in child.stdout:
        return last_line(child.stderr) or f"SAPIEN ended with code {child.returncode}"
    return ""


def try_here(name: str, draw: bool) -> None:
    """Start SAPIEN's renderer in this process and, with `draw`, take a picture of a white box.

    Raises RuntimeError if the picture is black; SAPIEN raises its own errors.
    """
    import sapien  # takes most of a second

    renderer = sapien.render.RenderSystem(sapien.Device(DEVICES[name]))
    if not draw:
        return
    scene = sapien.Scene([sapien.physx.PhysxCpuSystem(), renderer])
    scene.set_ambient_light([1.0, 1.0, 1.0])
    builder = scene.create_actor_builder()
    builder.add_box_visual(
        half_size=[1.0, 1.0, 1.0], material=sapien.render.RenderMaterial(base_color=[1.0, 1.0, 1.0, 1.0])
    )
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
