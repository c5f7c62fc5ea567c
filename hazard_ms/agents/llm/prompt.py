"""The prompts: texts of the folder `prompts`, filled in for a decision, and kept within their budgets of tokens."""

from __future__ import annotations

import base64
import io
import re
from collections.abc import Sequence
from functools import cache
from pathlib import Path
from typing import Any

import jinja2
from numpy.typing import NDArray

from hazard_ms.agents.llm.scene_text import Block, as_text, shortened
from hazard_ms.agents.search.outlook import skill_frames
from hazard_ms.sketch.travel.ways import WALK
from hazard_ms.skills.brief import Brief
from hazard_ms.skills.telling import FRAMES, LONGEST
from hazard_ms.spec.registry.mitigations import LOOK_AT, MITIGATIONS

VERSIONS = ("llm-1", "llm-2", "llm-3", "llm-2-image")
HISTORIES = ("llm-2", "llm-3", "llm-2-image")  # versions that tell of earlier sightings
FORECAST, IMAGE = "llm-3", "llm-2-image"  # the version that tells our forecast, and the one that shows the picture
BUDGETS = {"llm-1": 1250, "llm-2": 1500, "llm-3": 1500, "llm-2-image": 1500}  # of a prompt without picture [tokens]
MITIGATING = 1250  # further tokens for tasks with mitigations: doors, tools, and more to choose from [ours]
TEAM = 1000  # further tokens in a team: who is in it, where they are, and what was told [ours]
PICTURE = 512  # edge of the picture that is sent, at most [px]
QUALITY = 85  # of its JPEG, 0 to 100 [ours]
DANGERS = {
    "fire": "The room is burning; a flammable thing is damaged once it catches fire.",
    "flood": "Water is rising; a thing that is not waterproof is damaged once it is under water.",
    "wind": "A storm carries things away; it damages nothing, but what is far gone is hard to catch.",
}
PIECES = re.compile(r"[A-Za-z]+|\d{1,3}|[^\sA-Za-z\d]+")
LETTERS_PER_TOKEN = 6  # of English words; rarer ones are cut into shorter pieces [ours]
SIGNS_PER_TOKEN = 2  # of punctuation, as in the `","` of JSON [ours]

Message = dict[str, Any]


def estimate(text: str) -> int:
    """The number of tokens of a text, about: as most tokenizers cut words, digits and punctuation."""
    total = 0
    for piece in PIECES.findall(text):
        per = LETTERS_PER_TOKEN if piece[0].isascii() and piece[0].isalpha() else SIGNS_PER_TOKEN
        total += 1 if piece[0].isdigit() else -(-len(piece) // per)
    return total


def system_text(brief: Brief, macro: bool, team: Sequence[str] = ()) -> str:
    """The task in words: the same at every decision of an episode, so that servers keep what they have read of it.

    `team`: names of the robots of a team, that which is directed first.
    """
    times = skill_frames(brief.robot)
    return _filled(
        "system",
        hazards=[DANGERS.get(h.name, f"Beware of {h.name}: it can damage things.") for h in brief.hazards],
        carts=bool(brief.containers),
        share="half" if brief.damaged_share == 0.5 else f"{brief.damaged_share:g}",
        limit=brief.max_frames,
        walk=round(WALK),
        pick=round(times.pick),
        look=round(times.explore),
        macro=macro,
        team=team,
        longest=LONGEST,
        telling=FRAMES,
        rooms=brief.several_rooms and bool(brief.mitigations),
        averted=brief.averted,
        goal=brief.verb,
        mitigation=brief.mitigation,
        text=brief.text,
        looks=(LOOK_AT.replace("_", " "), MITIGATIONS[LOOK_AT].text) if brief.looks else (),
        mitigations=[(verb.replace("_", " "), MITIGATIONS[verb].text) for verb in brief.mitigations],
    )


def messages(
    version: str, system: str, told: Block, ask: str, picture: NDArray | None = None
) -> tuple[list[Message], Block]:
    """The messages of a decision, and the part of `told` that went into them: as much as the version's budget allows.

    `picture`: that of the head camera, [H, W, 3], uint8, for versions that show it.
    """
    rest: Block | None = told
    budget = BUDGETS[version] + (MITIGATING if "here" in told else 0) + (TEAM if "radio" in told else 0)
    while True:
        text = _filled(version, block=as_text(told), ask=ask)
        rest = shortened(told) if estimate(system) + estimate(text) > budget else None
        if rest is None:
            break
        told = rest
    content: str | list[dict[str, Any]] = text
    if version == IMAGE and picture is not None:
        shown = {"type": "image_url", "image_url": {"url": data_url(picture)}}
        content = [{"type": "text", "text": text}, shown]
    return [{"role": "system", "content": system}, {"role": "user", "content": content}], told


def data_url(picture: NDArray) -> str:
    """A picture [H, W, 3], uint8, as the data URL of a JPEG whose edges have PICTURE pixels at most."""
    from PIL import Image

    image = Image.fromarray(picture)
    image.thumbnail((PICTURE, PICTURE))
    file = io.BytesIO()
    image.save(file, "JPEG", quality=QUALITY)
    return "data:image/jpeg;base64," + base64.b64encode(file.getvalue()).decode("ascii")


def text_of(asked: Sequence[Message]) -> str:
    """The text of messages, without pictures."""
    parts = []
    for message in asked:
        content = message["content"]
        pieces = content if isinstance(content, list) else [{"type": "text", "text": content}]
        parts += [str(piece["text"]) for piece in pieces if piece.get("type") == "text"]
    return "\n".join(parts)


@cache
def _texts() -> jinja2.Environment:
    return jinja2.Environment(
        loader=jinja2.FileSystemLoader(Path(__file__).with_name("prompts")),
        undefined=jinja2.StrictUndefined,
        autoescape=False,  # the text is for a model, not for a browser
        trim_blocks=True,
        lstrip_blocks=True,
    )


def _filled(name: str, **values: Any) -> str:
    """The text NAME.j2 with `values` filled in."""
    return _texts().get_template(f"{name}.j2").render(**values)
