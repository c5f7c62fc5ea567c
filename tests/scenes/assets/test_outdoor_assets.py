"""The models of outdoor scenes.

Carts keep what is put into them, bodies stop at what stands around, grounds tile, skies load.
"""

from __future__ import annotations

from typing import Any

import cv2
import numpy as np
import pytest

from hazard_ms.scenes.assets.index import asset, asset_ids, asset_path
from hazard_ms.scenes.assets.rows import Asset
from hazard_ms.scenes.materials import MATERIALS
from hazard_ms.spec.catalogue import CATEGORIES

STEP = 1 / 120  # [s]
WANTED = {
    "cart": 2,
    "house": 3,
    "fence": 3,
    "hedge": 2,
    "tree": 3,
    "street_lamp": 2,
    "bench": 2,
    "trash_bin": 2,
    "car": 3,
    "hydrant": 1,
}
STREET = (
    "mailbox",
    "traffic_cone",
    "bollard",
    "kiosk",
    "bus_stop",
    "picnic_table",
    "slide",
    "sandbox",
    "planter",
    "traffic_sign",
    "shed",
)
GROUNDS = (
    "asphalt",
    "pavement",
    "grass",
    "gravel",
    "brick",
    "soil",
    "parquet",
    "dark_tile",
    "wallpaper_stripes",
    "wallpaper_flowers",
)
SHARE = 9e6  # bytes of all outdoor models together, at most
HEAVIEST = {"tree": 400e3, "car": 400e3}  # bytes of one file, at most


def outdoor() -> list[Asset]:
    return [asset(i) for category in (*WANTED, *STREET) for i in asset_ids(category=category)]


def scene_with(a: Asset) -> Any:
    """The asset as a static actor on the ground, through the code that builds scenes."""
    import sapien

    from hazard_ms.simulation.building import add_collision

    scene = sapien.Scene([sapien.physx.PhysxCpuSystem()])
    scene.set_timestep(STEP)
    scene.add_ground(0.0, render=False)
    builder = scene.create_actor_builder()
    add_collision(builder, a, (1.0, 1.0, 1.0))
    builder.initial_pose = sapien.Pose()
    builder.build_static(name=a.id)
    return scene


def body(
    scene: Any,
    shape: str,
    half: float,
    at: tuple[float, float, float],
    velocity: tuple[float, float, float] = (0, 0, 0),
) -> Any:
    """A ball of radius `half` or a cube of edge 2 `half` [m], 0.3 kg, that moves through `at` with `velocity` [m/s]."""
    import sapien

    builder = scene.create_actor_builder()
    if shape == "ball":
        builder.add_sphere_collision(radius=half)
    else:
        builder.add_box_collision(half_size=[half] * 3)
    builder.initial_pose = sapien.Pose(list(at))
    entity = builder.build(name=shape)
    component = entity.find_component_by_type(sapien.physx.PhysxRigidDynamicComponent)
    component.set_mass(0.3)
    component.set_linear_velocity(list(velocity))
    return entity


def run(scene: Any, seconds: float) -> None:
    for _ in range(round(seconds / STEP)):
        scene.step()


def test_there_is_enough_for_a_street() -> None:
    for category, least in WANTED.items():
        assert len(asset_ids(category=category, kind="fixture")) >= least, category
    assert sum(bool(asset_ids(category=c)) for c in STREET) >= 6
    assert all(a.category in CATEGORIES and a.mass > 0.0 for a in outdoor())
    assert not [i for i in asset_ids(category="bin") if i.startswith("trash")], (
        "indoor scenes draw from the category bin"
    )


def test_the_outdoor_models_are_small_files() -> None:
    size = {a.id: asset_path(a.visual).stat().st_size for a in outdoor()}
    assert sum(size.values()) < SHARE
    assert all(size[a.id] <= HEAVIEST.get(a.category, 500e3) for a in outdoor())


@pytest.mark.parametrize("name", asset_ids(category="cart"))
def test_a_cart_has_the_size_of_one(name: str) -> None:
    x, y, z = asset(name).extent
    assert 0.5 < x < 0.65 and 0.8 < y < 1.0 and 0.9 < z < 1.1
    (floor,) = asset(name).supports
    assert floor.max[0] - floor.min[0] >= 0.38 and floor.max[1] - floor.min[1] >= 0.65, "room for a suitcase"


@pytest.mark.parametrize("name", asset_ids(category="cart"))
def test_a_cart_is_hollow(name: str) -> None:
    """No collision box reaches into the basket: 0.45 m wide, 0.72 m long, from its floor to above the rim."""
    a = asset(name)
    (floor,) = a.supports
    middle = np.append(np.add(floor.min, floor.max) / 2, floor.z + 0.01 + 0.5)
    for box in np.array(a.boxes):
        apart = np.abs(box[:3] - middle) - box[3:] - [0.225, 0.36, 0.5]
        assert (apart > 0).any(), box


@pytest.mark.parametrize("shape", ["ball", "box"])
@pytest.mark.parametrize("name", asset_ids(category="cart"))
def test_what_is_dropped_into_a_cart_stays_in(name: str, shape: str) -> None:
    """Nine things dropped one after the other from over the rim, some with a push.

    All lie between the basket's floor and its rim.
    """
    a = asset(name)
    (floor,) = a.supports
    scene, dropped = scene_with(a), []
    for k, (x, y) in enumerate((x, y) for x in (-0.12, 0.0, 0.12) for y in (-0.2, 0.0, 0.2)):
        dropped.append(body(scene, shape, 0.04, (x, y, 1.15), (0.3 * (k % 3 - 1), 0.3 * (k // 3 - 1), 0.0)))
        run(scene, 0.4)
    run(scene, 1.5)
    half = np.array(a.extent) / 2
    for entity in dropped:
        x, y, z = entity.get_pose().p
        assert floor.z < z < 0.9 and abs(x) < half[0] and abs(y) < half[1], (entity.name, x, y, z)


@pytest.mark.parametrize("name", [a.id for a in outdoor() if a.category != "sandbox"])
def test_what_the_wind_drives_stops(name: str) -> None:
    """Two balls slide over the ground at 6 m/s towards the middle of the thing, along x and along y.

    Neither gets past it.
    """
    a = asset(name)
    boxes = np.array(a.boxes)
    for axis in (0, 1):
        scene = scene_with(a)
        low = boxes[boxes[:, 2] - boxes[:, 5] < 0.1]  # stands on the ground
        assert len(low), "nothing of it stands on the ground"
        aim = low[low[:, 3:].prod(axis=1).argmax()]
        at, velocity = [float(aim[0]), float(aim[1]), 0.12], [0.0, 0.0, 0.0]
        at[axis], velocity[axis] = -a.extent[axis] / 2 - 0.6, 6.0
        ball = body(scene, "ball", 0.11, (at[0], at[1], at[2]), (velocity[0], velocity[1], 0.0))
        run(scene, 1.5)
        assert ball.get_pose().p[axis] < aim[axis], f"along {'xy'[axis]}"


@pytest.mark.parametrize("name", asset_ids(category="tree"))
def test_a_robot_can_stand_under_a_crown(name: str) -> None:
    """Where the crown does not reach the ground, it is no obstacle up to 1.8 m: only the stem is."""
    boxes = np.array(asset(name).boxes)
    assert (np.abs(boxes[:, :2]) + boxes[:, 3:5]).max() <= 0.35


@pytest.mark.parametrize("name", [i for i in asset_ids(kind="texture") if i in MATERIALS])
def test_a_texture_tiles_and_has_the_colour_of_its_material(name: str) -> None:
    """No seam: opposite edges differ no more than neighbouring rows do.

    Its mean is the material's colour, linear, red green blue.
    """
    pixels = cv2.imread(str(asset_path(asset(name).visual)))[..., ::-1].astype(float)
    assert max(pixels.shape[:2]) <= 512
    if name not in GROUNDS:
        return
    grey = pixels.mean(axis=2)
    for image in (grey, grey.T):
        steps = np.abs(np.diff(image, axis=0)).mean(axis=1)
        assert np.abs(image[0] - image[-1]).mean() <= 1.2 * steps.max()
    c = pixels / 255.0
    linear = np.where(c <= 0.04045, c / 12.92, ((c + 0.055) / 1.055) ** 2.4).mean(axis=(0, 1))  # IEC 61966-2-1
    np.testing.assert_allclose(linear, MATERIALS[name], atol=0.03)


def test_grounds_are_materials_with_textures() -> None:
    assert set(GROUNDS) <= set(asset_ids(kind="texture")) & set(MATERIALS)
    assert set(asset_ids(kind="texture")) <= set(MATERIALS)


def test_there_are_three_small_skies() -> None:
    found = asset_ids(kind="sky")
    assert {"sky_day", "sky_storm", "sky_evening"} <= set(found)
    for name in found:
        data = asset_path(asset(name).visual).read_bytes()
        assert len(data) < 1.3e6 and data[1:7] == b"KTX 20", f"{name} is no KTX file"
        faces, levels = np.frombuffer(data[36:44], np.uint32)
        assert faces == 6 and levels >= 5, f"{name} has no blurred levels: SAPIEN would take a minute to make them"
