"""Imports scenes of the original benchmark: one JSON file for each of its folders (`hazard-ms scenes import`)."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path

from hazard_ms.spec.foreign.files import printable

LOG = "log.txt"  # a folder that holds one is a scene
MOST_SCENES = 2000  # in one import


def import_scenes(paths: Sequence[Path], out: Path) -> int:
    """Write the scenes of all folders in `paths` into the folder `out`; print each, and what had to be guessed.

    A scene that cannot be read does not keep the others from being written. Returns the exit code: 1 if there was one.
    Raises ValueError if there is nothing to read, or if `out` cannot be written.
    """
    from hazard_ms.scenes.original.read import read
    from hazard_ms.scenes.schema import to_json

    folders = list(dict.fromkeys(f for p in paths for f in _folders(p)))
    target = _target(out)
    failed, written = 0, set()
    for folder in folders:
        try:
            found = read(folder)
            if found.spec.name in written:
                raise ValueError(
                    f"{printable(str(folder))}: names of scenes must differ, got {found.spec.name!r} twice"
                )
            _write(target, found.spec.name, to_json(found.spec))
        except ValueError as error:
            failed += 1
            print(f"hazard-ms: {printable(str(error))}", file=sys.stderr)
            continue
        written.add(found.spec.name)
        spec = found.spec
        parts = {
            "bodies": spec.bodies,
            "fixtures": spec.fixtures,
            "targets": spec.targets,
            "containers": spec.containers,
        }
        print(f"{spec.name}: " + ", ".join(f"{len(things)} {what}" for what, things in parts.items()))
        for note in found.notes:
            print(f"  {printable(note)}")
    print(f"{len(written)} scenes in {printable(str(target))}" + (f", {failed} could not be read" if failed else ""))
    return 1 if failed else 0


def _folders(path: Path) -> Iterator[Path]:
    """The scene folders that a path means: itself, or those in it, or those in folders in it."""
    if not path.is_dir():
        raise ValueError(
            f"a scene must be a folder that exists, or a folder of such folders, got {printable(str(path))}"
        )
    path = path.resolve()
    found = (
        [path]
        if (path / LOG).is_file()
        else sorted(f.parent for depth in ("*", "*/*") for f in path.glob(f"{depth}/{LOG}"))
    )
    if not found or len(found) > MOST_SCENES:
        raise ValueError(
            f"{printable(str(path))} must hold 1 to {MOST_SCENES} scene folders, each with a {LOG}, got {len(found)}"
        )
    yield from found


def _target(out: Path) -> Path:
    try:
        out.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise ValueError(f"{printable(str(out))} cannot be made: {error.strerror}") from None
    return out.resolve()


def _write(target: Path, name: str, text: str) -> None:
    """Write `name`.json into `target`, nowhere else: links are replaced, not followed."""
    path = target / f"{name}.json"
    if path.parent != target or path.is_dir():
        raise ValueError(f"a scene must be written to a file directly in {printable(str(target))}, got {path.name!r}")
    part = target / f".{name}.{os.getpid()}.part"
    try:
        part.unlink(missing_ok=True)
        with part.open("x", encoding="utf-8") as file:
            file.write(text)
        part.replace(path)
    except OSError as error:
        raise ValueError(f"{printable(str(path))} cannot be written: {error.strerror}") from None
