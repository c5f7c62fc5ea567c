"""The routes about rescues: what there is to choose from, beginning one, and the WebSocket over which it is shown."""

from __future__ import annotations

import asyncio
import json
from typing import Any

from starlette.concurrency import run_in_threadpool
from starlette.exceptions import HTTPException
from starlette.requests import Request
from starlette.responses import JSONResponse, Response
from starlette.routing import BaseRoute, Route, WebSocketRoute
from starlette.websockets import WebSocket, WebSocketDisconnect

from hazard_ms.cli.web.guard import PROTOCOL
from hazard_ms.cli.web.playing.link import LONGEST
from hazard_ms.cli.web.rescue import PACES, asked_for
from hazard_ms.cli.web.session import Page, Session
from hazard_ms.cli.web.sessions import Sessions
from hazard_ms.evaluation.choices import LIGHTINGS, PRESETS, SEVERITIES
from hazard_ms.spec.registry import AGENTS, ROBOTS, TASKS, load

NO_RESCUE = 4404  # code with which a WebSocket is closed that asks for a rescue which cannot be gone on with [ours]


def live_routes(sessions: Sessions, plugins: tuple[str, ...]) -> list[BaseRoute]:
    """The routes below /api about the rescues of `sessions`; `plugins`: modules that episodes need."""

    async def rescues(request: Request) -> Response:
        return JSONResponse(sessions.listed())

    async def begin(request: Request) -> Response:
        rescue = await run_in_threadpool(asked_for, await _content(request), plugins)
        return JSONResponse({"name": sessions.begin(rescue).rescue.name})

    async def change(request: Request) -> Response:
        name, what = str(request.path_params["name"]), str(request.path_params["what"])
        content = await _content(request)
        if what == "again":
            sessions.again(name)
        elif what == "jump":
            sessions.jump(name, content.get("decisions"))
        elif what == "take_over":
            name = sessions.take_over(name, content.get("decisions")).rescue.name
        elif what == "end":
            sessions.close(name)
        else:
            raise HTTPException(404, "there is no such address")
        return JSONResponse({"name": name})

    async def live(socket: WebSocket) -> None:
        await socket.accept(PROTOCOL)
        try:
            session = sessions.find(str(socket.path_params["name"]))
        except ValueError as error:
            await socket.send_text(json.dumps({"type": "gone", "why": str(error)}))
            await socket.close(NO_RESCUE)
            return
        await _show(socket, session)

    return [
        Route("/api/setup", _setup),
        Route("/api/rescues", rescues),
        Route("/api/rescues", begin, methods=["POST"]),
        Route("/api/rescues/{name}/{what:str}", change, methods=["POST"]),
        WebSocketRoute("/api/rescues/{name}/live", live),
    ]


async def _show(socket: WebSocket, session: Session) -> None:
    """Show a rescue to a page until that has gone."""
    page = session.show()
    sending = asyncio.create_task(_send(socket, page))
    try:
        while True:
            text = await socket.receive_text()
            try:
                session.ask(_message(text))
            except ValueError as error:
                page.post("refused", json.dumps({"type": "refused", "why": str(error)}))
    except (WebSocketDisconnect, KeyError):  # gone, or bytes in place of text
        pass
    finally:
        sending.cancel()
        session.leave(page)


async def _send(socket: WebSocket, page: Page) -> None:
    """Send a page what comes, as fast as it takes it."""
    try:
        while True:
            for payload in await page.next():
                await (socket.send_text(payload) if isinstance(payload, str) else socket.send_bytes(payload))
    except (WebSocketDisconnect, RuntimeError):
        return


def _message(text: str) -> dict[str, Any]:
    """A message of a page. Raises ValueError for one that is not JSON, or too long."""
    if len(text) > LONGEST:
        raise ValueError(f"a message must have at most {LONGEST} characters, got {len(text)}")
    return _object(text)


async def _content(request: Request) -> dict[str, Any]:
    """The JSON of a request. Raises ValueError for anything else, and for more than LONGEST bytes."""
    content = b""
    async for part in request.stream():
        content += part
        if len(content) > LONGEST:
            raise ValueError(f"a request must have at most {LONGEST} bytes, got more")
    return _object(content.decode("utf-8", "replace") or "{}")


def _object(text: str) -> dict[str, Any]:
    try:
        found = json.loads(text)
    except (ValueError, RecursionError) as error:
        raise ValueError(f"a request must be JSON, got {error}") from None
    if not isinstance(found, dict):
        raise ValueError(f"a request must be a JSON object, got a {type(found).__name__}")
    return found


def _setup(request: Request) -> Response:
    """What there is to choose from; Starlette calls this in a thread."""
    tasks = []
    for name, entry in TASKS.items():
        task = load(entry.maker)("paper")
        scenes = {split: list(task.scenes(split)) for split in task.splits}
        tasks.append({"name": name, "text": task.text, "splits": scenes})
    robots, agents = list(ROBOTS), [{"name": n, "privileged": load(e.agent).privileged} for n, e in AGENTS.items()]
    choices = {"physics": PRESETS, "severity": SEVERITIES, "lighting": LIGHTINGS, "every": PACES}
    return JSONResponse({"tasks": tasks, "robots": robots, "agents": agents, **choices})
