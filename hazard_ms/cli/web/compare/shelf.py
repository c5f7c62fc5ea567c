"""Results in the folders that a server was given: found again at each look, each file read once until it changes."""

from __future__ import annotations

import hashlib
import os
import stat
import threading
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from hazard_ms.evaluation.comparison.folders import Kept
from hazard_ms.evaluation.regret.causes import beside, place_of
from hazard_ms.evaluation.result import REGRET, EpisodeResult

MOST_FILES = 5_000  # results that are read [ours]
MOST_ENTRIES = 200_000  # files and folders that are looked at [ours]
LARGEST = 8 * 1024 * 1024  # of a file [bytes] [ours]
LARGEST_IN_ALL = 160 * 1024 * 1024  # of all files together; those of 1,000 episodes take about 40 MB [bytes] [ours]
# what readers of odd files raise: such a file is named, and all others are shown
UNREADABLE = (OSError, ValueError, ArithmeticError, TypeError, LookupError, AttributeError, RecursionError)

Stamp = tuple[int, ...]  # of a file and of its regret: they are read again when it changes


@dataclass(frozen=True)
class Book:
    """A result that can be shown: `key` names it in addresses, `folder` is that of its folder, `name` its path."""

    key: str
    folder: str
    name: str
    kept: Kept
    stamp: Stamp


@dataclass(frozen=True)
class Refused:
    """A file that cannot be shown, as it is called on the page, and why not."""

    name: str
    reason: str


@dataclass(frozen=True)
class Shelf:
    """The finds of one look: folders by key with the name that is shown, results by key, and files that are refused."""

    folders: dict[str, str] = field(default_factory=dict)
    books: dict[str, Book] = field(default_factory=dict)
    refused: list[Refused] = field(default_factory=list)

    def chosen(self, folders: Sequence[str]) -> list[Book]:
        """The results in the folders with these keys, all if there are none. Raises ValueError for unknown keys."""
        for key in folders:
            if key not in self.folders:
                raise ValueError(f"folder must be one of those on the page, got {key!r:.100}")
        return [book for book in self.books.values() if not folders or book.folder in folders]


@dataclass(frozen=True)
class _Read:
    """What was read of a file when it had this stamp: a result or the reason why there is none, and of its regret."""

    stamp: Stamp
    kept: Kept | None
    reasons: tuple[str, ...]


class Librarian:
    """Looks through folders and the folders in them; follows no links, so that nothing outside them is ever read."""

    def __init__(self, folders: Sequence[Path]) -> None:
        self._folders = [Path(folder) for folder in folders]
        self._read: dict[Path, _Read] = {}
        self._lock = threading.Lock()

    def look(self) -> Shelf:
        """All results as they are now, in the order of their names."""
        with self._lock:
            shelf, left, bytes_left = Shelf(), self._read, LARGEST_IN_ALL
            self._read = {}
            for path, folder, name in self._files(shelf):
                found = self._one(path, name, left, bytes_left)
                if found.stamp:
                    self._read[path] = found
                    bytes_left -= found.stamp[1] + found.stamp[-1]
                shelf.refused.extend(Refused(name, reason) for reason in found.reasons)
                if found.kept is not None:
                    key = _key(path)
                    shelf.books[key] = Book(key, folder, name, found.kept, found.stamp)
            return shelf

    def _files(self, shelf: Shelf) -> Iterator[tuple[Path, str, str]]:
        """Each file that may hold a result, once, with the key of its folder and its path; notes what is left out."""
        seen, entries = set[Path](), 0
        for top in (folder.resolve() for folder in self._folders):
            for place, folders, names in os.walk(top):
                folders[:] = sorted(name for name in folders if not name.startswith("."))
                folder, key = Path(place), _key(Path(place))
                shown = Path(top.name, folder.relative_to(top)).as_posix()
                entries += len(names) + len(folders)
                own = {folder / name for name in names if _may_be_result(name)} - seen
                if entries > MOST_ENTRIES or len(seen) + len(own) > MOST_FILES:
                    why = f"folders must hold at most {MOST_FILES} results and {MOST_ENTRIES} files, got more"
                    shelf.refused.append(Refused(shown, f"{why}: this folder and those after it are left out"))
                    return
                seen |= own
                for path in sorted(own):
                    shelf.folders.setdefault(key, shown)
                    yield path, key, f"{shown}/{path.name}"

    def _one(self, path: Path, name: str, known: dict[Path, _Read], bytes_left: int) -> _Read:
        """What is in a file: as it is known, if it has not changed since."""
        try:
            stamp = _stamp(path, bytes_left)
        except (OSError, ValueError) as error:
            return _Read((), None, (_plain(error, path),))
        if path in known and known[path].stamp == stamp:
            return known[path]
        try:
            result = EpisodeResult.read(path)
        except UNREADABLE as error:
            return _Read(stamp, None, (_plain(error, path),))
        try:
            regret = beside(path) if stamp[-1] else None
        except UNREADABLE as error:
            return _Read(stamp, Kept(result, path), (f"its regret: {_plain(error, path)}",))
        return _Read(stamp, Kept(result, path, regret), ())


def _stamp(path: Path, bytes_left: int) -> Stamp:
    """When a result and its regret changed, and their sizes [bytes]; 0 for a regret that is not there.

    Raises ValueError for files that are links or too large.
    """
    made = [*_state(path)]
    regret = place_of(path)
    made += _state(regret) if os.path.lexists(regret) else (0, 0)
    if made[1] + made[3] > bytes_left:
        raise ValueError(f"results must have at most {LARGEST_IN_ALL} bytes together, got more; choose fewer folders")
    return tuple(made)


def _state(path: Path) -> tuple[int, int]:
    """Time of the last change [ns] and size [bytes] of a file. Raises ValueError for what must not be read."""
    found = path.lstat()
    if not stat.S_ISREG(found.st_mode):
        kind = "a link" if stat.S_ISLNK(found.st_mode) else "something else"
        raise ValueError(f"{path.name} must be a file, got {kind}")
    if found.st_size > LARGEST:
        raise ValueError(f"{path.name} must have at most {LARGEST} bytes, got {found.st_size}")
    return found.st_mtime_ns, found.st_size


def _may_be_result(name: str) -> bool:
    return name.endswith(".json") and not name.endswith(REGRET) and not name.startswith(".")


def film_of(kept: Kept) -> Path | None:
    """The film beside a result; None where there is none, or only a link to one."""
    film = kept.path.with_suffix(".mp4")
    return film if film.is_file() and not film.is_symlink() else None


def _key(path: Path) -> str:
    """A name for a path in addresses, from which no path can be made."""
    return hashlib.sha256(os.fsencode(path)).hexdigest()[:16]


def _plain(error: Exception, path: Path) -> str:
    """An error in words, without the folder in which the file is."""
    return str(error).replace(f"{path.parent}{os.sep}", "")[:500]
