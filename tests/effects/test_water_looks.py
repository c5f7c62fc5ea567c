"""Water: seen exactly where the hazard has it, over labels that stay those of the solid scene."""

from __future__ import annotations

import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import sapien
import torch
from mani_skill.render import PREBUILT_SHADER_CONFIGS, set_shader_pack

from hazard_ms.cli.costs.effects import costs
from hazard_ms.effects.entities import PREFIX, dry_ior, materials
from hazard_ms.effects.flood import paths_of, surface_corners
from hazard_ms.effects.looks import Looks, makers
from hazard_ms.effects.shaders.common import WATER
from hazard_ms.effects.shaders.water import CUT_IOR
from hazard_ms.effects.textures import ripples
from hazard_ms.hazards.flood.flood import Flood
from hazard_ms.simulation.world import World
from hazard_ms.spec import Opening, Partition, Room
from hazard_ms.tasks.compound import hazard_compound
from tests.worlds.looking import BOX, INSIDE, OVERHEAD, flooded, picture_hashes

ROOT = Path(__file__).parents[2]
LABELS = ("segmentation", "depth", "position", "normal")
MODES = [("full", "default"), pytest.param("fast", "minimal", marks=pytest.mark.long)]
PARTED = replace(
    INSIDE,
    room=Room(
        (6.0, 5.0), openings=(Opening("doorway", "middle", 1.5, 0.9, 2.0),), partitions=(Partition("middle", "y", 3.0),)
    ),
)


@pytest.mark.render
@pytest.mark.parametrize(("mode", "stock"), MODES)
def test_labels_are_those_without_water(mode: str, stock: str) -> None:
    set_shader_pack(PREBUILT_SHADER_CONFIGS[stock])  # the pixel formats of stock packs are those of the last one
    wet, dry = flooded(0.0, mode), flooded(0.0, "off", stock)
    without = dry.picture(0)
    for frame, level in ((40, 0.05), (90, 0.2), (900, 1.5)):
        wet.state.level[:] = level
        seen = wet.picture(frame)
        assert set(seen) == set(without)
        for name in set(LABELS) & set(without):
            np.testing.assert_array_equal(seen[name], without[name], err_msg=f"{name} at {level} m")
        if level >= 0.2:
            assert (seen["rgb"] != without["rgb"]).any(-1).mean() > 0.1


@pytest.mark.render
def test_water_is_seen_where_the_hazard_has_it_and_nowhere_else() -> None:
    """At every pixel of the floor, as seen from above: the hazard's own level there decides."""
    place = flooded(0.15, view=OVERHEAD)
    seen = place.picture(60)["rgb"].astype(int)
    points = place.points()
    floor = (np.abs(points[..., 2]) < 1e-3) & (np.linalg.norm(points[..., :2] - [1.6, 2.2], axis=-1) > 0.8)
    level = (
        place.hazard.image(place.state, place.world, torch.from_numpy(points.reshape(1, -1, 3)).float())
        .reshape(points.shape[:2])
        .numpy()
    )
    place.state.level[:] = 0.0
    changed = np.abs(seen - place.picture(60)["rgb"]).max(-1)
    assert floor.mean() > 0.5
    assert (changed[floor & (level > 0.03)] > 6).mean() > 0.99
    assert changed[floor & (level == 0.0)].max() == 0


@pytest.mark.render
@pytest.mark.parametrize("mode", ["full", "fast"])
def test_the_tint_grows_with_the_depth(mode: str) -> None:
    place = flooded(0.0, mode, view=OVERHEAD)
    reds = []
    for level in (0.0, 0.3, 0.6, 1.2):
        place.state.level[:] = level
        reds.append(place.picture(100)["rgb"][20:70, 50:90, 0].mean())  # red is what water swallows first
    assert (np.diff(reds) < -4).all(), reds


@pytest.mark.render
@pytest.mark.parametrize("mode", ["full", "fast"])
def test_under_water_what_is_far_vanishes(mode: str) -> None:
    place = flooded(0.0, mode, view=((0.4, 1.0, 0.5), (4.0, 3.0, 0.1)))
    before = place.picture(100)
    place.state.level[:] = 1.5
    after = place.picture(100)
    solid, rgb = before["segmentation"][..., 0] > 0, after["rgb"].astype(int)
    far = solid & (before["depth"][..., 0] > 3000)  # [mm]
    assert (rgb[solid][:, 1] > rgb[solid][:, 0]).all()  # blue-green; the floor is brown
    assert far.sum() > 50 and rgb[far].std(0).max() < 8
    near = solid & (before["depth"][..., 0] < 1500)
    assert rgb[near].std(0).max() > rgb[far].std(0).max()


@pytest.mark.render
@pytest.mark.parametrize("mode", ["full", "fast"])
def test_what_has_been_in_the_water_looks_wet(mode: str) -> None:
    place = flooded(0.05, mode)  # the box stands where it is dry
    before = place.picture(30)
    labels = before["segmentation"][..., 0]
    box = labels == max(
        np.unique(labels), key=lambda n: (labels == n).sum() * (0 < n < 10 and (labels == n).mean() < 0.2)
    )
    place.state.fraction[0, BOX] = 1.0
    after = place.picture(30)
    assert after["rgb"][box].mean() < 0.88 * before["rgb"][box].mean()
    np.testing.assert_array_equal(after["rgb"][~box], before["rgb"][~box])


@pytest.mark.render
def test_cut_out_leaves_are_no_darker_than_other_dry_things_and_get_as_wet() -> None:
    """Ray tracing marks them in the scalar that says how wet a thing is."""
    place = flooded(0.05)
    dry = place.picture(30)["rgb"]
    place.state.fraction[0, BOX] = 1.0
    wet = place.picture(30)["rgb"]
    (material,) = (m for e in place.scene.entities if e.name == "env-0_box_0" for m in materials(e))
    material.ior += CUT_IOR - dry_ior(material)
    np.testing.assert_array_equal(place.picture(30)["rgb"], wet)
    place.state.fraction[0, BOX] = 0.0
    np.testing.assert_array_equal(place.picture(30)["rgb"], dry)
    assert material.ior == pytest.approx(CUT_IOR)


@pytest.mark.render
def test_a_picture_depends_on_the_present_state_alone() -> None:
    place = flooded(0.25)
    first = place.picture(75)["rgb"]
    assert (place.picture(76)["rgb"] != first).any()  # it moves
    place.state.level[:], place.state.fraction[0, BOX] = 1.2, 1.0
    place.picture(700)
    place.state.level[:], place.state.fraction[0, BOX] = 0.25, 0.0
    np.testing.assert_array_equal(place.picture(75)["rgb"], first)


@pytest.mark.render
@pytest.mark.long
@pytest.mark.parametrize("others", [1, 2])
def test_other_processes_draw_the_same_pixels(others: int) -> None:
    command = [sys.executable, "-m", "tests.worlds.looking"]
    children = [subprocess.Popen(command, cwd=ROOT, stdout=subprocess.PIPE, text=True) for _ in range(others)]
    mine = picture_hashes().split()
    for child in children:
        assert child.communicate(timeout=280)[0].split()[-2:] == mine


@pytest.mark.render
def test_an_update_touches_neither_world_nor_flood() -> None:
    place = flooded(0.25)
    kept = {**place.state.save(), **{k: v.clone() for k, v in vars(place.world).items() if isinstance(v, torch.Tensor)}}
    place.looks.update(place.world, {"flood": place.state}, place.world.frame)
    for name, value in kept.items():
        now = getattr(place.state, name, None)
        assert torch.equal(value, now if now is not None else getattr(place.world, name)), name


@pytest.mark.render
def test_a_stock_pack_shows_no_water() -> None:
    np.testing.assert_array_equal(
        flooded(0.3, "fast", "default").picture(50)["rgb"], flooded(0.3, "off", "default").picture(50)["rgb"]
    )


@pytest.mark.render
def test_off_adds_nothing_to_the_scene() -> None:
    assert not [e for e in flooded(0.3, "off").scene.entities if e.name.startswith(PREFIX)]
    assert len([e for e in flooded(0.3, "full").scene.entities if e.name.startswith(PREFIX)]) == 1


def test_without_a_renderer_nothing_happens() -> None:
    world = World.of((INSIDE,), [[(0.5, 0.5, 0.4)]], [[1.0]])
    flood = Flood()
    state = flood.state_type.allocate({"E": 1, "B": 1} | flood.sizes(world), "cpu")
    scene = sapien.Scene([sapien.physx.PhysxCpuSystem()])
    Looks((flood,), [scene], (INSIDE,), world, "full").update(world, {"flood": state}, world.frame)
    assert len(scene.entities) == 0


@pytest.mark.parametrize("spec", [INSIDE, PARTED], ids=["room", "parted"])
def test_the_surface_is_the_hazards_own(spec) -> None:  # noqa: ANN001
    """Every corner of the mesh stands at the hazard's own level; together they cover all that water can reach."""
    world = World.of((spec,), [[(0.5, 0.5, 0.4)]], [[1.0]])
    flood = Flood()
    state = flood.state_type.allocate({"E": 1, "B": 1} | flood.sizes(world), "cpu")
    flood.reset(state, world, torch.arange(1))
    state.level[:] = 1.4
    place, data = surface_corners(spec, paths_of(spec))
    assert (data[..., 2] == WATER).all()
    points = torch.from_numpy(np.column_stack([place.reshape(-1, 2), np.zeros(place.size // 2)])).float()[None]
    mine = state.level.item() - state.surface_slope.item() * data[..., 0].ravel()
    np.testing.assert_allclose(np.maximum(mine, 0.0), flood.image(state, world, points)[0].numpy(), atol=1e-4)
    a, b = place[:, 1] - place[:, 0], place[:, 3] - place[:, 0]
    assert np.abs(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]).sum() == pytest.approx(np.prod(spec.room.size), rel=1e-3)


@pytest.mark.render
def test_the_surface_follows_doors() -> None:
    """What is drawn ends at a door that was shut, and goes on behind it once it is open again."""
    door = Opening("door", "middle", 1.5, 0.9, 2.0, open=1.0)
    place = flooded(0.6, spec=replace(PARTED, room=replace(PARTED.room, openings=(door,))), view=OVERHEAD)
    blue = []
    for share in (1.0, 0.0, 1.0):
        place.world.openings.set_open(torch.arange(1), 0, share)
        place.hazard.advance(place.state, place.world, 1 / 30)
        place.state.level[:] = 0.6
        blue.append(place.picture(300)["rgb"].astype(int))
    differs = (abs(blue[1] - blue[0]).max(-1) > 10).mean(0)
    assert differs.mean() > 0.1 and (differs == 0.0).sum() >= 5
    assert (abs(blue[2] - blue[0]).max(-1) > 10).mean() < 0.02


def test_the_cost_of_an_unknown_task_is_not_measured() -> None:
    with pytest.raises(ValueError, match="env_id must be one of HazardFire-v1, .*, got 'HazardSnow-v1'"):
        costs("HazardSnow-v1", 3, 0)


def test_ripples_tile() -> None:
    field = ripples(64)
    assert field.shape == (64, 64, 4) and field.min() >= 0.0 and field.max() <= 1.0
    assert np.abs(field[:, 0] - field[:, -1]).max() <= np.abs(np.diff(field, axis=1)).max() + 1e-6
    assert abs(field[..., :2].mean() - 0.5) < 0.01  # still water is level


def test_water_is_drawn_before_what_is_in_front_of_it() -> None:
    """All that an effect draws hides what is drawn later behind it, so smoke drawn first would cut holes into water."""
    hazards = hazard_compound("realistic", ("wind", "fire", "flood")).hazards
    assert list(makers(hazards)) == ["flood", "fire", "wind"]
