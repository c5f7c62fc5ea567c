"""Converts one model in a process of its own, within a budget of memory and time, so that a hostile one ends no other.

`conversion.py` starts it. It reads the order from standard input, and writes model.glb, hulls.ply
and facts.json into the folder in which it runs, nothing else.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

MEMORY = 800_000_000  # of its own, at most [bytes]; with the libraries' code this is 1 GB [ours]
PROCESSOR_TIME = 120  # at most [s]; 200,000 triangles take 50 [ours]
WRITTEN = 256 << 20  # each file, at most [bytes] [ours]
UNWRITABLE = 3  # exit code where the files of the model cannot be written


def limit() -> None:
    """Limit memory, processor time and files to the needs of the largest model that is accepted."""
    import resource

    for what, most in (
        (resource.RLIMIT_DATA, MEMORY),
        (resource.RLIMIT_CPU, PROCESSOR_TIME),
        (resource.RLIMIT_FSIZE, WRITTEN),
        (resource.RLIMIT_CORE, 0),
    ):
        _, hard = resource.getrlimit(what)
        resource.setrlimit(what, (most if hard == resource.RLIM_INFINITY else min(most, hard), hard))


def convert(order: dict[str, Any]) -> dict[str, Any]:
    """Write the model and its hulls, and return what was measured. Raises ValueError for what is not allowed."""
    from hazard_ms.scenes.assets.intake import collision, shaping
    from hazard_ms.scenes.assets.intake.supports import supports

    scene = shaping.shaped(assembled(order), order["size"])
    scene = shaping.painted(scene)
    mesh = shaping.solid(scene)
    hulls = collision.decompose(mesh)
    shaping.write(scene, Path("model.glb"))
    collision.write(hulls, Path("hulls.ply"))
    made = collision.cook(Path("hulls.ply"))
    if made != len(hulls):
        raise ValueError(f"PhysX must make one shape of each of the {len(hulls)} convex pieces, got {made}")
    return {
        "extent": [round(float(e), 5) for e in mesh.extents],
        "faces": int(sum(len(p.faces) for p in scene.geometry.values())),
        "volume": float(sum(h.volume for h in hulls)),
        "supports": supports(mesh) if order["kind"] == "fixture" else [],
    }


def assembled(order: dict[str, Any]) -> Any:
    """All parts of the order in one scene, in our frame and in metres. Raises ValueError for too many faces."""
    import numpy as np
    import trimesh

    from hazard_ms.scenes.assets.intake.reading import MOST_FACES, read_model
    from hazard_ms.scenes.assets.intake.shaping import creased, frame, pieces

    turn = frame(order["up"], order["front"]) @ np.diag([order["scale"]] * 3 + [1.0])
    made, faces = [], 0
    for part in order["parts"]:
        scene = read_model(Path(part["file"]))
        scene.apply_transform(turn @ np.array(part["matrix"], float).reshape(4, 4))
        found = pieces(scene)
        faces += sum(len(p.faces) for p in found)
        if faces > MOST_FACES:
            raise ValueError(
                f"parts of a model must have at most {MOST_FACES} triangles, got {faces}: simplify them first"
            )
        made += [creased(p) for p in found] if part["file"].lower().endswith((".stl", ".ply")) else found
    return trimesh.Scene(made)


def main() -> int:
    """Convert the model that standard input orders; a refusal is written to facts.json, too."""
    limit()
    from hazard_ms.scenes.assets.intake.textures import forbid_other_formats

    forbid_other_formats()
    try:
        facts = convert(json.load(sys.stdin))
    except ValueError as error:
        facts = {"refused": str(error)}
    except (MemoryError, RecursionError) as error:
        needed = f"a model must need at most {MEMORY // 10**6} MB of memory, got more"
        facts = {"refused": f"{needed} ({type(error).__name__}): simplify it first"}
    Path("facts.json").write_text(json.dumps(facts))
    return 0


def told() -> int:
    """Run `main`; a full disk is reported in the last line of the standard error, with an exit code of its own."""
    try:
        return main()
    except OSError as error:
        print(error.strerror or error, file=sys.stderr)
        return UNWRITABLE


if __name__ == "__main__":
    sys.exit(told())
