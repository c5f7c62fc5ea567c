"""Writes the checksums of all scenes, which the tests compare.

`python tests/scenes/make_digests.py`, after the last change of any asset.
"""

from __future__ import annotations

import hashlib
import json
from pathlib import Path

from hazard_ms.scenes.generate.draw import GENERATOR
from hazard_ms.scenes.schema import to_json
from hazard_ms.scenes.splits import SCENES, families, scene, scene_names, split_names

MOST = 100  # scenes of a split that all have a checksum
FILE = Path(__file__).with_name("scene_digests.json")


def digest(name: str) -> str:
    """SHA-256 of the JSON of the scene `name`."""
    return hashlib.sha256(to_json(scene(name)).encode()).hexdigest()


def pinned() -> list[str]:
    """Names of the scenes with a checksum: all, but of each thousand homes for training only five."""
    made = []
    for family in families():
        for split in split_names(family):
            names = scene_names(split, family)
            made += [*names[3 :: 10 * SCENES], names[-1]] if len(names) > MOST else names
    return made


def main() -> None:
    """Write the file."""
    names = pinned()
    table = {"generator": GENERATOR, "scenes": {name: digest(name) for name in names}}
    FILE.write_text(json.dumps(table, indent=1) + "\n", encoding="utf-8")
    print(f"{len(names)} scenes of generator {GENERATOR}: {FILE}")


if __name__ == "__main__":
    main()
