"""The cache folder: everything that hazard_ms keeps outside the checkout, written whole or not at all."""

from __future__ import annotations

import atexit
import hashlib
import os
import shutil
import tempfile
from collections.abc import Mapping
from functools import cache
from pathlib import Path


def home() -> Path:
    """The cache folder: HAZARD_MS_HOME, else `hazard_ms` in the user's cache folder. It need not exist yet."""
    default = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "hazard_ms"
    return Path(os.environ.get("HAZARD_MS_HOME") or default)


def kept_folder(kind: str, files: Mapping[str, str]) -> Path:
    """A folder that holds these files, text by relative path: kept in the cache, or temporary where that is read-only.

    Its name is the digest of its contents, so it is written once, and several processes may ask for it at once.
    """
    digest = hashlib.sha256("\0".join(f"{name}\0{text}" for name, text in sorted(files.items())).encode())
    folder = home() / kind / digest.hexdigest()[:16]
    if os.path.isdir(folder):  # Path.is_dir raises where the cache is closed to us
        return folder
    try:
        folder.parent.mkdir(parents=True, exist_ok=True)
        draft = Path(tempfile.mkdtemp(dir=folder.parent))
    except OSError:
        return _temporary_folder(kind, tuple(sorted(files.items())))
    try:
        draft.chmod(0o755)  # other users may share the cache
        _filled(draft, files).rename(folder)
    except OSError:
        shutil.rmtree(draft, ignore_errors=True)
        if not folder.is_dir():  # a full disk, and not a process that was faster
            return _temporary_folder(kind, tuple(sorted(files.items())))
    return folder


@cache
def _temporary_folder(kind: str, files: tuple[tuple[str, str], ...]) -> Path:
    """One folder with these files for this process, which is deleted at its end."""
    folder = Path(tempfile.mkdtemp(prefix=f"hazard_ms-{kind}-"))
    atexit.register(_delete_own, folder, os.getpid())
    return _filled(folder, dict(files))


def _delete_own(folder: Path, owner: int) -> None:
    """Delete a folder of the process `owner`, unless this is another one, which was forked from it."""
    if os.getpid() == owner:
        shutil.rmtree(folder, ignore_errors=True)


def _filled(folder: Path, files: Mapping[str, str]) -> Path:
    """The same folder with the files in it."""
    for name, text in files.items():
        place = folder / name
        place.parent.mkdir(parents=True, exist_ok=True)
        place.write_text(text, encoding="utf-8")
    return folder
