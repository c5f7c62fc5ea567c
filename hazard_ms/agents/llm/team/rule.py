"""A rule for one robot of a team that tells as a model does: for the scripted server, and to see what prompts tell.

It fetches as `greedy`, tells the others what it goes for and what it sees, and leaves to them what they said to fetch.
"""

from __future__ import annotations

from collections.abc import Collection

from hazard_ms.agents.llm.choices import FETCH
from hazard_ms.agents.llm.rules import greedy, rows
from hazard_ms.agents.llm.scene_text import Block
from hazard_ms.skills.telling import LONGEST, named_in
from hazard_ms.spec.registry.mitigations import TELL

FETCHING, SEEING = "I fetch ", "I see "  # before names of things in a message


def tells(block: Block) -> tuple[str, str]:
    """The letter of an option, and the message where that is to tell something."""
    options: dict[str, str] = block["options"]
    tell = next((letter for letter, text in options.items() if text == TELL), None)
    if tell is None or not block["last_actions"][1:]:
        return greedy(block), ""
    claims = _claims(block)
    letter = greedy(_without(block, {aim for aim, robot in claims.items() if robot != block["robot"]}))
    aim = options[letter].removeprefix(f"{FETCH} ") if options[letter].startswith(f"{FETCH} ") else ""
    seen = tuple(row["thing"] for row in rows(block["targets"]))
    told = {name for row in rows(block["radio"]) for name in named_in(row["text"], seen)}
    text = f"{FETCHING}{aim}." if aim and claims.get(aim) != block["robot"] else ""
    for name in seen:
        more = f"{text} {SEEING}{name}.".strip()
        text = more if name not in (aim, *told) and len(more) <= LONGEST else text
    return (tell, text) if text else (letter, "")


def _claims(block: Block) -> dict[str, str]:
    """Each thing that a robot last said to fetch, and that robot; of several robots the one that said it first."""
    last: dict[str, tuple[int, str, str]] = {}
    for row in rows(block["radio"]):
        if row["text"].startswith(FETCHING):
            last[row["from"]] = -row["frames_ago"], row["from"], row["text"].removeprefix(FETCHING).partition(".")[0]
    return {aim: robot for _, robot, aim in sorted(last.values(), reverse=True)}


def _without(block: Block, names: Collection[str]) -> Block:
    """The block in which the things `names` are not on offer."""
    header, *rest = block["targets"]
    option, thing = header.index("option"), header.index("thing")
    kept = [[None if k == option and row[thing] in names else entry for k, entry in enumerate(row)] for row in rest]
    return {**block, "targets": [header, *kept]}
