"""The catalogue against the published tables and against itself."""

from __future__ import annotations

import dataclasses
import json
from collections import Counter
from pathlib import Path

import pytest

from hazard_ms.spec.catalogue import (
    CATEGORIES,
    FIRE_POOL,
    GRASPS,
    NEW_OBJECTS,
    SOURCES,
    TEST_EXTRAS,
    WIND_POOL,
    category,
    check,
)

ORIGINAL = Path(__file__).parents[3] / "shared" / "hazard_original"
published = pytest.mark.skipif(not ORIGINAL.exists(), reason="the original benchmark's files are not here")
NUMBERED = (
    "value",
    "flammable",
    "waterproof",
    "ignition_temperature",
    "density",
    "drag_coefficient",
    "wind_resistance",
)


@published
def test_attributes_are_the_published_ones() -> None:
    table = json.loads((ORIGINAL / "categories.json").read_text())["categories"]
    ours = {c.published: c for c in CATEGORIES.values() if c.kind == "object"}
    assert len(table) == 35
    for name, row in table.items():
        c = ours[name]
        assert c.value == (5 if row["high_value"] else 1), name
        for attribute in ("flammable", "waterproof"):
            if row[attribute] is not None:
                assert getattr(c, attribute) == bool(row[attribute]), (name, attribute)
            else:
                assert c.source(attribute) == "ours", (name, attribute)


@published
def test_ignition_temperatures_marked_as_published_are_the_commonest_of_the_models() -> None:
    models = json.loads((ORIGINAL / "tdw_models.json").read_text()).values()
    tested = 0
    for c in CATEGORIES.values():
        found = Counter(m["ignition_c"] for m in models if m["category"] == c.published and m["ignition_c"] is not None)
        if c.source("ignition_temperature") == SOURCES["T"]:
            most = max(found.values())
            assert c.ignition_temperature in {t for t, n in found.items() if n == most}, (c.name, found)
            tested += 1
    assert tested >= 25


def test_pools_are_those_of_the_paper() -> None:
    fire = """bag banana plate phone hairbrush bowl pen lighter toothbrush apple key pan bottle chocolate book printer
        camera basket backpack coffee_grinder throw_pillow shirt_button"""
    wind = "bag backpack basket money box soda_can headphone suitcase phone bottle camera"
    assert set(FIRE_POOL) == set(fire.split()) and len(FIRE_POOL) == 22
    assert set(WIND_POOL) == set(wind.split()) and len(WIND_POOL) == 11
    assert set(TEST_EXTRAS) == {"suitcase", "candle"}
    assert len(NEW_OBJECTS) >= 12 and not set(NEW_OBJECTS) & set(FIRE_POOL)
    for name in (*FIRE_POOL, *WIND_POOL, *TEST_EXTRAS, *NEW_OBJECTS):
        assert CATEGORIES[name].kind == "object"


def test_every_number_has_a_source() -> None:
    for c in CATEGORIES.values():
        assert all(c.source(a) in SOURCES.values() for a in NUMBERED)
    with pytest.raises(ValueError, match="attribute with a source must be one of .*density.*, got 'colour'"):
        CATEGORIES["apple"].source("colour")


def test_wind_resistance_is_the_published_one() -> None:
    expected = {"basket": 0, "money": 0, "bottle": 0, "soda_can": 0, "bag": 1, "backpack": 2, "headphone": 2}
    expected |= {"box": 3, "phone": 3, "camera": 3}  # docs/physics.md 1.3
    assert {name: CATEGORIES[name].wind_resistance for name in expected} == expected
    assert all(c.wind_resistance > 10 for c in CATEGORIES.values() if c.kind == "fixture")  # above 10: no wind is felt


def test_what_floats() -> None:
    floats = {
        name: CATEGORIES[name].density < 1000
        for name in ("apple", "banana", "basket", "backpack", "book", "throw_pillow")
    }
    sinks = {name: CATEGORIES[name].density > 1000 for name in ("key", "plate", "phone", "pan", "knife", "scissors")}
    assert all(floats.values()) and all(sinks.values()), (floats, sinks)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"ignition_temperature": 20.0}, "ignition_temperature of 'apple' must be from 40 to 4000, got 20.0"),
        ({"density": float("nan")}, "density of 'apple' must be .* got nan"),
        ({"value": 3}, "value of 'apple' must be 1 or 5, got 3"),
        ({"kind": "fruit"}, "kind of 'apple' must be object or fixture, got 'fruit'"),
        ({"name": "Red Apple"}, "a name must be .* got 'Red Apple'"),
        ({"sources": "HH"}, "sources of 'apple' must be .* got 'HH'"),
        ({"drag_coefficient": -1.0}, "drag_coefficient of 'apple' must be .* got -1.0"),
    ],
)
def test_a_bad_row_is_refused(change: dict[str, object], message: str) -> None:
    bad = dataclasses.replace(CATEGORIES["apple"], **change)  # type: ignore[arg-type]
    with pytest.raises(ValueError, match=message):
        check([bad])


def test_names_differ_and_unknown_ones_are_refused() -> None:
    with pytest.raises(ValueError, match="names of categories must differ, got 'apple' twice"):
        check([CATEGORIES["apple"], CATEGORIES["apple"]])
    with pytest.raises(ValueError, match="category must be one of .*, got 'aple'"):
        category("aple")
    assert category("coffee_grinder").label == "coffee grinder"


def test_every_object_tells_where_to_take_it_and_no_hint_is_lost() -> None:
    named = {name for names in GRASPS.values() for name in names.split()}
    assert named <= {c.name for c in CATEGORIES.values() if c.kind == "object"}
    assert all((c.grasp in GRASPS) == (c.kind == "object") for c in CATEGORIES.values())
    assert category("mug").grasp == "handle" and category("apple").grasp == "body" and category("sofa").grasp == ""
    with pytest.raises(ValueError, match="grasp of 'mug' must be one of .*, got 'tail'"):
        check([dataclasses.replace(category("mug"), grasp="tail")])
