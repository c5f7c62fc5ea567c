"""Adds models to the user's folder and takes them out again.

A model is there as a whole or not at all, whatever interrupts it.
"""

from __future__ import annotations

import hashlib
import json
import math
import os
import re
import shutil
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from hazard_ms.scenes.assets.index import asset_ids
from hazard_ms.scenes.assets.intake.conversion import convert, preview
from hazard_ms.scenes.assets.intake.model import Model
from hazard_ms.scenes.assets.rows import Asset
from hazard_ms.scenes.assets.shipped import root
from hazard_ms.scenes.assets.user_models import LICENCE, USER_ID, confined, read_user_row, user_root, user_rows
from hazard_ms.spec.catalogue import CATEGORIES, category
from hazard_ms.spec.foreign.files import printable
from hazard_ms.spec.storage.files import write

FILES = ("model.glb", "hulls.ply", "preview.png")  # of a model, in its own folder
PENDING = ".adding-"  # how the names of temporary folders begin
CHANGES = "turned z up, put on its base, textures at most 512 pixels, convex hulls by CoACD"


def add(model: Model, name: str, mass: float | None = None, size: float | None = None) -> Asset:
    """Convert a model and keep it as `name`, `size` metres along its longest edge (None: as it is).

    `mass` [kg]; None: from its volume. Raises ValueError for whatever is not allowed; the folder is then unchanged.
    """
    _check(model, name, mass, size)
    folder = user_root()
    with _locked(folder) as rows:
        if any(isinstance(row, dict) and row.get("id") == name for row in rows):
            raise ValueError(
                f"names of models in {folder} must differ, got {name!r} again: hazard-ms assets remove {name}, "
                "or another --name"
            )
        place = _free_place(folder, name)
        with tempfile.TemporaryDirectory(prefix=PENDING, dir=folder) as pending:
            made = Path(pending) / name
            made.mkdir()
            facts = convert(model, made, size)
            row = _row(model, name, mass, facts, made)
            preview(row, made)
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
    """Remove the model `name` from the user's folder. Raises ValueError if there is none."""
    folder = user_root()
    with _locked(folder) as rows:
        kept = [row for row in rows if not (isinstance(row, dict) and row.get("id") == name)]
        if len(kept) == len(rows):
            there = ", ".join(printable(str(row.get("id"))) for row in rows if isinstance(row, dict)) or "none"
            raise ValueError(f"a model to remove must be one of {there} in {folder}, got {name!r:.100}")
        _write_index(folder, kept)
        if USER_ID.fullmatch(name):
            _delete(_place(folder, name))


def free_name(stem: str) -> str:
    """The id that the name of a file suggests."""
    return re.sub(r"[^a-z0-9]+", "_", stem.lower()).strip("_")[:40]


def _check(model: Model, name: str, mass: float | None, size: float | None) -> None:
    category(model.category)
    if not USER_ID.fullmatch(name):
        raise ValueError(
            f"an id must have 1 to 40 characters a-z, 0-9 or _, and begin with a letter, got {name!r:.100}: give "
            "another --name"
        )
    kept = re.fullmatch(r"(.+)_\d+", name)
    if name in asset_ids() or (kept and kept[1] in CATEGORIES):
        raise ValueError(
            f"an id must not be taken by a shipped model or reserved for one, got {name!r}: try --name my_{name}"
        )
    if not LICENCE.fullmatch(model.licence):
        raise ValueError(
            f"licence must name the model's licence, such as CC-BY-4.0 or own work, got {model.licence!r:.100}: give "
            "--licence"
        )
    for what, value, most in (("mass", mass, 1000.0), ("size", size, 20.0)):
        if value is not None and not (math.isfinite(value) and 0.0 < value < most):
            raise ValueError(f"{what} must be above 0 and below {most:g}, got {value}")


@contextmanager
def _locked(folder: Path) -> Iterator[list[Any]]:
    """The rows of the index, while nobody else may write it; what an interrupted run left is cleared away."""
    import fcntl

    if folder.resolve().is_relative_to(root().resolve()):
        raise ValueError(
            f"HAZARD_MS_ASSETS must be a folder of your own, got {folder}, which belongs to hazard_ms itself"
        )
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
        raise ValueError(
            f"{folder} must be free, got another hazard-ms writing to it: wait until that has ended"
        ) from None
    except OSError as error:
        remedy = "free some space, or set HAZARD_MS_ASSETS to a folder on another disk"
        raise ValueError(f"{folder} cannot be written: {error}; {remedy}") from None
    finally:
        os.close(lock)


def _place(folder: Path, name: str) -> Path:
    """The folder of the model `name`. Raises ValueError if links lead out of the user's folder."""
    confined(folder, f"models/{name}")
    return folder / "models" / name


def _free_place(folder: Path, name: str) -> Path:
    """The folder for the model `name`. What an interrupted run left there is deleted, anything else is not."""
    place = _place(folder, name)
    if place.is_symlink() or (place.exists() and not {p.name for p in place.iterdir()} <= set(FILES)):
        raise ValueError(f"{place} must be free, got a folder that holds more than a model: move it")
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


def _write_index(folder: Path, rows: list[Any]) -> None:
    """Replace the index at once: readers see the old one or the new one."""
    write(folder / "index.json", "[\n" + ",\n".join(json.dumps(row, ensure_ascii=False) for row in rows) + "\n]\n")
