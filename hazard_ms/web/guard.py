"""The door of the server: every request must come from its own page, and know its token.

A page of somebody else in the same browser can send requests to this machine. It does not know the token, and its
browser names it as the origin; a name of its own that leads to this machine shows in the host. All that is refused
gets 403, before anything else is looked at.
"""

from __future__ import annotations

import secrets
from http.cookies import CookieError, SimpleCookie
from urllib.parse import parse_qs

from starlette.datastructures import Headers, MutableHeaders
from starlette.responses import PlainTextResponse
from starlette.types import ASGIApp, Message, Receive, Scope, Send

POLICY = (
    "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' blob: data:; media-src 'self'; "
    "connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
)
# of files in folders of results, which others may have written: they show, but run nothing
FILE_POLICY = (
    "default-src 'none'; style-src 'unsafe-inline'; img-src 'self' data:; media-src 'self' data:; "
    "sandbox allow-same-origin; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
)
FILES = "/files/"  # where the addresses of those files begin
REFUSED = 4403  # code with which a WebSocket is closed that is refused; 403 where none was opened [ours]
SAFE = ("GET", "HEAD")


class Guard:
    """Lets requests through to `app` that come from this server's page, and adds the rules for browsers to answers."""

    def __init__(self, app: ASGIApp, token: str, port: int) -> None:
        self._app, self._token, self._cookie = app, token, f"hazard_ms_{port}"
        self._hosts = {f"{name}:{port}" for name in ("127.0.0.1", "localhost")}

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer, or refuse, one request."""
        if scope["type"] not in ("http", "websocket"):
            await self._app(scope, receive, send)
            return
        headers = Headers(scope=scope)
        given = parse_qs(scope["query_string"].decode("latin-1")).get("token", [""])[0]
        fault = self._fault(scope, headers, given)
        if fault:
            await _refuse(fault, scope, receive, send)
            return

        async def answered(message: Message) -> None:
            if message["type"] == "http.response.start":
                self._add_rules(MutableHeaders(scope=message), scope["path"], self._same(given))
            await send(message)

        await self._app(scope, receive, answered)

    def _fault(self, scope: Scope, headers: Headers, given: str) -> str:
        """Why a request is refused; empty if it is not."""
        host, origin = headers.get("host", ""), headers.get("origin")
        if host not in self._hosts:
            return "the host must be this machine"
        changes = scope["type"] == "websocket" or scope["method"] not in SAFE
        if origin is None and changes:
            return "the origin must be given"
        if origin is not None and origin != f"http://{host}":
            return "the origin must be this page"
        if not (self._same(given) or self._same(self._in_cookie(headers))):
            return "the token must be that of the address which hazard-ms serve printed"
        return ""

    def _in_cookie(self, headers: Headers) -> str:
        try:
            found = SimpleCookie(headers.get("cookie", "")).get(self._cookie)
        except CookieError:
            return ""
        return "" if found is None else found.value

    def _same(self, given: str) -> bool:
        return secrets.compare_digest(given.encode(), self._token.encode())

    def _add_rules(self, headers: MutableHeaders, path: str, first: bool) -> None:
        headers["Content-Security-Policy"] = FILE_POLICY if path.startswith(FILES) else POLICY
        headers["X-Content-Type-Options"] = "nosniff"
        headers["Referrer-Policy"] = "no-referrer"
        headers["Cross-Origin-Resource-Policy"] = "same-origin"
        headers["Cross-Origin-Opener-Policy"] = "same-origin"
        headers.setdefault("Cache-Control", "no-store")
        if first:
            headers.append("Set-Cookie", f"{self._cookie}={self._token}; Path=/; HttpOnly; SameSite=Strict")


async def _refuse(fault: str, scope: Scope, receive: Receive, send: Send) -> None:
    if scope["type"] == "websocket":
        await send({"type": "websocket.close", "code": REFUSED, "reason": fault})  # before it is open: HTTP 403
        return
    await PlainTextResponse(f"refused: {fault}\n", 403)(scope, receive, send)
