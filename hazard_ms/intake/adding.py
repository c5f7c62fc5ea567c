"""Adds models to the user's folder and takes them out again: a model is there as a whole or not at all, whatever interrupts it."""

from __future__ import annotations

import dataclasses
import hashlib
import json
import math
import os
import re
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from hazard_ms.assets import LICENCE, USER_ID, Asset, asset_ids, confined, read_user_row, root, user_root, user_rows
from hazard_ms.catalogue import CATEGORIES, category
from hazard_ms.intake.model import Model

FILES = ("model.glb", "hulls.ply", "preview.png")  # of a model, in its own folder
TIME = 300.0  # of a conversion, at most [s]; 200,000 triangles take 50 [ours]
PENDING = ".adding-"  # how the names of temporary folders begin
CHANGES = "turned z up, put on its base, textures at most 512 pixels, convex hulls by CoACD"


def add(model: Model, name: str, mass: float | None = None, size: float | None = None) -> Asset:
    """Convert `model` and keep it as `name`, `size` metres along its longest edge (None: as it is). Mass None: from its volume [kg].

    Raises ValueError for whatever is not allowed; then the folder is as it was.
    """
    _check(model, name, mass, size)
    folder = user_root()
    with _locked(folder) as rows:
        if any(isinstance(row, dict) and row.get("id") == name for row in rows):
            raise ValueError(f"{folder} has a model {name!r} already; hazard-ms assets remove {name}, or another --name")
        place = _free_place(folder, name)
        with tempfile.TemporaryDirectory(prefix=PENDING, dir=folder) as pending:
            made = Path(pending) / name
            made.mkdir()
            facts = _convert(model, made, size)
            row = _row(model, name, mass, facts, made)
            _preview(row, made)
            place.parent.mkdir(exist_ok=True)
            os.rename(made, place)
        try:
            found = read_user_row(row, folder)
            _write_index(folder, [*rows, row])
        except BaseException:
            _delete(place)
            raise
    return found


def remove(name: str) -> None:
    """Take the model `name` out of the user's folder. Raises ValueError where there is none."""
    folder = user_root()
    with _locked(folder) as rows:
        kept = [row for row in rows if not (isinstance(row, dict) and row.get("id") == name)]
        if len(kept) == len(rows):
            there = ", ".join(str(row.get("id")) for row in rows if isinstance(row, dict)) or "none"
            raise ValueError(f"{folder} has no model {name!r:.100}; there are: {there}")
        _write_index(folder, kept)
        if USER_ID.fullmatch(name):
            _delete(_place(folder, name))


def free_name(stem: str) -> str:
    """The id that a file of this name suggests."""
    return re.sub(r"[^a-z0-9]+", "_", stem.lower()).strip("_")[:40]


def _check(model: Model, name: str, mass: float | None, size: float | None) -> None:
    category(model.category)
    if not model.parts:
        raise ValueError(f"{model.source} is a whole scene; only models can be added")
    if not USER_ID.fullmatch(name):
        raise ValueError(f"{name!r:.100} is no id of at most 40 lower-case letters, digits and _, a letter first: give another --name")
    kept = re.fullmatch(r"(.+)_\d+", name)
    if name in asset_ids() or (kept and kept[1] in CATEGORIES):
        raise ValueError(f"{name!r} is, or may become, the name of a shipped model; give another --name, my_{name} say")
    if not LICENCE.fullmatch(model.licence):
        raise ValueError(f"licence {model.licence!r:.100}: name the model's licence, CC-BY-4.0 or own work say: --licence")
    for what, value, most in (("mass", mass, 1000.0), ("size", size, 20.0)):
        if value is not None and not (math.isfinite(value) and 0.0 < value < most):
            raise ValueError(f"{what} {value}; more than 0 and less than {most} is allowed")


@contextmanager
def _locked(folder: Path) -> Iterator[list[Any]]:
    """The rows of the index, while nobody else may write it; what an interrupted run left is cleared away."""
    import fcntl

    if folder.resolve().is_relative_to(root().resolve()):
        raise ValueError(f"{folder} belongs to hazard_ms itself; set HAZARD_MS_ASSETS to a folder of your own")
    try:
        folder.mkdir(parents=True, exist_ok=True)
        lock = os.open(folder / ".lock", os.O_CREAT | os.O_RDWR | os.O_NOFOLLOW, 0o600)
    except OSError as error:
        raise ValueError(f"{folder} cannot be written: {error.strerror}") from None
    try:
        fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        for left in folder.glob(f"{PENDING}*"):
            if not left.is_symlink():
                shutil.rmtree(left, ignore_errors=True)
        yield user_rows(folder)
    except BlockingIOError:
        raise ValueError(f"another hazard-ms is writing into {folder}; wait until it has ended") from None
    except OSError as error:
        raise ValueError(f"{folder} cannot be written: {error}") from None
    finally:
        os.close(lock)


def _place(folder: Path, name: str) -> Path:
    """The folder of the model `name`. Raises ValueError where links lead out."""
    confined(folder, f"models/{name}")
    return folder / "models" / name


def _free_place(folder: Path, name: str) -> Path:
    """Where the model `name` goes. What an interrupted run left there is deleted, anything else is not."""
    place = _place(folder, name)
    if place.is_symlink() or (place.exists() and not {p.name for p in place.iterdir()} <= set(FILES)):
        raise ValueError(f"{place} is in the way, and holds more than a model: move it")
    _delete(place)
    return place


def _delete(place: Path) -> None:
    """Delete a model's own files, and its folder."""
    if place.is_symlink():
        place.unlink()
    elif place.is_dir():
        for name in FILES:
            (place / name).unlink(missing_ok=True)
        if not any(place.iterdir()):
            place.rmdir()


def _convert(model: Model, made: Path, size: float | None) -> dict[str, Any]:
    """Run the worker in `made`; what it measured. Raises ValueError with its word, or when it crashed or took too long."""
    order = {**dataclasses.asdict(model), "size": size, "kind": CATEGORIES[model.category].kind}
    package = str(Path(__file__).resolve().parents[2])
    path = os.pathsep.join(p for p in (package, os.environ.get("PYTHONPATH", "")) if p)
    what = Path(model.parts[0].file).name
    try:
        done = subprocess.run(
            [sys.executable, "-m", "hazard_ms.intake.worker"],
            input=json.dumps(order),
            capture_output=True,
            text=True,
            cwd=made,
            env={**os.environ, "PYTHONPATH": path},
            timeout=TIME,
            check=False,
        )
    except subprocess.TimeoutExpired:
        raise ValueError(f"{what} could not be converted within {TIME:.0f} s: simplify it first") from None
    facts = made / "facts.json"
    if done.returncode != 0 or not facts.is_file():
        last = (done.stderr.strip().splitlines() or ["no word"])[-1]
        raise ValueError(f"{what} could not be converted: the conversion ended with {done.returncode}: {last:.300}")
    found: dict[str, Any] = json.loads(facts.read_text())
    facts.unlink()
    if "refused" in found:
        raise ValueError(f"{what}: {found['refused']}" if what not in found["refused"] else found["refused"])
    return found


def _row(model: Model, name: str, mass: float | None, facts: dict[str, Any], made: Path) -> dict[str, Any]:
    kind = category(model.category)
    weight = mass or model.mass or max(0.001, facts["volume"] * kind.density)
    files = {key: f"models/{name}/{file}" for key, file in (("visual", "model.glb"), ("hulls", "hulls.ply"))}
    return {
        "id": name,
        "kind": kind.kind,
        "category": model.category,
        **files,
        "licence": model.licence,
        "author": model.author,
        "source": model.source,
        "changes": CHANGES,
        "extent": facts["extent"],
        "mass": round(weight, 4),
        "supports": facts["supports"],
        "faces": facts["faces"],
        "sha256": {file: hashlib.sha256((made / Path(file).name).read_bytes()).hexdigest() for file in files.values()},
    }


def _preview(row: dict[str, Any], made: Path) -> None:
    """Draw the model beside its files, where this machine can draw."""
    from hazard_ms.rendering import backend

    if backend() == "none":
        return
    import cv2

    from hazard_ms.contact_sheet import Studio, captioned

    shown = Asset(
        row["id"],
        row["kind"],
        row["category"],
        str(made / "model.glb"),
        row["licence"],
        row["author"],
        row["source"],
        row["changes"],
        extent=tuple(row["extent"]),
        mass=row["mass"],
        faces=row["faces"],
    )
    cv2.imwrite(str(made / "preview.png"), captioned(Studio().picture(shown), shown)[..., ::-1])


def _write_index(folder: Path, rows: list[Any]) -> None:
    """Replace the index at once: readers see the old one or the new one."""
    text = "[\n" + ",\n".join(json.dumps(row, ensure_ascii=False) for row in rows) + "\n]\n"
    handle, pending = tempfile.mkstemp(prefix=".index-", dir=folder)
    try:
        with os.fdopen(handle, "w", encoding="utf-8") as file:
            file.write(text)
            file.flush()
            os.fsync(file.fileno())
        os.replace(pending, folder / "index.json")
    except BaseException:
        Path(pending).unlink(missing_ok=True)
        raise
