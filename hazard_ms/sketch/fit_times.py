"""Skill times fitted to attempts: to the decisions of played episodes, and to the rows of the probe of pick-ups."""

from __future__ import annotations

import dataclasses
import itertools
import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from hazard_ms.sketch import skill_times
from hazard_ms.sketch.skill_times import BAG, CART, NO_PATH, SKILLS, SkillRow, SkillTimes
from hazard_ms.skills import decision, failures
from hazard_ms.spec.foreign.files import printable, read_text
from hazard_ms.spec.foreign.plain import parse

LARGEST = 64_000_000  # of a probe [bytes]; a row has 300 [ours]
HEIGHTS = (-math.inf, 0.25, 0.9, math.inf)  # ends of the bands: floor, tables, shelves [m] [ours]
CLEARANCES = (-math.inf, 0.4, 0.7, math.inf)  # ends of the bands: at hand, over an edge, at arm's length [m] [ours]
FEWEST = 12  # attempts: a band with fewer takes the numbers of all bands [ours]
QUANTILES = 11  # numbers that a distribution of frames is kept as [ours]
# failures that say nothing about the skill: time ran out, or the agent asked for something impossible
NO_ATTEMPT = (
    failures.EPISODE_OVER,
    failures.UNKNOWN,
    failures.NOT_A_TARGET,
    failures.ALREADY_RESCUED,
    failures.TOO_FAR,
    failures.ALREADY_HOLDING,
    failures.NOT_HOLDING,
)


@dataclass(frozen=True)
class Attempt:
    """One attempt at a skill."""

    skill: str  # one of SKILLS
    ok: bool
    frames: int
    height: float = math.nan  # of the thing above the floor [m]; NaN if it was not recorded
    clearance: float = math.nan  # from the thing to where the robot can stand [m]


def attempt(verb: str, ok: bool, reason: str, frames: int, carts: bool, **place: float) -> Attempt | None:
    """The attempt behind an action's outcome; None for other actions and where it was not really tried.

    `carts`: whether things are safe in carts and not in a bag; `place`: height [m] and clearance [m], where known.
    """
    if reason in NO_ATTEMPT:
        return None
    if verb in (decision.PICK_UP, decision.EXPLORE):
        return Attempt(verb, ok, frames, **place)
    if verb == decision.DROP:
        return Attempt(CART if carts else BAG, ok, frames, **place)
    if verb == decision.WALK_TO and reason == failures.NO_PATH:
        return Attempt(NO_PATH, False, frames)
    return None


def probed(path: Path) -> Iterator[tuple[str, Attempt]]:
    """Robot and attempt of each row of a probe of pick-ups. Raises ValueError for a file that does not hold such rows.

    What cannot be reached from any place is left out.
    """
    try:
        rows: Sequence[dict[str, Any]] = [
            parse(line, "a row") for line in read_text(path, LARGEST).splitlines() if line
        ]
        for row in rows:
            place = {name: float(row[name]) for name in ("height", "clearance")}
            carts = float(row["distance"]) > 0.0  # the bag is at hand
            made = attempt(row["verb"], bool(row["ok"]), row["reason"], int(row["frames"]), carts, **place)
            if made is not None and row.get("reachable", True):
                yield str(row["robot"]), made
    except (ArithmeticError, ValueError, LookupError, TypeError, AttributeError) as error:
        told = printable(f"{type(error).__name__}: {error}")
        raise ValueError(f"{path} must hold rows of `hazard-ms bench --pickups`, got {told}") from None


def fit(robot: str, attempts: Iterable[Attempt], before: SkillTimes, source: str) -> SkillTimes:
    """The skill times of `robot` that its `attempts` show; a skill with too few attempts keeps its rows of `before`."""
    found = list(attempts)
    rows: list[SkillRow] = []
    for skill in SKILLS:
        tried = [a for a in found if a.skill == skill]
        kept = [row for row in before.rows if row.skill == skill]
        rows += _fitted(skill, tried, kept) if len(tried) >= FEWEST else kept
    return SkillTimes(robot, tuple(rows), source)


def _fitted(skill: str, tried: list[Attempt], before: list[SkillRow]) -> list[SkillRow]:
    """The rows of one skill: one, or for pick-ups one for each band."""
    if skill != skill_times.PICK_UP:
        return [_row(skill, tried, tried, before)]
    bands = itertools.product(itertools.pairwise(HEIGHTS), itertools.pairwise(CLEARANCES))
    made = []
    for height, clearance in bands:
        inside = [a for a in tried if _in(a.height, height) and _in(a.clearance, clearance)]
        rests_on = inside if len(inside) >= FEWEST else tried
        made.append(dataclasses.replace(_row(skill, rests_on, tried, before, height, clearance), count=len(inside)))
    return made


def _in(value: float, band: tuple[float, float]) -> bool:
    return band[0] <= value < band[1]


def _row(
    skill: str,
    tried: list[Attempt],
    every: list[Attempt],
    before: list[SkillRow],
    height: tuple[float, float] = (-math.inf, math.inf),
    clearance: tuple[float, float] = (-math.inf, math.inf),
) -> SkillRow:
    """One row; frames of an outcome that was never seen in the band are those of all, or of `before`."""

    def quantiles(ok: bool, fallback: tuple[float, ...]) -> tuple[float, ...]:
        for some in (tried, every):
            frames = [a.frames for a in some if a.ok == ok]
            if frames:
                return tuple(round(float(q), 1) for q in np.quantile(frames, np.linspace(0.0, 1.0, QUANTILES)))
        return fallback

    success = sum(a.ok for a in tried) / len(tried)
    frames, failed = quantiles(True, before[0].frames), quantiles(False, before[0].failed)
    return SkillRow(skill, len(tried), round(success, 4), frames, failed, height, clearance)
