"""The small detector: what it looks at, how pixels become things, and files that are refused."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import torch
from safetensors.torch import save_file

from hazard_ms.perception.detectors.small import Small, things
from hazard_ms.perception.detectors.small_network import (
    CHANNELS,
    HIGHEST,
    RAISED,
    SCALE,
    SmallNetwork,
    features,
    without_normalisation,
)
from hazard_ms.sensing.camera import STRUCTURE
from hazard_ms.sensing.detection.detector import Detection, Detector
from hazard_ms.sensing.detection.own import OwnLabeller
from hazard_ms.simulation.world import World
from hazard_ms.spec import AgentStart, Body, Room, SceneSpec
from tests.worlds.drawn_pictures import PITCH, camera, depth_to
from tests.worlds.wall import view as wall

SIDE = 64  # of a picture [pixels]
CLASSES = ["apple", "box"]


def seen(height: float, size: int = SIDE, rgb: int = 0) -> torch.Tensor:
    """What the network is told, [8, H, W], of a horizontal plane at `height` [m]."""
    intrinsic, pose = (torch.from_numpy(m).float()[None] for m in camera(size))
    depth = torch.from_numpy(depth_to(height, size)).float()[None]
    return features(torch.full((1, size, size, 3), rgb, dtype=torch.uint8), depth, intrinsic, pose)[0]


def test_height_and_slope_are_those_of_the_world_wherever_the_camera_looks() -> None:
    inside = slice(SIDE // 2, SIDE - 1)  # below the horizon
    for height in (0.0, 0.1):
        told = seen(height)[:, inside, 1:-1]
        assert told[4].numpy() == pytest.approx(height / HIGHEST, abs=1e-3)
        assert told[5].numpy() == pytest.approx(height / RAISED, abs=1e-2)
        assert told[6].numpy() == pytest.approx(1.0, abs=1e-3)  # it faces up
    middle = seen(0.0)[7, SIDE // 2 - 1 : SIDE // 2 + 1, SIDE // 2]
    assert float(middle.mean()) == pytest.approx(np.sin(PITCH), abs=0.01)  # and the camera as the sine of its pitch


def test_nothing_has_no_geometry_and_colours_are_from_minus_one_to_one() -> None:
    sky = features(
        torch.tensor([[[[0, 255, 51]]]], dtype=torch.uint8).expand(1, 4, 4, 3),
        torch.zeros(1, 4, 4),
        *(torch.from_numpy(m).float()[None] for m in camera(4)),
    )[0]
    assert bool((sky[3:] == 0.0).all())
    assert sky[:3, 0, 0].tolist() == pytest.approx([-1.0, 1.0, -0.6])


def test_a_network_without_normalisation_says_the_same_and_leaves_the_trained_one_as_it_was() -> None:
    torch.manual_seed(0)
    trained = SmallNetwork(4)
    for part in trained.modules():
        if isinstance(part, torch.nn.BatchNorm2d):  # of a network that has learned something
            for values, low, high in ((part.running_mean, -1.0, 1.0), (part.running_var, 0.5, 2.0)):
                assert values is not None
                torch.nn.init.uniform_(values, low, high)
            torch.nn.init.uniform_(part.weight, 0.5, 2.0)
            torch.nn.init.uniform_(part.bias, -1.0, 1.0)
    asked = without_normalisation(trained)
    assert not any(isinstance(part, torch.nn.BatchNorm2d) for part in asked.modules())
    given = torch.rand(1, CHANNELS, SCALE, 2 * SCALE)
    with torch.inference_mode():
        for mine, theirs in zip(asked(given), trained.eval()(given), strict=True):
            assert float(theirs.std()) > 0.01
            torch.testing.assert_close(mine, theirs, rtol=1e-4, atol=1e-4)


def painted(*squares: tuple[int, int, int, int]) -> tuple[np.ndarray, np.ndarray]:
    """Chances and offsets of squares (class, left, top, edge), each sure of its class and its middle."""
    chances = np.zeros((4, SIDE, SIDE), np.float32)
    chances[0] = 1.0
    offsets = np.zeros((2, SIDE, SIDE), np.float32)
    row, column = np.indices((SIDE, SIDE)) + 0.5
    for number, left, top, edge in squares:
        window = slice(top, top + edge), slice(left, left + edge)
        chances[:, window[0], window[1]] = 0.0
        chances[3][window] = 0.1
        chances[number][window] = 0.9
        offsets[0][window] = (left + edge / 2 - column)[window]
        offsets[1][window] = (top + edge / 2 - row)[window]
    return chances, offsets


def test_pixels_that_point_at_the_same_place_are_one_thing() -> None:
    """Two apples side by side touch, and stay two."""
    chances, offsets = painted((1, 10, 10, 8), (1, 18, 10, 8), (2, 40, 30, 20))
    found = sorted(things(chances, offsets, CLASSES), key=lambda one: one.box)
    assert [(one.category, one.box) for one in found] == [
        ("apple", (10.0, 10.0, 18.0, 18.0)),
        ("apple", (18.0, 10.0, 26.0, 18.0)),
        ("box", (40.0, 30.0, 60.0, 50.0)),
    ]
    assert [int(one.mask.sum()) for one in found] == [64, 64, 400]
    assert all(one.score == pytest.approx(0.9**0.5, abs=1e-4) for one in found)


def test_a_large_thing_whose_pixels_disagree_on_its_middle_is_one_thing() -> None:
    chances, offsets = painted((2, 10, 10, 40))
    offsets *= 0.6  # they all fall short of it
    (found,) = things(chances, offsets, CLASSES)
    assert int(found.mask.sum()) == 1600


def test_a_thing_has_no_stray_pixels_but_may_be_seen_in_two_parts() -> None:
    chances, offsets = painted((1, 10, 10, 12))
    chances[:, 10:22, 15:17] = np.array([1.0, 0.0, 0.0, 0.0])[:, None, None]  # something stands before it
    chances[:, 40, 50], offsets[:, 40, 50] = (0.0, 0.9, 0.0, 0.1), (16 - 50.5, 16 - 40.5)
    (found,) = things(chances, offsets, CLASSES)
    assert int(found.mask.sum()) == 12 * 10 and found.box == (10.0, 10.0, 22.0, 22.0)


def test_a_thing_in_many_small_patches_keeps_its_largest() -> None:
    """Branches before it may leave a thing in patches none of which has a tenth of its pixels."""
    squares = [(1, 4 + 8 * column, 4 + 8 * row, 2) for row in range(5) for column in range(5)]
    chances, offsets = painted(*squares, (1, 30, 44, 3))
    down, right = np.mgrid[:SIDE, :SIDE] + 0.5
    offsets[:] = 24.0 - right, 30.0 - down  # all point at one place
    [found] = things(chances, offsets, CLASSES)
    assert found.mask.sum() == 9 and found.mask[44:47, 30:33].all()


def test_other_things_and_specks_are_not_told() -> None:
    chances, offsets = painted((1, 10, 10, 2), (3, 30, 30, 10))
    assert things(chances, offsets, CLASSES) == []


@pytest.fixture(scope="module")
def weights(tmp_path_factory: pytest.TempPathFactory) -> Path:
    torch.manual_seed(0)
    path = tmp_path_factory.mktemp("weights") / "small.safetensors"
    network = SmallNetwork(len(CLASSES) + 2)
    save_file({k: v.half() if v.ndim == 4 else v for k, v in network.state_dict().items()}, path)
    path.with_suffix(".json").write_text(json.dumps({"network": "small", "classes": CLASSES}))
    return path


def test_pictures_may_have_any_size(weights: Path) -> None:
    detector = Small(str(weights))
    size = 50  # no multiple of what the network halves
    detector.aim(*camera(size))
    found = detector.detect(np.zeros((size, size, 3), np.uint8), depth_to(0.0, size).astype(np.float32))
    assert found and all(one.mask.shape == (size, size) and one.category in CLASSES for one in found)


def test_the_weights_take_less_than_eight_megabytes(weights: Path) -> None:
    assert weights.stat().st_size < 8e6


@pytest.mark.parametrize(
    ("recipe", "told"),
    [
        (None, "there is no file .*small.json"),
        ({"network": "resnet18_fpn", "classes": CLASSES}, "must hold the network small and its classes"),
        ({"network": "small", "classes": ["apple", "apple"]}, "must be a list of distinct categories"),
        ({"network": "small", "classes": ["apple", "unicorn"]}, "a class in .* must be one of"),
        ({"network": "small", "classes": ["apple"]}, "weights must fit the network small"),
    ],
)
def test_files_that_do_not_fit_are_refused(weights: Path, tmp_path: Path, recipe: object, told: str) -> None:
    path = tmp_path / "small.safetensors"
    path.symlink_to(weights)
    if recipe is not None:
        path.with_suffix(".json").write_text(json.dumps(recipe))
    with pytest.raises(ValueError, match=told):
        Small(str(path))


def test_without_weights_the_command_that_trains_them_is_named(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr("hazard_ms.perception.detectors.small.SHIPPED", tmp_path / "small.safetensors")
    with pytest.raises(ValueError, match="hazard-ms perception train DATA -o FOLDER --model small"):
        Small()


class Camera(Detector):
    """Finds nothing, and notes what is told before each picture."""

    told: tuple[np.ndarray, np.ndarray] | None = None
    at_picture: tuple[np.ndarray, np.ndarray] | None = None

    def aim(self, intrinsic: np.ndarray, cam2world: np.ndarray) -> None:
        self.told = intrinsic, cam2world

    def detect(self, rgb: np.ndarray, depth: np.ndarray) -> list[Detection]:
        self.at_picture = self.told
        return []


def test_a_detector_knows_where_the_camera_of_each_picture_is() -> None:
    spec = SceneSpec(
        "test/one",
        Room((8.0, 8.0)),
        (),
        (Body("mug_1", "mug", "", (2.0, 0.0, 0.9)),),
        ("mug",),
        (),
        AgentStart((0.0, 0.0)),
    )
    detector = Camera()
    labeller = OwnLabeller(World.of((spec,), [[(0.1, 0.1, 0.1)]], [[1.0]]), (), detector, 0.5)
    seen = wall(4.0)
    labels = np.full(seen.depth.shape, STRUCTURE, np.int64)
    labeller.view(np.zeros((*seen.depth.shape, 3), np.uint8), replace(seen, labels=labels), 0)
    assert detector.at_picture is not None
    assert all(np.array_equal(a, b) for a, b in zip(detector.at_picture, (seen.intrinsic, seen.cam2world), strict=True))
