"""The pipe between the server and the process of a rescue: JSON one way, JSON and pictures the other, no pickle.

A message is one byte that says what it is, and its content: `{` begins JSON, a letter of PICTURES a JPEG.
"""

from __future__ import annotations

import json
from multiprocessing.connection import Connection
from typing import Any

ROOM, HEAD, HAZARD, MAP = "r", "h", "z", "m"  # of the third person, the head camera, the hazard, the semantic map
PICTURES = (ROOM, HEAD, HAZARD, MAP)
LONGEST = 4096  # characters of a message of a page [ours]
LONGEST_BYTES = 4 * LONGEST  # of a message of a page as the process gets it [ours]


class Link:
    """The worker's end."""

    def __init__(self, connection: Connection) -> None:
        self._connection = connection

    def say(self, kind: str, **content: Any) -> None:
        """Send a message of this kind to the server, as JSON."""
        self._connection.send_bytes(json.dumps({"type": kind, **content}, allow_nan=False).encode())

    def show(self, picture: str, jpeg: bytes) -> None:
        """Send a picture."""
        self._connection.send_bytes(picture.encode() + jpeg)

    def hear(self, seconds: float | None) -> dict[str, Any] | None:
        """The next message of the page; None if there is none within `seconds` (None: however long it takes).

        Raises EOFError when the server has gone.
        """
        if not self._connection.poll(seconds):
            return None
        message = json.loads(self._connection.recv_bytes(LONGEST_BYTES))
        return message if isinstance(message, dict) else None
