"""Asks a model in an episode: out of the recorded answers or over the network, within budgets, and counts it all."""

from __future__ import annotations

import sys
import time
from collections import Counter
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Any

from hazard_ms.agents.llm.answers import Reply, reply_of
from hazard_ms.agents.llm.cache import Cache, Stored, key_of
from hazard_ms.agents.llm.client import Client
from hazard_ms.agents.llm.endpoint import Endpoint
from hazard_ms.agents.llm.network.faults import NoAnswerError
from hazard_ms.agents.llm.prompt import Message, estimate, text_of
from hazard_ms.spec.foreign.files import printable

LOST = "lost"  # in the body that is kept of a call that no answer came to: why
MILLION = 1e6  # tokens that a price is for


def cut_warning(model: str, reply: Reply, prompt: str) -> str:
    """A warning of a prompt that a server has cut, of which it says nothing."""
    return (
        f"{printable(model)[:60]} read {reply.prompt_tokens} tokens of a prompt of about {estimate(prompt)}: "
        "its server cuts prompts; start it with a longer context"
    )


class SpentError(RuntimeError):
    """Raised where a budget leaves no further call."""


@dataclass(frozen=True)
class Budget:
    """The most that an episode may use; None: any."""

    calls: int | None = None
    tokens: int | None = None  # read and written together
    cost: float | None = None  # [USD]
    price_in: float = 0.0  # of a million tokens read [USD]
    price_out: float = 0.0  # of a million tokens written [USD]

    def __post_init__(self) -> None:
        """Raises ValueError for a number below 0, and for a limit to the cost without prices."""
        for name, number in asdict(self).items():
            if number is not None and not 0 <= number < float("inf"):
                raise ValueError(f"{name} must be at least 0, got {number!r}")
        if self.cost is not None and not (self.price_in or self.price_out):
            raise ValueError("price_in or price_out must be above 0 for most_cost, got 0 for both")

    def spent(self, counts: Counts) -> float:
        """The cost of the calls that were counted [USD]."""
        return (counts.tokens_in * self.price_in + counts.tokens_out * self.price_out) / MILLION

    def check(self, counts: Counts) -> None:
        """Raises SpentError where a limit has been reached."""
        used = (counts.calls, counts.tokens_in + counts.tokens_out, self.spent(counts))
        for what, most, number in zip(
            ("calls", "tokens", "USD"), (self.calls, self.tokens, self.cost), used, strict=True
        ):
            if most is not None and number >= most:
                raise SpentError(f"the budget of {most:g} {what} is spent")


@dataclass
class Counts:
    """The counts of an episode."""

    decisions: int = 0  # for which the model was asked
    calls: int = 0
    tokens_in: int = 0  # read by the model
    tokens_out: int = 0  # written by it
    cached: int = 0  # calls that a recorded answer came to
    seconds: float = 0.0  # until answers were there [s]
    retries: int = 0  # tries after the first of a call
    lost: int = 0  # calls that no answer came to
    refused: int = 0  # answers that were refusals
    truncated: int = 0  # answers that broke off at their greatest length
    cut: int = 0  # answers to prompts of which the server says that it read less than half
    invalid: int = 0  # answers that named no option
    repaired: int = 0  # decisions in which the second answer named one
    fallbacks: int = 0  # decisions that something else took in place of the model


class Asker:
    """Asks one model. `counts` are those since the last `begin`; `taken`: time since it was last set to 0 [s]."""

    def __init__(
        self, endpoint: Endpoint, client: Client | None, cache: Cache | None, budget: Budget, sample: int
    ) -> None:
        """Ask over the network with `client`, out of `cache`, or both; without a client, every answer must be there."""
        self._endpoint, self._client, self._cache = endpoint, client, cache
        self._budget, self._sample = budget, sample
        self._warned = False
        self.begin()

    def begin(self) -> None:
        """Begin an episode."""
        self.counts = Counts()
        self.taken = 0.0
        self._turns: Counter[str] = Counter()

    @property
    def cost(self) -> float:
        """The cost of the calls of the episode [USD]; 0 without prices."""
        return self._budget.spent(self.counts)

    def ask(self, messages: Sequence[Message], settings: dict[str, Any], end: float) -> Reply:
        """The reply to `messages`, until the time `end` [s] of time.monotonic.

        Raises NoAnswerError where none came, UnreadableError for one that cannot be read, SpentError where a budget is
        spent, RefusedError where the server will never answer, ValueError where an answer should have been recorded.
        """
        self._budget.check(self.counts)
        request = {"model": self._endpoint.model, "messages": list(messages), **settings}
        alike = key_of(request, self._sample, 0)
        key = key_of(request, self._sample, self._turns[alike])
        self._turns[alike] += 1
        prompt = text_of(messages)
        stored = None if self._cache is None else self._cache.get(key)
        if stored is not None and self._client is not None and LOST in stored.body:
            stored = None
        self.counts.calls += 1
        if stored is None:
            reply = self._answer(key, request, prompt, end)
        else:
            self._took(stored.seconds)
            if LOST in stored.body:
                self.counts.lost += 1
                raise NoAnswerError(str(stored.body[LOST]))
            self.counts.cached += 1
            reply = reply_of(stored.body, stored.seconds, prompt, cached=True)
        counts = self.counts
        counts.tokens_in += reply.prompt_tokens
        counts.tokens_out += reply.answer_tokens
        counts.refused += reply.refused
        counts.truncated += reply.truncated
        counts.cut += reply.cut
        if reply.cut and not self._warned:
            self._warned = True
            print(f"hazard_ms: {cut_warning(self._endpoint.model, reply, prompt)}", file=sys.stderr, flush=True)
        return reply

    def _took(self, seconds: float) -> None:
        self.counts.seconds += seconds
        self.taken += seconds

    def _answer(self, key: str, request: dict[str, Any], prompt: str, end: float) -> Reply:
        """The reply of the server, which is kept."""
        if self._client is None:
            raise ValueError(
                f"cache must hold an answer to every call for replay=true, got none for call {self.counts.calls}; was "
                f"it recorded with the same model and settings? The prompt begins with {prompt[:60]!r}"
            )
        begun, retries = time.monotonic(), self._client.retries
        lost: NoAnswerError | None = None
        try:
            body = self._client.ask(request, end - begun)
        except NoAnswerError as error:
            lost, body = error, {LOST: str(error)}
        seconds = time.monotonic() - begun
        self._took(seconds)
        self.counts.retries += self._client.retries - retries
        if self._cache is not None:
            self._cache.put(key, Stored(body, seconds), self._endpoint.host, self._endpoint.model)
        if lost is not None:
            self.counts.lost += 1
            raise lost
        return reply_of(body, seconds, prompt)
