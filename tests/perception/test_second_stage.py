"""The second stage of the small detector: what it is shown, what it says beside the first, and how it is trained."""

from __future__ import annotations

import copy
import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import torch
from safetensors.torch import load_file, save_file

from hazard_ms.perception.detectors.second_stage import (
    FIRST,
    LEAST_PIXELS,
    PREFIX,
    SECOND,
    SIZES,
    SecondNetwork,
    both,
    patch_of,
    sizes_of,
)
from hazard_ms.perception.detectors.small import Small
from hazard_ms.perception.detectors.small_network import CHANNELS, SmallNetwork
from hazard_ms.perception.training.options import TrainOptions
from hazard_ms.perception.training.pictures import read
from hazard_ms.perception.training.run import student, train
from hazard_ms.perception.training.second_stage import KEPT, KEPT_MARGIN, SIDE, changed, shown
from tests.worlds.drawn_pictures import camera, depth_to, draw

SIZE = 64  # of a picture [pixels]
CLASSES = ["apple", "box"]


def square(left: int, top: int, edge: int) -> np.ndarray:
    mask = np.zeros((SIZE, SIZE), bool)
    mask[top : top + edge, left : left + edge] = True
    return mask


def test_a_patch_shows_a_thing_in_its_middle_however_large_it_is() -> None:
    """Of a square 20 pixels wide, seen with a margin of 1.6, a patch of 64 shows 40 pixels of it; of 10 alike."""
    row = torch.arange(SIZE, dtype=torch.float32)
    given = torch.zeros(CHANNELS, SIZE, SIZE)
    given[0], given[1] = row[None, :], row[:, None]
    for left, top, edge in ((20, 16, 20), (30, 40, 10)):
        patch = patch_of(given, square(left, top, edge), 64, 1.6)
        assert float(patch[-1].sum()) == pytest.approx(40.0**2, rel=0.01)
        inside = patch[-1] > 0.5
        assert torch.equal(inside, inside.flip(0)) and torch.equal(inside, inside.flip(1))
        # from edge to edge of the patch 1.6 edges of the picture, about the middle of the thing
        assert float(patch[0, 0, -1] - patch[0, 0, 0]) == pytest.approx(1.6 * edge * 63 / 64, abs=1e-3)
        assert float(patch[0].mean()) == pytest.approx(left + (edge - 1) / 2, abs=1e-3)
        assert float(patch[1].mean()) == pytest.approx(top + (edge - 1) / 2, abs=1e-3)


def test_beside_the_picture_its_edge_goes_on_and_nothing_is_of_the_thing() -> None:
    given = torch.zeros(CHANNELS, SIZE, SIZE)
    given[0, :, 0] = 1.0
    patch = patch_of(given, square(0, 20, 20), 64, 2.0)
    assert bool((patch[0, :, :16] == 1.0).all()) and bool((patch[-1, :, :15] == 0.0).all())


def test_sizes_are_those_of_the_world() -> None:
    """A rectangle on the floor: its ends from rays to the plane, computed here, and the others by their definitions."""
    size = 256
    intrinsic, pose = camera(size)
    depth = depth_to(0.2, size).astype(np.float32)
    mask = np.zeros((size, size), bool)
    mask[150:190, 100:180] = True
    told = sizes_of(depth, (intrinsic, pose), mask)
    assert told.shape == (SIZES,) and told.dtype == np.float32
    assert told[3] == pytest.approx(0.2, abs=1e-3) and told[4] == pytest.approx(0.2, abs=1e-3)
    assert told[0] == pytest.approx(np.log(0.01), abs=0.05)  # it has no height
    rows, columns = np.nonzero(mask)
    ray = np.stack([columns + 0.5 - size / 2, size / 2 - rows - 0.5, np.full(len(rows), -intrinsic[0, 0])], -1)
    ray = ray @ pose[:3, :3].T
    place = pose[:3, 3] + ray * ((0.2 - pose[2, 3]) / ray[:, 2:])
    # a uniform bar has four standard deviations of 2 / sqrt(3) times its length
    for number, spread in ((1, place[:, 1].std()), (2, place[:, 0].std())):
        assert told[number] == pytest.approx(np.log(4.0 * spread + 0.01), abs=0.05)
    assert told[6] == pytest.approx(np.log(3200.0))
    middle = float(np.median(depth[mask]))
    assert told[5] == pytest.approx(np.log(middle), abs=1e-4)
    assert told[7] == pytest.approx(np.log(middle * np.sqrt(3200.0) / intrinsic[0, 0]), abs=1e-3)


def test_a_thing_without_depth_has_no_sizes() -> None:
    intrinsic, pose = camera(SIZE)
    assert not sizes_of(np.zeros((SIZE, SIZE), np.float32), (intrinsic, pose), square(10, 10, 8)).any()


def test_both_stages_are_weighed_in_logarithms() -> None:
    first, second = np.array([[0.6, 0.2]]), np.array([[0.1, 0.7, 0.2]])
    product = [0.6**FIRST * 0.1**SECOND, 0.2**FIRST * 0.7**SECOND, 0.2**FIRST * 0.2**SECOND]
    assert both(first, second)[0].tolist() == pytest.approx([product[0] / sum(product), product[1] / sum(product)])
    assert both(first, second)[0].argmax() == 1  # the second stage persuades


@pytest.fixture(scope="module")
def weights(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Those of an untrained first stage."""
    torch.manual_seed(0)
    path = tmp_path_factory.mktemp("weights") / "small.safetensors"
    network = SmallNetwork(len(CLASSES) + 2)
    with torch.no_grad():
        network.logits.bias[1] += 2.0  # it takes much for apples
    save_file({k: v.half() if v.ndim == 4 else v for k, v in network.state_dict().items()}, path)
    path.with_suffix(".json").write_text(json.dumps({"network": "small", "classes": CLASSES}))
    return path


def with_second(weights: Path, folder: Path, state: dict[str, torch.Tensor]) -> Path:
    """The first stage of `weights` with a second stage of this state, in a folder."""
    path = folder / "small.safetensors"
    save_file({**load_file(weights), **{f"{PREFIX}{name}": value for name, value in state.items()}}, path)
    path.with_suffix(".json").write_text(weights.with_suffix(".json").read_text())
    return path


@pytest.fixture(scope="module")
def data(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("data") / "HazardFire-v1"
    draw(folder, "test", 2, SIZE, seed=1)
    return draw(folder, "train", 6, SIZE)


def test_a_detector_says_what_its_second_stage_says_of_what_the_first_found(weights: Path, tmp_path: Path) -> None:
    sure = SecondNetwork(len(CLASSES) + 1)
    with torch.no_grad():
        sure.head.weight.zero_()
        sure.head.bias.copy_(torch.tensor([0.0, 9.0, 0.0]))  # all things are boxes
    told = []
    for file in (weights, with_second(weights, tmp_path, sure.state_dict())):
        detector = Small(str(file))
        detector.aim(*camera(SIZE))
        told.append(detector.detect(np.full((SIZE, SIZE, 3), 90, np.uint8), depth_to(0.0, SIZE).astype(np.float32)))
    before, after = told
    assert {one.category for one in before} == {"apple"}
    large = [int(one.mask.sum()) >= LEAST_PIXELS for one in after]
    assert any(large) and [one.category for one in after] == ["box" if each else "apple" for each in large]
    assert all((a.mask == b.mask).all() for a, b in zip(before, after, strict=True))
    for one in after:
        assert one.chances is not None and one.score == pytest.approx(max(one.chances) ** 0.5)


def test_weights_of_another_second_stage_are_refused(weights: Path, tmp_path: Path) -> None:
    path = with_second(weights, tmp_path, SecondNetwork(7).state_dict())
    with pytest.raises(ValueError, match="weights must fit the network small"):
        Small(str(path))


def options(data: Path, output: Path, weights: str, **more: object) -> TrainOptions:
    told = {"model": "second_stage", "steps": 4, "every": 2, "batch": 8, "weights": weights, **more}
    return TrainOptions(data=(data,), output=output, **told)  # type: ignore[arg-type]


def test_things_are_shown_as_they_are_and_as_they_are_found(weights: Path, data: Path) -> None:
    """Each thing with its number first; then what the first stage finds, a box that it takes for an apple included."""

    class Finds(Small):
        def detect(self, rgb: np.ndarray, depth: np.ndarray) -> list:  # type: ignore[type-arg]
            return self.given

    detector = Finds(str(weights))
    (picture, *_) = read((data,), "train")
    ids, names = picture.ids(), picture.categories()
    numbers = [int(number) for number in np.unique(ids) if number]
    most = max(numbers, key=lambda number: int((ids == number).sum()))
    found = ids == most
    less = found & (np.arange(SIZE)[None, :] % 3 == 0)  # a third of it: neither the thing nor none
    floor = square(0, 0, 6)
    detector.given = [type("One", (), {"mask": mask})() for mask in (found, less, floor)]
    told = list(shown(picture, detector))
    kinds = [CLASSES.index(names[number]) for number in numbers]
    assert [kind for _, kind in told] == [*kinds, CLASSES.index(names[most]), len(CLASSES)]
    assert all((mask == (ids == number)).all() for (mask, _), number in zip(told, numbers, strict=False))
    assert (told[-2][0] == found).all() and (told[-1][0] == floor).all()


def test_changed_patches_keep_their_thing_in_sight() -> None:
    kept = torch.zeros(24, CHANNELS + 1, KEPT, KEPT)
    reach = round(KEPT / KEPT_MARGIN / 2)
    middle = slice(KEPT // 2 - reach, KEPT // 2 + reach)
    kept[:, :, middle, middle] = 1.0
    made = changed(kept.clone(), np.random.default_rng(0))
    assert made.shape == (24, CHANNELS + 1, SIDE, SIDE)
    share = made[:, -1].mean((1, 2))  # zoomed, it fills 1 / (zoom * margin) of each side, its mask grown or shrunk
    assert float(share.min()) > (1 / (0.9 * KEPT_MARGIN) - 0.13) ** 2 and float(share.max()) < 0.95
    assert float(made[:, -1, SIDE // 2, SIDE // 2].min()) == pytest.approx(1.0, abs=0.01)
    assert len(np.unique(share.numpy().round(3))) > 12  # none is as another
    assert torch.equal(made, changed(kept.clone(), np.random.default_rng(0)))


def test_a_second_stage_learns_and_leaves_the_first_as_it_was(
    weights: Path, data: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert train(options(data, tmp_path, str(weights), steps=40, every=40)) == 0
    assert f"--perception small:{tmp_path / 'second_stage.safetensors'}" in capsys.readouterr().out
    made, first = load_file(tmp_path / "second_stage.safetensors"), load_file(weights)
    assert all(torch.equal(made[name], value) for name, value in first.items())
    assert sum(name.startswith(PREFIX) for name in made) == len(SecondNetwork(3).state_dict())
    learned = student(options(data, tmp_path, str(weights)), read((data,), "train"))
    assert Small(str(tmp_path / "second_stage.safetensors")).classes == learned.classes == CLASSES
    rows = (tmp_path / "second_stage.csv").read_text().splitlines()
    assert float(rows[1].split(",")[2]) < np.log(3.0)  # better than chance, of three kinds


def test_a_training_goes_on_from_both_stages(weights: Path, data: Path, tmp_path: Path) -> None:
    """It begins with the second stage that the file has; one of other categories is refused."""
    kept, pictures = SecondNetwork(len(CLASSES) + 1).state_dict(), read((data,), "train")
    both_stages = options(data, tmp_path, str(with_second(weights, tmp_path, kept)))
    made, anew = student(both_stages, pictures), student(options(data, tmp_path, str(weights)), pictures)
    assert all(torch.equal(value, kept[name]) for name, value in made.network.state_dict().items())
    assert 0.0 < made.pace(10**6, 0.0) < anew.pace(10**6, 0.0)
    first = student(replace(both_stages, model="small", size=32), pictures)
    assert not any(name.startswith(PREFIX) for name in first.weights())
    with_second(weights, tmp_path, {**kept, "head.weight": torch.zeros(7, 8)})
    with pytest.raises(ValueError, match="weights must be those of a small detector"):
        student(both_stages, pictures)


def test_an_interrupted_training_of_it_ends_with_the_same_weights(weights: Path, data: Path, tmp_path: Path) -> None:
    kinds = []
    for stops in ((4,), (2, 4)):
        torch.manual_seed(3)
        state = None
        for stop in stops:
            made = student(options(data, tmp_path, str(weights)), read((data,), "train"))
            if state is not None:
                made.resume(state)
            made.network.train()
            for step in range(0 if state is None else 2, stop):
                torch.manual_seed(step)
                loss = made.losses(np.random.default_rng([0, step]))["categories"]
                made.optimiser.zero_grad()
                loss.backward()
                made.optimiser.step()
                made.learned()
            state = copy.deepcopy(made.state())
        kinds.append(made.weights())
    assert all(torch.equal(value, kinds[1][name]) for name, value in kinds[0].items())


def test_a_second_stage_needs_a_first(data: Path, tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="weights must be those of a small detector"):
        train(options(data, tmp_path, "none"))
