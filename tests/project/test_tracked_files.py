"""The repository holds its own folders and nothing that commands leave in a checkout."""

from __future__ import annotations

import subprocess

import pytest

from tests.worlds.files.checkout import ROOT

FOLDERS = {".ci", ".github", "assets", "docs", "examples", "hazard_ms", "results", "tests"}
LARGEST = 47_000_000  # of all files together [bytes]; they have 46 million, 7 of them weights of a detector [ours]


def test_only_known_folders_are_tracked_and_they_stay_small() -> None:
    if not (ROOT / ".git").exists():
        pytest.skip("this is not a checkout")
    told = subprocess.run(["git", "-C", str(ROOT), "ls-files", "-z"], check=True, capture_output=True, text=True)
    names = [name for name in told.stdout.split("\0") if name]
    assert names and {name.split("/")[0] for name in names if "/" in name} == FOLDERS
    assert sum((ROOT / name).stat().st_size for name in names if (ROOT / name).is_file()) < LARGEST
