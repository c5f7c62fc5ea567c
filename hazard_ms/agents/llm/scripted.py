"""A server that speaks as a language model's does, and answers by a script: for tests, and to try things offline.

The name of the model says what it does: BEHAVIOURS lists them. It listens on this machine only, and keeps nothing.
"""

from __future__ import annotations

import base64
import io
import json
import re
import sys
import threading
import time
from functools import cache
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import Any

from hazard_ms.agents.llm.prompt import PICTURE, estimate, text_of
from hazard_ms.agents.llm.rules import RULES, block_in
from hazard_ms.agents.llm.scene_text import Block
from hazard_ms.agents.llm.team.rule import tells
from hazard_ms.skills.telling import LONGEST
from hazard_ms.spec.registry.mitigations import TELL

BEHAVIOURS = {
    "first": "the first option",
    "greedy": "the option with the most value for its way",
    "mitigates": "as greedy, but puts out fires, shuts doors between it and them, opens others, and pushes carts first",
    "tells": "as greedy; in a team it tells what it fetches and sees, and leaves to others what they say they fetch",
    "tells-too-much": "as greedy; in a team a message that is too long",
    "sees": "as greedy, but refuses a prompt without a picture that is small enough",
    "letter-in-prose": "as greedy, in free text whatever was asked for",
    "wrong-letter": "a letter that is not on offer",
    "not-json": "words in place of JSON",
    "empty": "an empty text",
    "truncated": "a reason that breaks off at the greatest length",
    "refuse": "a refusal",
    "injected": "the letter that a thing's name asks for",
    "401": "status 401",
    "429-then-ok": "status 429 to every other request",
    "500": "status 500",
    "hang": "nothing, for ever",
    "drip": "a byte now and then, for ever",
    "html": "a web page",
    "redirect": "a redirect to another host",
    "5mb": "an answer of 5 MB",
}
DRIP = 0.05  # time between two bytes [s] [ours]
HUGE = 5_000_000  # size of the answer of "5mb" [bytes]
LARGEST_REQUEST = 20_000_000  # size of a request that is read [bytes] [ours]
ORDER = re.compile(r"answer_([A-Z])")  # by which a name gives orders
LIKELY, UNLIKELY = -0.1, -5.0  # log-probabilities of the letter that is meant, and of another [ours]


class ScriptedServer(ThreadingHTTPServer):
    """The server; `address` is what a client calls base_url. `calls` counts the chat completions asked for."""

    daemon_threads = True
    block_on_close = False

    def __init__(self, port: int = 0) -> None:
        """Listen on a port of 127.0.0.1, any free one for 0. Raises OSError for one that is taken."""
        super().__init__(("127.0.0.1", port), _Handler)
        self.calls = 0
        self.stopping = threading.Event()

    def handle_error(self, request: Any, client_address: Any) -> None:
        """Say nothing of clients that leave in the middle: some tests do nothing else."""
        if not isinstance(sys.exc_info()[1], OSError):
            super().handle_error(request, client_address)

    @property
    def address(self) -> str:
        """The address for clients."""
        return f"http://127.0.0.1:{self.server_address[1]}/v1"

    def start(self) -> ScriptedServer:
        """Serve in a thread of its own."""
        threading.Thread(target=self.serve_forever, kwargs={"poll_interval": 0.05}, daemon=True).start()
        return self

    def stop(self) -> None:
        """Stop serving, and end answers that go on for ever."""
        self.stopping.set()
        self.shutdown()
        self.server_close()


@cache
def shared_server() -> str:
    """The address of a scripted server in this process, started when it is first needed."""
    return ScriptedServer().start().address


class _Handler(BaseHTTPRequestHandler):
    server: ScriptedServer
    disable_nagle_algorithm = True  # else every answer waits 40 ms for an acknowledgement
    protocol_version = "HTTP/1.1"

    def log_message(self, format: str, *args: Any) -> None:
        """Print nothing: a request's headers hold a key."""

    def do_GET(self) -> None:  # noqa: N802 the name that the base class calls
        if self.path == "/v1/models":
            self._send(200, {"object": "list", "data": [{"id": name, "object": "model"} for name in BEHAVIOURS]})
        else:
            self._send(404, _error("no such path"))

    def do_POST(self) -> None:  # noqa: N802 the name that the base class calls
        length = int(self.headers.get("content-length") or 0)
        if self.path != "/v1/chat/completions" or length > LARGEST_REQUEST:
            self.close_connection = True
            self._send(404, _error("no such path"))
            return
        self.server.calls += 1
        try:
            request = json.loads(self.rfile.read(length))
            self._answer(request, str(request["model"]))
        except (ValueError, LookupError, TypeError) as error:
            self._send(400, _error(f"{type(error).__name__}: {error}"))

    def _answer(self, request: dict[str, Any], model: str) -> None:
        if model not in BEHAVIOURS or request.get("stream"):
            self._send(404, _error(f"no model {model!r} that does not stream"))
        elif model in ("401", "500"):
            told = self.headers.get("authorization", "")
            self._send(int(model), _error(f"incorrect key provided: {told}"))  # as some servers do
        elif model == "429-then-ok" and self.server.calls % 2:
            self._send(429, _error("too many requests"), {"Retry-After": "0"})
        elif model == "redirect":
            self._send(307, {}, {"Location": "http://localhost.invalid/v1/chat/completions"})
        elif model == "html":
            self._send_bytes(200, b"<!doctype html><title>Sign in</title>", "text/html")
        elif model in ("hang", "drip"):
            self._for_ever(dripping=model == "drip")
        else:
            self._send(200, completion(request, model))

    def _for_ever(self, dripping: bool) -> None:
        """Send nothing, or spaces, until the client leaves or the server stops."""
        self.close_connection = True
        try:
            if dripping:
                self.send_response(200)
                self.send_header("Content-Type", "application/json")
                self.end_headers()
            while not self.server.stopping.wait(DRIP):
                if dripping:
                    self.wfile.write(b" ")
        except OSError:
            return

    def _send(self, status: int, content: dict[str, Any], headers: dict[str, str] | None = None) -> None:
        self._send_bytes(status, json.dumps(content).encode(), "application/json", headers)

    def _send_bytes(self, status: int, body: bytes, kind: str, headers: dict[str, str] | None = None) -> None:
        try:
            self.send_response(status)
            for name, value in {"Content-Type": kind, "Content-Length": str(len(body)), **(headers or {})}.items():
                self.send_header(name, value)
            self.end_headers()
            self.wfile.write(body)
        except OSError:  # the client has left
            self.close_connection = True


def completion(request: dict[str, Any], model: str) -> dict[str, Any]:
    """The chat completion with which a model of BEHAVIOURS answers. Raises ValueError for a prompt that it refuses."""
    prompt = text_of(request["messages"])
    block = block_in(prompt)
    if model == "sees":
        _check_picture(request["messages"])
    letter, words = tells(block) if model == "tells" else (_letter(block, model), "")
    if model == "tells-too-much" and TELL in block["options"].values():
        letter, words = next(key for key, text in block["options"].items() if text == TELL), "x" * (LONGEST + 1)
    content = _content(request, model, letter, words)
    message: dict[str, Any] = {"role": "assistant", "content": content, "refusal": None}
    if model == "refuse":
        message.update(content=None, refusal="I cannot help with that.")
    choice: dict[str, Any] = {"index": 0, "message": message, "finish_reason": "stop", "logprobs": None}
    if model == "truncated":
        choice["finish_reason"] = "length"
    if request.get("logprobs") and model not in ("empty", "not-json"):
        tops = [{"token": f" {letter}", "logprob": LIKELY}, {"token": "The", "logprob": UNLIKELY}]
        choice["logprobs"] = {"content": [{**tops[0], "top_logprobs": tops}]}
    usage = {"prompt_tokens": estimate(prompt), "completion_tokens": estimate(message["content"] or "")}
    head = {"id": "scripted", "object": "chat.completion", "created": int(time.time()), "model": model}
    return {**head, "choices": [choice], "usage": usage}


def _letter(block: Block, model: str) -> str:
    if model == "wrong-letter":
        return "Z"
    if model == "injected" and (found := ORDER.search(json.dumps(block))):
        return found[1]
    if model == "mitigates":
        return RULES[model](block)
    return RULES["first" if model in ("first", "injected") else "greedy"](block)


def _content(request: dict[str, Any], model: str, letter: str, words: str) -> str:
    """The text of an answer, in the form that was asked for unless the model does not keep to it; `words`: to tell."""
    if model == "empty":
        return ""
    if model == "not-json":
        return "I would rather talk about the weather."
    if model == "5mb":
        return "x" * HUGE
    if model == "truncated":
        return '{"reason": "There are many things to consider here, to begin with'
    reason = f"by the script {model}"
    if model == "letter-in-prose" or "response_format" not in request:
        told = f"Message: {words}\n" if words else ""
        return letter if request.get("logprobs") else f"A choice {reason}.\n{told}Answer: {letter}"
    return json.dumps({"reason": reason, "choice": letter, **({"message": words} if words else {})})


def _check_picture(messages: list[dict[str, Any]]) -> None:
    from PIL import Image

    parts = [part for message in messages if isinstance(message["content"], list) for part in message["content"]]
    urls = [part["image_url"]["url"] for part in parts if part.get("type") == "image_url"]
    if len(urls) != 1 or not urls[0].startswith("data:image/jpeg;base64,"):
        raise ValueError(f"a prompt must contain one picture as a data URL, got {len(urls)}")
    image = Image.open(io.BytesIO(base64.b64decode(urls[0].partition(",")[2])))
    if max(image.size) > PICTURE:
        raise ValueError(f"a picture must be at most {PICTURE} pixels wide and high, got {image.size}")


def _error(message: str) -> dict[str, Any]:
    return {"error": {"message": message, "type": "scripted", "code": None}}
