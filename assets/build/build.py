"""Makes the assets: `python assets/build/build.py PACKAGE.deb [ID ...]`; with ids, makes these again and keeps the other rows.

Needs trimesh, scipy, Pillow, coacd, manifold3d, sapien, and gltfpack (npm) on the path or in the variable GLTFPACK.
"""

from __future__ import annotations

import fcntl
import hashlib
import json
import os
import sys
from pathlib import Path
from typing import Any

import numpy as np
import trimesh

import carried_things
import carts
import collide
import convert
import greenery
import ground_patterns
import household_things
import houses
import indoor_things
import large_things
import outdoor_things
import patterns
import skies
import small_things
import surfaces
import table_things
from attribution import attribution
from source import Model, find_models, open_package

HERE = Path(__file__).resolve().parent
ASSETS = HERE.parent
FOLDERS = ("models", "hulls", "textures", "skies")
PACKAGE = "Debian package sweethome3d-furniture 1.8-1"
US = "the authors of hazard_ms"
FACES = {"object": 3000, "fixture": 5000}  # at most
PIXELS = {"object": 256, "fixture": 512}  # of a texture, longest edge, at most
SNAP = 0.04  # a support's height may differ so much from the level found on the model [m]
OURS = (small_things, large_things, carried_things, household_things, table_things, indoor_things, carts, houses, outdoor_things, greenery)
MAKERS = {name: make for module in OURS for name, make in module.MAKERS.items()}
TEXTURES = {  # names of materials in hazard_ms/scenes/shell.py
    "wood": patterns.planks,
    "tile": patterns.tiles,
    "carpet": patterns.carpet,
    "door": patterns.leaf_of_door,
    "plaster": lambda: patterns.plaster((196, 188, 172), (214, 206, 190), 51),
    "paint_white": lambda: patterns.plaster((222, 221, 217), (232, 231, 227), 52),
    "paint_green": lambda: patterns.plaster((178, 189, 172), (190, 200, 183), 53),
    "paint_blue": lambda: patterns.plaster((170, 184, 194), (182, 195, 205), 54),
    "ceiling": lambda: patterns.plaster((232, 232, 230), (242, 242, 240), 55),
    **ground_patterns.TEXTURES,
}


def make(pick: dict[str, Any], models: dict[str, Model], gltfpack: list[str]) -> dict[str, Any]:
    """Write the files of one row; returns its row of the index."""
    scene, credit = own(pick) if "make" in pick else packaged(pick, models)
    convert.fit(scene, pick)
    before = convert.count(scene)
    visual = f"models/{pick['id']}.glb"
    written = convert.write(
        scene, ASSETS / visual, pick.get("faces", FACES[pick["kind"]]), pick.get("pixels", PIXELS[pick["kind"]]), gltfpack
    )
    mesh = convert.solid(written)
    row = {name: pick[name] for name in ("id", "kind", "category", "mass")} | credit
    row["visual"], row["faces"] = visual, convert.count(written)
    row["extent"] = [round(float(e), 5) for e in written.extents]
    if row["faces"] < before:
        row["changes"] += f", reduced from {before} faces"
    row.update(collision(pick, mesh, np.array(row["extent"])))
    row["supports"] = [rectangle(mesh, *wanted) for wanted in pick.get("supports", ())]
    row["sha256"] = {file: checksum(ASSETS / file) for file in (visual, row.get("hulls")) if file}
    return row


def own(pick: dict[str, Any]) -> tuple[trimesh.Scene, dict[str, str]]:
    """A model that we make ourselves, and whose it is."""
    name = pick["make"]
    scene = trimesh.Scene(MAKERS[name](*pick.get("arguments", [])))
    return scene, {"licence": "own work", "author": US, "source": f"assets/build, function {name}", "changes": ""}


def packaged(pick: dict[str, Any], models: dict[str, Model]) -> tuple[trimesh.Scene, dict[str, str]]:
    """A model of the package, and whose it is."""
    model = models[pick["model"]]
    changes = ["turned z up, scaled, textures at most 512 pixels"]
    changes += [
        word for key, word in (("keep", "one part of it"), ("drop", "parts left out"), ("paint", "repainted")) if pick.get(key)
    ]
    credit = {
        "licence": model.licence,
        "author": model.author,
        "source": f"{PACKAGE}, {pick['model']}",
        "changes": ", ".join(changes),
    }
    return convert.load(model, pick), credit


def collision(pick: dict[str, Any], mesh: trimesh.Trimesh, extent: np.ndarray) -> dict[str, Any]:
    """Hulls in a file of their own, or boxes."""
    if "boxes" in pick:
        return {"boxes": collide.boxes(pick["boxes"], extent)}
    file = f"hulls/{pick['id']}.ply"
    collide.write_hulls(collide.decompose(mesh, pick.get("hulls", {})), ASSETS / file)
    return {"hulls": file}


def rectangle(mesh: trimesh.Trimesh, z: float, clearance: float, *corners: list[float]) -> dict[str, object]:
    """Where things can be put at about the height `z` [m]: between `corners`, if given (soft seats), else as found on the model."""
    if corners:
        return {"z": z, "min": corners[0], "max": corners[1], "clearance": clearance}
    near = [h for h, _ in surfaces.heights(mesh, 0.02) if abs(h - z) < SNAP]
    return surfaces.support(mesh, min(near, key=lambda h: abs(h - z), default=z), clearance)


def texture(name: str) -> dict[str, Any]:
    """Write one material's picture; returns its row."""
    file = f"textures/{name}.jpg"
    TEXTURES[name]().save(ASSETS / file, "JPEG", quality=82)
    credit = {"licence": "own work", "author": US, "source": "assets/build", "changes": ""}
    return {"id": name, "kind": "texture", "category": "", "visual": file, **credit, "sha256": {file: checksum(ASSETS / file)}}


def sky(name: str) -> dict[str, Any]:
    """Write one sky; returns its row."""
    file = f"skies/{name}.ktx"
    skies.write(name, ASSETS / file)
    credit = {"licence": "own work", "author": US, "source": "assets/build/skies.py", "changes": ""}
    return {"id": name, "kind": "sky", "category": "", "visual": file, **credit, "sha256": {file: checksum(ASSETS / file)}}


def checksum(path: Path) -> str:
    """SHA-256 of a file, hexadecimal."""
    return hashlib.sha256(path.read_bytes()).hexdigest()


def write_index(rows: list[dict[str, Any]]) -> None:
    """Write index.json and ATTRIBUTION.md, and delete files that no row names."""
    named = {file for row in rows for file in row["sha256"]}
    for folder in FOLDERS:
        for path in (ASSETS / folder).iterdir():
            if f"{folder}/{path.name}" not in named:
                path.unlink()
    lines = ",\n".join(json.dumps(row, ensure_ascii=False) for row in rows)
    draft = ASSETS / "index.json.new"
    draft.write_text(f"[\n{lines}\n]\n", encoding="utf-8")
    draft.replace(ASSETS / "index.json")  # at once: readers never see half an index
    (ASSETS / "ATTRIBUTION.md").write_text(attribution(rows), encoding="utf-8")


def read_picks() -> list[dict[str, Any]]:
    """What picks.json and every picks_*.json beside it ask for."""
    files = [HERE / "picks.json", *sorted(HERE.glob("picks_*.json"))]
    return [pick for file in files for pick in json.loads(file.read_text(encoding="utf-8"))]


def main(package: str, *only: str) -> int:
    """Build all, or `only` these; returns the number of rows that failed. A second run waits until the first has written the index."""
    held = os.open(ASSETS, os.O_RDONLY)
    try:
        fcntl.flock(held, fcntl.LOCK_EX)
        return _build(package, only)
    finally:
        os.close(held)


def _build(package: str, only: tuple[str, ...]) -> int:
    models = find_models(open_package(Path(package)))
    gltfpack = os.environ.get("GLTFPACK", "gltfpack").split()
    for folder in FOLDERS:
        (ASSETS / folder).mkdir(exist_ok=True)
    old = json.loads((ASSETS / "index.json").read_text(encoding="utf-8")) if only else []
    kept = {row["id"]: row for row in old if row["id"] not in only}
    rows, failed = [], 0
    for pick in read_picks():
        try:
            rows.append(kept.get(pick["id"]) or make(pick, models, gltfpack))
        except (KeyError, ValueError, AttributeError, IndexError, TypeError) as error:
            failed += 1
            print(f"{pick['id']}: {type(error).__name__}: {error}", file=sys.stderr)
    write_index([*rows, *(texture(name) for name in TEXTURES), *(sky(name) for name in skies.SKIES)])
    return failed


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    sys.exit(1 if main(*sys.argv[1:]) else 0)
