"""Folders that stand for machines, and processes whose Vulkan really is broken."""

from __future__ import annotations

import dataclasses
import os
from pathlib import Path

from hazard_ms.machine.diagnosis import PACKAGES, Facts
from hazard_ms.machine.survey import Machine, read_machine
from hazard_ms.machine.vulkan import Answer, Device

ALL_LIBRARIES = ("libX11.so.6", "libXext.so.6", "libvulkan.so.1", "libvulkan_lvp.so")
LAVAPIPE = '{"file_format_version": "1.0.0", "ICD": {"library_path": "libvulkan_lvp.so", "api_version": "1.4.305"}}'
CPU_DEVICE = 4  # VK_PHYSICAL_DEVICE_TYPE_CPU
NO_DRIVER = "no Vulkan driver works"


def ldconfig(*libraries: str) -> str:
    """What `ldconfig -p` prints where exactly `libraries` are installed."""
    lines = [f"\t{name} (libc6,x86-64) => /lib/x86_64-linux-gnu/{name}" for name in libraries]
    return "\n".join(
        [f"{len(lines)} libs found in cache `/etc/ld.so.cache'", *lines, "\tlibonly32.so (libc6) => /lib/libonly32.so"]
    )


def machine_at(
    root: Path, icd: str | None = LAVAPIPE, libraries: tuple[str, ...] = ALL_LIBRARIES, release: str = "debian 12"
) -> Machine:
    """A machine whose files lie below `root`, with one Vulkan driver file of text `icd`."""
    system, version = release.split()
    (root / "etc").mkdir(parents=True)
    (root / "etc/os-release").write_text(f'PRETTY_NAME="A Linux"\nID={system}\nVERSION_ID="{version}"\n')
    folder = root / "usr/share/vulkan/icd.d"
    folder.mkdir(parents=True)
    if icd is not None:
        (folder / "lvp_icd.json").write_text(icd)
    return read_machine(root, {}, ldconfig(*libraries), gpus="")


def lavapipe(*version: int) -> Answer:
    """The answer of a loader whose only device is lavapipe of a version of Mesa."""
    return Answer((Device("llvmpipe (LLVM 15.0.6, 256 bits)", CPU_DEVICE, 0x10005, version),), "libvulkan.so.1")


def facts_of(machine: Machine, vulkan: Answer, **changes: object) -> Facts:
    """A machine in an environment where everything else is as it should be."""
    packages = {name: "1.0" for name in PACKAGES}
    draws = "" if vulkan.usable else "RuntimeError: vk::createInstanceUnique: ErrorIncompatibleDriver"
    facts = Facts(machine, vulkan, (3, 11), packages, None, draws, "", None, 50.0)
    return dataclasses.replace(facts, **changes)  # type: ignore[arg-type]


def environment(**changes: str) -> dict[str, str]:
    """This process's variables, changed, with the package importable."""
    root = str(Path(__file__).parents[3])
    return {**os.environ, "PYTHONPATH": root, **changes}


def broken_environment(folder: Path) -> dict[str, str]:
    """Variables under which Vulkan has one driver, whose library does not exist."""
    icd = folder / "broken_icd.json"
    icd.write_text('{"file_format_version": "1.0.0", "ICD": {"library_path": "./gone.so", "api_version": "1.3.0"}}')
    return environment(VK_DRIVER_FILES=str(icd), VK_ICD_FILENAMES=str(icd), HAZARD_MS_HOME=str(folder / "home"))
