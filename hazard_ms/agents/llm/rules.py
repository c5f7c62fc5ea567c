"""Rules that choose from the text of a prompt alone, as a model does: for the scripted server, and as stand-ins.

They know no more than what is written there, so they show what the prompts tell.
"""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from typing import Any

from hazard_ms.agents.llm.choices import BRING, END, FETCH, LOOK, PICK, PUT, PUT_DOWN, SEARCH
from hazard_ms.agents.llm.scene_text import SAFE, Block

FENCED = re.compile(r"```json\n(.*?)\n```", re.DOTALL)
HANDLING = 1.0  # what picking up costs, as a distance [m], as for `greedy`
LOYALTY = 0.8  # factor on the cost of what it is on its way to, as for `greedy`
DAMAGED = 0.5  # share of its value that a damaged thing counts
SHUT, OPEN, PUSH, EXTINGUISH = "shut ", "open ", "push ", "extinguish "  # begin options of mitigations
TRIES = 2  # of one option of a mitigation among the actions that are told [ours]
DOOR = 6.0  # distance up to which a door is worth shutting [m] [ours]
WET = 0.02  # depth of water around the robot from which rooms are shut [m] [ours]
WALK = 62.0  # frames for a metre, to tell which forecasts come too late


def block_in(text: str) -> Block:
    """The last JSON block in a text. Raises ValueError where there is none."""
    found = FENCED.findall(text)
    if not found:
        raise ValueError("a prompt must contain a block ```json, got none")
    block = json.loads(found[-1])
    if not isinstance(block, dict) or not block.get("options"):
        raise ValueError("the ```json block of a prompt must contain options, got none")
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


def mitigates(block: Block) -> str:
    """The letter of an option against the hazard itself where one makes sense, else that of `greedy`.

    It puts out what is hot, shuts the doors of rooms in danger behind itself, pushes carts to things, and opens doors
    where it knows of nothing to fetch.
    """
    if not block["last_actions"][1:]:
        return greedy(block)
    return _fought(block) or _turned(block, SHUT, _shields) or _pushed(block) or _opened(block) or greedy(block)


RULES: dict[str, Callable[[Block], str]] = {"first": first, "greedy": greedy, "mitigates": mitigates}


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


def _tries(block: Block, text: str) -> int:
    """How often an option that begins so was taken and did not pause, of the actions that are told."""
    return sum(done[0].startswith(text) and done[1] != "paused" for done in block["last_actions"][1:])


def _fought(block: Block) -> str | None:
    """The letter with which a fire is fought: for what is hot, the extinguisher, or to put it down; None for none."""
    tools, hot = rows(block.get("tools", [["option"]])), rows(block.get("hot", [["option"]]))
    if any(tool["tool"] == block["held"] for tool in tools):
        for row in hot:
            if row["option"] is not None and _tries(block, f"{EXTINGUISH}{row['thing']}") < TRIES:
                return str(row["option"])
        return _letter(block, PUT_DOWN)
    full = [tool for tool in tools if tool["option"] is not None and tool["percent_left"] > 0]
    new = [row for row in hot if _tries(block, f"{EXTINGUISH}{row['thing']}") < TRIES]
    if block["held"] is not None or not full or not new:
        return None
    near = min(full, key=lambda tool: tool["metres"])
    return None if _tries(block, f"{FETCH} {near['tool']}") >= TRIES else str(near["option"])


def _turned(block: Block, verb: str, fits: Callable[[Block, dict[str, Any]], bool]) -> str | None:
    """The letter for the nearest door that `fits` and can be turned; None for none. Each is tried once."""
    for door in sorted(rows(block.get("doors", [["door"]])), key=lambda row: row["metres"]):
        text = f"{verb}{door['door']}"
        letter = next((letter for letter, told in block["options"].items() if told == text), None)
        if letter is not None and not _tries(block, text) and fits(block, door):
            return letter
    return None


def _shields(block: Block, door: dict[str, Any]) -> bool:
    """Whether a shut door would part what burns, or water, from the room that the robot is in."""
    here = block["here"].get("room")
    if door["metres"] > DOOR or here is None or door["door"].startswith("window"):
        return False
    burning = {row["room"] for row in rows(block.get("hot", [["room"]]))}
    if burning:
        return here not in burning and bool(burning & set(door["joins"]))
    return bool((block["here"].get("water_level_m") or 0.0) >= WET and not _tries(block, SHUT))


def _pushed(block: Block) -> str | None:
    return _letter(block, PUSH) if block["targets"][1:] and not _tries(block, PUSH) else None


def _opened(block: Block) -> str | None:
    """The letter for the nearest shut door where there is nothing to fetch; None for none."""
    wanted = [row for row in rows(block["targets"]) if row["option"] is not None]
    return None if wanted or block["held"] is not None else _turned(block, OPEN, _is_door)


def _is_door(block: Block, door: dict[str, Any]) -> bool:
    return bool(door["door"].startswith("door_") and door["percent_open"] < 50)


def _on_the_way(block: Block) -> str:
    """The option chosen last, if it was a walk that paused."""
    done = block["last_actions"][1:]
    paused = bool(done) and done[-1][1] == "paused" and done[-1][0].startswith((FETCH, SEARCH, BRING))
    return str(done[-1][0]) if paused else ""


def _letter(block: Block, move: str) -> str | None:
    """The letter of the first option that begins with a move."""
    return next((letter for letter, text in block["options"].items() if text.startswith(move)), None)
