"""Read what this machine has for drawing pictures: release, libraries, Vulkan drivers, NVIDIA devices.

Everything is read below `root` and from `environ`, so that a folder can stand for a machine. Uses the
standard library only, so it runs where nothing else works.
"""

from __future__ import annotations

import json
import os
import re
import subprocess
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from hazard_ms.machine.processes import environment

MANIFEST_VARIABLES = ("VK_DRIVER_FILES", "VK_ICD_FILENAMES")  # these replace the folders; the first that is set counts
MANIFEST_FOLDERS = ("etc/vulkan/icd.d", "usr/local/share/vulkan/icd.d", "usr/share/vulkan/icd.d")
LAVAPIPE = "libvulkan_lvp"  # the library of Mesa's driver that draws on the CPU
LISTING_TIMEOUT = 20.0  # [s] for ldconfig and nvidia-smi


@dataclass(frozen=True)
class Manifest:
    """The description of one Vulkan driver: a JSON file that names its library."""

    path: str
    library: str = ""
    fault: str = ""  # what is wrong with it; empty: nothing


@dataclass(frozen=True)
class Machine:
    """The libraries, drivers and devices that were found."""

    system: str  # ID of os-release, "debian"
    release: str  # VERSION_ID of os-release, "12"
    libraries: frozenset[str]  # names the dynamic loader finds, "libX11.so.6"
    manifests: tuple[Manifest, ...]
    chosen_by: str  # the variable that names the manifests; empty: they lie in the system's folders
    nvidia_devices: bool
    mig: bool  # the NVIDIA GPU is cut into slices, which cannot draw

    @property
    def nvidia_driver(self) -> bool:
        """Whether NVIDIA's Vulkan driver, not only its CUDA driver, is there and described."""
        return "libGLX_nvidia.so.0" in self.libraries and any(
            "nvidia" in m.library and not m.fault for m in self.manifests
        )


def read_machine(
    root: Path = Path("/"),
    environ: Mapping[str, str] | None = None,
    ldconfig: str | None = None,
    gpus: str | None = None,
) -> Machine:
    """Read the machine below `root`.

    `ldconfig`, `gpus`: the text of `ldconfig -p` and `nvidia-smi -L`; the commands are run if it is None.
    """
    environ = os.environ if environ is None else environ
    libraries = read_libraries(listing(["/sbin/ldconfig", "-p"]) if ldconfig is None else ldconfig)
    devices = (root / "dev/nvidiactl").exists() or (root / "proc/driver/nvidia/version").exists()
    if gpus is None:
        gpus = listing(["nvidia-smi", "-L"]) if devices else ""
    release = read_release(root)
    return Machine(
        system=release.get("ID", "unknown"),
        release=release.get("VERSION_ID", ""),
        libraries=libraries,
        manifests=tuple(read_manifest(path, libraries) for path in manifest_paths(root, environ)),
        chosen_by=next((name for name in MANIFEST_VARIABLES if environ.get(name)), ""),
        nvidia_devices=devices,
        mig="MIG" in gpus,
    )


def listing(command: list[str]) -> str:
    """The output of `command`; empty if it does not exist or does not end."""
    try:
        done = subprocess.run(
            command, capture_output=True, text=True, timeout=LISTING_TIMEOUT, check=False, env=environment()
        )
        return done.stdout
    except (OSError, subprocess.TimeoutExpired):
        return ""


def read_libraries(ldconfig: str) -> frozenset[str]:
    """Names of the 64-bit libraries in the text of `ldconfig -p`."""
    return frozenset(match[1] for match in re.finditer(r"^\s+(\S+) \([^)]*x86-64[^)]*\) =>", ldconfig, re.MULTILINE))


def read_release(root: Path) -> dict[str, str]:
    """The fields of os-release."""
    try:
        text = (root / "etc/os-release").read_text(encoding="utf-8")
    except OSError:
        return {}
    return {name: value.strip().strip("\"'") for name, _, value in (line.partition("=") for line in text.splitlines())}


def manifest_paths(root: Path, environ: Mapping[str, str]) -> list[Path]:
    """The driver files that the Vulkan loader reads: those that its variable names, else those of the system."""
    for name in MANIFEST_VARIABLES:
        if environ.get(name):
            places = [Path(part) for part in environ[name].split(":") if part]
            break
    else:
        places = [root / folder for folder in MANIFEST_FOLDERS]
        places = [place for place in places if place.is_dir()]
    files: list[Path] = []
    for place in places:
        files += sorted(place.glob("*.json")) if place.is_dir() else [place]
    return files


def read_manifest(path: Path, libraries: frozenset[str]) -> Manifest:
    """Read one driver description and say what is wrong with it."""
    try:
        library = str(json.loads(path.read_text(encoding="utf-8"))["ICD"]["library_path"])
    except OSError:
        return Manifest(str(path), fault="cannot be read")
    except ValueError:
        return Manifest(str(path), fault="is not valid JSON")
    except (KeyError, TypeError):
        return Manifest(str(path), fault="names no library (ICD.library_path)")
    known = library in libraries if "/" not in library else (path.parent / library).exists()
    return Manifest(str(path), library, "" if known else f"its library {library} is not there")
