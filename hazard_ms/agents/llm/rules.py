"""Rules that choose from the text of a prompt alone, as a model does: for the scripted server, and as stand-ins.

They know no more than what is written there, so they show what the prompts tell.
"""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from typing import Any

from hazard_ms.agents.llm.choices import BRING, END, FETCH, LOOK, PICK, PUT, SEARCH
from hazard_ms.agents.llm.scene_text import SAFE, Block

FENCED = re.compile(r"```json\n(.*?)\n```", re.DOTALL)
HANDLING = 1.0  # what picking up costs, as a distance [m], as for `greedy`
LOYALTY = 0.8  # factor on the cost of what it is on its way to, as for `greedy`
DAMAGED = 0.5  # share of its value that a damaged thing counts
WALK = 62.0  # frames for a metre, to tell which forecasts come too late


def block_in(text: str) -> Block:
    """The last JSON block in a text. Raises ValueError where there is none."""
    found = FENCED.findall(text)
    if not found:
        raise ValueError("a prompt must hold a block ```json, got none")
    block = json.loads(found[-1])
    if not isinstance(block, dict) or not block.get("options"):
        raise ValueError("the block of a prompt must hold options, got none")
    return block


def first(block: Block) -> str:
    """The letter of the first option."""
    return next(iter(block["options"]))


def greedy(block: Block) -> str:
    """The letter of the option that brings the most value for its way; it searches where nothing is known."""
    if not block["last_actions"][1:] and (look := _letter(block, LOOK)) is not None:
        return look
    if block["held"] is not None:
        return _put_away(block)
    done = block["last_actions"][-1]
    if done[0].startswith(FETCH) and done[1] == "done":  # where the model decides on every action
        here = _letter(block, done[0].replace(FETCH, PICK, 1))
        if here is not None:
            return here
    costs = {row["option"]: _cost(block, row) for row in rows(block["targets"]) if row["option"] is not None}
    if costs:
        return min(costs, key=lambda letter: costs[letter])
    return _search(block)


RULES: dict[str, Callable[[Block], str]] = {"first": first, "greedy": greedy}


def rows(table: list[list[Any]]) -> list[dict[str, Any]]:
    """The rows of a table of a block, by the names of its columns."""
    header, *rest = table
    return [dict(zip(header, row, strict=True)) for row in rest]


def _cost(block: Block, row: dict[str, Any]) -> float:
    """What a target costs for each unit of its value, in metres."""
    text = block["options"][row["option"]]
    way = row["metres"] + HANDLING
    until = row.get("damaged_from_frame", SAFE)
    late = until != SAFE and until < block["frame"] + WALK * way
    value = row["value"] * (DAMAGED if row.get("damaged") or late else 1.0)
    loyalty = LOYALTY if text == _on_the_way(block) else 1.0
    return float(loyalty * way * (1 + row.get("failures", 0)) ** 2 / value)


def _put_away(block: Block) -> str:
    """The letter for what is held: into the nearest cart, or into the bag."""
    put = _letter(block, PUT)
    if put is not None:
        return put
    carts = [row for row in rows(block.get("carts", [["option"]])) if row["option"] is not None]
    if carts and _letter(block, BRING) is not None:
        return str(min(carts, key=lambda row: row["metres"] * (1 + row["failures"]))["option"])
    return _search(block)


def _search(block: Block) -> str:
    """The letter of the place with most unexplored floor around it for its way; else it looks around, or stops."""
    places = [row for row in rows(block["places_to_search"]) if row["option"] is not None]
    for row in places:
        if block["options"][row["option"]] == _on_the_way(block):
            return str(row["option"])
    if places:
        best = max(places, key=lambda row: row["unexplored_metres"] / (1 + row["metres"]) / (1 + row["visits"]) ** 2)
        return str(best["option"])
    looked = block["last_actions"][1:] and block["last_actions"][-1][0] == LOOK
    return (None if looked else _letter(block, LOOK)) or _letter(block, END) or first(block)


def _on_the_way(block: Block) -> str:
    """The option chosen last, if it was a walk that paused."""
    done = block["last_actions"][1:]
    paused = bool(done) and done[-1][1] == "paused" and done[-1][0].startswith((FETCH, SEARCH, BRING))
    return str(done[-1][0]) if paused else ""


def _letter(block: Block, move: str) -> str | None:
    """The letter of the first option that begins with a move."""
    return next((letter for letter, text in block["options"].items() if text.startswith(move)), None)
