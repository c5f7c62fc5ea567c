"""The packages: what a wheel and an sdist hold, and that the wheel works far from the checkout.

An sdist holds what the wheel is built from and no more: tests, documentation and examples belong to the repository,
where `./run` and the lock set up what they need.
"""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
import tarfile
import zipfile
from pathlib import Path

import pytest

from hazard_ms.spec.registry.version import __version__
from tests.worlds.files.checkout import PYTHONS, ROOT, build, installed_uv, source_copy

pytestmark = pytest.mark.setup
UNSHIPPED_ASSETS = {"build"}  # the scripts that made the models


def tracked(folder: str) -> set[str]:
    """Files below `folder` that belong to the repository, relative to it: what is not hidden, compiled or generated."""
    top = ROOT / folder
    paths = [path.relative_to(top) for path in top.rglob("*") if path.is_file()]
    return {
        str(path)
        for path in paths
        if not any(part.startswith(".") or part in ("__pycache__", "_assets") for part in path.parts)
    }


def expected_in_wheel() -> set[str]:
    """Code and data of the package, and `assets/` as `hazard_ms/_assets`."""
    code = {f"hazard_ms/{name}" for name in tracked("hazard_ms")}
    assets = {name for name in tracked("assets") if name.split("/")[0] not in UNSHIPPED_ASSETS}
    return code | {f"hazard_ms/_assets/{name}" for name in assets}


@pytest.fixture(scope="module")
def source(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return source_copy(tmp_path_factory.mktemp("package") / "source")


@pytest.fixture(scope="module")
def wheel(source: Path) -> Path:
    return build(source, "wheel")


@pytest.fixture(scope="module")
def sdist(source: Path) -> Path:
    return build(source, "sdist")


def test_the_wheel_holds_the_package_its_assets_and_the_licence(wheel: Path) -> None:
    with zipfile.ZipFile(wheel) as archive:
        names = {name for name in archive.namelist() if not name.endswith("/")}
    about = {name.split("/", 1)[1] for name in names if ".dist-info/" in name}
    assert {name for name in names if ".dist-info/" not in name} == expected_in_wheel()
    licences = {"licenses/LICENSE", "licenses/assets/ATTRIBUTION.md"}
    assert about == licences | {"METADATA", "WHEEL", "RECORD", "entry_points.txt", "top_level.txt"}


def test_the_wheel_says_what_it_is_and_under_which_licences(wheel: Path) -> None:
    """Fields that PyPI refuses are refused here; every licence of a model stands beside that of the code."""
    from packaging.metadata import Metadata

    with zipfile.ZipFile(wheel) as archive:
        (name,) = [name for name in archive.namelist() if name.endswith(".dist-info/METADATA")]
        told = Metadata.from_email(archive.read(name), validate=True)
    assert told.name == "hazard_ms" and str(told.version) == __version__ and told.author and told.summary
    assert told.description == (ROOT / "README.md").read_text() and told.description_content_type == "text/markdown"
    licences = {entry["licence"] for entry in json.loads((ROOT / "assets/index.json").read_text())}
    assert told.license_expression
    assert set(told.license_expression.split(" AND ")) == {"Apache-2.0"} | (licences - {"own work"})
    pythons = {text.rpartition(" ")[2] for text in told.classifiers if text.startswith("Programming Language :: ")}
    assert told.requires_python and pythons == {text for text in PYTHONS if told.requires_python.contains(text)}


def test_the_sdist_holds_what_the_wheel_is_built_from(sdist: Path, wheel: Path, tmp_path: Path) -> None:
    with tarfile.open(sdist) as archive:
        archive.extractall(tmp_path, filter="data")
    root = next(tmp_path.iterdir())
    files = {path.relative_to(root) for path in root.rglob("*") if path.is_file()}
    rooms = {path.parts[0] for path in files if len(path.parts) > 1}
    assert rooms == {"hazard_ms", "assets", "hazard_ms.egg-info"}
    top = {str(path) for path in files if len(path.parts) == 1}
    assert top == {"LICENSE", "PKG-INFO", "README.md", "pyproject.toml", "setup.cfg", "setup.py"}
    with zipfile.ZipFile(build(root, "wheel")) as again, zipfile.ZipFile(wheel) as direct:
        assert sorted(again.namelist()) == sorted(direct.namelist())


def test_the_wheel_works_without_the_checkout(wheel: Path, tmp_path: Path) -> None:
    """Unpacked elsewhere and imported there: with version, command and every asset of the index."""
    site = tmp_path / "site"
    with zipfile.ZipFile(wheel) as archive:
        archive.extractall(site)
    scripts = [path.read_text() for path in site.glob("*.dist-info/entry_points.txt")]
    assert len(scripts) == 1 and "hazard-ms = hazard_ms.cli.__main__:main" in scripts[0]
    code = (
        "import hazard_ms, pathlib; from hazard_ms.scenes.assets.index import asset_ids, asset, asset_path\n"
        "print(pathlib.Path(hazard_ms.__file__).parents[1], len(asset_ids()), all(asset_path(asset(a).visual).is_file()"
        " for a in asset_ids() if asset(a).visual))"
    )
    environ = {**os.environ, "PYTHONPATH": str(site)}
    command = [sys.executable, "-c", code]
    child = subprocess.run(command, cwd=tmp_path, env=environ, capture_output=True, text=True, check=True)
    place, number, complete = child.stdout.split()
    assert place == str(site) and int(number) > 0 and complete == "True"


def test_pip_installs_from_another_directory(source: Path, tmp_path: Path) -> None:
    """`pip install PATH` as a user gives it, without its dependencies; the command starts there."""
    base = getattr(sys, "_base_executable", sys.executable)
    if subprocess.run([base, "-m", "pip", "--version"], capture_output=True, check=False).returncode:
        pytest.skip("no pip")
    target = tmp_path / "target"
    site = next(path for path in map(Path, sys.path) if (path / "setuptools").is_dir())
    environ = {**os.environ, "PYTHONPATH": str(site)}
    done = subprocess.run(
        [base, "-m", "pip", "install", "--quiet", "--no-deps", "--no-build-isolation", "--no-index"]
        + ["--target", str(target), str(source)],
        cwd=tmp_path,
        env=environ,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    environ["PYTHONPATH"] = str(target)
    command = [sys.executable, str(target / "bin/hazard-ms"), "version"]
    said = subprocess.run(command, cwd=tmp_path, env=environ, capture_output=True, text=True, check=False)
    assert said.returncode == 0 and "hazard_ms" in said.stdout, said.stderr


@pytest.mark.long
@pytest.mark.timeout(3600)
def test_the_wheel_brings_all_that_an_episode_needs(wheel: Path, tmp_path: Path) -> None:
    """Installed into an empty environment with what it asks for, in the versions of the lock, it plays a rescue.

    Downloads gigabytes, where uv has not kept them.
    """
    uv = installed_uv()
    if uv is None:
        pytest.skip("not started by ./run")
    kept = {name: value for name, value in os.environ.items() if name not in ("PYTHONPATH", "VIRTUAL_ENV")}
    base = getattr(sys, "_base_executable", sys.executable)
    subprocess.run(
        [str(uv / "bin/uv"), "venv", "--quiet", "--python", base, "bare"], cwd=tmp_path, env=kept, check=True
    )
    constraints = ["-c", str(ROOT / "requirements.lock"), "--overrides", str(ROOT / "requirements-overrides.txt")]
    subprocess.run(
        [str(uv / "bin/uv"), "pip", "install", "--quiet", "--no-build", "--python", "bare", str(wheel), *constraints],
        cwd=tmp_path,
        env=kept,
        check=True,
    )
    command = [str(tmp_path / "bare/bin/hazard-ms"), *"play -e HazardFire-v1 --agent greedy -s 0".split()]
    played = subprocess.run(command, cwd=tmp_path, env=kept, capture_output=True, text=True, check=False)
    assert played.returncode == 0, played.stderr[-3000:]
    found = re.search(r"greedy rescued (\d+) of \d+ targets", played.stdout)
    assert found and int(found[1]) > 0, played.stdout
