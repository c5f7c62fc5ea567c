"""The agent that asks a language model at each decision which of a few actions to take.

The model chooses what to go for. In `macro` moves, as in the paper, what follows from that is done by itself: what was
walked up to is picked up, what is held goes into the bag, at a place to search it looks around.
"""

from __future__ import annotations

import time
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

from hazard_ms.agents.base import Agent
from hazard_ms.agents.latency import Thought
from hazard_ms.agents.llm.answers import (
    ASKS,
    LOGPROB,
    ONLY_LETTER,
    SHORT_REPLY,
    TELLING_ASKS,
    THINK,
    WAYS,
    Reply,
    UnreadableError,
    message_of,
    read,
    request_of,
)
from hazard_ms.agents.llm.asking import Asker, Budget, SpentError
from hazard_ms.agents.llm.cache import Cache
from hazard_ms.agents.llm.choices import FULL, LETTERS, LOOK, MOVES, PICK, PUT, SEARCH, Choice, Menu, forced, menu
from hazard_ms.agents.llm.client import Client
from hazard_ms.agents.llm.endpoint import endpoint
from hazard_ms.agents.llm.memory import Memory
from hazard_ms.agents.llm.network.extra import extra_of
from hazard_ms.agents.llm.network.faults import NoAnswerError, RefusedError
from hazard_ms.agents.llm.prompt import FORECAST, HISTORIES, IMAGE, VERSIONS, Message, messages, system_text
from hazard_ms.agents.llm.rules import RULES
from hazard_ms.agents.llm.scene_text import Block, block, plain_names
from hazard_ms.agents.llm.team.radio import Radio
from hazard_ms.agents.llm.trace import Trace
from hazard_ms.skills.brief import Brief
from hazard_ms.skills.decision import EXPLORE, STOP, Action, Decision
from hazard_ms.spec.checks import one_of, whole
from hazard_ms.spec.registry.mitigations import TELL

FEWEST_OPTIONS = 6  # places to search, to look, and to stop [ours]
MOST_TOKENS = 1_000_000  # of a reply: any more must be a mistake [ours]
MOST_TRIES = 10  # of a call [ours]
LONGEST_DEADLINE = 3600.0  # [s] [ours]
MOST_LOST = 3  # decisions one after another without any answer, after which the episode ends with an error [ours]
SEEDS = 2**31  # of servers: some take 32 bits with a sign
GIVE_UP = 4  # failures with a thing after which it is no longer offered, as for other agents
END_BUDGET = "budget"  # how an episode ends whose budget is spent


@dataclass(eq=False, repr=False)
class Llm(Agent):
    """An agent that asks a language model behind an OpenAI-compatible address; docs/language_models.md tells more."""

    base_url: str = ""  # address of the server; else that of the environment
    model: str = ""  # its name there; else that of the environment
    version: str = "llm-1"  # of the prompt
    way: str = "json"  # of answering
    moves: str = "macro"  # what the model decides: what to go for, or every action
    stand_in: str = "first"  # rule that decides where no answer could be read
    options: int = len(LETTERS)  # that are offered at most
    temperature: float | None = 0.7  # none: not sent
    top_p: float | None = 1.0  # none: not sent
    reply_tokens: int = 512  # of an answer, at most
    limit_field: str = "max_tokens"  # name under which that is sent; some models want max_completion_tokens
    send_seed: bool = True  # whether a seed is sent, which some servers refuse
    extra: str = ""  # further fields of a request: name:value;name:value, or a JSON object
    sample: int = 0  # another number: other answers than those recorded
    deadline: float = 50.0  # for a decision [s]; `hazard-ms evaluate` ends one that takes more than its --timeout
    tries: int = 4  # of a call
    cache: str = ""  # file of recorded answers; empty: none
    replay: bool = False  # whether every answer must be in the cache, and the network is not used
    trace: str = ""  # folder for one file for each episode with all that was asked and answered; empty: none
    most_calls: int | None = None  # of an episode
    most_tokens: int | None = None  # of an episode, read and written
    most_cost: float | None = None  # of an episode [USD]
    price_in: float = 0.0  # of a million tokens read [USD]
    price_out: float = 0.0  # of a million tokens written [USD]

    def __post_init__(self) -> None:
        """Check all parameters, and see that the server is there. Raises ValueError for what cannot be used."""
        one_of(self.version, VERSIONS, "version")
        self.colours = self.version == IMAGE
        one_of(self.way, WAYS, "way")
        one_of(self.moves, MOVES, "moves")
        one_of(self.stand_in, RULES, "stand_in")
        whole(self.options, FEWEST_OPTIONS, len(LETTERS), "options")
        whole(self.reply_tokens, 1, MOST_TOKENS, "reply_tokens")
        whole(self.tries, 1, MOST_TRIES, "tries")
        if not 0.0 < self.deadline <= LONGEST_DEADLINE:
            raise ValueError(f"deadline must be more than 0 and at most {LONGEST_DEADLINE:g} s, got {self.deadline}")
        if self.replay and not self.cache:
            raise ValueError("cache must name a file for replay=true, got none")
        self._extra = extra_of(self.extra)
        budget = Budget(self.most_calls, self.most_tokens, self.most_cost, self.price_in, self.price_out)
        where = endpoint(self.base_url, self.model)
        self._endpoint, client = where, None
        if not self.replay:
            client = Client(where, self.tries, self.sample)
            client.greet()
        cache = Cache(Path(self.cache), writable=not self.replay) if self.cache else None
        self._asker = Asker(where, client, cache, budget, self.sample)
        self._team: tuple[str, ...] = ()  # names of the robots of a team, that of its own first

    def join(self, name: str, others: tuple[str, ...]) -> None:
        """Direct the robot `name` beside the `others` of its team. Raises ValueError for what no team can have."""
        one_of(self.way, TELLING_ASKS, "way of a team, whose messages need more than a letter,")
        one_of(self.version, [version for version in VERSIONS if version != IMAGE], "version of a team without colours")
        self._team = (name, *others) if others else ()

    def reset(self, brief: Brief) -> None:
        """Begin an episode with an empty memory."""
        self._brief, self._memory = brief, Memory(brief.random_seed)
        self._radio = Radio(self._team[0]) if self._team else None
        self._ask = (TELLING_ASKS if self._team else ASKS)[self.way]
        self._system = system_text(brief, self.moves != FULL, self._team)
        self._asker.begin()
        self._lost = 0  # decisions one after another without any answer
        player = f"{self._endpoint.model}-{self.version}-{self.way}"
        self._trace = Trace(Path(self.trace), player, brief, self._endpoint.hide) if self.trace else None
        self.counters = {}
        self.ending = "stopped"

    def act(self, decision: Decision) -> Action:
        """The next action: what follows by itself, else what the model chooses."""
        self._memory.note(decision)
        if self._radio is not None:
            self._radio.note(decision)
        self.fallback, self.thought = False, Thought()
        try:
            choice = self._by_itself(decision) or self._asked(decision)
        finally:
            counts = {name: round(number, 3) for name, number in asdict(self._asker.counts).items()}
            self.counters = {**counts, "cost": round(self._asker.cost, 6)}
        names = plain_names(decision.names)
        words = choice.move if choice.thing is None else f"{choice.move} {names.get(choice.thing, choice.thing)}"
        self._memory.chose(decision, choice.action, words, search=choice.move == SEARCH)
        return choice.action

    def _by_itself(self, decision: Decision) -> Choice | None:
        """What is done without asking."""
        if decision.targets and all(target.rescued for target in decision.targets):
            self.note = "every target is rescued"
            return Choice("", "stop", None, Action(STOP))
        if self.moves == FULL:
            return None
        self.note = "follows by itself"
        action = forced(decision)
        if action is not None:
            return Choice("", PUT if decision.held is not None else PICK, action.target or "bag", action)
        if self._memory.arrived_to_search(decision):
            return Choice("", LOOK, None, Action(EXPLORE))
        return None

    def _asked(self, decision: Decision) -> Choice:
        """What the model chooses; where it cannot be read, what the stand-in does."""
        failures, visits = self._memory.believed.failures, self._memory.believed.visits
        on_offer = menu(decision, failures, visits, GIVE_UP, self.moves, self.options, tells=self._radio is not None)
        told = block(self._brief, decision, self._memory, on_offer, self.version in HISTORIES, self.version == FORECAST)
        if self._radio is not None:
            told = self._radio.added(told, self._brief, decision, self._memory.rooms)
        picture = None if decision.images is None else decision.images.rgb
        asked, told = messages(self.version, self._system, told, self._ask, picture)
        self._asker.counts.decisions += 1
        replies: list[Reply] = []
        self._asker.taken = 0.0
        try:
            choice, reason = self._chosen(asked, on_offer, told, replies)
        except SpentError as spent:
            choice, reason, self.ending = Choice("", "stop", None, Action(STOP)), str(spent), END_BUDGET
        except (NoAnswerError, UnreadableError) as error:
            choice, reason = self._stand_in(on_offer, told, error, answered=bool(replies))
        self.note = f"{choice.letter}: {reason}" if choice.letter else reason
        self.thought = Thought(
            self._asker.taken,
            sum(reply.prompt_tokens for reply in replies),
            sum(reply.answer_tokens for reply in replies),
            len(replies),
        )
        if self._trace is not None:
            self._trace.add(decision, asked, told, replies, choice, self.note, self.fallback)
        return choice

    def _chosen(self, asked: list[Message], on_offer: Menu, told: Block, replies: list[Reply]) -> tuple[Choice, str]:
        """The choice of the model and its reason; what cannot be read may be said once more."""
        end = time.monotonic() + self.deadline
        try:
            choice = self._tried(asked, on_offer, told, replies, end)
            self._lost = 0
            return choice
        except UnreadableError as error:
            self._asker.counts.invalid += 1
            if self.way == LOGPROB:
                raise
            said = replies[-1].text if replies else ""
            again = f"That could not be read: {error}. {self._ask}"
        talk = [*asked, {"role": "assistant", "content": said or "(nothing)"}, {"role": "user", "content": again}]
        try:
            choice = self._tried(talk, on_offer, told, replies, end)
        except UnreadableError:
            self._asker.counts.invalid += 1
            raise
        self._asker.counts.repaired += 1
        self._lost = 0
        return choice

    def _tried(
        self, talk: list[Message], on_offer: Menu, told: Block, replies: list[Reply], end: float
    ) -> tuple[Choice, str]:
        """One answer, in one call, or in two where the model thinks first."""
        form = request_of(self.way, on_offer, self.reply_tokens, self.limit_field)
        replies.append(self._asker.ask(talk, self._settings(form), end))
        if self.way == LOGPROB and replies[-1].candidates is None:
            raise RefusedError(f"way must be json, letter or think: {self._endpoint.host} sends no log-probabilities")
        first, thoughts = replies[-1], replies[-1].text
        if self.way == THINK:
            talk = [*talk, {"role": "assistant", "content": thoughts or "(nothing)"}]
            talk.append({"role": "user", "content": ONLY_LETTER})
            replies.append(self._asker.ask(talk, self._settings({self.limit_field: SHORT_REPLY}), end))
        choice, reason = read(self.way, replies[-1], on_offer, told["options"])
        if choice.move == TELL:
            choice = replace(choice, action=Action(TELL, message_of(self.way, first)))
        return choice, thoughts if self.way == THINK else reason

    def _settings(self, form: dict[str, Any]) -> dict[str, Any]:
        """The settings of a request; those of `form` come first, and what the user added before all."""
        made: dict[str, Any] = {"temperature": self.temperature, "top_p": self.top_p}
        if self.send_seed:
            made["seed"] = (self._brief.random_seed + self.sample) % SEEDS
        made.update(form)
        return {name: value for name, value in made.items() if value is not None} | self._extra

    def _stand_in(self, on_offer: Menu, told: Block, error: Exception, answered: bool) -> tuple[Choice, str]:
        """What is done in place of an answer. Raises RuntimeError where none has come for several decisions."""
        self._lost = 0 if answered else self._lost + 1
        if self._lost >= MOST_LOST:
            raise RuntimeError(f"no answer came for {MOST_LOST} decisions in a row: {error}") from None
        self._asker.counts.fallbacks += 1
        self.fallback = True
        letter = RULES[self.stand_in](told)
        choice = next(choice for choice in on_offer.choices if choice.letter == letter)
        return choice, f"no answer, so by the rule {self.stand_in}: {error}"
