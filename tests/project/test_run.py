"""The script `run`: what it refuses, what it keeps, and how it survives an interrupted set-up."""

from __future__ import annotations

import os
import resource
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import pytest

from tests.worlds.files.checkout import ROOT, THIS_PYTHON, installed_uv, locked, pins, run, small_checkout

pytestmark = pytest.mark.setup
COMMANDS = ("demo", "demos", "test", "results", "gpu-check", "docs", "python", "hazard-ms", "pip")


@pytest.fixture
def started_by_run() -> Path:
    """The folder of environments that these tests run in."""
    if not (Path(os.environ.get("VIRTUAL_ENV", "/nowhere")) / "ready").exists():
        pytest.skip("not started by ./run")
    return Path(os.environ["HAZARD_MS_HOME"])


def test_run_refuses_what_it_does_not_know_before_any_set_up(tmp_path: Path) -> None:
    done = run("dance", HAZARD_MS_HOME=str(tmp_path / "home"))
    assert done.returncode == 1
    assert (
        "must be demo, demos, serve, test, results, gpu-check, docs, python, hazard-ms or pip, got 'dance'"
        in done.stderr
    )
    assert not (tmp_path / "home").exists()


def test_the_help_names_every_command_and_needs_no_set_up(tmp_path: Path) -> None:
    done = run("--help", HAZARD_MS_HOME=str(tmp_path / "home"))
    assert done.returncode == 0 and not (tmp_path / "home").exists()
    for command in COMMANDS:
        assert f"\n  ./run {command} " in f"\n{done.stdout}"
    for variable in ("HAZARD_MS_HOME", "HAZARD_MS_PYTHON", "HAZARD_MS_NO_SYSTEM"):
        assert variable in done.stdout
    assert "set -euo" not in done.stdout


def test_run_refuses_a_python_that_does_not_fit(tmp_path: Path) -> None:
    done = run("python", HAZARD_MS_HOME=str(tmp_path), HAZARD_MS_PYTHON="/bin/false")
    assert done.returncode == 1 and "must be a Python 3.10, 3.11 or 3.12, got /bin/false" in done.stderr


def test_run_says_when_its_home_is_not_a_folder(tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    done = run("python", HAZARD_MS_HOME=str(tmp_path / "file"))
    assert done.returncode == 1 and "HAZARD_MS_HOME" in done.stderr


def test_a_second_start_adds_less_than_two_seconds(started_by_run: Path) -> None:
    def spent(start: Callable[[], subprocess.CompletedProcess[str]]) -> float:
        """Processor time of what `start` runs [s]: a loaded machine does not add to it."""
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        done = start()
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        assert done.returncode == 0, done.stderr
        return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime

    bare = spent(lambda: subprocess.run([sys.executable, "-c", "pass"], capture_output=True, text=True, check=False))
    assert spent(lambda: run("python", "-c", "pass")) - bare < 2.0


def test_the_users_pythonpath_is_kept_after_the_checkout(started_by_run: Path) -> None:
    code = "import os; print(os.environ['PYTHONPATH'])"
    assert run("python", "-c", code, PYTHONPATH="/my/own:/second").stdout.strip() == f"{ROOT}:/my/own:/second"
    assert run("python", "-c", code, PYTHONPATH="").stdout.strip() == str(ROOT)


def test_a_complete_home_may_be_read_only(tmp_path: Path, started_by_run: Path) -> None:
    """Root may write everywhere, so the script runs without the rights that make root special."""
    if shutil.which("setpriv") is None:
        pytest.skip("no setpriv")
    bare = ["setpriv", "--bounding-set=-all", "--inh-caps=-all"] if os.geteuid() == 0 else []
    home = tmp_path / "home"
    home.mkdir()
    environment = Path(os.environ["VIRTUAL_ENV"])
    (home / environment.name).symlink_to(environment)
    for graphics in started_by_run.glob("graphics-*"):
        shutil.copy(graphics, home)
    home.chmod(0o555)
    try:
        command = [*bare, str(ROOT / "run"), "python", "-c", "import numpy; print('works')"]
        environ = {**os.environ, "HAZARD_MS_HOME": str(home)}
        kept = subprocess.run(command, env=environ, capture_output=True, text=True, check=False)
        home.chmod(0o755)
        for graphics in home.glob("graphics-*"):
            graphics.unlink()
        home.chmod(0o555)
        asked = subprocess.run(command, env=environ, capture_output=True, text=True, check=False)
        home.chmod(0o755)
        (home / environment.name).unlink()
        home.chmod(0o555)
        empty = subprocess.run(command, env=environ, capture_output=True, text=True, check=False)
    finally:
        home.chmod(0o755)
    assert kept.stdout.strip() == "works", kept.stderr
    assert asked.stdout.strip() == "works", asked.stderr
    assert not list(home.iterdir()), "nothing was written"
    assert empty.returncode == 1 and "cannot be written; set HAZARD_MS_HOME" in empty.stderr


def test_an_environment_is_ready_only_when_it_is_whole(tmp_path: Path, started_by_run: Path) -> None:
    """With an empty lock, which needs no network: made once, and not again; again if the marker is gone."""
    uv = installed_uv()
    if uv is None:
        pytest.skip("./run has not installed uv")
    checkout, home = small_checkout(tmp_path, ""), tmp_path / "home"
    home.mkdir()
    (home / uv.name).symlink_to(uv)
    variables = {"HAZARD_MS_HOME": str(home), "HAZARD_MS_NO_SYSTEM": "1"}
    first, second = (run("pip", "list", root=checkout, **variables) for _ in range(2))
    assert first.returncode == second.returncode == 0, first.stderr
    assert "making the environment" in first.stderr and "making the environment" not in second.stderr
    (marker,) = home.glob("env-*/ready")
    marker.unlink()
    assert "making the environment" in run("pip", "list", root=checkout, **variables).stderr and marker.exists()


@pytest.mark.parametrize("selection", [("-k", "a_tested_name"), ("tests/project",)])
def test_selected_tests_run_alone(tmp_path: Path, started_by_run: Path, selection: tuple[str, ...]) -> None:
    """In a checkout with one test in each of two folders, and with code that ruff and mypy would refuse."""
    for name in ("run", "requirements.lock", "requirements-uv.txt", "pyproject.toml"):
        shutil.copy(ROOT / name, tmp_path / name)
    (tmp_path / "bad.py").write_text("import os, sys\nx: int = 'text'\n")
    for folder, test in (("project", "a_tested_name"), ("other", "something_else")):
        (tmp_path / "tests" / folder).mkdir(parents=True)
        (tmp_path / "tests" / folder / f"test_{folder}.py").write_text(f"def test_{test}() -> None:\n    pass\n")
    done = run("test", *selection, root=tmp_path)
    assert done.returncode == 0 and "1 passed" in done.stdout, done.stdout + done.stderr
    everything = run("test", root=tmp_path)
    assert everything.returncode == 1 and "F401" in everything.stdout and "passed" not in everything.stdout


@pytest.mark.long
def test_two_starts_at_once_and_an_interrupted_one(tmp_path: Path) -> None:
    """Whatever happens to a set-up, the next start ends with a whole environment."""
    wanted = ("gymnasium", "numpy", "cloudpickle", "typing-extensions", "farama-notifications")
    versions = locked(THIS_PYTHON)
    pinned = {name: hashes for name, _, hashes in pins((ROOT / "requirements.lock").read_text())}
    lines = [f"{pin} {' '.join(pinned[pin])}\n" for pin in (f"{name}=={versions[name]}" for name in wanted)]
    small = small_checkout(tmp_path, "".join(lines))
    environ = {
        **os.environ,
        "HAZARD_MS_HOME": str(small / "home"),
        "HAZARD_MS_PYTHON": getattr(sys, "_base_executable", sys.executable),
        "HAZARD_MS_NO_SYSTEM": "1",
    }
    command = [str(small / "run"), "python", "-c", "import gymnasium; print('whole')"]
    quiet = subprocess.DEVNULL
    first = subprocess.Popen(command, env=environ, start_new_session=True, stdout=quiet, stderr=quiet)
    while first.poll() is None and not list((small / "home").glob("env-*")):
        time.sleep(0.01)
    os.killpg(first.pid, signal.SIGKILL)
    first.wait()
    assert not list((small / "home").glob("env-*/ready")), "it was to be interrupted half way"
    pipe = subprocess.PIPE
    both = [subprocess.Popen(command, env=environ, stdout=pipe, stderr=pipe, text=True) for _ in range(2)]
    ends = [process.communicate(timeout=250) for process in both]
    assert [out.strip() for out, _ in ends] == ["whole", "whole"], ends
    assert sum("making the environment" in err for _, err in ends) == 1, "one makes it, the other waits"
    assert len(list((small / "home").glob("env-*/ready"))) == 1
