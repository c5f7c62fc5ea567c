"""Judge the facts about a machine: findings in causal order, so that the first fault explains those after it."""

from __future__ import annotations

import importlib.metadata
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from hazard_ms.machine import drivers
from hazard_ms.machine.survey import Machine
from hazard_ms.machine.vulkan import OLDEST_MESA, Answer
from hazard_ms.spec.storage.cache import home

PACKAGES = (
    "sapien",
    "mani-skill",
    "gymnasium",
    "torch",
    "torchvision",
    "warp-lang",
    "numpy",
    "scipy",
    "trimesh",
    "opencv-python-headless",
)
NIGHTLY = "-nightly"  # end of the name under which ManiSkill's daily builds are installed
OPENCVS = ("opencv-python", "opencv-contrib-python", "opencv-python-headless", "opencv-contrib-python-headless")
PYTHONS = ((3, 10), (3, 12))  # first and last; mani-skill's mplib has no later build
LEAST_FREE = 1.0  # [GB] a video, a result and the caches of one run need less


def installed_version(package: str) -> str | None:
    """The version of a package, or of its nightly build; None if neither is installed."""
    for name in (package, f"{package}{NIGHTLY}"):
        try:
            return importlib.metadata.version(name)
        except importlib.metadata.PackageNotFoundError:
            continue
    return None


@dataclass(frozen=True)
class Facts:
    """The facts about this machine and its Python environment."""

    machine: Machine
    vulkan: Answer
    python: tuple[int, int]
    packages: Mapping[str, str]  # version of each that is installed
    gpu_fault: str | None  # why SAPIEN cannot draw with the GPU; empty: it can; None: no GPU, not tried
    cpu_fault: str | None  # the same for lavapipe; None: not tried
    opencv_fault: str  # why `import cv2` fails; empty: it does not
    cuda_fault: str | None  # why torch cannot compute on the GPU; empty: it can; None: no GPU
    free: float  # [GB] in the cache folder


@dataclass(frozen=True)
class Finding:
    """One thing that was checked."""

    name: str
    state: str  # "ok", "warning", "fault"
    detail: str
    command: str = ""  # what mends it


def chosen_backend(facts: Facts) -> str:
    """The renderer that `render_backend.backend()` would choose."""
    return "gpu" if facts.gpu_fault == "" else "cpu" if facts.cpu_fault == "" else "none"


def examine(facts: Facts) -> list[Finding]:
    """Judge the facts, causes before consequences."""
    draws = chosen_backend(facts) != "none"
    return [
        examine_python(facts),
        examine_packages(facts),
        examine_opencv(facts),
        examine_libraries(facts, draws),
        examine_manifests(facts, draws),
        examine_nvidia(facts),
        examine_mesa(facts, draws),
        examine_rendering(facts),
        examine_disk(facts),
    ]


def examine_python(facts: Facts) -> Finding:
    """Python 3.10 to 3.12."""
    version = ".".join(map(str, facts.python))
    if PYTHONS[0] <= facts.python <= PYTHONS[1]:
        return Finding("python", "ok", version)
    return Finding(
        "python",
        "fault",
        f"Python {version}; 3.10, 3.11 or 3.12 is needed",
        "HAZARD_MS_PYTHON=python3.11 ./run hazard-ms doctor",
    )


def examine_packages(facts: Facts) -> Finding:
    """All packages that are imported are installed."""
    missing = [name for name in PACKAGES if name not in facts.packages]
    if missing:
        return Finding(
            "packages", "fault", f"not installed: {', '.join(missing)}", f"python -m pip install {' '.join(missing)}"
        )
    return Finding("packages", "ok", ", ".join(f"{name} {facts.packages[name]}" for name in PACKAGES))


def examine_opencv(facts: Facts) -> Finding:
    """One OpenCV only: all of them own the folder `cv2`, so removing one breaks the rest."""
    several = [name for name in OPENCVS if name in facts.packages]
    drop = " ".join(several) or "opencv-python-headless"
    cure = f"python -m pip uninstall -y {drop} && python -m pip install --no-deps opencv-python-headless"
    if facts.opencv_fault:
        return Finding("opencv", "fault", f"import cv2: {facts.opencv_fault}", cure)
    if len(several) > 1:
        return Finding("opencv", "warning", f"{' and '.join(several)} share one folder; removing one breaks both", cure)
    return Finding("opencv", "ok", "one OpenCV")


def examine_libraries(facts: Facts, draws: bool) -> Finding:
    """The X libraries, which SAPIEN and NVIDIA's driver load even without a screen, and the Vulkan loader."""
    missing = [library for library in drivers.LIBRARIES if library not in facts.machine.libraries]
    if not missing:
        return Finding("libraries", "ok", ", ".join(drivers.LIBRARIES))
    return Finding(
        "libraries", "warning" if draws else "fault", f"not found: {', '.join(missing)}", install_line(facts)
    )


def examine_manifests(facts: Facts, draws: bool) -> Finding:
    """Vulkan drivers are described by JSON files; a broken one hides its driver."""
    manifests = facts.machine.manifests
    broken = [manifest for manifest in manifests if manifest.fault]
    if broken:
        first = broken[0]
        chosen_by = facts.machine.chosen_by
        cure = f"unset {chosen_by}" if chosen_by else f"sudo mv {first.path} {first.path}.broken"
        return Finding("vulkan drivers", "warning" if draws else "fault", f"{first.path}: {first.fault}", cure)
    if manifests:
        return Finding("vulkan drivers", "ok", ", ".join(Path(manifest.path).name for manifest in manifests))
    return Finding("vulkan drivers", "warning" if draws else "fault", "none is installed", install_line(facts))


def examine_nvidia(facts: Facts) -> Finding:
    """A GPU that computes need not draw: MIG slices and containers without graphics cannot."""
    if not facts.machine.nvidia_devices:
        return Finding("gpu", "ok", "no NVIDIA GPU; the CPU simulates and draws")
    if facts.cuda_fault:
        return Finding("gpu", "warning", f"an NVIDIA GPU, but {facts.cuda_fault}; the CPU simulates", "nvidia-smi")
    if facts.gpu_fault == "":
        return Finding("gpu", "ok", "an NVIDIA GPU; it computes and draws")
    if facts.machine.mig:
        return Finding(
            "gpu",
            "warning",
            "the GPU is cut into MIG slices, which cannot draw; the CPU draws",
            "export HAZARD_MS_RENDER=cpu",
        )
    if not facts.machine.nvidia_driver:
        reason = (
            "NVIDIA's Vulkan driver (libGLX_nvidia.so.0 and its ICD file) is missing; in a container allow `graphics`"
        )
        return Finding(
            "gpu",
            "warning",
            f"{reason}; the CPU draws",
            "export NVIDIA_DRIVER_CAPABILITIES=all  # when starting the container",
        )
    return Finding("gpu", "warning", f"the GPU does not draw: {facts.gpu_fault}", "export HAZARD_MS_RENDER=cpu")


def examine_mesa(facts: Facts, draws: bool) -> Finding:
    """Mesa's lavapipe, which draws where no GPU does."""
    least = ".".join(map(str, OLDEST_MESA))
    cure = install_line(facts)
    if facts.vulkan.fault:
        return Finding("vulkan", "warning" if draws else "fault", facts.vulkan.fault, cure)
    for device in facts.vulkan.devices:
        if device.lavapipe:
            version = ".".join(map(str, device.version))
            if device.usable:
                return Finding("vulkan", "ok", f"lavapipe of Mesa {version}")
            return Finding(
                "vulkan", "warning" if draws else "fault", f"Mesa {version} is too old: {least} is needed", cure
            )
    names = ", ".join(device.name for device in facts.vulkan.devices)
    if facts.vulkan.usable:
        return Finding("vulkan", "ok", names)
    return Finding(
        "vulkan", "warning" if draws else "fault", f"only {names}; lavapipe of Mesa >= {least} is missing", cure
    )


def examine_rendering(facts: Facts) -> Finding:
    """The outcome: the renderer that SAPIEN really uses."""
    name = chosen_backend(facts)
    if name != "none":
        return Finding("rendering", "ok", f"SAPIEN draws with the {name.upper()}")
    cure = "./run hazard-ms doctor  # installs what is missing, then looks again"
    return Finding(
        "rendering", "fault", f"SAPIEN cannot draw: {facts.cpu_fault}; state observations work without it", cure
    )


def examine_disk(facts: Facts) -> Finding:
    """Free space in the cache folder."""
    detail = f"{facts.free:.1f} GB free for {home()}"
    if facts.free < LEAST_FREE:
        return Finding("disk", "fault", detail, "export HAZARD_MS_HOME=/a/larger/disk")
    return Finding("disk", "ok", detail)


def install_line(facts: Facts) -> str:
    """One line that installs everything that is missing, for users to copy."""
    packages = drivers.missing_packages(facts.machine, facts.vulkan) or [drivers.LAVAPIPE]
    line = drivers.command_line(facts.machine, packages)
    if facts.machine.system == "ubuntu" and facts.machine.release == "22.04" and drivers.LAVAPIPE in packages:
        return f"{line} && ./run hazard-ms doctor  # unpacks a newer lavapipe beside the one of 22.04, which is too old"
    return line
