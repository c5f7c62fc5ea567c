"""Set-up: the lock, the wheel, the script `run`."""

from __future__ import annotations

import ast
import os
import re
import shutil
import signal
import subprocess
import sys
import time
import zipfile
from pathlib import Path

import pytest

pytestmark = pytest.mark.setup
ROOT = Path(__file__).parents[1]
PYTHONS = ("3.10", "3.11", "3.12")


def locked(python: str) -> dict[str, str]:
    """What the lock installs on 64-bit Linux for a version of Python."""
    from packaging.markers import Marker

    machine = {
        "python_version": python,
        "python_full_version": f"{python}.0",
        "sys_platform": "linux",
        "platform_system": "Linux",
        "platform_machine": "x86_64",
        "platform_python_implementation": "CPython",
    }
    versions: dict[str, str] = {}
    for line in (ROOT / "requirements.lock").read_text().splitlines():
        pin, _, marker = line.partition(" ; ")
        if not marker or Marker(marker).evaluate(machine):
            name, _, version = pin.partition("==")
            assert version and name not in versions, f"{line}: {name} must be pinned once for Python {python}"
            versions[name] = version
    return versions


def setup_argument(name: str) -> object:
    """A literal keyword of the call of setup() in setup.py."""
    calls = [node for node in ast.walk(ast.parse((ROOT / "setup.py").read_text())) if isinstance(node, ast.Call)]
    call = next(node for node in calls if getattr(node.func, "id", "") == "setup")
    return ast.literal_eval(next(keyword.value for keyword in call.keywords if keyword.arg == name))


def test_the_lock_names_no_hosts_and_no_folders() -> None:
    text = (ROOT / "requirements.lock").read_text()
    assert not re.search(r"https?:|file:|@|/|^-", text, re.MULTILINE)


@pytest.mark.parametrize("python", PYTHONS)
def test_the_lock_holds_all_that_the_package_asks_for(python: str) -> None:
    from packaging.requirements import Requirement

    extras = setup_argument("extras_require")
    requirements = setup_argument("install_requires")
    assert isinstance(extras, dict) and isinstance(requirements, list)
    versions = locked(python)
    for text in [*requirements, *extras["rl"], *extras["test"]]:
        requirement = Requirement(text)
        assert requirement.specifier.contains(versions[requirement.name]), text


@pytest.mark.parametrize("python", PYTHONS)
def test_the_lock_holds_one_opencv(python: str) -> None:
    assert [name for name in locked(python) if name.startswith("opencv")] == ["opencv-python-headless"]


def test_the_wheel_works_without_the_checkout(tmp_path: Path) -> None:
    """Built from a copy, unpacked elsewhere, imported there: with version, command and every asset of the index."""
    source = tmp_path / "source"
    unwanted = shutil.ignore_patterns(".*", "__pycache__", "demo_output", "tests", "_assets", "*.egg-info")
    shutil.copytree(ROOT, source, ignore=unwanted)
    code = "from setuptools import build_meta; print(build_meta.build_wheel('.'))"
    built = subprocess.run([sys.executable, "-c", code], cwd=source, capture_output=True, text=True, check=True).stdout
    site = tmp_path / "site"
    with zipfile.ZipFile(source / built.split()[-1]) as wheel:
        wheel.extractall(site)
    scripts = [path.read_text() for path in site.glob("*.dist-info/entry_points.txt")]
    assert len(scripts) == 1 and "hazard-ms = hazard_ms.cli:main" in scripts[0]
    code = (
        "import hazard_ms, pathlib; from hazard_ms.assets import asset_ids, asset, asset_path\n"
        "print(pathlib.Path(hazard_ms.__file__).parents[1], len(asset_ids()), all(asset_path(asset(a).visual).is_file()"
        " for a in asset_ids() if asset(a).visual))"
    )
    environ = {**os.environ, "PYTHONPATH": str(site)}
    child = subprocess.run([sys.executable, "-c", code], cwd=tmp_path, env=environ, capture_output=True, text=True, check=True)
    place, number, complete = child.stdout.split()
    assert place == str(site) and int(number) > 0 and complete == "True"


def run(*arguments: str, root: Path = ROOT, **variables: str) -> subprocess.CompletedProcess[str]:
    environ = {**os.environ, **variables}
    return subprocess.run([str(root / "run"), *arguments], env=environ, capture_output=True, text=True, check=False, timeout=280)


def test_run_refuses_what_it_does_not_know_before_any_set_up(tmp_path: Path) -> None:
    done = run("dance", HAZARD_MS_HOME=str(tmp_path / "home"))
    assert done.returncode == 1 and "'dance'" in done.stderr and "demo, test, python or hazard-ms" in done.stderr
    assert not (tmp_path / "home").exists()


def test_run_refuses_a_python_that_is_none(tmp_path: Path) -> None:
    done = run("python", HAZARD_MS_HOME=str(tmp_path), HAZARD_MS_PYTHON="/bin/false")
    assert done.returncode == 1 and "/bin/false is not a Python 3.10, 3.11 or 3.12" in done.stderr


def test_run_says_when_its_home_is_no_folder(tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    done = run("python", HAZARD_MS_HOME=str(tmp_path / "file"))
    assert done.returncode == 1 and "HAZARD_MS_HOME" in done.stderr


def test_a_second_start_adds_less_than_two_seconds() -> None:
    if not (Path(os.environ.get("VIRTUAL_ENV", "/nowhere")) / "ready").exists():
        pytest.skip("not started by ./run")
    began = time.perf_counter()
    done = run("python", "-c", "pass")
    assert done.returncode == 0, done.stderr
    assert time.perf_counter() - began < 2.0


@pytest.fixture
def small(tmp_path: Path) -> Path:
    """A checkout whose lock holds only what the import of the package needs."""
    shutil.copy(ROOT / "run", tmp_path / "run")
    shutil.copytree(ROOT / "hazard_ms", tmp_path / "hazard_ms", ignore=shutil.ignore_patterns("__pycache__"))
    wanted = ("gymnasium", "numpy", "cloudpickle", "typing-extensions", "farama-notifications")
    versions = locked(f"{sys.version_info.major}.{sys.version_info.minor}")
    (tmp_path / "requirements.lock").write_text("".join(f"{name}=={versions[name]}\n" for name in wanted))
    return tmp_path


@pytest.mark.long
def test_two_starts_at_once_and_an_interrupted_one(small: Path) -> None:
    """Whatever happens to a set-up, the next start ends with a whole environment."""
    base = getattr(sys, "_base_executable", sys.executable)
    environ = {**os.environ, "HAZARD_MS_HOME": str(small / "home"), "HAZARD_MS_PYTHON": base, "HAZARD_MS_NO_SYSTEM": "1"}
    command = [str(small / "run"), "python", "-c", "import gymnasium; print('whole')"]
    first = subprocess.Popen(command, env=environ, start_new_session=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    while first.poll() is None and not list((small / "home").glob("env-*")):
        time.sleep(0.01)
    os.killpg(first.pid, signal.SIGKILL)
    first.wait()
    assert not list((small / "home").glob("env-*/ready")), "it was to be interrupted half way"
    both = [subprocess.Popen(command, env=environ, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) for _ in range(2)]
    ends = [process.communicate(timeout=250) for process in both]
    assert [out.strip() for out, _ in ends] == ["whole", "whole"], ends
    assert sum("making the environment" in err for _, err in ends) == 1, "one makes it, the other waits"
    assert len(list((small / "home").glob("env-*/ready"))) == 1
