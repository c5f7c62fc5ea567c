"""Finds out in a minute whether a model can play: which ways of answering it keeps to, how fast it is, and its cost."""

from __future__ import annotations

import statistics
import time
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any

from hazard_ms.agents.llm.answers import ASKS, JSON, LETTER, LOGPROB, UnreadableError, read, request_of
from hazard_ms.agents.llm.asking import Asker, Budget, Counts
from hazard_ms.agents.llm.choices import FETCH, LOOK, SEARCH, Choice, Menu
from hazard_ms.agents.llm.client import Client
from hazard_ms.agents.llm.endpoint import endpoint
from hazard_ms.agents.llm.network.extra import extra_of
from hazard_ms.agents.llm.network.faults import SAMPLING, NoAnswerError, RefusedError
from hazard_ms.agents.llm.prompt import messages
from hazard_ms.agents.llm.rules import greedy
from hazard_ms.agents.llm.scene_text import Block
from hazard_ms.skills.decision import EXPLORE, STOP, Action
from hazard_ms.spec.foreign.files import printable

CHECKED = (JSON, LETTER, LOGPROB)  # `think` needs no more than `letter`
DECISIONS = 20  # of an episode for which a model is asked: 14 in rooms, 31 in the open [measured with `greedy`]
PROMPT_TOKENS = 900  # of a prompt of llm-1 [measured with `estimate`]
EPISODES = 75  # 25 of each of three tasks, as the benchmark has them
WORKS = 0.95  # share of answers that can be read, from which a way is recommended [ours]
PROMPTS = 4  # that are asked in each way
TOKENS = 512  # of an answer, at most
SETTINGS = {"temperature": 0.7, "top_p": 1.0, "seed": 0}  # that the agent sends by default
SYSTEM = (
    "You direct a rescue robot. The room is burning; a flammable thing is damaged once it catches fire.\n"
    "Things are saved once they are in the robot's bag. Time runs while the robot moves.\n"
    "You get the situation as JSON. In each table the first row names the columns."
)


@dataclass(frozen=True)
class Way:
    """The outcome of one way of answering."""

    way: str
    asked: int
    read: int  # answers that named an option
    greedy: int  # that named the one that the rule `greedy` takes
    seconds: float  # median until the answer was there [s]
    counts: Counts
    fault: str = ""  # why it cannot be used at all
    needs: str = ""  # parameters of the agent that the server asks for


def ways(base_url: str, model: str, seconds: float, limit_field: str, extra: str = "") -> Iterator[Way]:
    """The model at an address, tried in each way, with `seconds` [s] for each answer, and with the fields of `extra`.

    What an episode sends is sent here, too; what the server refuses of it is then left out. Raises ValueError for an
    address that cannot be used.
    """
    where, more = endpoint(base_url, model), extra_of(extra)
    client = Client(where, tries=2, seed=0)
    client.greet()
    for way in CHECKED:
        found = _tried(way, Asker(where, client, None, Budget(), 0), seconds, limit_field, {**SETTINGS, **more})
        if not found.read and found.needs == SAMPLING:
            asker = Asker(where, client, None, Budget(), 0)
            found = replace(_tried(way, asker, seconds, limit_field, more), needs=SAMPLING)
        yield found


def _tried(way: str, asker: Asker, seconds: float, limit_field: str, settings: dict[str, Any]) -> Way:
    """The outcome of some prompts in one way, sent with `settings`."""
    taken, named, same, fault, needs = [], 0, 0, "", ""
    for number in range(PROMPTS):
        told, menu = sample(number)
        asked, _ = messages("llm-1", SYSTEM, told, ASKS[way])
        form = {**settings, **request_of(way, menu, TOKENS, limit_field)}
        try:
            reply = asker.ask(asked, form, time.monotonic() + seconds)
            taken.append(reply.seconds)
            if way == LOGPROB and reply.candidates is None:
                fault = "no log-probabilities are sent"
                break
            choice, _ = read(way, reply, menu, told["options"])
        except RefusedError as error:
            fault, needs = str(error), error.remedy
            break
        except (UnreadableError, NoAnswerError) as error:
            fault = str(error)
            continue
        named += 1
        same += choice.letter == greedy(told)
    return Way(way, asker.counts.calls, named, same, statistics.median(taken or [0.0]), asker.counts, fault, needs)


def report(found: list[Way], price_in: float, price_out: float) -> str:
    """The table of the ways, which one to use, and what it takes; prices are of a million tokens [USD]."""
    lines = ["way      read   as greedy  seconds  tokens read, written a decision"]
    for each in found:
        counts, calls = each.counts, max(each.counts.calls, 1)
        lines.append(
            f"{each.way:8} {each.read}/{each.asked:<5} {each.greedy}/{each.asked:<9} {each.seconds:7.2f}  "
            f"{counts.tokens_in / calls:.0f}, {counts.tokens_out / calls:.0f}"
            + (f"  {printable(each.fault)}" if each.fault else "")
        )
    if any(each.counts.cut for each in found):
        lines.append("Its server cuts prompts: it says that it read less than half. Start it with a longer context.")
    good = [each for each in found if each.asked and each.read >= WORKS * each.asked]
    if not good:
        return "\n".join([*lines, "It cannot play: in no way could its answers be read."])
    best, count = good[0], DECISIONS * EPISODES
    tokens_in, tokens_out = count * PROMPT_TOKENS, round(count * best.counts.tokens_out / best.counts.calls)
    cost = Budget(price_in=price_in, price_out=price_out).spent(Counts(tokens_in=tokens_in, tokens_out=tokens_out))
    lines.append(f"It can play: --agent llm:way={best.way}{best.needs and ','}{best.needs},...")
    lines.append(
        f"{EPISODES} episodes of about {DECISIONS} decisions: {count * best.seconds / 3600:.1f} hours one by one, "
        f"{tokens_in / 1e6:.2f} million tokens read, {tokens_out / 1e6:.2f} written"
        + (f", {cost:.2f} USD" if cost else "")
    )
    return "\n".join(lines)


def sample(number: int) -> tuple[Block, Menu]:
    """A small scene and its menu; each `number` gives another."""
    names = [f"book_{number + 1}", "bottle_1", f"apple_{number + 2}"]
    metres = [1.5 + number, 4.0, 6.5 - number]
    moves = [*((FETCH, name, Action("walk_to", name)) for name in names)]
    every = [*moves, (SEARCH, "table_1", Action("walk_to", "table_1")), (LOOK, None, Action(EXPLORE))]
    every.append(("stop", None, Action(STOP)))
    letters = "ABCDEF"
    menu = Menu(tuple(Choice(letter, *each) for letter, each in zip(letters, every, strict=True)), ())
    rows = [
        [letter, name, 5 if name.startswith("book") else 1, way, 40 + 10 * k, 12 * k]
        for k, (letter, name, way) in enumerate(zip(letters, names, metres, strict=False))
    ]
    told: Block = {
        "wanted": [["kind", "value", "left", "burns_at_C"], ["book", 5, 1, 230], ["bottle", 1, 2, "never"]],
        "frame": 200 + 100 * number,
        "frames_left": 1300 - 100 * number,
        "saved": number,
        "held": None,
        "last_actions": [["action", "result", "frames"], ["look", "done", 60]],
        "targets": [["option", "thing", "value", "metres", "temperature_C", "frames_ago"], *rows],
        "places_to_search": [
            ["option", "near", "metres", "unexplored_metres", "visits"],
            ["D", "table_1", 3.0, 4.2, 0],
        ],
        "options": {c.letter: c.move if c.thing is None else f"{c.move} {c.thing}" for c in menu.choices},
    }
    return told, menu
