"""A submission made here is verified whatever instructions the processor of who verifies it offers."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from dataclasses import asdict
from pathlib import Path

import pytest

from hazard_ms.cli.__main__ import main
from tests.env.forced_instructions import FORCED, NOT_PROMISED
from tests.worlds.submissions import CARD

pytestmark = [pytest.mark.render, pytest.mark.long, pytest.mark.timeout(900)]
ROOT = Path(__file__).parents[3]


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A submission of two whole episodes, in which a robot rescues things."""
    place = tmp_path_factory.mktemp("whole")
    (place / "card.json").write_text(json.dumps(asdict(CARD)))
    words = ["-e", "HazardFire-v1", "--split", "test", "--agents", "greedy", "--episodes", "2", "--workers", "1"]
    assert main(["evaluate", *words, "-o", str(place / "played")]) == 0
    named = ["--card", str(place / "card.json"), "-o", str(place / "it.zip"), "--track", "trial"]
    assert main(["submit", str(place / "played"), *named]) == 0
    return place / "it.zip"


def verify(file: Path, variables: dict[str, str]) -> subprocess.CompletedProcess[str]:
    """Verify a submission in a new process, which looks at the file alone."""
    words = [sys.executable, "-m", "hazard_ms.cli", "verify", str(file), "--workers", "1"]
    environ = {**os.environ, "PYTHONPATH": str(ROOT), **variables}
    return subprocess.run(words, capture_output=True, text=True, cwd=file.parent, env=environ, check=False)


@pytest.mark.parametrize("name", FORCED)
def test_a_submission_verifies_with_other_instructions_of_the_processor(name: str, whole: Path) -> None:
    done = verify(whole, FORCED[name])
    assert done.returncode == 0 and "verified: all 2 episodes" in done.stdout, done.stdout + done.stderr


@pytest.mark.parametrize("name", NOT_PROMISED)
def test_a_processor_that_computes_otherwise_accuses_nobody(name: str, whole: Path) -> None:
    """Without fused multiplications and additions an episode differs, which is no fault of the submission."""
    done = verify(whole, NOT_PROMISED[name])
    assert done.returncode == 2 and "not verified" not in done.stdout, done.stdout + done.stderr
    assert "all machines must compute with AVX2, got one where torch uses DEFAULT" in done.stderr
