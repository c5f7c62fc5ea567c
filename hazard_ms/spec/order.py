"""The order in which people expect numbered names: scene-2 before scene-10."""

from __future__ import annotations

import re

LONGEST_NUMBER = 9  # digits of a number that counts as one: Python refuses to read absurdly long ones [ours]


def natural(name: str) -> list[tuple[int, str]]:
    """The key by which names sort with their numbers as numbers; no two names have the same one."""
    parts: list[tuple[int, str]] = []
    for word in re.split(r"([0-9]+)", name):
        is_number = word.isascii() and word.isdigit() and len(word) <= LONGEST_NUMBER
        parts.append((int(word), "") if is_number else (-1, word))
    return [*parts, (-1, name)]
