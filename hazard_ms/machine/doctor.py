"""Find out why hazard_ms does not start or draw on this machine, and name one cause and one command.

`collect()` gathers the facts; everything that loads a driver runs in a child process, so that a crash is a fact like
any other. `examine(facts)` in diagnosis.py judges them and changes nothing.
"""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from collections.abc import Mapping
from dataclasses import asdict
from pathlib import Path

from hazard_ms.machine import render_backend
from hazard_ms.machine.diagnosis import OPENCVS, PACKAGES, Facts, chosen_backend, examine, installed_version
from hazard_ms.machine.processes import environment
from hazard_ms.machine.survey import read_machine
from hazard_ms.machine.vulkan import ask_vulkan, last_line
from hazard_ms.spec.storage.cache import home

CHILD_TIMEOUT = 120.0  # [s] importing torch from a cold disk takes most of a minute


def collect(
    environ: Mapping[str, str] | None = None, root: Path = Path("/"), ldconfig: str | None = None, draw: bool = True
) -> Facts:
    """Gather the facts for a process with `environ` on the machine below `root`; without `draw` SAPIEN only starts."""
    environ = dict(os.environ if environ is None else environ)
    machine = read_machine(root, environ, ldconfig)
    gpu_fault = render_backend.trial_fault("gpu", draw, environ) if machine.nvidia_devices else None
    cpu_fault = None if gpu_fault == "" else render_backend.trial_fault("cpu", draw, environ)
    check = "import sys, torch; sys.exit(not torch.cuda.is_available() and 'torch finds no CUDA device')"
    return Facts(
        machine=machine,
        vulkan=ask_vulkan(environ),
        python=(sys.version_info.major, sys.version_info.minor),
        packages=installed(),
        gpu_fault=gpu_fault,
        cpu_fault=cpu_fault,
        opencv_fault=python_fault("import cv2", environ),
        cuda_fault=python_fault(check, environ) if machine.nvidia_devices else None,
        free=free_space(home()),
    )


def installed() -> dict[str, str]:
    """Versions of the installed packages that matter."""
    found = {name: installed_version(name) for name in {*PACKAGES, *OPENCVS}}
    return {name: version for name, version in found.items() if version}


def python_fault(code: str, environ: Mapping[str, str]) -> str:
    """The reason why `code` fails in a child process; empty if it does not."""
    try:
        command = [sys.executable, "-c", code]
        child = subprocess.run(
            command, capture_output=True, text=True, timeout=CHILD_TIMEOUT, check=False, env=environment(environ)
        )
    except subprocess.TimeoutExpired:
        return f"no answer within {CHILD_TIMEOUT:.0f} s"
    if child.returncode < 0:
        return f"crashed (signal {-child.returncode})"
    return "" if child.returncode == 0 else last_line(child.stderr) or f"ended with code {child.returncode}"


def free_space(folder: Path) -> float:
    """Free space [GB] for `folder`, which need not exist yet."""
    while not folder.exists():
        folder = folder.parent
    return shutil.disk_usage(folder).free / 1e9


def report(facts: Facts, as_json: bool) -> int:
    """Print the findings, one cause and one command; return 0 if nothing is at fault, else 1."""
    findings = examine(facts)
    fault = next((finding for finding in findings if finding.state == "fault"), None)
    if as_json:
        cause = None if fault is None else asdict(fault)
        print(
            json.dumps(
                {"backend": chosen_backend(facts), "cause": cause, "findings": [asdict(f) for f in findings]}, indent=2
            )
        )
        return int(fault is not None)
    for finding in findings:
        print(f"{finding.state:8} {finding.name:15} {finding.detail}")
    if fault is None:
        print("No problems found.")
        return 0
    print(f"\nCause:   {fault.detail}\nCommand: {fault.command}")
    return 1
