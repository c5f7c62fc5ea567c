"""The lock: it pins everything that the package asks for, each file by its hash, and a wrong hash is refused."""

from __future__ import annotations

import ast
import re
import subprocess
import sys
from pathlib import Path

import pytest

from tests.worlds.files.checkout import (
    PYTHONS,
    ROOT,
    THIS_PYTHON,
    UV_VERSION,
    installed_uv,
    locked,
    make_wheel,
    pins,
    run,
    small_checkout,
)

LOCKS = ("requirements.lock", "requirements-uv.txt", "requirements-local-llm.txt", "requirements-release.txt")

pytestmark = pytest.mark.setup
LOCKED_EXTRAS = ("rl", "pictures", "demos", "docs", "test")  # the others serve users, not our own checks
HASH = re.compile(r"--hash=sha256:[0-9a-f]{64}")
WRONG = "0" * 64


def setup_argument(name: str) -> object:
    """A literal keyword of the call of setup() in setup.py."""
    calls = [node for node in ast.walk(ast.parse((ROOT / "setup.py").read_text())) if isinstance(node, ast.Call)]
    call = next(node for node in calls if getattr(node.func, "id", "") == "setup")
    return ast.literal_eval(next(keyword.value for keyword in call.keywords if keyword.arg == name))


@pytest.mark.parametrize("name", LOCKS)
def test_locks_name_no_hosts_and_no_folders(name: str) -> None:
    text = (ROOT / name).read_text()
    assert not re.search(r"https?:|file:|@|/|^-", text, re.MULTILINE)


@pytest.mark.parametrize("name", LOCKS)
def test_every_pin_has_hashes(name: str) -> None:
    found = pins((ROOT / name).read_text())
    assert found
    for requirement, _, hashes in found:
        assert "==" in requirement and all(HASH.fullmatch(text) for text in hashes), requirement


@pytest.mark.parametrize("python", PYTHONS)
def test_the_lock_holds_all_that_the_package_asks_for(python: str) -> None:
    from packaging.requirements import Requirement

    extras = setup_argument("extras_require")
    requirements = setup_argument("install_requires")
    assert isinstance(extras, dict) and isinstance(requirements, list)
    versions = locked(python)
    for text in [*requirements, *(text for extra in LOCKED_EXTRAS for text in extras[extra])]:
        requirement = Requirement(text)
        assert requirement.specifier.contains(versions[requirement.name]), text


def test_the_extras_are_those_that_the_documentation_names() -> None:
    extras = setup_argument("extras_require")
    assert isinstance(extras, dict)
    named = set(re.findall(r"^\| `([a-z]+)` \|", (ROOT / "docs/installation.md").read_text(), re.M))
    assert named == set(extras)


@pytest.mark.parametrize("python", PYTHONS)
def test_the_lock_holds_one_opencv(python: str) -> None:
    assert [name for name in locked(python) if name.startswith("opencv")] == ["opencv-python-headless"]


@pytest.fixture
def offline(tmp_path: Path) -> dict[str, str]:
    """Variables for a set-up without network: packages come from the folder `wheels`, uv is the one that is here."""
    uv = installed_uv()
    if uv is None:
        pytest.skip("not started by ./run")
    home = tmp_path / "home"
    home.mkdir()
    (home / uv.name).symlink_to(uv)
    (tmp_path / "wheels").mkdir()
    return {
        "HAZARD_MS_HOME": str(home),
        "HAZARD_MS_PYTHON": getattr(sys, "_base_executable", sys.executable),
        "HAZARD_MS_NO_SYSTEM": "1",
        "UV_NO_INDEX": "1",
        "UV_FIND_LINKS": str(tmp_path / "wheels"),
        "UV_CACHE_DIR": str(tmp_path / "cache"),
    }


@pytest.mark.parametrize(
    ("hashes", "refusal"),
    [("--hash=sha256:{right}", ""), (f"--hash=sha256:{WRONG}", "Hash mismatch"), ("", "must have a hash")],
    ids=["right", "tampered", "dropped"],
)
def test_run_installs_only_files_with_the_hashes_of_the_lock(
    tmp_path: Path, offline: dict[str, str], hashes: str, refusal: str
) -> None:
    _, right = make_wheel(tmp_path / "wheels", "thing", "1.0")
    lock = f"thing==1.0 {hashes}\n".format(right=right)
    checkout = small_checkout(tmp_path, lock)
    done = run("pip", "list", root=checkout, **offline)
    if refusal:
        assert done.returncode == 1 and refusal.lower() in done.stderr.lower()
        assert not list((tmp_path / "home").glob("env-*/ready"))
    else:
        assert done.returncode == 0, done.stderr
        assert "thing" in done.stdout


def test_run_refuses_an_uv_with_another_hash(tmp_path: Path, offline: dict[str, str]) -> None:
    (tmp_path / "home" / f"uv-{UV_VERSION}").unlink()
    make_wheel(tmp_path / "wheels", "uv", UV_VERSION)
    pip = {"PIP_NO_INDEX": "1", "PIP_FIND_LINKS": str(tmp_path / "wheels"), "PIP_EXTRA_INDEX_URL": ""}
    done = run("pip", "list", root=small_checkout(tmp_path, ""), **offline, **pip)
    assert done.returncode == 1
    assert "DO NOT MATCH THE HASHES" in done.stderr and "could not install uv" in done.stderr
    assert not (tmp_path / "home" / f"uv-{UV_VERSION}").exists()


def test_run_pip_adds_packages_but_keeps_those_of_the_lock(tmp_path: Path, offline: dict[str, str]) -> None:
    _, locked_hash = make_wheel(tmp_path / "wheels", "thing", "1.0")
    for name, version in (("thing", "2.0"), ("other", "3.0")):
        make_wheel(tmp_path / "wheels", name, version)
    checkout = small_checkout(tmp_path, f"thing==1.0 --hash=sha256:{locked_hash}\n")
    assert run("pip", "install", "other", root=checkout, **offline).returncode == 0
    refused = run("pip", "install", "thing==2.0", root=checkout, **offline)
    assert refused.returncode != 0 and "thing==1.0" in refused.stderr
    code = "import thing, other; print(thing.version, other.version)"
    python = next((tmp_path / "home").glob("env-*/bin/python"))
    out = subprocess.run([str(python), "-c", code], capture_output=True, text=True, check=True).stdout
    assert out.split() == ["1.0", "3.0"] and THIS_PYTHON in python.parts[-3]
