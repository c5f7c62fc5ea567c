"""Camera, hazard image and target table against geometry and numbers worked out by hand."""

from __future__ import annotations

import math

import numpy as np
import pytest
import torch
from torch import Tensor

from hazard_ms.hazards.base import Hazard, State
from hazard_ms.sensing.camera import FAR, metres, points_of_depth, relabel
from hazard_ms.sensing.hazard_image import enlarge, hazard_images, sample_points
from hazard_ms.sensing.target_table import TargetTable
from hazard_ms.simulation.world import World
from hazard_ms.spec import AgentStart, Body, Room, SceneSpec
from hazard_ms.spec.catalogue import CATEGORIES
from tests.worlds.rays import Block, cast, intrinsic, looking


def small_world() -> World:
    """Two scenes: a bottle, an apple and a stool; and a backpack alone. Targets: bottle, apple, backpack."""
    start = AgentStart((0.0, 0.0))

    def scene(name: str, *bodies: Body) -> SceneSpec:
        return SceneSpec(name, Room((4.0, 4.0)), (), bodies, ("bottle", "apple", "backpack"), (), start)

    first = scene(
        "first",
        Body("table_1", "table", "none", (1.0, 2.0, 0.0)),
        Body("bottle_1", "bottle", "none", (1.0, 1.0, 0.0)),
        Body("apple_1", "apple", "none", (3.0, 1.0, 0.5)),
    )
    second = scene("second", Body("backpack_1", "backpack", "none", (2.0, 2.0, 0.0)))
    sizes = [[(0.4, 0.4, 0.4)] * 3, [(0.3, 0.2, 0.4)]]
    return World.of((first, second), sizes, [[1.0] * 3, [2.0]])


class Lamp(Hazard):
    """A level that is known everywhere: ten per metre of height, plus x."""

    name = "lamp"
    state_type = State

    def reset(self, state: State, world: World, rows: Tensor) -> None:
        return

    def advance(self, state: State, world: World, dt: float) -> None:
        return

    def damaged(self, state: State, world: World) -> Tensor:
        return torch.zeros_like(world.safe)

    def image(self, state: State, world: World, points: Tensor) -> Tensor:
        return 10.0 * points[..., 2] + points[..., 0]


def test_depth_becomes_the_points_it_was_made_from() -> None:
    """Every point of a ray-cast room lies on the floor, a wall, the ceiling or a face of the box."""
    box = Block((2.0, 1.0, 0.0), (3.0, 2.0, 0.8), 0)
    room = (5.0, 4.0, 2.6)
    pose = looking((0.7, 1.2, 1.1), (2.5, 1.7, 0.5))
    depth, label = cast(pose, 64, (box,), room)
    points, there = points_of_depth(
        torch.tensor(depth)[None], torch.tensor(intrinsic(64))[None], torch.tensor(pose)[None]
    )
    assert bool(there.all()) and points.shape == (1, 64, 64, 3)
    p = points[0].numpy()
    to_room = np.minimum(np.abs(p), np.abs(p - room)).min(-1)
    to_box = np.minimum(np.abs(p - box.low), np.abs(p - box.high)).min(-1)
    assert np.where(label == 0, to_box, to_room).max() < 1e-4
    assert (label == 0).sum() > 100


def test_the_middle_of_the_image_is_the_optical_axis() -> None:
    """A camera at 1 m that looks along +x: the middle sees straight ahead, up in the image is up, right is -y."""
    pose = torch.tensor(looking((0.0, 0.0, 1.0), (1.0, 0.0, 1.0)))[None]
    depth = torch.full((1, 64, 64), 2.0)
    points, _ = points_of_depth(depth, torch.tensor(intrinsic(64))[None], pose)
    focal = 32 / math.tan(math.pi / 3)
    assert points[0, 31, 31].tolist() == pytest.approx([2.0, 2.0 * 0.5 / focal, 1.0 + 2.0 * 0.5 / focal], abs=1e-5)
    assert points[0, 0, 0].tolist() == pytest.approx([2.0, 2.0 * 31.5 / focal, 1.0 + 2.0 * 31.5 / focal], abs=1e-4)


def test_millimetres_beyond_the_sign_bit_are_read_unsigned() -> None:
    depth = torch.tensor([[1500, 32767, 40000 - 65536]], dtype=torch.int16)
    assert metres(depth).tolist() == [pytest.approx([1.5, 32.767, 40.0])]
    with pytest.raises(ValueError, match="int64"):
        metres(torch.ones(2, dtype=torch.int64))


def test_rays_into_nothing_end_far_away_and_say_so() -> None:
    points, there = points_of_depth(torch.zeros(1, 16, 16), torch.tensor(intrinsic(16))[None], torch.eye(4)[None])
    assert not bool(there.any())
    assert points[0, ..., 2].tolist() == [[-FAR] * 16] * 16


def test_labels_come_from_the_table_of_their_own_environment() -> None:
    segmentation = torch.tensor([[[0, 1], [2, 2]], [[0, 1], [2, 2]]], dtype=torch.int16)
    label_of = torch.tensor([[-3, 7, -1], [-3, -1, 4]])
    assert relabel(segmentation[..., None], label_of).tolist() == [[[-3, 7], [-1, -1]], [[-3, -1], [4, 4]]]
    with pytest.raises(ValueError, match="3 to 5"):
        relabel(segmentation + 3, label_of)


def test_hazard_image_samples_the_first_pixel_of_each_block() -> None:
    """16 x 16 of 128 x 128: the sample (i, j) is the pixel (8 i, 8 j), at the depth that stands there."""
    pose = torch.tensor(looking((1.0, 1.0, 1.0), (2.0, 1.0, 1.0)))[None]
    depth = torch.ones(1, 128, 128)
    depth[0, 8, 16] = 3.0
    points = sample_points(depth, torch.tensor(intrinsic(128))[None], pose)
    lamp = Lamp()
    both = hazard_images(lambda at: torch.stack([lamp.image(State(), small_world(), at)] * 2, dim=1), points)
    assert both.shape == (1, 2, 16, 16) and torch.equal(both[:, 0], both[:, 1])
    image = both[:, 0]
    focal = 64 / math.tan(math.pi / 3)
    height = 1.0 + 3.0 * (64 - 8.5) / focal
    assert float(image[0, 1, 2]) == pytest.approx(10.0 * height + 1.0 + 3.0, rel=1e-4)
    height = 1.0 + 1.0 * (64 - 8.5) / focal
    assert float(image[0, 1, 3]) == pytest.approx(10.0 * height + 1.0 + 1.0, rel=1e-4)


def test_enlarged_image_repeats_each_sample() -> None:
    images = torch.arange(512.0).reshape(1, 2, 16, 16)
    large = enlarge(images, 64, 32)
    assert torch.equal(large.permute(0, 3, 1, 2), images.repeat_interleave(4, 2).repeat_interleave(2, 3))


@pytest.mark.parametrize(("height", "width"), [(100, 60), (16, 17), (48, 64)])
def test_the_sample_that_an_enlarged_image_shows_is_the_first_pixel_with_it(height: int, width: int) -> None:
    """Of every block of pixels with one sample, that sample is taken at the block's first row and column."""
    pose, depth = torch.eye(4)[None], torch.ones(1, height, width)
    points = sample_points(depth, torch.tensor(intrinsic(64))[None], pose)
    every, _ = points_of_depth(depth, torch.tensor(intrinsic(64))[None], pose)
    shown = enlarge(torch.arange(256.0).reshape(1, 1, 16, 16), height, width)[0, ..., 0]
    for number in range(256):
        row, column = (int(i.min()) for i in torch.nonzero(shown == number, as_tuple=True))
        assert torch.equal(points[0, number // 16, number % 16], every[0, row, column]), (number, row, column)


@pytest.mark.parametrize("shape", [(1, 8, 8), (1, 64, 15)])
def test_images_that_cannot_be_sampled_are_refused(shape: tuple[int, int, int]) -> None:
    with pytest.raises(ValueError, match="at least 16 pixels high and wide, got"):
        sample_points(torch.ones(shape), torch.tensor(intrinsic(64))[None], torch.eye(4)[None])


def test_target_table_tells_properties_but_no_places() -> None:
    world = small_world()
    world.held[0, 2] = world.safe[1, 0] = True
    table = TargetTable(world)
    assert table.index.tolist() == [[1, 2], [0, -1]]
    assert table.of(world.value).tolist() == [[1.0, 1.0], [5.0, 0.0]]
    backpack, (told,) = CATEGORIES["backpack"], table.rows(world, 1)
    assert (told.flammable, told.waterproof) == (backpack.flammable, backpack.waterproof)
    assert told.ignition_temperature == backpack.ignition_temperature
    assert (told.value, told.held, told.rescued) == (5.0, False, True)
    assert not hasattr(told, "position")
    rows = table.rows(world, 0, damaged={2})
    assert [(r.name, r.held, r.damaged, r.rescued) for r in rows] == [
        ("bottle_1", False, False, False),
        ("apple_1", True, True, False),
    ]


def test_target_table_with_slots() -> None:
    world = small_world()
    table = TargetTable(world, slots=5)
    assert table.of(world.position).shape == (2, 5, 3)
    assert table.of(world.position)[0, 1].tolist() == pytest.approx([3.0, 1.0, 0.7])
    assert not table.of(world.position)[1, 1:].any()
    with pytest.raises(ValueError, match="at most 1 targets, got 2"):
        TargetTable(world, slots=1)
