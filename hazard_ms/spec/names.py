"""Names: the order in which people expect numbered ones, scene-2 before scene-10, and those of the simulator's actors.

"env-0_apple_1" is the thing apple_1 of the first scene. ManiSkill's own scene builders use the same form. A name must
not hold a slash: recorded states are HDF5 files, in which a slash would begin a group within a group.
"""

from __future__ import annotations

import re

LONGEST_NUMBER = 9  # digits of a number that counts as one: Python refuses to read absurdly long ones [ours]
ENTITY = re.compile(r"(?:scene-\d+_)?env-\d+_(.+)")  # names of SAPIEN's entities begin with ManiSkill's prefix


def actor_name(env: int, name: str) -> str:
    """The simulator's name of the thing called `name` in scene number `env`."""
    return f"env-{env}_{name}"


def plain_name(entity: str) -> str:
    """The name within its scene of the simulator's `entity`, or `entity` itself if `actor_name` did not make it."""
    found = ENTITY.fullmatch(entity)
    return found[1] if found else entity


def natural(name: str) -> list[tuple[int, str]]:
    """The key by which names sort with their numbers as numbers; no two names have the same one."""
    parts: list[tuple[int, str]] = []
    for word in re.split(r"([0-9]+)", name):
        is_number = word.isascii() and word.isdigit() and len(word) <= LONGEST_NUMBER
        parts.append((int(word), "") if is_number else (-1, word))
    return [*parts, (-1, name)]
