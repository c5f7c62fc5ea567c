"""Calls to a model's server: within a deadline, again after passing faults, and never with a key to anybody else."""

from __future__ import annotations

import json
import queue
import random
import threading
import time
from collections.abc import Callable
from functools import partial
from typing import Any, TypeVar

from hazard_ms.agents.llm.endpoint import KEY_VARIABLE, Endpoint

LARGEST = 1_000_000  # size of an answer: hundreds of times that of a letter with its reason [bytes] [ours]
LONGEST_PAUSE = 60.0  # for which a server may ask before the next try [s] [ours]
FIRST_PAUSE = 1.0  # before the second try; it doubles with each [s] [ours]
FIRST_CONTACT = 10.0  # time for the first sign of a server [s] [ours]
PASSING = (408, 409, 425, 429)  # status of faults that pass, besides those from 500 on
HEADERS = (  # that are sent
    "host",
    "accept",
    "accept-encoding",
    "authorization",
    "connection",
    "content-length",
    "content-type",
    "transfer-encoding",
    "user-agent",
    "x-stainless-raw-response",  # by which openai knows how it was asked
)
LONGEST_MESSAGE = 200  # characters of a server's message that are shown [ours]

_Made = TypeVar("_Made")


class NoAnswerError(RuntimeError):
    """Raised where no answer came in time, or none that can be read."""


class RefusedError(RuntimeError):
    """Raised where a server will not answer however often it is asked: a wrong key, an unknown model."""


class _AgainError(Exception):
    """A fault that may pass; `pause`: the time for which the server asks [s]."""

    def __init__(self, why: str, pause: float | None = None) -> None:
        super().__init__(why)
        self.pause = pause


class Client:
    """Asks the model of one endpoint. `retries` counts the tries after the first."""

    def __init__(self, endpoint: Endpoint, tries: int, seed: int) -> None:
        """Make no connection yet; `seed` fixes the lengths of pauses. Raises ValueError where openai is missing."""
        try:
            import openai
        except ImportError:
            raise ValueError("openai must be installed, got none: pip install 'hazard_ms[llm]'") from None
        self._openai, self.endpoint, self._tries = openai, endpoint, tries
        self._chance = random.Random(seed)
        self.retries = 0
        omit: Any = openai.Omit()
        self._headers: dict[str, Any] = {} if endpoint.key else {"Authorization": omit}
        self._client = openai.OpenAI(
            base_url=endpoint.base_url,
            api_key=endpoint.key or "none",
            max_retries=0,
            http_client=openai.DefaultHttpxClient(
                follow_redirects=False, trust_env=not endpoint.local, event_hooks={"request": [_without_others]}
            ),
        )

    def greet(self) -> None:
        """See whether the server is there and takes the key. Raises ValueError where it is not, or does not."""

        def listed() -> None:
            models = self._client.models.with_streaming_response
            with models.list(timeout=FIRST_CONTACT, extra_headers=self._headers):
                pass

        host = self.endpoint.host
        try:
            self._within(FIRST_CONTACT, listed)
        except RefusedError as refused:
            if "401" in str(refused) or "403" in str(refused):
                raise ValueError(f"{KEY_VARIABLE} must be a key that {host} takes; {refused}") from None
        except _AgainError as error:
            if "status" not in str(error):
                raise ValueError(
                    f"base_url must be the address of a running server, got {self.endpoint.base_url}: {error}"
                ) from None

    def ask(self, request: dict[str, Any], seconds: float) -> dict[str, Any]:
        """The body of the answer to a chat completion, which must be there within `seconds` [s].

        Raises NoAnswerError where none came, and RefusedError where none ever will.
        """
        end, why = time.monotonic() + seconds, "the deadline has passed"
        for number in range(self._tries):
            left = end - time.monotonic()
            if left <= 0.0:
                break
            self.retries += number > 0
            try:
                return self._within(left, partial(self._call, request, end))
            except _AgainError as again:
                why = str(again)
                pause = FIRST_PAUSE * 2**number * self._chance.uniform(0.5, 1.5) if again.pause is None else again.pause
            if pause > LONGEST_PAUSE or time.monotonic() + pause >= end:
                break
            time.sleep(pause if number + 1 < self._tries else 0.0)
        raise NoAnswerError(f"{self.endpoint.host} gave no answer: {why}")

    def _within(self, seconds: float, call: Callable[[], _Made]) -> _Made:
        """The result of `call`, made in a thread, since nothing else ends a server's dripping at a given time."""
        done: queue.SimpleQueue[tuple[_Made | None, BaseException | None]] = queue.SimpleQueue()

        def work() -> None:
            try:
                done.put((self._guarded(call), None))
            except BaseException as error:  # noqa: B036 it is raised again in the thread that asked
                done.put((None, error))

        threading.Thread(target=work, daemon=True).start()
        try:
            made, error = done.get(timeout=seconds + 0.2)  # [s] the call's own time-out comes first
        except queue.Empty:
            raise _AgainError("no answer in time") from None
        if error is not None:
            raise error
        return made  # type: ignore[return-value]

    def _guarded(self, call: Callable[[], _Made]) -> _Made:
        """The result of `call`, its errors as ours, without the requests that hold the key."""
        import httpx2

        try:
            return call()
        except (self._openai.APITimeoutError, httpx2.TimeoutException):
            raise _AgainError("no answer in time") from None
        except self._openai.APIStatusError as error:
            raise self._meaning(error) from None
        except (self._openai.APIConnectionError, httpx2.HTTPError, OSError) as error:
            raise _AgainError(f"no connection ({type(error).__name__})") from None

    def _call(self, request: dict[str, Any], until: float) -> dict[str, Any]:
        left = max(until - time.monotonic(), 0.01)
        chat = self._client.chat.completions.with_streaming_response
        try:
            with chat.create(**request, timeout=left, extra_headers=self._headers) as response:
                body = bytearray()
                for chunk in response.iter_bytes():
                    body += chunk
                    if len(body) > LARGEST:
                        raise NoAnswerError(f"an answer must have at most {LARGEST} bytes, got more")
                    if time.monotonic() > until:
                        raise _AgainError("no answer in time")
        except self._openai.BadRequestError as error:
            if error.code == "content_filter":  # how Azure says that a filter stopped it
                return {"choices": [{"message": {"content": ""}, "finish_reason": "content_filter"}]}
            raise
        try:
            found = json.loads(body)
        except (ValueError, RecursionError):
            raise NoAnswerError("an answer must be JSON, got something else") from None
        if not isinstance(found, dict):
            raise NoAnswerError("an answer must be a JSON object, got something else")
        hidden: dict[str, Any] = self.endpoint.hide(found)
        return hidden

    def _meaning(self, error: Any) -> Exception:
        """The error of ours that a server's status means."""
        status, host = int(error.status_code), self.endpoint.host
        spent = error.code == "insufficient_quota"
        if (status in PASSING or status >= 500) and not spent:
            return _AgainError(f"status {status}", _seconds(error.response.headers.get("retry-after")))
        if 300 <= status < 400:
            return RefusedError(f"base_url must be the final address of the server, got a redirect from {host}")
        told = self.endpoint.hide(str(error.message))
        shown = "".join(c if c.isprintable() else " " for c in told[:LONGEST_MESSAGE])
        return RefusedError(f"{host} refused with status {status}: {shown}")


def _without_others(request: Any) -> None:
    """Take out of a request what the environment holds for another server: openai adds headers that it finds there."""
    for name in [name for name in request.headers if name.lower() not in HEADERS]:
        del request.headers[name]


def _seconds(header: str | None) -> float | None:
    """The time in a Retry-After header [s]; None where there is none, or a date."""
    try:
        seconds = float(header or "")
    except ValueError:
        return None
    return seconds if 0.0 <= seconds < float("inf") else None
