"""Maps of agents with detectors: what moved away without having been recognised does not bar ways for ever."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from hazard_ms.sensing.camera import STRUCTURE
from hazard_ms.sensing.far_floor import BARE_WITHIN, FLOOR
from hazard_ms.sensing.semantic_map import SemanticMap
from hazard_ms.sensing.view import View
from tests.worlds.rays import Block, cast, intrinsic, looking

ROOM = (12.0, 10.0, 3.0)
HEIGHT = 1.1  # of the eye [m]
AGENT = (2.0, 5.0)
CHAIR = Block((3.5, 4.8, 0.0), (3.9, 5.2, 0.8), STRUCTURE)  # that no detector knows


def look(seen: SemanticMap, frame: int, *blocks: Block, agent: tuple[float, float] = AGENT) -> None:
    """Along +x, a little downwards."""
    pose = looking((*agent, HEIGHT), (agent[0] + 1.0, agent[1], 0.9))
    depth, labels = cast(pose, 512, blocks, ROOM)
    seen.update(View(depth, intrinsic(512), pose, labels), frame, agent)


def empty_map(clears: bool = True) -> SemanticMap:
    """The map of an agent that knows three things, which can move."""
    return SemanticMap(AGENT, np.ones(3, bool), clears=clears)


def heights(seen: SemanticMap, low: tuple[float, ...], high: tuple[float, ...]) -> NDArray[np.float32]:
    """The heights in the cells whose middles lie between two corners [m]."""
    y, x = np.mgrid[0:256, 0:256]
    middle = seen.origin + (np.stack([x, y], -1) + 0.5) * 0.1
    return seen.height[((middle > low[:2]) & (middle < high[:2])).all(-1)]


@pytest.mark.parametrize(("clears", "gone"), [(True, True), (False, False)])
def test_where_floor_is_seen_what_stood_there_has_gone(clears: bool, gone: bool) -> None:
    """A map that trusts its labels, which tell what moves, keeps it."""
    seen = empty_map(clears)
    look(seen, 0, CHAIR)
    assert heights(seen, CHAIR.low, CHAIR.high).max() > 0.7
    look(seen, 1)
    assert (heights(seen, CHAIR.low, CHAIR.high).max() < FLOOR) == gone


def test_what_still_stands_there_stays() -> None:
    seen = empty_map()
    for frame in range(3):
        look(seen, frame, CHAIR)
    assert heights(seen, CHAIR.low, CHAIR.high).max() > 0.7


@pytest.mark.parametrize("top", [0.45, 0.75, 0.95])
def test_floor_below_a_table_does_not_end_the_table(top: float) -> None:
    """It stands on nothing here; its top is seen at a flat angle, and the floor below it between its edge and it."""
    table, seen = Block((4.0, 4.2, top - 0.05), (5.0, 5.8, top), STRUCTURE), empty_map()
    look(seen, 0, table, agent=(3.2, 5.0))
    marked = heights(seen, table.low, table.high) > FLOOR
    assert marked.mean() > 0.3
    for frame, x in enumerate((2.0, 2.6, 3.0), 1):
        look(seen, frame, table, agent=(x, 5.0))
    assert (heights(seen, table.low, table.high) > FLOOR)[marked].all()


def test_floor_farther_off_ends_nothing() -> None:
    """A look has too few points there to tell that nothing stands in a cell."""
    far = Block((AGENT[0] + BARE_WITHIN + 0.5, 4.8, 0.0), (AGENT[0] + BARE_WITHIN + 0.9, 5.2, 0.8), STRUCTURE)
    seen = empty_map()
    look(seen, 0, far)
    look(seen, 1)
    assert heights(seen, far.low, far.high).max() > 0.7


def test_a_thin_thing_keeps_its_mark() -> None:
    """A bottle 4 cm wide between the columns of pixels that mark cells: its picture says where it is."""
    for y in np.arange(5.0, 5.1, 0.01):
        bottle, seen = Block((4.2, y - 0.02, 0.0), (4.24, y + 0.02, 0.25), 1), empty_map()
        look(seen, 0, bottle)
        assert (seen.object_id == 1).any()
        assert seen.height[seen.object_id == 1].max() == pytest.approx(0.25, abs=0.03)
