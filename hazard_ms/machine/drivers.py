"""Prepare a machine so that SAPIEN can draw: X libraries, Vulkan loader, and Mesa's lavapipe where no GPU draws.

`python -m hazard_ms.machine.drivers --home FOLDER --answer FILE`, called by `./run`, installs what is missing if it may
and writes the lines that a shell has to source (often none) to FILE. Where this machine cannot draw, it prints the
commands that help and exits with 1.

Sources of lavapipe: the Mesa of Debian 12 is too old, its backports have 25.0. Ubuntu 24.04 has 25 in its updates.
Ubuntu 22.04 stays at 23.2; there Debian's lavapipe, one library that needs no more than 22.04's own glibc and LLVM
15, is unpacked into FOLDER and named by VK_ICD_FILENAMES, beside the system's Mesa and without touching it. That
needs no root where the libraries it needs are there already.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import os
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
import urllib.request
from pathlib import Path

from hazard_ms.machine.processes import environment
from hazard_ms.machine.survey import Machine, read_machine
from hazard_ms.machine.vulkan import Answer, ask_vulkan
from hazard_ms.spec.storage.files import write

# Library that SAPIEN or a Vulkan driver loads -> Debian's and Ubuntu's package of it.
LIBRARIES = {"libX11.so.6": "libx11-6", "libXext.so.6": "libxext6", "libvulkan.so.1": "libvulkan1"}
LAVAPIPE = "mesa-vulkan-drivers"
BACKPORTS = "bookworm-backports"
BACKPORTS_FILE = "/etc/apt/sources.list.d/hazard_ms-backports.list"
# of the package python-apt-common: Debian's own address, on Ubuntu too
MIRRORS = Path("/usr/share/python-apt/templates/Debian.info")
# The package that holds the unpacked lavapipe; its contents are checked, so any mirror will do.
PRIVATE_PACKAGE = "pool/main/m/mesa/mesa-vulkan-drivers_25.0.7-2~bpo12+1_amd64.deb"
PRIVATE_SHA256 = "3899f1800424c60a05df5d6913076a526ca8fdbabec43672cd397563d1ca3263"
PRIVATE_LIBRARY = "usr/lib/x86_64-linux-gnu/libvulkan_lvp.so"
DOWNLOAD_TIMEOUT = 60.0  # [s] without a byte

Command = list[str]


def say(text: str) -> None:
    """Print a message for the user."""
    print(f"run: {text}", file=sys.stderr, flush=True)


def missing_packages(machine: Machine, vulkan: Answer) -> list[str]:
    """Packages that Debian or Ubuntu must install so that this machine can draw."""
    packages = [package for library, package in LIBRARIES.items() if library not in machine.libraries]
    return packages if vulkan.usable else [*packages, LAVAPIPE]


def install_commands(machine: Machine, packages: list[str], policy: str = "") -> list[Command]:
    """The commands with which root installs `packages`.

    `policy`: the text of `apt-cache policy`, which names the mirror in use.
    Raises ValueError if no mirror with Debian's backports is known.
    """
    target: Command = []
    commands: list[Command] = []
    if (machine.system, machine.release) == ("debian", "12") and LAVAPIPE in packages:
        target = ["-t", BACKPORTS]
        if BACKPORTS not in policy:
            found = re.search(r"(https?://\S+) bookworm/main", policy)
            line = f"deb {found[1] if found else mirror()} {BACKPORTS} main"
            commands.append(["sh", "-c", f"echo {shlex.quote(line)} > {BACKPORTS_FILE}"])
    commands.append(["apt-get", "update", "-qq"])
    commands.append(["apt-get", "install", "-y", "-qq", "--no-install-recommends", *target, *packages])
    return commands


def mirror(templates: Path = MIRRORS) -> str:
    """Address of a Debian mirror: HAZARD_MS_DEBIAN, else the one that python-apt-common names.

    Raises ValueError if neither gives one.
    """
    if os.environ.get("HAZARD_MS_DEBIAN"):
        return os.environ["HAZARD_MS_DEBIAN"].rstrip("/")
    if not templates.exists() and shutil.which("apt-get"):
        install([["apt-get", "install", "-y", "-qq", "--no-install-recommends", "python-apt-common"]])
    found = (
        re.search(r"^BaseURI: (https?://\S+/debian)/?$", templates.read_text(encoding="utf-8"), re.M)
        if templates.exists()
        else None
    )
    if not found:
        raise ValueError(
            "HAZARD_MS_DEBIAN must be the address of a Debian mirror, got nothing; set it, or install python-apt-common"
        )
    return found[1]


def root_prefix() -> Command | None:
    """The words before a command that make it run as root without a password; None if that is not possible."""
    if os.environ.get("HAZARD_MS_NO_SYSTEM"):
        return None
    if os.geteuid() == 0:
        return ["env", "DEBIAN_FRONTEND=noninteractive"]
    sudo = shutil.which("sudo")
    if (
        sudo
        and subprocess.run([sudo, "-n", "true"], capture_output=True, check=False, env=environment()).returncode == 0
    ):
        return [sudo, "-n", "env", "DEBIAN_FRONTEND=noninteractive"]
    return None


def install(commands: list[Command]) -> bool:
    """Run `commands` as root; return False if that is not possible or one of them fails."""
    prefix = root_prefix()
    if prefix is None:
        return False
    for command in commands:
        say(f"as root: {shlex.join(command)}")
        done = subprocess.run(
            [*prefix, *command], stdout=subprocess.DEVNULL, stdin=subprocess.DEVNULL, check=False, env=environment()
        )
        if done.returncode != 0:
            say(f"that failed with code {done.returncode}")
            return False
    return True


def unpack_lavapipe(folder: Path) -> Path:
    """Put Debian's lavapipe into `folder`; return its driver description, which names the library by its full path.

    Raises ValueError if the download is not the expected package, OSError if it fails.
    """
    manifest = folder / "lvp_icd.json"
    if manifest.exists():
        return manifest
    folder.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=folder.parent) as scratch:
        package = Path(scratch) / "package.deb"
        address = f"{mirror()}/{PRIVATE_PACKAGE}"
        with urllib.request.urlopen(address, timeout=DOWNLOAD_TIMEOUT) as reply:  # noqa: S310 (its contents are checked)
            package.write_bytes(reply.read())
        if hashlib.sha256(package.read_bytes()).hexdigest() != PRIVATE_SHA256:
            raise ValueError(f"{address} must have the SHA-256 {PRIVATE_SHA256}, got another file")
        subprocess.run(["dpkg-deb", "-x", str(package), f"{scratch}/files"], check=True, env=environment())
        folder.mkdir(exist_ok=True)
        shutil.move(f"{scratch}/files/{PRIVATE_LIBRARY}", folder / "libvulkan_lvp.so")
    text = {
        "file_format_version": "1.0.0",
        "ICD": {"api_version": "1.4.305", "library_path": str(folder / "libvulkan_lvp.so")},
    }
    write(manifest, json.dumps(text))
    return manifest


def private_lavapipe(home: Path) -> dict[str, str]:
    """Environment variables under which the unpacked lavapipe draws; empty if it does not."""
    try:
        manifest = str(unpack_lavapipe(home / "lavapipe-25.0.7"))
    except (OSError, ValueError, subprocess.SubprocessError) as error:
        say(f"lavapipe could not be unpacked: {error}")
        return {}
    variables = {"VK_ICD_FILENAMES": manifest, "VK_DRIVER_FILES": manifest}  # the loader of 22.04 knows only the first
    return variables if ask_vulkan({**os.environ, **variables}).usable else {}


def command_line(machine: Machine, packages: list[str]) -> str:
    """One line that a user with root can copy."""
    if not shutil.which("apt-get"):
        return "use your package manager to install the Vulkan loader, libX11, libXext and lavapipe of Mesa >= 24.3"
    commands = install_commands(machine, packages, policy())
    return " && ".join(f"sudo {shlex.join(command)}" for command in commands)


def policy() -> str:
    """The text of `apt-cache policy`: which suites are known, and from where."""
    return subprocess.run(
        ["apt-cache", "policy"], capture_output=True, text=True, check=False, env=environment()
    ).stdout


def prepare(home: Path) -> dict[str, str] | None:
    """Make this machine draw; return the environment variables that this needs, None if it cannot draw."""
    machine, vulkan = read_machine(), ask_vulkan()
    packages = missing_packages(machine, vulkan)
    if not packages:
        return {}
    if machine.chosen_by:
        say(f"{machine.chosen_by} must name a driver that works, or be unset")
        return None
    if shutil.which("apt-get") and install(install_commands(machine, packages, policy())):
        machine, vulkan = read_machine(), ask_vulkan()
        packages = missing_packages(machine, vulkan)
        if not packages:
            return {}
    if packages == [LAVAPIPE] and (variables := private_lavapipe(home)):
        return variables
    say("this machine cannot draw pictures yet; as root, once:")
    say(f"  {command_line(machine, packages)}")
    return None


def main() -> int:
    """Parse the command line that `./run` gives, prepare the machine and write the answer."""
    parser = argparse.ArgumentParser(
        prog="python -m hazard_ms.machine.drivers", description=(__doc__ or "").splitlines()[0]
    )
    parser.add_argument("--home", type=Path, required=True, help="where an unpacked lavapipe is kept")
    parser.add_argument("--answer", type=Path, required=True, help="file of shell lines to write")
    options = parser.parse_args()
    variables = prepare(options.home)
    if variables is None:
        return 1
    write(options.answer, "".join(f"export {name}={shlex.quote(value)}\n" for name, value in variables.items()))
    return 0


if __name__ == "__main__":
    sys.exit(main())
