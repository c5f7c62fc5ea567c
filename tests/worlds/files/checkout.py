"""A checkout of this repository as a new user has it: its lock, its script `run`, a copy to build packages from."""

from __future__ import annotations

import base64
import hashlib
import os
import re
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path

ROOT = Path(__file__).parents[3]
PYTHONS = ("3.10", "3.11", "3.12")
THIS_PYTHON = f"{sys.version_info.major}.{sys.version_info.minor}"
UV_VERSION = re.findall(r"^uv==([\d.]+)", (ROOT / "requirements-uv.txt").read_text(), re.M)[0]
REQUIREMENT_FILES = ("requirements.lock", "requirements-uv.txt", "requirements-overrides.txt")


def pins(text: str) -> list[tuple[str, str, list[str]]]:
    """Requirement, marker and hashes of each pin of a file in pip's format."""
    found = []
    for line in text.replace("\\\n", " ").splitlines():
        pin, _, hashes = line.partition(" --hash=")
        name, _, marker = pin.partition(" ; ")
        found.append((name.strip(), marker.strip(), f"--hash={hashes}".split()))
    return found


def locked(python: str) -> dict[str, str]:
    """What the lock installs on 64-bit Linux for a version of Python: version by name."""
    from packaging.markers import Marker

    machine = {
        "python_version": python,
        "python_full_version": f"{python}.9",
        "sys_platform": "linux",
        "platform_system": "Linux",
        "platform_machine": "x86_64",
        "platform_python_implementation": "CPython",
    }
    versions: dict[str, str] = {}
    for requirement, marker, _ in pins((ROOT / "requirements.lock").read_text()):
        if not marker or Marker(marker).evaluate(machine):
            name, _, version = requirement.partition("==")
            assert version and name not in versions, f"{name} must be pinned once for Python {python}"
            versions[name] = version
    return versions


def run(*arguments: str, root: Path = ROOT, **variables: str) -> subprocess.CompletedProcess[str]:
    """`./run` of the checkout at `root`."""
    environ = {**os.environ, **variables}
    return subprocess.run(
        [str(root / "run"), *arguments], env=environ, capture_output=True, text=True, check=False, timeout=280
    )


def installed_uv() -> Path | None:
    """The folder of the uv that `./run` installed; None where the tests were not started by it."""
    folder = Path(os.environ.get("HAZARD_MS_HOME", "/nowhere")) / f"uv-{UV_VERSION}"
    return folder if (folder / "bin/uv").exists() else None


def small_checkout(folder: Path, lock: str) -> Path:
    """A checkout in `folder` whose lock is the text `lock`, with the package beside it."""
    shutil.copy(ROOT / "run", folder / "run")
    for name in REQUIREMENT_FILES:
        shutil.copy(ROOT / name, folder / name)
    shutil.copytree(ROOT / "hazard_ms", folder / "hazard_ms", ignore=shutil.ignore_patterns("__pycache__", "_assets"))
    (folder / "requirements.lock").write_text(lock)
    return folder


def make_wheel(folder: Path, name: str, version: str) -> tuple[Path, str]:
    """A wheel with one module `name` that holds its version, and the SHA-256 of the file."""
    info = f"{name}-{version}.dist-info"
    files = {
        f"{name}.py": f"version = {version!r}\n",
        f"{info}/METADATA": f"Metadata-Version: 2.1\nName: {name}\nVersion: {version}\n",
        f"{info}/WHEEL": "Wheel-Version: 1.0\nGenerator: tests\nRoot-Is-Purelib: true\nTag: py3-none-any\n",
    }
    rows = [f"{path},sha256={_record_hash(text)},{len(text)}" for path, text in files.items()]
    files[f"{info}/RECORD"] = "\n".join([*rows, f"{info}/RECORD,,"]) + "\n"
    folder.mkdir(parents=True, exist_ok=True)
    wheel = folder / f"{name}-{version}-py3-none-any.whl"
    with zipfile.ZipFile(wheel, "w") as archive:
        for path, text in files.items():
            archive.writestr(path, text)
    return wheel, hashlib.sha256(wheel.read_bytes()).hexdigest()


def _record_hash(text: str) -> str:
    return base64.urlsafe_b64encode(hashlib.sha256(text.encode()).digest()).rstrip(b"=").decode()


def source_copy(folder: Path) -> Path:
    """The files that a package is built from, and those that must not get into it, copied to `folder`."""
    unwanted = shutil.ignore_patterns(".*", "__pycache__", "demo*_output", "build", "dist", "_assets", "*.egg-info")
    shutil.copytree(ROOT, folder, ignore=unwanted)
    return folder


def build(source: Path, kind: str) -> Path:
    """Build the `wheel` or `sdist` of a source tree; the file."""
    code = f"from setuptools import build_meta; print(build_meta.build_{kind}('.'))"
    done = subprocess.run([sys.executable, "-c", code], cwd=source, capture_output=True, text=True, check=True)
    return source / done.stdout.split()[-1]
