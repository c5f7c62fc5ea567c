"""Answers of models in a file, so that an episode can be played again without the network, exactly as it was.

The file is an SQLite database that several processes may use at once. An answer is found by a hash of everything that
was sent: the model, the messages, the settings, and the how-manieth time it was asked in the episode.
"""

from __future__ import annotations

import hashlib
import json
import math
import os
import sqlite3
import stat
import sys
from collections.abc import Iterable, Iterator
from contextlib import closing, contextmanager
from pathlib import Path
from typing import Any, NamedTuple

from hazard_ms.spec.foreign.files import printable
from hazard_ms.spec.foreign.plain import parse

PATIENCE = 30.0  # time for which a process waits until others have written [s] [ours]
TABLE = """CREATE TABLE answers (
    key TEXT PRIMARY KEY, body TEXT NOT NULL, seconds REAL NOT NULL, host TEXT NOT NULL, model TEXT NOT NULL,
    at TEXT NOT NULL DEFAULT CURRENT_TIMESTAMP)"""
SCHEMA = {("table", "answers", TABLE), ("index", "sqlite_autoindex_answers_1", None)}  # all that a file may define
LONGEST = 8_000_000  # of an answer's body, whose every letter may be written as six [bytes] [ours]
STEPS = 1_000  # of SQLite's machine between two calls of the watch [-]
MOST_STEPS = 300  # such calls in one use of the file, which needs fewer than one [-] [ours]
LIMITS = ("SQLITE_LIMIT_LENGTH", "SQLITE_LIMIT_SQL_LENGTH")  # of SQLite that become LONGEST, from Python 3.11 on
GUARDS = ("trusted_schema=OFF", "cell_size_check=ON", "mmap_size=0", "temp_store=MEMORY")


class Stored(NamedTuple):
    """The body of an answer as the server sent it, JSON, and how long it took [s]."""

    body: dict[str, Any]
    seconds: float


class Cache:
    """The answers in one file."""

    def __init__(self, path: Path, writable: bool = True) -> None:
        """Open the file, or make it where it is `writable`.

        Raises ValueError for one that does not exist and must not be made, and for one that is no such database.
        """
        self._path, self._writable = path, writable
        if not writable and not path.is_file():
            raise ValueError(f"cache must be a file of recorded answers for replay=true, got {self._shown}")
        with self._open() as database:
            if writable and not database.execute("SELECT 1 FROM sqlite_master LIMIT 1").fetchone():
                database.execute("PRAGMA journal_mode=WAL")
                database.execute(TABLE.replace("TABLE", "TABLE IF NOT EXISTS", 1))
            found = database.execute(f"SELECT type, name, sql FROM sqlite_master LIMIT {len(SCHEMA) + 1}").fetchall()
            if _plain(found) != _plain(SCHEMA):
                raise ValueError(
                    f"cache must be a file of recorded answers, got a database with other tables: {self._shown}"
                )

    def get(self, key: str) -> Stored | None:
        """The answer that was kept under a key; None if there is none. Raises ValueError for one that is damaged."""
        with self._open() as database:
            row = database.execute("SELECT body, seconds FROM answers WHERE key = ?", (key,)).fetchone()
        if row is None:
            return None
        body, seconds = row
        found = parse(body, f"an answer in {self._shown}") if isinstance(body, str) else None
        if not isinstance(found, dict) or not isinstance(seconds, float) or not 0.0 <= seconds < math.inf:
            raise ValueError(
                "each row of a cache must hold an answer, as a JSON object, and its time, got another row in "
                f"{self._shown}"
            )
        return Stored(found, seconds)

    def put(self, key: str, answer: Stored, host: str, model: str) -> None:
        """Keep an answer under a key, in place of what was kept there."""
        with self._open() as database:
            database.execute(
                "INSERT OR REPLACE INTO answers (key, body, seconds, host, model) VALUES (?, ?, ?, ?, ?)",
                (key, json.dumps(answer.body), answer.seconds, host, model),
            )

    @property
    def _shown(self) -> str:
        return printable(str(self._path))

    @contextmanager
    def _open(self) -> Iterator[sqlite3.Connection]:
        """The database, for one use, so that no connection outlives a fork. Raises ValueError on its errors."""
        try:
            if self._path.exists() and not stat.S_ISREG(os.stat(self._path).st_mode):
                raise OSError("not a regular file")
            with closing(sqlite3.connect(self._path, timeout=PATIENCE)) as database, database:
                _guard(database)
                yield database
        except (sqlite3.Error, OSError, UnicodeError) as error:
            told = printable(str(error))[:200]
            raise ValueError(f"cache must be a file of recorded answers, got {self._shown}: {told}") from None


def _guard(database: sqlite3.Connection) -> None:
    """Set limits, so that a file that somebody else made can neither hang nor write much."""
    if sys.version_info >= (3, 11):
        for limit in LIMITS:
            database.setlimit(getattr(sqlite3, limit), LONGEST)
    left = [MOST_STEPS]

    def watch() -> bool:
        left[0] -= 1
        return left[0] < 0

    database.set_progress_handler(watch, STEPS)
    for guard in GUARDS:
        database.execute(f"PRAGMA {guard}")


def _plain(schema: Iterable[tuple[Any, ...]]) -> list[str]:
    """The definitions of a file, to be compared: in some order, with single spaces."""
    return sorted(" ".join(" ".join(map(str, row)).split()) for row in schema)


def key_of(request: dict[str, Any], sample: int, turn: int) -> str:
    """The key of a request's answer.

    `turn` tells requests that are alike within an episode from each other, and `sample` those of several runs.
    """
    text = json.dumps([request, sample, turn], sort_keys=True, separators=(",", ":"))
    return hashlib.sha256(text.encode()).hexdigest()
