"""The list of mutations: small mistakes that a programmer could make, each of which a test must notice.

An entry of `list.txt` begins with its name, and a blank line ends it:

    = name-of-the-mistake
    file: hazard_ms/room/module.py
    tests: tests/room/test_module.py::test_that_notices_it
    breaks: What goes wrong for the user.
    - the text of the file, which occurs exactly once in it
    + the text that takes its place
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

LIST = Path(__file__).with_name("list.txt")
KEYS = ("file", "tests", "breaks")


@dataclass(frozen=True)
class Mutation:
    """A mistake: `old` is replaced by `new` in `file`. `tests`: the test, or file of tests, that should notice it."""

    name: str
    file: str  # relative to the checkout, as is the next
    tests: str
    breaks: str  # what goes wrong for the user, in one line
    old: str
    new: str

    def __str__(self) -> str:
        """The name."""
        return self.name

    def apply(self, text: str) -> str:
        """The text of the file with the mistake in it.

        Raises ValueError unless the old text occurs exactly once.
        """
        found = text.count(self.old)
        if found != 1:
            raise ValueError(f"the old text of {self.name} must occur once in {self.file}, got {found} times")
        return text.replace(self.old, self.new)


def read(text: str) -> dict[str, Mutation]:
    """All mutations of a list by name. Raises ValueError for entries without one of the parts, and for names twice."""
    made: dict[str, Mutation] = {}
    for entry in text.split("\n= ")[1:]:
        name, *lines = entry.rstrip("\n").split("\n")
        parts = {key: [line.removeprefix(f"{key}: ") for line in lines if line.startswith(f"{key}: ")] for key in KEYS}
        old, new = ("\n".join(line[2:] for line in lines if line.startswith(sign)) for sign in ("- ", "+ "))
        if any(len(found) != 1 for found in parts.values()) or not old or old == new or name in made:
            raise ValueError(
                f"a mutation must have its own name, {', '.join(KEYS)}, an old and a new text, got {entry!r}"
            )
        made[name] = Mutation(name, *(parts[key][0] for key in KEYS), old, new)
    return made


def listed() -> dict[str, Mutation]:
    """All mutations of the list by name."""
    return read("\n" + LIST.read_text(encoding="utf-8"))
