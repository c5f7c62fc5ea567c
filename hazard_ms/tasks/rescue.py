"""The goal that all rescues share: bring the targets to a safe place before they are damaged."""

from __future__ import annotations

from collections.abc import Sequence

from hazard_ms.hazards.base import Hazard
from hazard_ms.scenes import splits
from hazard_ms.spec import Goal, Task, Term
from hazard_ms.spec.catalogue import HIGH_VALUE
from hazard_ms.tasks.episode import rewards
from hazard_ms.tasks.episode.safe_places import BAG, CART
from hazard_ms.tasks.terms import terms
from hazard_ms.tasks.words import RESCUES, worded

INFO = (
    Term("rescued", rewards.rescued, "targets that are safe", low=0.0),
    Term("targets", rewards.targets, "things to rescue", low=0.0),
    Term("value", rewards.rescued_value, "rescued value as a share of all, damaged targets half", low=0.0, high=1.0),
    Term("damaged", rewards.damaged_targets, "targets that were damaged and are not safe", low=0.0),
)
RESCUE = Goal(  # it cannot be lost: damaged targets can still be saved, for half their value
    success=rewards.all_rescued,
    dense=rewards.dense,
    sparse=rewards.rescued_now,
    largest=rewards.LARGEST,
    info=INFO,
    done="all rescued",
)


def rescue(hazards: Sequence[Hazard], family: str = "", most_value: float = HIGH_VALUE) -> Task:
    """The rescue from `hazards`: in rooms and into the bag, or in the open and into carts if one of them needs that.

    `family`: of the scenes; empty: the usual one. `most_value`: highest value of a target.
    """
    open_air = any(h.open_air for h in hazards)
    family = family or ("outdoor" if open_air else "indoor")
    place = CART if open_air else BAG
    names = " and ".join(h.name for h in hazards)
    return Task(
        scenes=lambda split: splits.scene_names(split, family),
        build=splits.scene,
        hazards=tuple(hazards),
        goal=RESCUE,
        safe_place=place,
        observations=terms(hazards, most_value),
        text=f"Put every target into {place.text} before the {names} can damage it or carry it away.",
        rewordings=worded(RESCUES, place=place.text, hazards=names),
        splits=splits.split_names(family),
    )
