"""The shipped objects and indoor furniture: enough of each kind, of plausible size, and with places for things."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh

from hazard_ms.scenes.assets.index import asset, asset_ids, asset_path
from hazard_ms.spec.catalogue import CATEGORIES, NEW_OBJECTS, WIND_POOL

PUBLISHED = tuple(c.name for c in CATEGORIES.values() if c.kind == "object")[:35]  # the pool of HAZARD's value.json
THREE = (
    "bottle",
    "book",
    "box",
    "bowl",
    "bag",
    "backpack",
    "basket",
    "soda_can",
    "phone",
    "camera",
    "plate",
    "suitcase",
)
LEVELS = (0.3, 1.0)  # things stand between these heights [m]: hazard_ms/scenes/generate/scatter.py
# [m]
LONGEST = {"suitcase": 0.8, "skate": 0.85, "vacuum_cleaner": 0.9, "backpack": 0.7, "fire_extinguisher": 0.7, "bag": 0.6}


def test_every_published_category_has_two_models_that_differ() -> None:
    assert len(PUBLISHED) == 35 and PUBLISHED[-1] == "vacuum_cleaner"
    for category in PUBLISHED:
        ids = asset_ids(category=category)
        assert len(ids) >= (3 if category in THREE else 2), category
        files = {asset(i).sha256[-1][1] for i in ids}
        sizes = {tuple(np.round(asset(i).extent, 3)) for i in ids}
        assert len(files) == len(ids) and len(sizes) > 1, category


def test_new_objects_have_models() -> None:
    assert sum(len(asset_ids(category=c)) >= 2 for c in NEW_OBJECTS) >= 12
    assert all(asset_ids(category=c) for c in (*NEW_OBJECTS, *WIND_POOL))


@pytest.mark.parametrize("name", asset_ids(kind="object"))
def test_objects_have_household_sizes(name: str) -> None:
    a = asset(name)
    assert 0.01 < max(a.extent) < LONGEST.get(a.category, 0.55)
    assert 0.0005 < a.mass < 12.0


@pytest.mark.parametrize(
    ("category", "least"),
    [("table", 6), ("shelf", 6), ("cabinet", 6), ("chair", 3), ("sofa", 2), ("bed", 2), ("stool", 2)],
)
def test_furniture_has_places_within_reach(category: str, least: int) -> None:
    """At least this many models, all but two of which carry something between knee and chest."""
    ids = asset_ids(category=category)
    with_places = [i for i in ids if any(LEVELS[0] <= s.z <= LEVELS[1] for s in asset(i).supports)]
    assert len(ids) >= least and len(with_places) >= least - 2, with_places


@pytest.mark.parametrize("name", asset_ids(category="wall_cupboard") + asset_ids(category="picture"))
def test_what_hangs_has_a_flat_back(name: str) -> None:
    """Much of the model lies in the plane of its back, at +y."""
    a = asset(name)
    scene = trimesh.load_scene(asset_path(a.visual), process=False)
    mesh = trimesh.util.concatenate([trimesh.Trimesh(p.vertices, p.faces, process=False) for p in scene.dump()])
    back = (mesh.face_normals[:, 1] > 0.99) & (mesh.triangles_center[:, 1] > a.extent[1] / 2 - 0.015)
    assert mesh.area_faces[back].sum() > 0.6 * a.extent[0] * a.extent[2]


@pytest.mark.parametrize("name", asset_ids(category="door"))
def test_doors_fill_the_opening(name: str) -> None:
    assert asset(name).extent[0] == pytest.approx(0.9, abs=0.005) and asset(name).extent[2] == pytest.approx(
        2.05, abs=0.005
    )
