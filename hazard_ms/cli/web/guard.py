"""The door of the server: every request must come from its own page, and show its token.

The page is the same for everybody; what it shows is not. Whatever tells or changes something needs the token, which
the page sends in a header, and in the protocol of a WebSocket. There is no cookie: browsers send those to every port
of this machine. Files that a browser opens by itself have a key in their address, which opens nothing else. All that is
refused gets 403, before anything else is looked at.
"""

from __future__ import annotations

import hmac
from collections.abc import Callable

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
OPEN = ("/", "/static/")  # the page itself, which holds nothing of the user's
BEARER = "Bearer "  # before the token in the header Authorization
PROTOCOL = "hazard_ms"  # of the WebSocket; the page offers it with the token beside it


def file_key(token: str) -> str:
    """The key in addresses of files: it opens files alone, and the token cannot be worked out from it."""
    return hmac.new(token.encode(), b"files", "sha256").hexdigest()[:32]


class Guard:
    """Lets requests through to `app` that come from this server's page, and adds the rules for browsers to answers.

    `admitted` is told of the connection of each request that has shown the token.
    """

    def __init__(self, app: ASGIApp, token: str, port: int, admitted: Callable[[object], None]) -> None:
        self._app, self._token, self._admitted = app, token, admitted
        self._files = f"{FILES}{file_key(token)}/"
        self._host = f"127.0.0.1:{port}"  # no name: another server may have the port at the other addresses of a name

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer, or refuse, one request."""
        if scope["type"] not in ("http", "websocket"):
            await self._app(scope, receive, send)
            return
        scope = self._without_key(scope)
        fault = self._fault(scope, Headers(scope=scope))
        if fault:
            await _refuse(fault, scope, receive, send)
            return

        async def answered(message: Message) -> None:
            if message["type"] == "http.response.start":
                _add_rules(MutableHeaders(scope=message), scope["path"])
            await send(message)

        await self._app(scope, receive, answered)

    def _without_key(self, scope: Scope) -> Scope:
        """The request without the key of files in its address; `keyed` says whether it had the right one."""
        start, key, rest = scope["path"][: len(FILES)], *_parted(scope["path"][len(FILES) :])
        keyed = start == FILES and _same(f"{FILES}{key}/", self._files)
        return {**scope, "keyed": keyed, "path": FILES + rest} if keyed else {**scope, "keyed": False}

    def _fault(self, scope: Scope, headers: Headers) -> str:
        """Why a request is refused; empty if it is not."""
        origin = headers.get("origin")
        if headers.get("host", "") != self._host:
            return f"the host must be {self._host}"
        changes = scope["type"] == "websocket" or scope["method"] not in SAFE
        if origin is None and changes:
            return "the origin must be given"
        if origin is not None and origin != f"http://{self._host}":
            return "the origin must be this page"
        if _same(_shown(scope, headers), self._token) or (scope["keyed"] and not changes):
            self._admitted(scope.get("client"))
            return ""
        if not changes and (scope["path"] == OPEN[0] or scope["path"].startswith(OPEN[1])):
            return ""
        return "the token must be the one in the address that hazard-ms serve printed"


def _parted(path: str) -> tuple[str, str]:
    first, _, rest = path.partition("/")
    return first, rest


def _shown(scope: Scope, headers: Headers) -> str:
    """The token that a request shows; empty if it shows none."""
    if scope["type"] == "websocket":
        offered = [word.strip() for word in headers.get("sec-websocket-protocol", "").split(",")]
        return offered[1] if len(offered) == 2 and offered[0] == PROTOCOL else ""
    given = headers.get("authorization", "")
    return given[len(BEARER) :] if given.startswith(BEARER) else ""


def _same(given: str, wanted: str) -> bool:
    return hmac.compare_digest(given.encode("utf-8", "surrogatepass"), wanted.encode())


def _add_rules(headers: MutableHeaders, path: str) -> None:
    headers["Content-Security-Policy"] = FILE_POLICY if path.startswith(FILES) else POLICY
    headers["X-Content-Type-Options"] = "nosniff"
    headers["Referrer-Policy"] = "no-referrer"
    headers["Cross-Origin-Resource-Policy"] = "same-origin"
    headers["Cross-Origin-Opener-Policy"] = "same-origin"
    headers.setdefault("Cache-Control", "no-store")


async def _refuse(fault: str, scope: Scope, receive: Receive, send: Send) -> None:
    if scope["type"] == "websocket":
        await send({"type": "websocket.close", "code": REFUSED, "reason": fault})  # before it is open: HTTP 403
        return
    await PlainTextResponse(f"refused: {fault}\n", 403)(scope, receive, send)
