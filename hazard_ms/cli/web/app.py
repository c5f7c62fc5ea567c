"""The application of `hazard-ms serve`: which address shows what."""

from __future__ import annotations

import asyncio
import contextlib
from collections.abc import AsyncIterator, Callable
from pathlib import Path

from starlette.applications import Starlette
from starlette.middleware import Middleware
from starlette.requests import Request
from starlette.responses import FileResponse, JSONResponse, Response
from starlette.routing import Mount, Route
from starlette.staticfiles import StaticFiles

from hazard_ms.cli.web import compare
from hazard_ms.cli.web.files import file_routes
from hazard_ms.cli.web.guard import Guard, file_key
from hazard_ms.cli.web.live import live_routes
from hazard_ms.cli.web.options import ServeOptions
from hazard_ms.cli.web.sessions import Sessions

STATIC = Path(__file__).parent / "static"


def application(
    options: ServeOptions, token: str, port: int, admitted: Callable[[object], None] = lambda client: None
) -> Starlette:
    """The application that serves the folders of `options` at `port`, to whom knows the `token`.

    `admitted` is told of each connection that has shown it.
    """
    folders, sessions = options.folders, Sessions(options)

    @contextlib.asynccontextmanager
    async def life(app: Starlette) -> AsyncIterator[None]:
        looking = asyncio.create_task(sessions.look_round())
        yield
        looking.cancel()
        sessions.end()

    async def entered(request: Request) -> Response:
        return JSONResponse({"file_key": file_key(token)})

    return Starlette(
        routes=[
            Route("/", _index),
            Route("/api/enter", entered),
            *live_routes(sessions, options.load),
            *file_routes(folders),
            *compare.routes(folders),
            Mount("/static", StaticFiles(directory=STATIC)),
        ],
        middleware=[Middleware(Guard, token=token, port=port, admitted=admitted)],
        exception_handlers={ValueError: _refused},
        lifespan=life,
    )


async def _index(request: Request) -> Response:
    return FileResponse(STATIC / "index.html")


async def _refused(request: Request, error: Exception) -> Response:
    """Input that is not valid, as every command says it."""
    return JSONResponse({"error": str(error)}, 400)
