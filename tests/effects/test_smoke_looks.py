"""The layer of smoke of a realistic fire dims the scene behind it, over labels that stay those of the scene."""

from __future__ import annotations

import numpy as np
import pytest
import torch

from hazard_ms.effects.fire import above_water
from hazard_ms.hazards.presets import fire
from tests.hazards.fire.test_blaze import REAL, begin, run, with_room
from tests.worlds.fire_worlds import room_world
from tests.worlds.looking import INSIDE, Place


@pytest.mark.render
@pytest.mark.parametrize("mode", ["full", "fast"])
def test_smoke_dims_by_its_density_and_only_from_inside(mode: str) -> None:
    place = Place(fire("realistic"), INSIDE, mode)  # eyes are at 1.4 m
    seen = []
    for height, density in ((2.6, 0.0), (2.0, 3.0), (1.0, 1.0), (1.0, 3.0)):
        place.state.smoke_height[:], place.state.smoke_density[:] = height, density
        seen.append(place.picture(10))
    clear, above, thin, thick = (s["rgb"].astype(float) for s in seen)
    np.testing.assert_array_equal(above, clear)
    solid = seen[0]["segmentation"][..., 0] > 0
    assert thick[solid].mean() < thin[solid].mean() - 5 < clear[solid].mean() - 10
    for name in {"segmentation", "depth", "position", "normal"} & set(seen[0]):
        np.testing.assert_array_equal(seen[3][name], seen[0][name], err_msg=name)


@pytest.mark.render
def test_a_spectator_sees_through_smoke_and_the_robot_does_not() -> None:
    place = Place(fire("realistic"), INSIDE)
    state, world = {"fire": place.state}, place.world
    place.state.smoke_height[:] = 0.3
    seen = {}
    for density in (0.0, 1.0, 12.0):
        place.state.smoke_density[:] = density
        seen[density] = place.picture(10)
    solid = seen[0.0]["segmentation"][..., 0] > 0
    clear, _, thick = (s["rgb"][solid].astype(float).std() for s in seen.values())
    assert thick < 0.1 * clear  # the robot sees nothing
    shown = []
    for density in (1.0, 12.0):
        place.state.smoke_density[:] = density
        place.looks.update(world, state, world.frame, spectator=True)
        place.scene.update_render()
        place.camera.take_picture()
        shown.append(place.camera.get_picture("Color")[..., :3][solid].astype(float))
    assert shown[1].std() > 0.3 * shown[0].std() and shown[1].mean() < shown[0].mean()  # more smoke is darker still
    np.testing.assert_array_equal(place.picture(10)["rgb"], seen[12.0]["rgb"])  # and the robot's eyes come after


@pytest.mark.render
@pytest.mark.parametrize("mode", ["full", "fast"])
def test_air_below_the_layer_dims_like_smoke_as_dense(mode: str) -> None:
    """Beer and Lambert: exp(-K d) of a way d, whichever layer it lies in; of half of each, that of the mean."""
    place = Place(fire("realistic"), INSIDE, mode)
    state, seen = place.state, {}
    cases = {"clear": (9.0, 0.0, 0.0), "above": (0.0, 0.4, 0.0), "below": (9.0, 0.0, 0.4), "both": (1.4, 0.4, 0.4)}
    for name, (height, dense, low) in (cases | {"thicker": (9.0, 0.0, 0.8)}).items():
        state.smoke_height[:], state.smoke_density[:], state.smoke_low_density[:] = height, dense, low
        seen[name] = place.picture(10)["rgb"].astype(float)
    assert seen["clear"].mean() > seen["below"].mean() + 10.0 > seen["thicker"].mean() + 15.0
    for name in ("above", "both"):
        assert np.abs(seen[name] - seen["below"]).max() <= 1.0


def test_the_air_below_that_pictures_show_is_that_of_the_agents_room() -> None:
    world = with_room(room_world([], [(2.0, 2.0)], size=(4.0, 4.0), agent=(3.0, 3.0)), floor="tile")
    state = begin(REAL, world)
    run(REAL, state, world, 1.0)
    state.zone_air[..., 2] += 0.01  # soot in the air below [kg]
    run(REAL, state, world, 1.0)
    assert float(state.smoke_low_density) == float(state.zone_low_density[0, 0]) > 0.1


def test_flames_on_the_floor_burn_above_the_water() -> None:
    """What burns at first stands above the water, so its flames do, too; dry places stay as they are."""
    world = room_world()
    flames = torch.tensor([[[1.0, 1.0, 0.0], [3.0, 1.0, 0.1]]])
    assert torch.equal(above_water(world, flames), flames)
    world.fields = {"water": lambda points: 0.2 * points[..., 0] - 0.3}  # 0.1 m below the floor, 0.3 m above it
    lifted = above_water(world, flames)
    assert torch.allclose(lifted, torch.tensor([[[1.0, 1.0, 0.0], [3.0, 1.0, 0.3]]]))
