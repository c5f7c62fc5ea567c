"""Scenes are the same bytes everywhere.

The committed checksums, made anew in another process with another hash seed.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

import pytest

from hazard_ms.scenes.generate.draw import GENERATOR
from hazard_ms.scenes.splits import families, scene_names, split_names
from tests.scenes.make_digests import FILE, pinned

COMMITTED = json.loads(FILE.read_text(encoding="utf-8"))
SPLITS = [(family, split) for family in families() for split in split_names(family)]


def made_elsewhere(names: Sequence[str], hash_seed: str) -> dict[str, str]:
    """The checksums of scenes by a new process.

    The names come in reverse order, so that no scene can lean on an earlier one.
    """
    code = (
        "import json, sys; from tests.scenes.make_digests import digest; "
        "print(json.dumps({n: digest(n) for n in reversed(sys.argv[1:])}))"
    )
    environment = {**os.environ, "PYTHONHASHSEED": hash_seed}
    here = Path(__file__).parent
    found = subprocess.run(
        [sys.executable, "-c", code, *names], capture_output=True, text=True, check=True, cwd=here, env=environment
    )
    return dict(json.loads(found.stdout))


def test_every_scene_has_its_checksum() -> None:
    assert COMMITTED["generator"] == GENERATOR
    assert list(COMMITTED["scenes"]) == pinned()
    assert len(set(COMMITTED["scenes"].values())) == len(COMMITTED["scenes"])


def test_scenes_of_every_split_are_the_committed_bytes() -> None:
    names = [scene_names(split, family)[k] for family, split in SPLITS for k in (3, -1)]
    assert made_elsewhere(names, "777") == {n: COMMITTED["scenes"][n] for n in names}


@pytest.mark.long
def test_all_scenes_are_the_committed_bytes() -> None:
    names = list(COMMITTED["scenes"])
    assert made_elsewhere(names, "42") == COMMITTED["scenes"]
