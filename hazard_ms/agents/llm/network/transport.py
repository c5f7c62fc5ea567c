"""A connection that reads no more of an answer than it may, whatever its status, packed or not, and until its deadline.

What comes out holds the status, the plain body and one header; nothing else that a server sends is looked at.
"""

from __future__ import annotations

import contextlib
import socket
import time
import zlib
from typing import Any

import httpx2

LARGEST = 1_000_000  # size of an answer: hundreds of times that of a letter with its reason [bytes] [ours]
LARGEST_ERROR = 10_000  # of what is read of an error: its first words count [bytes] [ours]
GZIP = 31  # zlib's number for data of gzip
CONNECTED = (".connect_tcp.complete", ".start_tls.complete")  # ends of events that give a connection


class BodyError(Exception):
    """Raised for an answer that is too large, or packed in another way than gzip."""


class Bounded(httpx2.BaseTransport):
    """Sends requests through another transport, one at a time."""

    def __init__(self, inner: httpx2.BaseTransport) -> None:
        """Make no connection yet."""
        self._inner = inner
        self._socket: Any = None  # of the newest connection

    def handle_request(self, request: httpx2.Request) -> httpx2.Response:
        """The answer, whole, or the beginning of an error; nothing of an answer to GET, of which the status is enough.

        The deadline is that for reading. Raises BodyError for an answer that it does not read, and httpx2's errors.
        """
        until = time.monotonic() + float(request.extensions["timeout"]["read"])

        def watch(event: str, info: dict[str, Any]) -> None:
            if event.endswith(CONNECTED):
                self._socket = info["return_value"].get_extra_info("socket")
                if time.monotonic() > until:  # nobody waits any more who would cut it
                    raise httpx2.ReadTimeout("the deadline has passed")

        request.extensions = {**request.extensions, "trace": watch}
        response = self._inner.handle_request(request)
        try:
            body = _body(response, until) if request.method != "GET" or response.status_code >= 300 else b""
        finally:
            response.close()
        kept = {name: response.headers[name] for name in ("retry-after",) if name in response.headers}
        return httpx2.Response(
            response.status_code, headers={**kept, "content-type": "application/json"}, content=body, request=request
        )

    def cut(self) -> None:
        """End the connection, whatever another thread waits for there."""
        if self._socket is not None:
            with contextlib.suppress(OSError):
                socket.socket.shutdown(self._socket, socket.SHUT_RDWR)  # not that of TLS, which would wait

    def close(self) -> None:
        """Close the other transport."""
        self._inner.close()


def _body(response: httpx2.Response, until: float) -> bytes:
    """The plain body, or the beginning of that of an error, as far as it came."""
    if response.status_code < 300:
        return bytes(_read(response, bytearray(), LARGEST, until))
    found = bytearray()
    with contextlib.suppress(BodyError, httpx2.HTTPError):
        _read(response, found, LARGEST_ERROR, until)
    return bytes(found[:LARGEST_ERROR])


def _read(response: httpx2.Response, found: bytearray, most: int, until: float) -> bytearray:
    """`found`, to which the plain body was added. Raises BodyError where that has more than `most` bytes."""
    packed = response.headers.get("content-encoding", "identity").strip().lower()
    if packed not in ("identity", "gzip"):
        raise BodyError("an answer must be plain or packed with gzip, got something else")
    unpacking = zlib.decompressobj(GZIP) if packed == "gzip" else None
    assert isinstance(response.stream, httpx2.SyncByteStream)
    for part in response.stream:
        try:
            found += part if unpacking is None else unpacking.decompress(part, most + 1 - len(found))
        except zlib.error:
            raise BodyError("an answer that says gzip must be that, got something else") from None
        if len(found) > most:
            raise BodyError(f"an answer must have at most {most} bytes, got more")
        if time.monotonic() > until:
            raise httpx2.ReadTimeout("the deadline has passed")
        if unpacking is not None and unpacking.eof:
            break
    return found
