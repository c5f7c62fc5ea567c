"""What GitHub runs: commands that exist, with the fewest rights, and publishing by a tag alone."""

from __future__ import annotations

import re
import shlex
from pathlib import Path
from typing import Any

import pytest
import yaml

from tests.worlds.files.checkout import ROOT, pins, run

FILES = sorted((ROOT / ".github/workflows").glob("*"))
RELEASE = {name.partition("==")[0] for name, _, _ in pins((ROOT / "requirements-release.txt").read_text())}
TAGGED = "startsWith(github.ref, 'refs/tags/v')"
PINNED = re.compile(r"[\w-]+/[\w-]+@(v\d+|release/v\d+|[0-9a-f]{40})")
MADE = {"dist": "python -m build", "build/docs": "./run docs", "hazard_ms.cdx.json": ".ci/materials.py -o"}
SYSTEM = ("gh", "test")  # of every runner
# What a job may do beside reading the repository: to show PyPI who it is, to make the page of a release
RAISED = {"publish": {"id-token": "write"}, "attach": {"contents": "write"}}


def workflow(path: Path) -> dict[Any, Any]:
    """A workflow as data; its key `on` is True, as YAML 1.1 reads it."""
    assert path.suffix == ".yml"
    return yaml.safe_load(path.read_text(encoding="utf-8"))


def jobs() -> list[object]:
    """Every job, with its workflow and its name."""
    found = [(path, name) for path in FILES for name in workflow(path)["jobs"]]
    return [pytest.param(workflow(path), name, id=f"{path.stem}-{name}") for path, name in found]


def commands(job: dict[str, Any]) -> list[str]:
    """The command lines of a job."""
    return [line for step in job["steps"] for line in step.get("run", "").splitlines()]


def check_command(line: str) -> None:
    """Raise unless the command of a line exists, and the files that it is given."""
    assert "${{" not in line, "names that strangers choose must come by variables of the environment"
    words = shlex.split(line)
    if words[0] == "./run":
        assert f"\n  ./run {words[1]} " in f"\n{run('--help').stdout}"
    elif words[0] == "python":
        assert words[1] == "-m" and words[2] in RELEASE | {"pip"}
    else:
        assert words[0] in SYSTEM, line
    for word in words[1:]:
        if word.endswith((".py", ".txt")):
            assert (ROOT / word).is_file(), word


def test_there_are_tests_packages_and_documentation() -> None:
    assert [path.stem for path in FILES] == ["docs", "tests", "wheels"]
    assert commands(workflow(ROOT / ".github/workflows/tests.yml")["jobs"]["tests"]) == ["./run test"]
    assert (
        'exec ./run test "$@"' in (ROOT / ".ci/run").read_text() and "./run test " in (ROOT / "README.md").read_text()
    )


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.stem)
def test_strangers_get_no_rights(path: Path) -> None:
    told = workflow(path)
    assert told["permissions"] == {"contents": "read"}
    assert set(told[True]) <= {"push", "pull_request"}, "pull_request_target gives them ours"
    assert "secrets." not in path.read_text(encoding="utf-8")


@pytest.mark.parametrize(("told", "name"), jobs())
def test_jobs_may_do_more_only_for_a_tag(told: dict[str, Any], name: str) -> None:
    job = told["jobs"][name]
    assert job.get("permissions", {}) == RAISED.get(name, {})
    if name in RAISED:
        assert job["if"] == TAGGED
        assert not any("checkout" in step.get("uses", "") for step in job["steps"]), "code of ours does not run there"
    publishes = any("pypi" in step.get("uses", "") for step in job["steps"])
    assert publishes == (name == "publish") and not any("upload" in line.split() for line in commands(job))
    assert set(job.get("needs", ())) <= set(told["jobs"])


@pytest.mark.parametrize(("told", "name"), jobs())
def test_steps_run_what_is_there(told: dict[str, Any], name: str) -> None:
    job = told["jobs"][name]
    assert job["timeout-minutes"] <= 90
    for step in job["steps"]:
        assert ("uses" in step) != ("run" in step)
        if "uses" in step:
            assert PINNED.fullmatch(step["uses"]), step
        if step.get("uses", "").startswith("actions/checkout@"):
            assert step["with"]["persist-credentials"] is False
        if step.get("uses", "").startswith("actions/upload-artifact@"):
            path = step["with"]["path"]
            assert any(MADE[path] in line for line in commands(job)) and step["with"]["if-no-files-found"] == "error"
    for line in commands(job):
        check_command(line)


def test_what_a_tag_publishes_is_what_was_checked() -> None:
    told = workflow(ROOT / ".github/workflows/wheels.yml")["jobs"]
    assert told["publish"]["needs"] == ["build", "materials"] and told["publish"]["environment"] == "pypi"
    build = commands(told["build"])
    assert "--require-hashes" in build[0] and "requirements-release.txt" in build[0]
    assert build[1:3] == ["python -m build --no-isolation", "python -m twine check --strict dist/*"]
    assert "hazard_ms-${GITHUB_REF_NAME#v}-py3-none-any.whl" in build[3], "the tag is that of the version"
    # packages are built with what the tests build them with
    setuptools = r"^setuptools==(\S+)"
    locks = [(ROOT / name).read_text() for name in ("requirements.lock", "requirements-release.txt")]
    assert len({re.findall(setuptools, text, re.M)[0] for text in locks}) == 1


@pytest.mark.parametrize(
    "line", ["./run dance", "python -m flake8", "rm -r x", "./run python gone.py", 'echo "${{ github.head_ref }}"']
)
def test_wrong_commands_are_noticed(line: str) -> None:
    with pytest.raises(AssertionError):
        check_command(line)
