"""Servers that send without an end, explain what they lack, think without a word, or cut prompts."""

from __future__ import annotations

import gzip
import json
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import cache
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import Any

import pytest

from hazard_ms.agents.llm.agent import Llm
from hazard_ms.agents.llm.client import Client
from hazard_ms.agents.llm.endpoint import endpoint
from hazard_ms.agents.llm.network.extra import extra_of
from hazard_ms.agents.llm.network.faults import NoAnswerError, RefusedError
from tests.agents.llm.conftest import Ground
from tests.worlds.playground import brief, play

Act = Callable[[Any, dict[str, Any]], None]  # given the handler and the request


@contextmanager
def serving(act: Act) -> Iterator[str]:
    """The address of a server that does this for each chat completion."""

    class Handler(BaseHTTPRequestHandler):
        def log_message(self, format: str, *args: object) -> None:
            return

        def do_GET(self) -> None:  # noqa: N802
            send(self, 200, {"data": []})

        def do_POST(self) -> None:  # noqa: N802
            try:
                act(self, json.loads(self.rfile.read(int(self.headers["content-length"]))))
            except OSError:
                return

    with ThreadingHTTPServer(("127.0.0.1", 0), Handler) as running:
        running.daemon_threads, running.block_on_close = True, False
        threading.Thread(target=running.serve_forever, kwargs={"poll_interval": 0.05}, daemon=True).start()
        yield f"http://127.0.0.1:{running.server_address[1]}/v1"
        running.shutdown()


def send(handler: Any, status: int, body: Any, packed: bool = False) -> None:
    data = body if isinstance(body, bytes) else json.dumps(body).encode()
    handler.send_response(status)
    handler.send_header("Content-Length", str(len(data)))
    if packed:
        handler.send_header("Content-Encoding", "gzip")
    handler.end_headers()
    handler.wfile.write(data)


def endless(status: int, part: bytes = b"a" * 65536, pause: float = 0.0) -> Act:
    def act(handler: Any, request: dict[str, Any]) -> None:
        handler.send_response(status)
        handler.end_headers()
        while True:
            handler.wfile.write(part)
            time.sleep(pause)

    return act


def message(text: Any, finish: str = "stop", **more: Any) -> dict[str, Any]:
    return {"choices": [{"message": {"content": text, **more}, "finish_reason": finish}]}


def answering(body: dict[str, Any]) -> Act:
    return lambda handler, request: send(handler, 200, body)


@cache
def bomb() -> bytes:
    """A megabyte that unpacks to 300."""
    return gzip.compress(gzip.compress(b"") + bytes(300_000_000), 1)


ENDLESS = {
    "endless 200": endless(200),
    "endless 401": endless(401),
    "endless 500": endless(500),
    "dripping 401": endless(401, b" ", 0.05),
    "packed 200": lambda handler, request: send(handler, 200, bomb(), packed=True),
    "packed 500": lambda handler, request: send(handler, 500, bomb(), packed=True),
    "headers": lambda handler, request: (
        [handler.wfile.write(b"HTTP/1.1 200 OK\r\n")]
        and [handler.wfile.write(b"X: " + b"a" * 1000 + b"\r\n") for _ in range(10**6)]
        and None
    ),
    "early hints": lambda handler, request: (
        [(handler.wfile.write(b"HTTP/1.1 103 Early\r\n\r\n"), time.sleep(0.05)) for _ in range(10**6)] and None
    ),
}


@pytest.mark.parametrize("name", ENDLESS)
def test_what_never_ends_is_read_in_part_and_left_at_the_deadline(name: str) -> None:
    with serving(ENDLESS[name]) as address:
        client, before, begun = Client(endpoint(address, "m"), 1, 0), threading.active_count(), time.monotonic()
        with pytest.raises((NoAnswerError, RefusedError)) as told:
            client.ask({"model": "m", "messages": []}, 1.0)
        assert time.monotonic() - begun < 6.0 and len(str(told.value)) < 500
        end = time.monotonic() + 5.0
        while any("work" in thread.name for thread in threading.enumerate()) and time.monotonic() < end:
            time.sleep(0.05)
        assert not any("work" in thread.name for thread in threading.enumerate()), before


WORDS = 'response_format type must be one of "text" or "json_object"'


@pytest.mark.parametrize("status", [400, 500])
def test_what_a_server_lacks_is_said_with_a_remedy_at_once(status: int) -> None:
    asked = []

    def act(handler: Any, request: dict[str, Any]) -> None:
        asked.append(request)
        send(handler, status, {"error": {"message": WORDS + "\x1b[2J"}})

    with serving(act) as address, pytest.raises(RefusedError) as refused:
        play(Llm(base_url=address, model="m"), Ground())
    assert len(asked) == 1 and WORDS in str(refused.value) and str(refused.value).endswith("set way=letter")
    assert str(refused.value).isprintable()


@pytest.mark.parametrize("field", ["reasoning", "reasoning_content"])
def test_a_thought_is_no_answer(field: str) -> None:
    thought = "Answer: A"
    with serving(answering(message(None, "length", **{field: thought}))) as address:
        player = Llm(base_url=address, model="m", way="letter")
        player.reset(brief())
        player.act(Ground().decision())
    assert player.fallback and player.counters["truncated"] == 2 and thought in str(player.note)
    assert "reply_tokens" in str(player.note) and "reasoning_effort" in str(player.note)


@pytest.mark.parametrize(
    ("text", "named"),
    [([{"type": "text", "text": "Answer: A"}], True), ("\ufeffAnswer: A", True), ("<think>Answer: A", False)],
)
def test_parts_and_marks_are_read_and_open_thoughts_are_not(text: Any, named: bool) -> None:
    with serving(answering(message(text))) as address:
        player = Llm(base_url=address, model="m", way="letter")
        player.reset(brief())
        player.act(Ground().decision())
    assert player.fallback is not named


def test_a_prompt_that_was_cut_is_noticed_once(capsys: pytest.CaptureFixture[str]) -> None:
    with serving(answering({**message("Answer: A"), "usage": {"prompt_tokens": 48}})) as address:
        player = Llm(base_url=address, model="m", way="letter")
        play(player, Ground(), most=4)
    assert player.counters["cut"] == player.counters["calls"] > 0
    assert capsys.readouterr().err.count("its server cuts prompts") == 1


def test_the_second_answer_has_what_is_left_of_the_deadline() -> None:
    def act(handler: Any, request: dict[str, Any]) -> None:
        time.sleep(1.5)
        send(handler, 200, message("hm, hm, hm"))

    with serving(act) as address:
        player = Llm(base_url=address, model="m", way="letter", deadline=2.0, tries=1)
        player.reset(brief())
        begun = time.monotonic()
        player.act(Ground().decision())
    assert player.fallback and player.counters["lost"] == 1, "with 2 s more it would have come"
    assert time.monotonic() - begun < 3.0


def test_extra_fields_reach_the_server() -> None:
    asked: list[dict[str, Any]] = []

    def act(handler: Any, request: dict[str, Any]) -> None:
        asked.append(request)
        send(handler, 200, message("Answer: A"))

    with serving(act) as address:
        player = Llm(base_url=address, model="m", way="letter", extra="reasoning_effort:none;top_k:40")
        play(player, Ground(), most=2)
    assert asked[0]["reasoning_effort"] == "none" and asked[0]["top_k"] == 40
    assert extra_of('{"a": {"b": [1]}}') == {"a": {"b": [1]}} and extra_of("t:false") == {"t": False}
    for text in ("model:x", "a", ":1", '{"messages": []}', "{", "a:{"):
        with pytest.raises(ValueError, match="extra must"):
            extra_of(text)
