"""Calls to a model's server: within a deadline, again after passing faults, and never with a key to anybody else."""

from __future__ import annotations

import queue
import random
import threading
import time
import urllib.request
from collections.abc import Callable
from functools import partial
from typing import Any, TypeVar

from hazard_ms.agents.llm.endpoint import KEY_VARIABLE, Endpoint
from hazard_ms.agents.llm.network.faults import AgainError, NoAnswerError, RefusedError, meaning
from hazard_ms.spec.foreign.plain import parse

LONGEST_PAUSE = 60.0  # for which a server may ask before the next try [s] [ours]
FIRST_PAUSE = 1.0  # before the second try; it doubles with each [s] [ours]
ENDING = 1.0  # time in which a call ends whose connection was cut [s] [ours]
FIRST_CONTACT = 10.0  # time for the first sign of a server [s] [ours]
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
_Made = TypeVar("_Made")


class Client:
    """Asks the model of one endpoint. `retries` counts the tries after the first."""

    def __init__(self, endpoint: Endpoint, tries: int, seed: int) -> None:
        """Make no connection yet; `seed` fixes the lengths of pauses. Raises ValueError where openai is missing."""
        try:
            import openai
        except ImportError:
            raise ValueError(
                "the agent llm needs the package openai, which is not installed: pip install 'hazard_ms[llm]'"
            ) from None
        self._openai, self.endpoint, self._tries = openai, endpoint, tries
        self._chance = random.Random(seed)
        self.retries = 0
        omit: Any = openai.Omit()
        self._headers: dict[str, Any] = {} if endpoint.key else {"Authorization": omit}
        self._connection = _connection(endpoint)
        self._client = openai.OpenAI(
            base_url=endpoint.base_url,
            api_key=endpoint.key or "none",
            max_retries=0,
            http_client=openai.DefaultHttpxClient(
                transport=self._connection,
                follow_redirects=False,
                trust_env=not endpoint.local,
                event_hooks={"request": [_without_others]},
            ),
        )

    def greet(self) -> None:
        """See whether the server is there and takes the key. Raises ValueError where it is not, or does not."""
        import httpx2

        def listed() -> None:
            self._client.get("/models", cast_to=httpx2.Response, options=self._options(FIRST_CONTACT))

        host = self.endpoint.host
        try:
            self._within(FIRST_CONTACT, listed)
        except RefusedError as refused:
            if refused.status in (401, 403):
                raise ValueError(f"{KEY_VARIABLE} must be a key that {host} accepts; {refused}") from None
        except AgainError as error:
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
            except AgainError as again:
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

        thread = threading.Thread(target=work, name="llm work", daemon=True)
        thread.start()
        try:
            made, error = done.get(timeout=seconds + 0.2)  # [s] the call's own time-out comes first
        except queue.Empty:
            self._connection.cut()
            thread.join(ENDING)
            raise AgainError("no answer in time") from None
        if error is not None:
            raise error
        return made  # type: ignore[return-value]

    def _guarded(self, call: Callable[[], _Made]) -> _Made:
        """The result of `call`, its errors as ours, without the requests that hold the key."""
        import httpx2

        from hazard_ms.agents.llm.network.transport import BodyError

        try:
            return call()
        except (self._openai.APITimeoutError, httpx2.TimeoutException):
            raise AgainError("no answer in time") from None
        except self._openai.APIStatusError as error:
            raise meaning(error, (), self.endpoint) from None
        except (BodyError, self._openai.OpenAIError, httpx2.HTTPError, OSError, ValueError) as error:
            told = next((each for each in (error, error.__cause__) if isinstance(each, BodyError)), None)
            if told is not None:
                raise NoAnswerError(str(told)) from None
            raise AgainError(f"no connection ({type(error).__name__})") from None

    def _call(self, request: dict[str, Any], until: float) -> dict[str, Any]:
        import httpx2

        options = self._options(max(until - time.monotonic(), 0.01))
        try:
            answer = self._client.post("/chat/completions", cast_to=httpx2.Response, body=request, options=options)
        except self._openai.APIStatusError as error:
            if error.status_code == 400 and error.code == "content_filter":  # how Azure says that a filter stopped it
                return {"choices": [{"message": {"content": ""}, "finish_reason": "content_filter"}]}
            raise meaning(error, request, self.endpoint) from None
        try:
            found = parse(answer.content, "an answer")
        except ValueError:
            raise NoAnswerError("an answer must be JSON, got something else") from None
        if not isinstance(found, dict):
            raise NoAnswerError("an answer must be a JSON object, got something else")
        hidden: dict[str, Any] = self.endpoint.hide(found)
        return hidden

    def _options(self, seconds: float) -> Any:
        return {"timeout": seconds, "headers": self._headers}


def _connection(endpoint: Endpoint) -> Any:
    """The connection to an endpoint: direct, or through the proxy that the environment names for it."""
    import httpx2

    from hazard_ms.agents.llm.network.transport import Bounded

    proxies = urllib.request.getproxies()
    direct = endpoint.local or urllib.request.proxy_bypass(endpoint.host)
    scheme = endpoint.base_url.partition(":")[0]
    proxy = None if direct else proxies.get(scheme) or proxies.get("all")
    return Bounded(httpx2.HTTPTransport(trust_env=not endpoint.local, proxy=proxy))


def _without_others(request: Any) -> None:
    """Take out of a request what the environment holds for another server: openai adds headers that it finds there."""
    request.headers["accept-encoding"] = "gzip"
    for name in [name for name in request.headers if name.lower() not in HEADERS]:
        del request.headers[name]
