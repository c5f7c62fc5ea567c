"""The command itself: its version, its help, the names that completion lists, and how it ends."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from hazard_ms import __version__
from hazard_ms.cli import assets, scenes
from hazard_ms.cli.__main__ import COMMANDS, main
from hazard_ms.env.hazard_env import EFFECTS
from hazard_ms.evaluation import choices
from hazard_ms.hazards.presets import PRESETS
from hazard_ms.scenes.assets.providers import PROVIDERS
from hazard_ms.scenes.splits import families, split_names
from hazard_ms.simulation.drawing.lighting import LIGHTINGS
from hazard_ms.spec import registry

ROOT = Path(__file__).parents[2]
COMMAND = f"{sys.executable} -m hazard_ms.cli"


def shell(line: str, **environ: str) -> subprocess.CompletedProcess[str]:
    """The outcome of a line of bash in the repository; it fails where a part of a pipe fails."""
    words = ["bash", "-o", "pipefail", "-c", line]
    return subprocess.run(words, capture_output=True, text=True, cwd=ROOT, env={**os.environ, **environ}, timeout=280)


def test_version(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["--version"]) == 0
    assert capsys.readouterr().out == f"hazard_ms {__version__}\n"
    assert main(["version"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[0] == f"hazard_ms {__version__}" and any(line.startswith("torch ") for line in lines)


def test_a_reader_that_has_enough_is_no_error() -> None:
    done = shell(f"{COMMAND} scenes make kitchen_a/00 | head -1")
    assert (done.returncode, done.stdout, done.stderr) == (0, "{\n", "")


@pytest.mark.parametrize(
    ("redirection", "code", "told"),
    [
        *(pytest.param(closed, 0, "", marks=pytest.mark.long) for closed in (">&-", "2>&-")),
        ("> /dev/full", 1, "hazard-ms: the output must be written whole, got No space left on device; free some space"),
    ],
)
def test_outputs_that_are_closed_or_full(redirection: str, code: int, told: str) -> None:
    done = shell(f"{COMMAND} scenes list --split train --family outdoor {redirection}")
    assert (done.returncode, done.stderr.strip()) == (code, told)


def test_a_scene_is_written_whole_or_not_at_all(tmp_path: Path) -> None:
    """A limit on the size of files ends the writing of a scene in its midst."""
    place = tmp_path / "scene.json"
    place.write_text("older")
    done = shell(f"ulimit -f 4; {COMMAND} scenes make kitchen_a/00 -o {place}")
    assert done.returncode == 2 and f"got {place}: File too large; raise the limit" in done.stderr
    assert place.read_text() == "older" and list(tmp_path.iterdir()) == [place]


def test_help_works_where_only_ascii_can_be_written() -> None:
    done = shell(
        f"{COMMAND} play --help", LC_ALL="C", PYTHONUTF8="0", PYTHONCOERCECLOCALE="0", PYTHONIOENCODING="ascii"
    )
    assert done.returncode == 0 and "--robot-uids" in done.stdout, done.stderr


def test_help_loads_nothing_heavy() -> None:
    heavy = ("torch", "warp", "sapien", "mani_skill", "gymnasium", "numpy")
    code = f"import sys, hazard_ms.cli.__main__; print([m for m in {heavy} if m in sys.modules])"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, cwd=ROOT, check=True)
    assert done.stdout.strip() == "[]"


@pytest.fixture(scope="module")
def completion() -> str:
    done = shell(f"{COMMAND} --tyro-print-completion bash")
    assert done.returncode == 0
    return done.stdout


@pytest.mark.parametrize(
    ("command", "option", "names"),
    [
        ("play", "--env-id", registry.TASKS),
        ("play", "--robot-uids", registry.ROBOTS),
        ("play", "--physics", PRESETS),
        ("play", "--lighting", LIGHTINGS),
        ("play", "--agent", registry.AGENTS),
        ("evaluate", "--hazards", registry.HAZARDS),
        ("render", "--effects", EFFECTS),
        ("validate", "--hazard", registry.HAZARDS),
        ("bench", "--env-id", registry.TASKS),
    ],
)
def test_help_and_completion_list_the_names(
    command: str, option: str, names: object, completion: str, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit):
        main([command, "--help"])
    told = re.sub(r"[│\s]+", "", capsys.readouterr().out)
    listed = ",".join(names)  # type: ignore[call-overload]
    assert re.search(re.escape(option) + r"\[?\{" + re.escape(listed), told)
    for name in names:  # type: ignore[attr-defined]
        assert re.search(rf"['\"]{re.escape(name)}['\"]", completion)


def test_the_names_that_are_offered_are_those_that_there_are() -> None:
    """They are written down twice, since the modules that define them are slow to import."""
    assert choices.PRESETS == tuple(PRESETS) and choices.LIGHTINGS == tuple(LIGHTINGS)
    assert choices.EFFECTS == tuple(EFFECTS) and assets.PROVIDERS == tuple(PROVIDERS)
    assert scenes.FAMILIES == families()
    assert set(choices.SPLITS) == {split for family in families() for split in split_names(family)}


@pytest.mark.parametrize(
    ("line", "nearest"),
    [
        ("play -e HazardFir-v1", "HazardFire-v1"),
        ("play --robot-uids fetsh", "fetch"),
        ("play --lighting nihgt", "night"),
        ("evaluate --physics papper", "paper"),
        ("play --agent gredy", "greedy"),
        ("validate --hazard flod", "flood"),
        ("bench -e HazardWind-v2", "HazardWind-v1"),
    ],
)
def test_a_wrong_name_gets_the_nearest_one(line: str, nearest: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(line.split()) == 2
    assert f"did you mean {nearest!r}" in capsys.readouterr().err


@pytest.mark.parametrize("line", ["play --robot g1 --light night --video x.mp4", "scenes make a/00 --out x.json"])
def test_spellings_of_old_still_work(line: str, capsys: pytest.CaptureFixture[str]) -> None:
    """They are read, so that what is wrong is something else."""
    assert main([*line.split(), *(["--every", "0"] if line.startswith("play") else [])]) == 2
    assert re.search("every must|scene must", capsys.readouterr().err)


def test_every_command_has_a_description() -> None:
    assert all((made.__doc__ or "").strip() for made in COMMANDS.values())
