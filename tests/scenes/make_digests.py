"""Writes the checksums of all scenes, which the tests compare.

`python tests/scenes/make_digests.py`, after the last change of any asset.
"""

from __future__ import annotations

import hashlib
import json
from pathlib import Path

from hazard_ms.scenes.generate.draw import GENERATOR
from hazard_ms.scenes.schema import to_json
from hazard_ms.scenes.splits import all_scene_names, families, scene

FILE = Path(__file__).with_name("scene_digests.json")


def digest(name: str) -> str:
    """SHA-256 of the JSON of the scene `name`."""
    return hashlib.sha256(to_json(scene(name)).encode()).hexdigest()


def main() -> None:
    """Write the file."""
    names = [name for family in families() for name in all_scene_names(family)]
    table = {"generator": GENERATOR, "scenes": {name: digest(name) for name in names}}
    FILE.write_text(json.dumps(table, indent=1) + "\n", encoding="utf-8")
    print(f"{len(names)} scenes of generator {GENERATOR}: {FILE}")


if __name__ == "__main__":
    main()
