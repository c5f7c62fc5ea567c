"""Answers of models in a file, so that an episode can be played again without the network, exactly as it was.

The file is an SQLite database that several processes may use at once. An answer is found by a hash of everything that
was sent: the model, the messages, the settings, and the how-manieth time it was asked in the episode.
"""

from __future__ import annotations

import hashlib
import json
import sqlite3
from collections.abc import Iterator
from contextlib import closing, contextmanager
from pathlib import Path
from typing import Any, NamedTuple

PATIENCE = 30.0  # time for which a process waits until others have written [s] [ours]
TABLE = """CREATE TABLE IF NOT EXISTS answers (
    key TEXT PRIMARY KEY, body TEXT NOT NULL, seconds REAL NOT NULL, host TEXT NOT NULL, model TEXT NOT NULL,
    at TEXT NOT NULL DEFAULT CURRENT_TIMESTAMP)"""


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
            raise ValueError(f"cache must be a file of recorded answers for replay=true, got {path}")
        with self._open() as database:
            if writable:
                database.execute("PRAGMA journal_mode=WAL")
                database.execute(TABLE)
            database.execute("SELECT key, body, seconds FROM answers LIMIT 1")

    def get(self, key: str) -> Stored | None:
        """The answer that was kept under a key; None if there is none."""
        with self._open() as database:
            row = database.execute("SELECT body, seconds FROM answers WHERE key = ?", (key,)).fetchone()
        return None if row is None else Stored(json.loads(row[0]), float(row[1]))

    def put(self, key: str, answer: Stored, host: str, model: str) -> None:
        """Keep an answer under a key, in place of what was kept there."""
        with self._open() as database:
            database.execute(
                "INSERT OR REPLACE INTO answers (key, body, seconds, host, model) VALUES (?, ?, ?, ?, ?)",
                (key, json.dumps(answer.body), answer.seconds, host, model),
            )

    @contextmanager
    def _open(self) -> Iterator[sqlite3.Connection]:
        """The database, for one use, so that no connection outlives a fork. Raises ValueError on its errors."""
        try:
            with closing(sqlite3.connect(self._path, timeout=PATIENCE)) as database, database:
                yield database
        except (sqlite3.Error, OSError) as error:
            raise ValueError(f"cache must be a file of recorded answers, got {self._path}: {error}") from None


def key_of(request: dict[str, Any], sample: int, turn: int) -> str:
    """The key of a request's answer.

    `turn` tells requests that are alike within an episode from each other, and `sample` those of several runs.
    """
    text = json.dumps([request, sample, turn], sort_keys=True, separators=(",", ":"))
    return hashlib.sha256(text.encode()).hexdigest()
