"""The shipped models: whose they are, that the files are what the index says, and that they stand in real physics."""

from __future__ import annotations

import hashlib
import json
import subprocess
import sys
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh

from hazard_ms import assets
from hazard_ms.assets import Asset, asset, asset_ids, asset_path, read_row
from hazard_ms.catalogue import CATEGORIES, FIRE_POOL

FREE = {"CC0-1.0", "CC-BY-3.0", "CC-BY-3.0-US", "CC-BY-4.0", "own work"}
CREDITED = {"CC-BY-3.0", "CC-BY-3.0-US", "CC-BY-4.0"}
MADE = ("models", "hulls", "textures", "skies")
MOST_FACES = {"object": 6000, "fixture": 8200, "structure": 8200}
WHOLE_SET = 25e6  # bytes in all, at most
HULL_SLACK = 0.005  # a collision shape may stand out of the model so far [m]
FLAT, SOFT = 0.015, 0.05  # a support's height may differ so much from the model's: furniture, cushions [m]
GOOD = {
    "id": "x_1",
    "kind": "object",
    "category": "bowl",
    "visual": "models/x_1.glb",
    "licence": "CC0-1.0",
    "author": "a",
    "source": "s",
    "changes": "",
    "extent": [0.1, 0.1, 0.1],
    "mass": 0.2,
    "boxes": [[0, 0, 0.05, 0.05, 0.05, 0.05]],
    "sha256": {},
}


def models() -> list[Asset]:
    return [asset(i) for i in asset_ids() if asset(i).visual.endswith(".glb")]


@cache
def mesh_of(file: str) -> trimesh.Trimesh:
    """Vertices and faces of a file, transforms applied, in one mesh."""
    scene = trimesh.load_scene(asset_path(file), process=False)
    parts = scene.dump()
    starts = np.cumsum([0] + [len(p.vertices) for p in parts])
    faces = np.concatenate([p.faces + s for p, s in zip(parts, starts[:-1], strict=True)])
    return trimesh.Trimesh(np.concatenate([p.vertices for p in parts]), faces, process=False)


@cache
def hulls_of(file: str) -> list[trimesh.Trimesh]:
    whole = trimesh.load(asset_path(file), force="mesh", process=False)
    return list(whole.split(only_watertight=False))


def collision_bounds(a: Asset) -> np.ndarray:
    """Lowest and highest corner of the collision shapes [m], [2, 3]."""
    if a.hulls:
        return mesh_of(a.hulls).bounds
    boxes = np.array(a.boxes)
    return np.array([(boxes[:, :3] - boxes[:, 3:]).min(axis=0), (boxes[:, :3] + boxes[:, 3:]).max(axis=0)])


def collision_volume(a: Asset) -> float:
    """Volume of the collision shapes [m^3]; where they overlap it counts twice."""
    if a.hulls:
        return sum(h.convex_hull.volume for h in hulls_of(a.hulls))
    return float(sum(8 * np.prod(b[3:]) for b in a.boxes))


def crossings(mesh: trimesh.Trimesh, x: float, y: float) -> np.ndarray:
    """Heights [m] at which the vertical line through (x, y) meets the mesh."""
    a, b, c = (mesh.triangles[:, k] for k in range(3))
    area = (b[:, 0] - a[:, 0]) * (c[:, 1] - a[:, 1]) - (b[:, 1] - a[:, 1]) * (c[:, 0] - a[:, 0])
    with np.errstate(divide="ignore", invalid="ignore"):
        v = ((x - a[:, 0]) * (c[:, 1] - a[:, 1]) - (y - a[:, 1]) * (c[:, 0] - a[:, 0])) / area
        w = ((b[:, 0] - a[:, 0]) * (y - a[:, 1]) - (b[:, 1] - a[:, 1]) * (x - a[:, 0])) / area
        hit = (np.abs(area) > 1e-12) & (v >= 0) & (w >= 0) & (v + w <= 1)
    return a[hit, 2] + v[hit] * (b[hit, 2] - a[hit, 2]) + w[hit] * (c[hit, 2] - a[hit, 2])


def images_of(path: Path) -> list[tuple[int, int]]:
    """Sizes of the pictures inside a GLB."""
    scene = trimesh.load_scene(path)
    materials = [g.visual.material for g in scene.geometry.values() if hasattr(g.visual, "material")]
    return [m.baseColorTexture.size for m in materials if getattr(m, "baseColorTexture", None) is not None]


def test_every_row_is_free_to_ship_and_says_whose_it_is() -> None:
    rows = json.loads((assets.root() / "index.json").read_text())
    assert {r["licence"] for r in rows} <= FREE
    credit = (assets.root() / "ATTRIBUTION.md").read_text()
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
        assert path.is_relative_to(assets.root().resolve()), file
        assert hashlib.sha256(path.read_bytes()).hexdigest() == checksum, file
    there = {str(p.relative_to(assets.root())) for folder in MADE for p in (assets.root() / folder).rglob("*") if p.is_file()}
    assert there == set(named)
    assert sum(asset_path(f).stat().st_size for f in named) < WHOLE_SET


def test_the_set_is_wide_enough_for_a_kitchen() -> None:
    of_pool = [c for c in FIRE_POOL if len(asset_ids(category=c)) >= 2]
    assert len(of_pool) >= 12
    assert all(asset_ids(category=c) for c in FIRE_POOL)
    furniture = {asset(i).category for i in asset_ids(kind="fixture")}
    assert {"counter", "sink", "stove", "fridge", "table", "chair", "shelf", "cabinet", "sofa", "lamp", "rug", "bin"} <= furniture
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
    """Mass over the volume of the collision shapes is within a factor of 8 of the catalogue's density: pots are hollow."""
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


CHILD = """
import sys
import sapien
from sapien.physx import PhysxCollisionShapeConvexMesh as Shape
material = sapien.physx.PhysxMaterial(0.5, 0.5, 0.0)
for file in sys.argv[1:]:
    print(file, flush=True)
    print(len(Shape.load_multiple(file, [1, 1, 1], material)), flush=True)
"""


@cache
def shapes_in_sapien() -> dict[str, int]:
    """Number of convex shapes that SAPIEN makes of each file of hulls; asked in a child, for a bad hull crashes SAPIEN."""
    files = [str(asset_path(a.hulls)) for a in models() if a.hulls]
    child = subprocess.run([sys.executable, "-c", CHILD, *files], capture_output=True, text=True, check=False)
    lines = child.stdout.split("\n")
    assert child.returncode == 0, f"SAPIEN crashes when it loads {[line for line in lines if line.startswith('/')][-1]}"
    return {Path(file).name: int(number) for file, number in zip(lines[:-1:2], lines[1::2], strict=True)}


def test_sapien_makes_one_convex_shape_of_each_hull() -> None:
    made = shapes_in_sapien()
    for a in models():
        if a.hulls:
            assert made[Path(a.hulls).name] == len(hulls_of(a.hulls)), a.id


def test_all_objects_come_to_rest_where_they_are_put() -> None:
    """Dropped from 2 cm: after 3 s still, upright, at most 5 mm in the floor."""
    assert shapes_in_sapien()
    dropped = [a for a in models() if a.kind == "object"]
    poses, speeds = drop(dropped, height=0.02, seconds=3.0)
    bad = []
    for a, pose, speed in zip(dropped, poses, speeds, strict=True):
        matrix = pose.to_transformation_matrix()
        corners = hull_points(a) @ matrix[:3, :3].T + matrix[:3, 3]
        tilt = np.degrees(np.arccos(np.clip(matrix[2, 2], -1, 1)))
        lowest = corners[:, 2].min()
        faults = {"moves": speed > 0.005, "sunk": lowest < -0.005, "afloat": lowest > 0.005, "tilted": tilt > 10}
        if any(faults.values()):
            bad.append((a.id, [k for k, wrong in faults.items() if wrong], round(speed, 4), round(float(tilt), 1)))
    assert not bad


def hull_points(a: Asset) -> np.ndarray:
    """Corners of the collision shapes [m], [N, 3], asset frame."""
    if a.hulls:
        return np.asarray(mesh_of(a.hulls).vertices)
    signs = np.array(np.meshgrid([-1, 1], [-1, 1], [-1, 1])).T.reshape(-1, 3)
    return np.concatenate([np.array(b[:3]) + signs * b[3:] for b in a.boxes])


def drop(things: list[Asset], height: float, seconds: float) -> tuple[list[Any], list[float]]:
    """Final poses and speeds [m/s] of objects dropped side by side, with the masses of the index, through the code that builds scenes."""
    import sapien

    from hazard_ms.building import add_collision

    scene = sapien.Scene([sapien.physx.PhysxCpuSystem()])
    scene.set_timestep(1 / 120)
    scene.add_ground(0.0, render=False)
    entities = []
    for k, a in enumerate(things):
        builder = scene.create_actor_builder()
        add_collision(builder, a, (1.0, 1.0, 1.0))
        builder.initial_pose = sapien.Pose([k % 10, k // 10, height])
        entity = builder.build(name=a.id)
        x, y, z = a.extent
        body = entity.find_component_by_type(sapien.physx.PhysxRigidDynamicComponent)
        body.set_mass(a.mass)
        body.set_cmass_local_pose(sapien.Pose([0.0, 0.0, z / 2]))
        body.set_inertia([a.mass / 12 * (y * y + z * z), a.mass / 12 * (x * x + z * z), a.mass / 12 * (x * x + y * y)])
        entities.append(entity)
    for _ in range(round(seconds * 120)):
        scene.step()
    bodies = [e.find_component_by_type(sapien.physx.PhysxRigidDynamicComponent) for e in entities]
    return [e.get_pose() for e in entities], [float(np.linalg.norm(b.linear_velocity)) for b in bodies]


@pytest.mark.parametrize(
    ("change", "named"),
    [
        ({"kind": "monster"}, "monster"),
        ({"licence": "CC-BY-NC-4.0"}, "CC-BY-NC-4.0"),
        ({"visual": "../../secret.glb"}, "secret.glb"),
        ({"visual": "/models/x.glb"}, "/models/x.glb"),
        ({"hulls": "hulls/../../x.ply"}, "x.ply"),
        ({"extent": [0.1, 0.0, 0.1]}, "extent"),
        ({"extent": [0.1, 40.0, 0.1]}, "extent"),
        ({"extent": [0.1, float("nan"), 0.1]}, "extent"),
        ({"mass": 0.0}, "mass"),
        ({"mass": float("nan")}, "mass"),
        ({"colour": "red"}, "colour"),
    ],
)
def test_a_bad_row_is_refused_by_name(change: dict[str, Any], named: str) -> None:
    assert read_row(GOOD).id == "x_1"
    with pytest.raises(ValueError, match="x_1") as raised:
        read_row({**GOOD, **change})
    assert named in str(raised.value)


@pytest.mark.parametrize("missing", ["licence", "author", "visual", "kind"])
def test_a_row_that_lacks_an_entry_is_refused(missing: str) -> None:
    with pytest.raises(ValueError, match=missing):
        read_row({k: v for k, v in GOOD.items() if k != missing})


def test_unknown_assets_are_refused_with_the_known_ones() -> None:
    with pytest.raises(ValueError, match="'unicorn'.*table_1"):
        asset("unicorn")


@pytest.mark.render
def test_the_sheet_shows_each_model() -> None:
    from hazard_ms.contact_sheet import CAPTION, TILE, contact_sheet

    ids = [asset_ids(category=c)[0] for c in ("bottle", "table", "book")]
    sheet = contact_sheet(ids, columns=2)
    assert sheet.shape == (2 * (TILE + CAPTION), 2 * TILE, 3) and sheet.dtype == np.uint8
    tiles = [sheet[:TILE, :TILE], sheet[:TILE, TILE:], sheet[TILE + CAPTION : 2 * TILE + CAPTION, :TILE]]
    for tile in tiles:  # the corner shows bare floor, the middle the model
        middle, corner = tile[TILE // 4 : -TILE // 4, TILE // 4 : -TILE // 4].reshape(-1, 3), tile[:8, :8].reshape(-1, 3)
        assert (np.abs(middle - corner.mean(axis=0)).max(axis=1) > 20).mean() > 0.1
    assert (sheet[TILE + CAPTION :, TILE:] == 255).all(), "no fourth model, so blank"
