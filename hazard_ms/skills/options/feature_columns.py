"""The numbers that a policy sees of a decision: four tables, declared column by column.

A number is clip(quantity / scale, low, high). Each table has one row per slot of the menu
(`hazard_ms.skills.options.options`).
"""

from __future__ import annotations

from dataclasses import dataclass

from hazard_ms.skills.options.landmarks import MOST_VISITS
from hazard_ms.skills.options.options import GIVE_UP

FEATURES_VERSION = 1  # goes up whenever a column is added, moved or changes its meaning: a policy fits one version
MEASURED_VERSION = 2  # the same of the layout of tasks with measures, which is another
NO_PATH_KNOWN = 2.0  # walking time to where no path is known, in units of its scale
SOON = 100.0  # frames over which the change of a level is given


@dataclass(frozen=True)
class Column:
    """One number of a row: clip(quantity / scale, low, high)."""

    name: str
    unit: str
    scale: float
    low: float
    high: float
    meaning: str


def _flag(name: str, meaning: str) -> Column:
    return Column(name, "", 1.0, 0.0, 1.0, f"1 if {meaning}, else 0")


_PLACE = (
    Column("ahead", "m", 5.0, -5.0, 5.0, "distance ahead of the agent, as last seen"),
    Column("left", "m", 5.0, -5.0, 5.0, "distance to the left of the agent, as last seen"),
    Column("walk", "frame", 500.0, 0.0, NO_PATH_KNOWN, "time to walk there over the map; 2 if no path is known"),
)


def target_columns(hazards: int, most: float = 5.0) -> tuple[Column, ...]:
    """The columns of a target's row in a task with this many `hazards`; `most`: the value of a target at most."""
    levels = [
        column
        for k in range(hazards)
        for column in (
            Column(f"level_{k}", "range", 1.0, 0.0, 2.0, f"level of hazard {k} over it when last seen, in its range"),
            Column(f"rise_{k}", "range", 1.0, -1.0, 1.0, f"change of level_{k} in {SOON:.0f} frames, as last seen"),
        )
    ]
    return (
        _flag("known", "it was seen and is remembered"),
        _flag("held", "it is in the hand"),
        _flag("rescued", "it is rescued"),
        *_PLACE,
        Column("value", "", most, 0.0, 1.0, "what its rescue is worth undamaged"),
        _flag("flammable", "it can burn"),
        _flag("waterproof", "water does not damage it"),
        Column("ignition", "C", 300.0, 0.0, 2.0, "its ignition temperature"),
        _flag("damaged", "it was damaged when last seen"),
        *levels,
        Column("unseen", "frame", 1500.0, 0.0, 2.0, "time since it was last seen"),
        Column("failures", "", float(GIVE_UP), 0.0, 1.0, "times that fetching it failed; at 1 it is no longer offered"),
    )


CART_COLUMNS = (
    _flag("known", "it was seen and is remembered"),
    *_PLACE,
    Column("failures", "", float(GIVE_UP), 0.0, 1.0, "times that bringing there failed; at 1 it is no longer offered"),
)
LANDMARK_COLUMNS = (
    *_PLACE,
    Column("edge", "m", 10.0, 0.0, 1.0, "length of the border to unexplored floor within 2 m of it"),
    Column("visits", "", float(MOST_VISITS), 0.0, 1.0, "times that it was searched at"),
)

FIRE_COLUMNS = (
    _flag("known", "a fire is in this slot"),
    *_PLACE,
    Column("flames", "", 10.0, 0.0, 2.0, "number of its flames when last seen, as temperatures tell"),
    Column("unseen", "frame", 1500.0, 0.0, 2.0, "time since it was last seen"),
    Column("near", "value", 40.0, 0.0, 2.0, "value of known whole targets within 3 m of it that are not rescued"),
    Column("failures", "", 2.0, 0.0, 1.0, "times that putting it out failed; at 1 it is no longer offered"),
)
TOOL_COLUMNS = (
    _flag("known", "an extinguisher can be used"),
    _flag("held", "it is in the hand"),
    *_PLACE,
    Column("charge", "frame", 500.0, 0.0, 2.0, "time that it lasts"),
    Column("out", "", 4.0, 0.0, 2.0, "number of fires that were put out"),
)


def global_columns(hazards: int) -> tuple[Column, ...]:
    """The columns of the row about the whole in a task with this many `hazards`."""
    fronts = (
        Column(
            f"front_{k}", "m", 5.0, 0.0, 2.0, f"distance to where hazard {k} was seen in the upper half of its range"
        )
        for k in range(hazards)
    )
    return (
        Column("elapsed", "share", 1.0, 0.0, 1.0, "share of the episode that is over"),
        Column("remaining", "frame", 1500.0, 0.0, 2.0, "time until the episode ends"),
        _flag("holding", "something is in the hand"),
        _flag("carts", "things are safe in carts, not in a bag"),
        Column("open", "", 32.0, 0.0, 1.0, "number of targets that are known, not held and not rescued"),
        Column("unknown", "", 32.0, 0.0, 1.0, "number of targets that were not seen yet"),
        Column("rescued", "", 32.0, 0.0, 1.0, "number of targets that are rescued"),
        Column("explored", "m^2", 100.0, 0.0, 2.0, "area of the floor that was seen"),
        _flag("failed", "the last action failed"),
        *fronts,
    )
