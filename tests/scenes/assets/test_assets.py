"""The shipped models: whose they are, that the files are what the index says, and that they stand in real physics."""

from __future__ import annotations

import hashlib
import json

import numpy as np
import pytest

from hazard_ms.scenes.assets import shipped
from hazard_ms.scenes.assets.index import asset, asset_ids, asset_path
from hazard_ms.spec.catalogue import CATEGORIES, FIRE_POOL
from tests.worlds.files.shipped_models import (
    collision_bounds,
    collision_volume,
    crossings,
    hulls_of,
    images_of,
    mesh_of,
    models,
)

FREE = {"CC0-1.0", "CC-BY-3.0", "CC-BY-3.0-US", "CC-BY-4.0", "own work"}
CREDITED = {"CC-BY-3.0", "CC-BY-3.0-US", "CC-BY-4.0"}
MADE = ("models", "hulls", "textures", "skies")
MOST_FACES = {"object": 6000, "fixture": 8200, "structure": 8200}
WHOLE_SET = 25e6  # bytes in all, at most
HULL_SLACK = 0.005  # a collision shape may stand out of the model so far [m]
FLAT, SOFT = 0.015, 0.05  # a support's height may differ by this much from the model's: furniture, cushions [m]


def test_every_row_is_free_to_ship_and_says_whose_it_is() -> None:
    rows = json.loads((shipped.root() / "index.json").read_text())
    assert {r["licence"] for r in rows} <= FREE
    credit = (shipped.root() / "ATTRIBUTION.md").read_text()
    for r in rows:
        assert r["author"].strip() and r["source"].strip(), r["id"]
        if r["licence"] in CREDITED:
            assert r["changes"].strip(), f"{r['id']}: CC-BY asks to say what was changed"
            line = next((line for line in credit.splitlines() if line.startswith(f"| {r['id']} |")), "")
            assert r["author"] in line and r["changes"] in line, r["id"]


def test_files_and_index_belong_together() -> None:
    """Every file of a row is there with its checksum; no file is without a row; nothing lies outside the folder."""
    named: dict[str, str] = {}
    for i in asset_ids():
        a = asset(i)
        assert {a.visual, a.hulls} - {""} == set(dict(a.sha256)), i
        named |= dict(a.sha256)
    for file, checksum in named.items():
        path = asset_path(file).resolve()
        assert path.is_relative_to(shipped.root().resolve()), file
        assert hashlib.sha256(path.read_bytes()).hexdigest() == checksum, file
    there = {
        str(p.relative_to(shipped.root()))
        for folder in MADE
        for p in (shipped.root() / folder).rglob("*")
        if p.is_file()
    }
    assert there == set(named)
    assert sum(asset_path(f).stat().st_size for f in named) < WHOLE_SET


def test_the_set_is_wide_enough_for_a_kitchen() -> None:
    of_pool = [c for c in FIRE_POOL if len(asset_ids(category=c)) >= 2]
    assert len(of_pool) >= 12
    assert all(asset_ids(category=c) for c in FIRE_POOL)
    furniture = {asset(i).category for i in asset_ids(kind="fixture")}
    assert {
        "counter",
        "sink",
        "stove",
        "fridge",
        "table",
        "chair",
        "shelf",
        "cabinet",
        "sofa",
        "lamp",
        "rug",
        "bin",
    } <= furniture
    assert {"wood", "tile", "plaster", "ceiling"} <= set(asset_ids(kind="texture"))


@pytest.mark.parametrize("name", [a.id for a in models()])
def test_the_model_is_what_the_index_says(name: str) -> None:
    """Size from the file to 1 mm, base at z = 0, centred, few faces, small textures."""
    a = asset(name)
    mesh = mesh_of(a.visual)
    np.testing.assert_allclose(np.ptp(mesh.vertices, axis=0), a.extent, atol=1e-3)
    low, high = mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)
    np.testing.assert_allclose([low[0] + high[0], low[1] + high[1], low[2]], 0.0, atol=1e-3)
    assert np.isfinite(mesh.vertices).all()
    assert len(mesh.faces) == a.faces <= MOST_FACES[a.kind]
    assert all(max(size) <= 512 for size in images_of(asset_path(a.visual)))


@pytest.mark.parametrize("name", [a.id for a in models()])
def test_collision_shapes_fit_the_model(name: str) -> None:
    a = asset(name)
    assert bool(a.hulls) != bool(a.boxes), "either hulls or boxes"
    low, high = collision_bounds(a)
    half = np.array(a.extent) / 2
    assert (low >= [-half[0] - HULL_SLACK, -half[1] - HULL_SLACK, -1e-3]).all()
    assert (high <= [half[0] + HULL_SLACK, half[1] + HULL_SLACK, a.extent[2] + HULL_SLACK]).all()
    if a.kind == "object":
        assert low[2] == pytest.approx(0.0, abs=1e-3), "rests on its own base"
    for hull in hulls_of(a.hulls) if a.hulls else ():
        assert len(hull.vertices) <= 64, "PhysX on the GPU takes no more"
        assert hull.convex_hull.volume == pytest.approx(abs(hull.volume), rel=0.02), "not convex"
    assert not a.hulls or len(hulls_of(a.hulls)) <= 8


@pytest.mark.parametrize("name", [a.id for a in models() if a.kind == "object"])
def test_the_mass_suits_size_and_material(name: str) -> None:
    """Mass over the volume of the collision shapes is within a factor of 8 of the catalogue's density.

    Pots are hollow.
    """
    a = asset(name)
    if a.category not in CATEGORIES:
        pytest.skip(f"{a.category} is not in the catalogue")
    ratio = a.mass / collision_volume(a) / CATEGORIES[a.category].density
    assert 1 / 8 < ratio < 8


@pytest.mark.parametrize("name", [a.id for a in models() if a.supports])
def test_supports_are_surfaces_with_air_above(name: str) -> None:
    """At 7 x 7 points of each rectangle the model has a surface at its height and nothing within its clearance."""
    a, mesh = asset(name), mesh_of(asset(name).visual)
    half = np.array(a.extent) / 2
    for s in a.supports:
        assert -half[0] <= s.min[0] < s.max[0] <= half[0] and -half[1] <= s.min[1] < s.max[1] <= half[1]
        points = [(x, y) for x in np.linspace(s.min[0], s.max[0], 7) for y in np.linspace(s.min[1], s.max[1], 7)]
        z = [crossings(mesh, x + 1e-5, y + 2e-5) for x, y in points]
        level = SOFT if a.category in ("sofa", "armchair") else FLAT
        on = np.mean([np.any(np.abs(h - s.z) < level) for h in z])
        assert on > 0.9, f"{on:.0%} of {s} is there"
        blocked = np.mean([np.any((h > s.z + level) & (h < s.z + s.clearance - 0.01)) for h in z])
        assert blocked < 0.05, f"{blocked:.0%} of the air above {s} is not free"
        boxes = np.array(a.boxes or np.zeros((0, 6)))
        tops = boxes[(np.abs(boxes[:, 2] + boxes[:, 5] - s.z) < 0.02)] if len(boxes) else boxes
        assert a.hulls or len(tops), f"no collision shape carries {s}"


@pytest.mark.long
@pytest.mark.render
def test_the_sheet_shows_each_model() -> None:
    from hazard_ms.scenes.assets.contact_sheet import CAPTION, TILE, contact_sheet

    ids = [asset_ids(category=c)[0] for c in ("bottle", "table", "book")]
    sheet = contact_sheet(ids, columns=2)
    assert sheet.shape == (2 * (TILE + CAPTION), 2 * TILE, 3) and sheet.dtype == np.uint8
    tiles = [sheet[:TILE, :TILE], sheet[:TILE, TILE:], sheet[TILE + CAPTION : 2 * TILE + CAPTION, :TILE]]
    for tile in tiles:  # the corner shows bare floor, the middle the model
        middle, corner = (
            tile[TILE // 4 : -TILE // 4, TILE // 4 : -TILE // 4].reshape(-1, 3),
            tile[:8, :8].reshape(-1, 3),
        )
        assert (np.abs(middle - corner.mean(axis=0)).max(axis=1) > 20).mean() > 0.1
    assert (sheet[TILE + CAPTION :, TILE:] == 255).all(), "no fourth model, so blank"
