"""Ask the Vulkan loader for its devices, in a child process: a driver that crashes ends only the child.

`python -m hazard_ms.machine.vulkan` is the child; it prints one JSON object.
"""

from __future__ import annotations

import ctypes
import importlib.util
import json
import os
import re
import subprocess
import sys
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path

from hazard_ms.machine.processes import environment

CHILD_TIMEOUT = 60.0  # [s] a loader with all of Mesa's drivers answers within one
OLDEST_MESA = (24, 3)  # SAPIEN 3.0.3 finds no device in the lavapipe of earlier ones

# From the Vulkan 1.3 specification (vulkan_core.h).
INSTANCE_CREATE_INFO = 1
PROPERTIES_2 = 1000059001
DRIVER_PROPERTIES = 1000196000
API_1_2 = (1 << 22) | (2 << 12)
CPU_DEVICE = 4
NVIDIA = 0x10DE
NO_DRIVER = -9  # VK_ERROR_INCOMPATIBLE_DRIVER


@dataclass(frozen=True)
class Device:
    """One Vulkan device."""

    name: str
    kind: int  # VkPhysicalDeviceType
    vendor: int
    version: tuple[int, ...]  # of the driver

    @property
    def lavapipe(self) -> bool:
        """Mesa's renderer on the CPU."""
        return self.kind == CPU_DEVICE and "llvmpipe" in self.name

    @property
    def usable(self) -> bool:
        """Whether SAPIEN can be expected to draw with it."""
        return self.version[:2] >= OLDEST_MESA if self.lavapipe else self.vendor == NVIDIA


@dataclass(frozen=True)
class Answer:
    """The answer of the loader: devices, or the reason why there are none."""

    devices: tuple[Device, ...] = ()
    loader: str = ""  # the library that was loaded; empty: none
    fault: str = ""

    @property
    def usable(self) -> bool:
        """Whether SAPIEN can draw with any of the devices."""
        return any(device.usable for device in self.devices)


def ask_vulkan(environ: Mapping[str, str] | None = None) -> Answer:
    """The devices that a process with `environ` sees."""
    environ = os.environ if environ is None else environ
    command = [sys.executable, "-m", "hazard_ms.machine.vulkan"]
    try:
        child = subprocess.run(
            command, capture_output=True, text=True, timeout=CHILD_TIMEOUT, check=False, env=environment(environ)
        )
    except subprocess.TimeoutExpired:
        return Answer(fault=f"the Vulkan loader did not answer within {CHILD_TIMEOUT:.0f} s")
    if child.returncode < 0:
        return Answer(fault=f"a Vulkan driver crashed (signal {-child.returncode})")
    try:
        row = json.loads(child.stdout)
    except ValueError:
        return Answer(fault=last_line(child.stderr) or "the Vulkan child printed nothing")
    devices = tuple(Device(d["name"], d["kind"], d["vendor"], tuple(d["version"])) for d in row["devices"])
    return Answer(devices, row["loader"], row["fault"])


def last_line(text: str) -> str:
    """The last line of `text` that is not blank."""
    lines = [line.strip() for line in text.splitlines() if line.strip()]
    return lines[-1] if lines else ""


class ApplicationInfo(ctypes.Structure):
    """The structure VkApplicationInfo of Vulkan."""

    _fields_ = [
        ("kind", ctypes.c_uint32),
        ("next", ctypes.c_void_p),
        ("name", ctypes.c_char_p),
        ("version", ctypes.c_uint32),
        ("engine_name", ctypes.c_char_p),
        ("engine_version", ctypes.c_uint32),
        ("api_version", ctypes.c_uint32),
    ]


class InstanceInfo(ctypes.Structure):
    """The structure VkInstanceCreateInfo of Vulkan, used without layers and extensions."""

    _fields_ = [
        ("kind", ctypes.c_uint32),
        ("next", ctypes.c_void_p),
        ("flags", ctypes.c_uint32),
        ("application", ctypes.POINTER(ApplicationInfo)),
        ("layer_count", ctypes.c_uint32),
        ("layers", ctypes.c_void_p),
        ("extension_count", ctypes.c_uint32),
        ("extensions", ctypes.c_void_p),
    ]


class DriverProperties(ctypes.Structure):
    """The structure VkPhysicalDeviceDriverProperties of Vulkan."""

    _fields_ = [
        ("kind", ctypes.c_uint32),
        ("next", ctypes.c_void_p),
        ("driver", ctypes.c_uint32),
        ("name", ctypes.c_char * 256),
        ("info", ctypes.c_char * 256),
        ("conformance", ctypes.c_uint8 * 4),
    ]


class DeviceProperties(ctypes.Structure):
    """The structure VkPhysicalDeviceProperties2 of Vulkan; the limits at its end are not read."""

    _fields_ = [
        ("kind", ctypes.c_uint32),
        ("next", ctypes.POINTER(DriverProperties)),
        ("api_version", ctypes.c_uint32),
        ("driver_version", ctypes.c_uint32),
        ("vendor", ctypes.c_uint32),
        ("device", ctypes.c_uint32),
        ("device_kind", ctypes.c_uint32),
        ("name", ctypes.c_char * 256),
        ("rest", ctypes.c_uint64 * 256),
    ]


def load_loader() -> tuple[ctypes.CDLL | None, str]:
    """The Vulkan loader of the system, else the one that SAPIEN brings; None if neither loads."""
    places = ["libvulkan.so.1"]
    sapien = importlib.util.find_spec("sapien")
    if sapien is not None and sapien.origin is not None:
        places += [str(path) for path in sorted((Path(sapien.origin).parent / "vulkan_library").glob("libvulkan.so*"))]
    for place in places:
        try:
            return ctypes.CDLL(place), place
        except OSError:
            continue
    return None, ""


def list_devices() -> Answer:
    """Ask the Vulkan loader in this process."""
    loader, place = load_loader()
    if loader is None:
        return Answer(fault="the Vulkan loader libvulkan.so.1 is not installed")
    instance = ctypes.c_void_p()
    application = ApplicationInfo(api_version=API_1_2)
    info = InstanceInfo(kind=INSTANCE_CREATE_INFO, application=ctypes.pointer(application))
    result = loader.vkCreateInstance(ctypes.byref(info), None, ctypes.byref(instance))
    if result != 0:
        reason = "no Vulkan driver works" if result == NO_DRIVER else f"vkCreateInstance failed with {result}"
        return Answer(loader=place, fault=reason)
    count = ctypes.c_uint32()
    loader.vkEnumeratePhysicalDevices(instance, ctypes.byref(count), None)
    handles = (ctypes.c_void_p * count.value)()
    loader.vkEnumeratePhysicalDevices(instance, ctypes.byref(count), handles)
    devices = tuple(describe(loader, handle) for handle in handles[: count.value] if handle)
    return Answer(devices, place, "" if devices else "no Vulkan driver finds a device")


def describe(loader: ctypes.CDLL, handle: int) -> Device:
    """Read a device's properties; its driver's version stands in a text such as `Mesa 25.0.7 (LLVM 15.0.6)`."""
    driver = DriverProperties(kind=DRIVER_PROPERTIES)
    device = DeviceProperties(kind=PROPERTIES_2, next=ctypes.pointer(driver))
    loader.vkGetPhysicalDeviceProperties2(ctypes.c_void_p(handle), ctypes.byref(device))
    version = re.search(r"\d+(\.\d+)+", driver.info.decode("utf-8", "replace"))
    numbers = tuple(int(part) for part in version[0].split(".")) if version else ()
    return Device(device.name.decode("utf-8", "replace"), device.device_kind, device.vendor, numbers)


if __name__ == "__main__":
    print(json.dumps(asdict(list_devices())))
