"""The card of an agent: what its authors say about it. Nothing of it can be verified but `privileged`, in part."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

from hazard_ms.spec.foreign import plain
from hazard_ms.spec.foreign.plain import Within

LARGEST = 100_000  # of its file [bytes] [ours]
SECURE = "https://"  # how links begin
Line = Annotated[str, Within(1, 200)]  # [characters] [ours]
Words = Annotated[str, Within(1, 2_000)]  # [characters] [ours]


@dataclass(frozen=True)
class Card:
    """An agent as its authors describe it. Raises ValueError for a link that is not an https address."""

    name: Annotated[str, Within(1, 60)]  # under which it is listed [characters]
    authors: Annotated[tuple[Line, ...], Within(1, 100)]
    description: Words
    trained_on: Words  # data, scenes and demonstrations; "nothing" where there are none
    models: Annotated[dict[str, Line], Within(0, 50)]  # by name: the size or exact version
    privileged: bool  # whether it knew what agents cannot know
    cost: Line  # of an episode, in whatever was spent: "none", "0.04 USD", "2 s of one GPU"
    link: Annotated[str, Within(0, 300)] = ""

    def __post_init__(self) -> None:
        if self.link and not self.link.startswith(SECURE):
            raise ValueError(f"link of a card must begin with {SECURE}, got {self.link!r:.100}")


def read_card(path: Path) -> Card:
    """The card in a JSON file. Raises ValueError that names what is missing or wrong in it."""
    if not path.is_file():
        raise ValueError(
            f"card must be a file with the agent's card (docs/leaderboard.md), got {path}, which is not a file"
        )
    found: Card = plain.made(Card, plain.read(path, LARGEST), f"card {path}")
    return found
