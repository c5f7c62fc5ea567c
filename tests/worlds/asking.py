"""Requests to an application without a network between, as a browser with the token sends them."""

from __future__ import annotations

import asyncio
import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from urllib.parse import unquote, urlsplit

from hazard_ms.cli.web.app import application
from hazard_ms.cli.web.options import ServeOptions

TOKEN, PORT = "a-token-for-tests-of-24-bytes", 8000


@dataclass(frozen=True)
class Answer:
    """What came back."""

    status: int
    headers: dict[str, str]
    body: bytes

    @property
    def json(self) -> Any:
        return json.loads(self.body, parse_constant=lambda word: 1 / 0)  # NaN and infinities are not JSON


class Asking:
    """The application of `hazard-ms serve` for some folders."""

    def __init__(self, *folders: Path) -> None:
        self.app = application(ServeOptions(folder=folders), TOKEN, PORT)

    def get(self, address: str, token: str = TOKEN) -> Answer:
        """Ask for an address, which may have a query."""
        parts = urlsplit(address)
        headers = [(b"host", f"127.0.0.1:{PORT}".encode()), (b"authorization", f"Bearer {token}".encode())]
        scope = {
            "type": "http",
            "asgi": {"version": "3.0", "spec_version": "2.4"},
            "method": "GET",
            "path": unquote(parts.path),
            "raw_path": parts.path.encode(),
            "root_path": "",
            "query_string": parts.query.encode(),
            "headers": headers,
            "http_version": "1.1",
            "scheme": "http",
        }
        return asyncio.run(self._answer(scope))

    async def _answer(self, scope: dict[str, Any]) -> Answer:
        sent: list[dict[str, Any]] = []

        async def receive() -> dict[str, Any]:
            return {"type": "http.request", "body": b"", "more_body": False}

        async def send(message: Any) -> None:
            sent.append(message)

        await self.app(scope, receive, send)
        start, *rest = sent
        headers = {name.decode(): value.decode() for name, value in start["headers"]}
        return Answer(start["status"], headers, b"".join(message.get("body", b"") for message in rest))
