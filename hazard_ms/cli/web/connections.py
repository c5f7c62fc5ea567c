"""Connections to the server: nobody who has not shown the token holds one for long, or keeps others from one."""

from __future__ import annotations

import asyncio
import resource
from typing import Any

from uvicorn.protocols.http.h11_impl import H11Protocol

MOST = 200  # connections that have not shown the token [ours]
SHARE = 4  # of the files that the process may open they have at most one in so many [ours]
TIME = 10.0  # time in which a connection must show the token [s] [ours]
BACKLOG = 64  # connections that wait to be taken, and that are taken at once [ours]


class Connections:
    """The connections of one server. Those that have shown the token stay; of the others the oldest go first."""

    def __init__(self, most: int = 0) -> None:
        files = resource.getrlimit(resource.RLIMIT_NOFILE)[0]
        self._most = most or min(MOST, max(files // SHARE, 1))
        self._strange: dict[object, asyncio.Transport] = {}  # by the address of the other end, the oldest first

    def begin(self, transport: asyncio.Transport) -> None:
        """A connection has been made."""
        client = transport.get_extra_info("peername")
        self._strange = {c: t for c, t in self._strange.items() if not t.is_closing()}
        while len(self._strange) >= self._most:
            self._strange.pop(next(iter(self._strange))).abort()
        self._strange[client] = transport
        asyncio.get_running_loop().call_later(TIME, self._late, client, transport)

    def admit(self, client: object) -> None:
        """The connection from `client` has shown the token."""
        self._strange.pop(tuple(client) if isinstance(client, list | tuple) else client, None)

    def _late(self, client: object, transport: asyncio.Transport) -> None:
        if self._strange.get(client) is transport:
            del self._strange[client]
            transport.abort()

    def protocol(self, *given: Any, **named: Any) -> Any:
        """The protocol of one connection, for uvicorn."""
        return _Watched(self, *given, **named)


class _Watched(H11Protocol):
    """HTTP whose connection is counted."""

    def __init__(self, connections: Connections, *given: Any, **named: Any) -> None:
        super().__init__(*given, **named)
        self._counted = connections

    def connection_made(self, transport: asyncio.Transport) -> None:  # type: ignore[override]
        """Count the connection."""
        super().connection_made(transport)
        self._counted.begin(transport)
