"""Scenes with a chosen number of things: what is in them, and that they can be played."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

from hazard_ms.cli.costs.scaling import FIRST, THINGS, crowded, time_of_things
from hazard_ms.scenes.schema import from_json, to_json
from hazard_ms.scenes.solids import extent_of


@pytest.mark.parametrize(("env_id", "number"), [*itertools.product(FIRST, (THINGS[0], THINGS[-1]))])
def test_a_crowded_scene_holds_as_many_things_that_do_not_touch(env_id: str, number: int) -> None:
    spec = crowded(env_id, number)
    assert from_json(to_json(spec)) == spec
    assert len({body.name for body in spec.bodies}) == len(spec.bodies) == number
    assert spec.targets
    low = [np.array(body.position[:2]) - np.array(extent_of(body)[:2]) / 2 for body in spec.bodies]
    high = [np.array(body.position[:2]) + np.array(extent_of(body)[:2]) / 2 for body in spec.bodies]
    for a, b in itertools.combinations(range(number), 2):
        assert ((high[a] < low[b]) | (high[b] < low[a])).any()
    start = np.array(spec.agent_start.position)
    gaps = [np.maximum(np.maximum(near - start, start - far), 0.0) for near, far in zip(low, high, strict=True)]
    assert min(float(np.hypot(*gap)) for gap in gaps) > 0.29  # Fetch's radius [m]


def test_more_things_than_there_is_room_for_are_refused() -> None:
    with pytest.raises(ValueError, match="number"):
        crowded("HazardFire-v1", 10**4)


def test_crowded_scenes_can_be_played() -> None:
    found = time_of_things((20,), 20, 0, "realistic")
    assert [*found] == [(env_id, 20) for env_id in FIRST]
    for phases in found.values():
        assert 0.0 < phases["physics"] < phases["frame"]
