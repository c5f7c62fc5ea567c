"""Numbers and sizes of scene files at their limits: what is just allowed, and what is just too much."""

from __future__ import annotations

import json

import pytest

from hazard_ms.scenes.schema import from_json, to_json
from hazard_ms.scenes.splits import scene

SPEC = scene("kitchen_a/00")
LARGEST = 4_000_000  # [characters]


def changed(**of_body: float | None) -> str:
    data = json.loads(to_json(SPEC))
    data["bodies"][0].update(of_body)
    return json.dumps(data)


def test_a_file_may_be_as_large_as_the_limit_and_no_larger() -> None:
    text = to_json(SPEC)
    assert from_json(text.ljust(LARGEST)) == SPEC
    with pytest.raises(ValueError, match=f"at most {LARGEST} characters, got {LARGEST + 1}"):
        from_json(text.ljust(LARGEST + 1))


@pytest.mark.parametrize(("name", "words"), [("friction", "friction"), ("wind_resistance", "wind resistance")])
def test_nothing_is_smoother_than_smooth(name: str, words: str) -> None:
    assert getattr(from_json(changed(**{name: 0.0})).bodies[0], name) == 0.0
    assert getattr(from_json(changed(**{name: None})).bodies[0], name) is None
    with pytest.raises(ValueError, match=f"{words} of {SPEC.bodies[0].name} must be None or at least 0, got -0.001"):
        from_json(changed(**{name: -0.001}))


def test_water_comes_from_two_different_walls_or_from_one() -> None:
    data = json.loads(to_json(SPEC))
    assert "second_flood_side" not in data  # scenes that were written before it could be given are the same bytes
    walls = [wall for wall in ("south", "east", "north", "west") if wall != SPEC.flood_side]
    for wall in walls:
        twice = from_json(json.dumps({**data, "second_flood_side": wall}))
        assert twice.second_flood_side == wall and from_json(to_json(twice)) == twice
    for wall in (SPEC.flood_side, "partition_1"):
        with pytest.raises(ValueError, match=f"second_flood_side must be one of {', '.join(walls)}, got '{wall}'"):
            from_json(json.dumps({**data, "second_flood_side": wall}))


def test_everything_weighs_something() -> None:
    assert from_json(changed(mass=0.001)).bodies[0].mass == 0.001
    for mass in (0.0, -1.0):
        with pytest.raises(ValueError, match="mass of .* must be None or above 0 kg"):
            from_json(changed(mass=mass))


def test_of_two_equal_keys_neither_counts() -> None:
    text = to_json(SPEC).replace('"flood_side"', '"name": "kitchen_a/01", "flood_side"', 1)
    with pytest.raises(ValueError, match="keys of an object must differ, got 'name' twice"):
        from_json(text)
