"""Mitigations by verb: what an agent can do about a hazard itself, beyond the six verbs of the benchmark.

A task names those that its agents have (`hazard_ms.spec.Task.mitigations`); the published tasks have none. Two verbs
are kept here that are no mitigations: LOOK_AT, which all agents have that see through a detector, and TELL, which the
robots of a team have. Functions are given as text, "package.module:function", which is imported when it is first
needed, or as themselves.

    import hazard_ms
    hazard_ms.register_mitigation("switch_off", "my_package.power:switch_off", "my_package.power:switches", "...")
"""

from __future__ import annotations

import re
from collections.abc import Collection, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any

from hazard_ms.spec.catalogue import FLOOD_BOARD
from hazard_ms.spec.registry import find

VERB = re.compile(r"[a-z]+(_[a-z]+)*")
PUBLISHED = ("walk_to", "walk_one_step", "pick_up", "drop", "explore", "stop")  # verbs that every task has
LOOK_AT, TELL = "look_at", "tell"
MODULE = "hazard_ms.skills.mitigations."


@dataclass(frozen=True)
class MitigationEntry:
    """A mitigation: its verb, how it is done, and on what.

    `skill(stage, target)` gives the generator that does it, a `hazard_ms.skills.context.Skill`; `targets(stage)` gives
    the names of what it makes sense on now. `stage`: `hazard_ms.skills.context.Stage`.
    """

    verb: str
    skill: Any
    targets: Any
    text: str  # what it does and needs, one sentence for prompts and pages
    # of the things that it needs in the hand, any one of them: categories, or what they are called before their number
    tools: tuple[str, ...] = ()
    reasons: tuple[str, ...] = ()  # for which it fails, beyond those of `hazard_ms.skills.failures.FAILURES`


_mitigations: dict[str, MitigationEntry] = {}
MITIGATIONS: Mapping[str, MitigationEntry] = MappingProxyType(_mitigations)


def register_mitigation(
    verb: str, skill: Any, targets: Any, text: str, tools: tuple[str, ...] = (), reasons: tuple[str, ...] = ()
) -> None:
    """Add a mitigation, see `MitigationEntry`. Raises ValueError for a verb that cannot be, or that is taken."""
    if not isinstance(verb, str) or not VERB.fullmatch(verb):
        raise ValueError(f"a verb must be lower-case words joined by underscores, got {verb!r}")
    entry = MitigationEntry(verb, skill, targets, text, tools, reasons)
    if verb in PUBLISHED or _mitigations.get(verb, entry) != entry:
        raise ValueError(f"a verb must be new, got {verb!r}, which is taken")
    _mitigations[verb] = entry


def unregister_mitigation(verb: str) -> None:
    """Remove a mitigation. Raises KeyError if it is not registered."""
    del _mitigations[verb]


def tools_of(verbs: Collection[str]) -> frozenset[str]:
    """The kinds of all things that the mitigations of these `verbs` need in the hand, see `MitigationEntry.tools`.

    Raises ValueError for a verb that is not registered.
    """
    return frozenset(kind for verb in verbs for kind in find(MITIGATIONS, verb, "mitigation").tools)


_DOORS = ("too_far", "no_leaf", "broken", "held_shut", "held_open", "in_the_swing")
register_mitigation(
    "open",
    MODULE + "doors:open_door",
    MODULE + "doors:shut_ones",
    "opens a shut door, which takes about five seconds at its handle with an empty hand",
    reasons=_DOORS,
)
register_mitigation(
    "shut",
    MODULE + "doors:shut_door",
    MODULE + "doors:open_ones",
    "shuts an open door, which takes about five seconds at its handle with an empty hand; a shut door holds back "
    "smoke, fire and water for a time",
    reasons=_DOORS,
)
register_mitigation(
    "extinguish",
    MODULE + "extinguish:extinguish",
    MODULE + "extinguish:hot_things",
    "puts out a thing that burns, and flames around it, with the fire extinguisher in the hand, from a few metres "
    "away, until it is empty",
    tools=("fire_extinguisher",),
    reasons=("no_extinguisher", "empty", "no_line_of_sight", "too_hot", "not_burning", "still_burning"),
)
register_mitigation(
    "put_on",
    MODULE + "shelving:put_on",
    MODULE + "shelving:tops",
    "puts what is in the hand on top of a table or other furniture, where it stays dry while the water is lower",
    reasons=("no_top", "no_room", "fell_off"),
)
register_mitigation(
    "block",
    MODULE + "blocking:block",
    MODULE + "blocking:gaps",
    "sets the flood board in the hand into the rails of a door or doorway, while the water there is low; it holds back "
    "water up to its own height",
    tools=(FLOOD_BOARD,),
    reasons=("no_board", "no_rails", "too_deep"),
)
register_mitigation(
    "push",
    MODULE + "carts:push_to",
    MODULE + "carts:far_things",
    "pushes the cart that is nearest to the robot to a thing that is still to be rescued, with an empty hand",
    reasons=("not_movable",),
)
register_mitigation(
    LOOK_AT,
    MODULE + "looking:look_at",
    MODULE + "looking:doubtful",
    "comes near enough to a thing to tell what it is, and faces it, which takes no time where it is near and ahead",
)
register_mitigation(
    TELL,
    "hazard_ms.skills.telling:tell",
    "hazard_ms.skills.telling:nothing",
    "tells all other robots of the team a message, and the places of the things that it names",
)
