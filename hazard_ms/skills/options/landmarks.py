"""Places to search from: remembered things near the border of the unexplored floor."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hazard_ms.sensing.semantic_map import SemanticMap
from hazard_ms.skills.decision import Decision

# radius of the floor around a landmark [m]: a look sees about that far past furniture [ours]
AROUND = 2.0
WALKABLE = 0.3  # cells whose highest point lies below this can be walked on, or nearly [m] [ours]
MIN_SPACING = 1.0  # least distance between landmarks, so that they offer different views [m] [ours]
MOST_VISITS = 2  # number of visits after which nothing new is expected around a landmark [ours]


@dataclass(frozen=True)
class Landmark:
    """A remembered thing from which to look around."""

    name: str
    position: tuple[float, float]  # [m], world frame
    edge: float  # length of the border between explored floor and the unexplored within AROUND of it [m]
    visits: int  # number of times that it was walked to in search


def frontier(seen: SemanticMap) -> NDArray[np.float64]:
    """Middles of the explored, walkable cells that touch unexplored ones [m], world frame, [P, 2]."""
    known = seen.explored
    inner = np.ones_like(known)
    inner[1:-1, 1:-1] = known[:-2, 1:-1] & known[2:, 1:-1] & known[1:-1, :-2] & known[1:-1, 2:]
    y, x = np.nonzero(known & ~inner & (seen.height < WALKABLE))
    return seen.centre_of(y, x)


def landmarks(decision: Decision, visits: Mapping[str, int], most: int) -> tuple[Landmark, ...]:
    """The `most` best landmarks, best first: much unexplored around them, a short way off, not visited yet.

    `visits`: how often each thing was walked to in search. Things in the hand, exhausted ones and those nearer than
    MIN_SPACING to a better one are left out.
    """
    border = frontier(decision.map)
    scored = []
    for index, sighting in decision.map.objects.items():
        name, place = decision.names[index], np.asarray(sighting.position[:2], dtype=np.float64)
        edge = float((np.hypot(*(border - place).T) < AROUND).sum()) * decision.map.cell
        if name == decision.held or visits.get(name, 0) >= MOST_VISITS or edge == 0.0:
            continue
        away = float(np.hypot(*(place - np.asarray(decision.agent_position))))
        score = edge / (1.0 + away) / (1 + visits.get(name, 0)) ** 2
        scored.append((score, index, Landmark(name, (float(place[0]), float(place[1])), edge, visits.get(name, 0))))
    chosen: list[Landmark] = []
    for _, _, landmark in sorted(scored, key=lambda s: (-s[0], s[1])):
        if len(chosen) < most and all(
            np.hypot(*np.subtract(landmark.position, c.position)) >= MIN_SPACING for c in chosen
        ):
            chosen.append(landmark)
    return tuple(chosen)
