"""In a flat, as in a home, agents are told of its rooms, and lintels do not block doorways in the map."""

from __future__ import annotations

import numpy as np
import pytest

from hazard_ms.scenes.floor import partitions
from hazard_ms.sensing.semantic_map import CEILING, LINTELS
from hazard_ms.skills.executor import SkillEnv

LINTEL = 2.03  # height of the doorways of flats [m]


@pytest.mark.parametrize(("split", "several"), [("large", True), ("test", False)])
def test_maps_end_below_lintels_where_walls_divide_a_scene(split: str, several: bool) -> None:
    env = SkillEnv.make("HazardFire-v1", effects="off", split=split, physics="paper")
    env.reset(seed=2)
    room = env.base.specs[0].room
    assert bool(room.partitions) is several and env.brief().several_rooms is several
    assert env.seen.ceiling == (LINTELS if several else CEILING)
    assert LINTELS < LINTEL < CEILING
    if several:
        lintels = [b for b in partitions(room) if b.low > 0.0]
        assert lintels and min(b.low for b in lintels) == pytest.approx(LINTEL, abs=0.1)
        assert float(np.max(env.seen.height)) < LINTEL
    env.close()
