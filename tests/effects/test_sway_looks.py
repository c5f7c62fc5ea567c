"""Trees and hedges sway in the wind.

In colours alone, by centimetres, as far as it is strong, and nothing beside them does.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import sapien
import torch
from sapien.render import RenderMaterial, RenderShapeBox, RenderShapeTriangleMesh

from hazard_ms.effects import sway
from hazard_ms.effects.looks import Looks
from hazard_ms.spec import Fixture
from tests.worlds.burning_room import _add, _box, _looking
from tests.worlds.looking import SIDE, Place, windy

LABELS = {"segmentation", "depth", "position", "normal"}
TREE, HIGH, WIDE = (4.0, 3.4), 3.0, 0.7  # foot and edges of a tree [m]
POST = (2.2, 1.85)  # a post before the middle of the tree [m]
EYE, DISTANCE = (0.6, 0.5, 1.5), 4.4  # of the camera, from the tree [m]
RIGHT = (0.649, -0.761)  # in the picture
WIND = 3.0  # [m/s]
MOST = 0.15  # by which the top of a tree bends in any wind [m]
FOVY = 0.75
FOCUS = SIDE / 2 / np.tan(FOVY / 2)  # [pixels]
RATE, PERIOD = 6, 48  # pictures per second, pictures


def garden(wind: float = WIND, mode: str = "full") -> Place:
    """A bright tree before a dark sky, behind a post, in a `wind` to the right [m/s]."""
    place = windy((wind * RIGHT[0], wind * RIGHT[1]), mode)
    for name, at, edges in (("tree_0", TREE, (WIDE, WIDE, HIGH)), ("post", POST, (0.05, 0.05, 3.0))):
        material = RenderMaterial(base_color=[0.0, 0.0, 0.0, 1.0], specular=0.0)
        material.emission = [0.6 if name == "post" else 0.9] * 3 + [1.0]
        _add(place.scene, name, _box(edges, material), (*at, 0.0))
    spec = replace(place.spec, fixtures=(Fixture("tree_0", "tree", "none", (*TREE, 0.0)),))
    place.looks = Looks((place.hazard,), [place.scene], (spec,), place.world, mode)
    place.camera.set_fovy(FOVY)
    place.camera.entity.set_pose(_looking(EYE, (*TREE, 1.5)))
    return place


def resting(place: Place, frame: int) -> dict[str, np.ndarray]:
    """The picture at `frame` in which nothing sways, all else equal."""
    foliage = place.looks._parts["wind"]._scenes[0]._foliage  # type: ignore[attr-defined]
    show = foliage.show
    foliage.show = lambda *_: foliage.hide()
    made = place.picture(frame)
    foliage.show = show
    return made


def named(place: Place, name: str, seen: dict[str, np.ndarray]) -> np.ndarray:
    """Which pixels show the entity of this name, [H, W]."""
    return seen["segmentation"][..., 0] == next(e.per_scene_id for e in place.scene.entities if e.name == name)


def shifts(place: Place, frame: int) -> np.ndarray:
    """By how much both edges of the tree have moved to the right, per row [pixels], [H, 2].

    Not a number beside the tree.
    """
    pictures = place.picture(frame), resting(place, frame)
    with_wind, without = (np.power(p["rgb"][..., 1] / 255.0, 2.2) for p in pictures)
    tree = named(place, "tree_0", pictures[1])
    inside = np.median(without[tree])
    made = np.full((SIDE, 2), np.nan)
    for row in np.flatnonzero(tree.sum(1) > 8):
        for k, (edge, step) in enumerate(((tree[row].argmax(), 1), (SIDE - 1 - tree[row, ::-1].argmax(), -1))):
            near = slice(max(edge - 5, 0), edge + 6)
            outside = without[row, edge - 2 * step]
            made[row, k] = -step * (with_wind[row, near] - without[row, near]).sum() / (inside - outside)
    return made


@pytest.mark.render
def test_labels_are_those_of_a_tree_at_rest() -> None:
    place = garden()
    for frame in (30, 41, 52):
        seen, still = place.picture(frame), resting(place, frame)
        assert len(LABELS & set(seen)) >= 3
        for name in LABELS & set(seen):
            np.testing.assert_array_equal(seen[name], still[name], err_msg=f"{name} at frame {frame}")
        assert (seen["rgb"] != still["rgb"]).any()


@pytest.mark.render
def test_only_what_is_beside_a_tree_changes_and_never_what_stands_before_it() -> None:
    place = garden()
    for frame in (30, 60, 90):
        seen, still = place.picture(frame), resting(place, frame)
        changed = (seen["rgb"] != still["rgb"]).any(-1)
        tree, post = (named(place, n, still) for n in ("tree_0", "post"))
        reach = int(np.ceil(MOST * FOCUS / DISTANCE * 1.2)) + 1  # pixels; the tree's near side is nearer
        around = np.zeros_like(tree)
        for row, column in np.argwhere(tree):
            around[max(row - reach, 0) : row + reach + 1, max(column - reach, 0) : column + reach + 1] = True
        assert changed.any() and post[tree.any(1)].any()
        assert not changed[~around].any() and not changed[post].any()


@pytest.mark.render
def test_it_bends_downwind_from_the_foot_on_by_centimetres_at_0_3_to_1_hertz() -> None:
    place = garden()
    moved = np.array([shifts(place, round(30 * k / RATE)) for k in range(PERIOD)])
    rows = np.flatnonzero(np.isfinite(moved).all((0, 2)))
    low, middle, high = (np.abs(moved[:, r]).mean() for r in (rows[-4:], rows[len(rows) // 2 - 4 :][:8], rows[2:8]))
    assert low < 0.12 and low < 0.5 * middle < 0.5 * high
    top = moved[:, rows[2:8]]
    assert 0.5 < np.abs(top).max() < MOST * FOCUS / (DISTANCE - WIDE)
    assert top.mean() > 0.2  # it leans
    assert np.abs(top[..., 0] - top[..., 1]).mean() < 0.5  # what it leaves shows what stands behind
    swing = top.mean((1, 2))
    power = np.abs(np.fft.rfft(swing - swing.mean())) ** 2
    main = np.fft.rfftfreq(PERIOD, 1.0 / RATE)[power.argmax()]
    assert 0.3 <= main <= 1.0


@pytest.mark.render
def test_it_bends_as_far_as_the_wind_is_strong_and_to_its_side() -> None:
    place, reach = garden(), []
    place.camera.set_fovy(FOVY / 2)
    place.camera.entity.set_pose(_looking(EYE, (*TREE, 0.8 * HIGH)))
    for speed, gust in ((0.0, 0.0), (0.2, 0.0), (0.5, 0.0), (0.5, 3.0), (WIND, 0.0), (-WIND, 0.0)):
        place.state.speed[:], place.state.gust[:] = abs(speed), gust
        place.state.heading[:] = torch.tensor(RIGHT) * (1.0 if speed >= 0.0 else -1.0)
        reach.append(np.mean([np.nanmean(shifts(place, f)) for f in range(0, 240, 24)]))
    calm, breeze, fresh, gusty, strong, back = reach
    assert calm == 0.0 < breeze < 0.7 * fresh and fresh < gusty < strong and back < -0.5 * strong


@pytest.mark.render
def test_a_picture_depends_on_the_present_state_alone() -> None:
    place = garden()
    first, speed, heading = place.picture(45)["rgb"], place.state.speed.clone(), place.state.heading.clone()
    place.state.speed[:], place.state.heading[:] = 0.0, torch.tensor([0.6, 0.8])
    assert (place.picture(200)["rgb"] != first).any()
    place.state.speed[:], place.state.heading[:] = speed, heading
    np.testing.assert_array_equal(place.picture(45)["rgb"], first)


@pytest.mark.render
@pytest.mark.parametrize("mode", ["fast", "off"])
def test_only_full_effects_sway(mode: str) -> None:
    place = garden(mode=mode)
    place.picture(30)
    assert sway.NAME not in {e.name for e in place.scene.entities}
    assert sway.NAME in {e.name for e in garden().scene.entities}


@pytest.mark.render
def test_the_largest_sway_and_other_passes_see_no_area() -> None:
    place = windy(mode="off")
    fixtures = []
    for k in range(sway.MOST_PLANTS + 2):
        name = f"hedge_{k}"
        _add(place.scene, name, RenderShapeBox([0.5, 0.2, 0.2 + 0.1 * k], RenderMaterial()), (0.5 * k, 1.0, 0.0))
        fixtures.append(Fixture(name, "hedge", "none", (0.5 * k, 1.0, 0.0)))
    effect = sway.foliage(place.scene, replace(place.spec, fixtures=tuple(fixtures)))
    assert effect is not None
    body = effect.entity.find_component_by_type(sapien.render.RenderBodyComponent)
    (shape,) = body.render_shapes
    assert isinstance(shape, RenderShapeTriangleMesh)
    (part,) = shape.parts
    assert set(np.round(2 * part.vertices[:, 0]).astype(int)) == set(range(2, sway.MOST_PLANTS + 2))
    corners = part.vertices[part.triangles]
    assert (corners == corners[:, :1]).all()
    assert sway.foliage(place.scene, place.spec) is None
