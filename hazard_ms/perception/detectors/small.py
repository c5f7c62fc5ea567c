"""Our own small detector, which looks at colours and depth, on one core.

Its network tells the category of every pixel and where the middle of its thing is. Pixels that point at the same place
are one thing. Where the weights have a second stage, it looks at each such thing by itself and says what it is.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import torch
from numpy.typing import NDArray
from scipy import ndimage
from torch.nn import functional

from hazard_ms.perception.detectors import second_stage
from hazard_ms.perception.detectors.second_stage import LEAST_PIXELS, SecondNetwork, SecondStage, both
from hazard_ms.perception.detectors.small_network import SCALE, SmallNetwork, features, without_normalisation
from hazard_ms.perception.detectors.weights import read_recipe, read_weights
from hazard_ms.sensing.detection.confusion import Confusion
from hazard_ms.sensing.detection.detector import Detection, Detector, box_of

NETWORK = "small"  # in the file beside the weights
SHIPPED = Path(__file__).parents[1] / "weights" / "small.safetensors"
CONFUSION = "_confusion.json"  # end of the name of the table of errors beside the weights
FOREGROUND = 0.4  # probability of all known categories together from which a pixel counts [ours]
FEWEST = 6  # pixels of a thing [ours]
STRAY = 0.1  # share of a thing's pixels below which a patch apart from the others is left out [ours]
SPREAD = 1.0  # pixels by which votes for a middle are smoothed [ours]
WINDOW = 7  # side of that in which a middle has the most votes [pixels] [ours]
FEWEST_VOTES = 0.02  # at a middle, once smoothed [ours]
NEAR = 0.35  # distance of two middles that are of one thing, as a share of the side of a square of its pixels [ours]
ASKED = 0.35  # score from which the second stage is asked what a thing is: it takes 4 ms of a core each [ours]


class Small(Detector):
    """The trained network, asked on one core or on a GPU."""

    eyes = "768x512/120"  # with fewer pixels it finds less of what is far and small (docs/perception.md)
    second: SecondStage | None  # None: the first stage alone says what things are

    def __init__(self, path: str = "") -> None:
        """Load the weights at `path`, NAME.safetensors with NAME.json beside it; by default those of the package.

        Raises ValueError for files that are missing or do not fit each other.
        """
        file = Path(path) if path else SHIPPED
        if not path and not file.is_file():
            raise ValueError(
                f"perception small must find the package's weights, got none at {SHIPPED}: reinstall hazard_ms, or "
                "train others with `hazard-ms perception train DATA -o FOLDER --model small` and give small:FILE"
            )
        self.classes = read_recipe(file.with_suffix(".json"), (NETWORK,))["classes"]
        table = file.with_name(f"{file.stem}{CONFUSION}")
        self.confusion = Confusion.read(table) if table.is_file() else None
        made, weights = SmallNetwork(len(self.classes) + 2), read_weights(file)
        try:
            second = second_stage.loaded(weights, len(self.classes))
            own = {name: value for name, value in weights.items() if not name.startswith(second_stage.PREFIX)}
            made.load_state_dict({name: value.float() for name, value in own.items()})
        except RuntimeError as error:
            raise ValueError(f"weights must fit the network small, got {file}: {str(error).splitlines()[0]}") from None
        self._use(made, second)

    @classmethod
    def of(cls, network: SmallNetwork, classes: list[str], second: SecondNetwork | None = None) -> Small:
        """The detector that asks `network`, whose classes from 1 on are the categories `classes`.

        `second`: the network of the second stage, if there is one.
        """
        made = cls.__new__(cls)
        made.classes = classes
        made._use(network, second)
        return made

    def _use(self, network: SmallNetwork, second: SecondNetwork | None) -> None:
        self._device = torch.device("cuda" if torch.cuda.is_available() else "cpu")
        self.second = SecondStage(second, self._device) if second is not None else None
        self._network = without_normalisation(network).to(self._device).to(memory_format=torch.channels_last)
        self._camera: tuple[NDArray[np.floating], NDArray[np.floating]] | None = None

    def aim(self, intrinsic: NDArray[np.floating], cam2world: NDArray[np.floating]) -> None:
        self._camera = np.asarray(intrinsic, np.float32), np.asarray(cam2world, np.float32)

    @torch.inference_mode()
    def detect(self, rgb: NDArray[np.uint8], depth: NDArray[np.float32]) -> list[Detection]:
        """Find things in the colours `rgb`, [H, W, 3], and the `depth`, [H, W] [m], of the camera told to `aim`."""
        assert self._camera is not None, "aim comes first"
        picture, far = (torch.from_numpy(np.ascontiguousarray(a)).to(self._device)[None] for a in (rgb, depth))
        matrices = (torch.from_numpy(matrix)[None].to(self._device) for matrix in self._camera)
        given = features(picture, far, *matrices)
        below, beside = (-size % SCALE for size in depth.shape)
        padded = functional.pad(given, (0, beside, 0, below)).contiguous(memory_format=torch.channels_last)
        logits, offsets = self._network(padded)
        height, width = depth.shape
        by_pixel = logits[0, :, :height, :width].permute(1, 2, 0)  # as they lie in memory, which is quicker
        chances = by_pixel.softmax(-1).permute(2, 0, 1).cpu().numpy()
        found = things(chances, offsets[0, :, :height, :width].cpu().numpy(), self.classes)
        asked = [k for k, one in enumerate(found) if one.score >= ASKED and one.mask.sum() >= LEAST_PIXELS]
        if self.second is not None and asked:
            first = np.array([found[k].chances for k in asked])
            second = self.second.chances(given[0], depth, self._camera, [found[k].mask for k in asked])
            for k, each in zip(asked, both(first, second), strict=True):
                found[k] = named(each, found[k].mask, self.classes)
        return found


def things(chances: NDArray[np.float32], offsets: NDArray[np.float32], classes: Sequence[str]) -> list[Detection]:
    """The things that the pixels of a picture point at.

    `chances`, [C + 2, H, W]: of structure, of each of `classes`, and of other things; `offsets`, [2, H, W] [pixels]:
    right and down to the middle of the thing. The score of a thing is the square root of the mean chance of its
    category in its mask: 0.5, from where agents believe it, is a chance of 0.25, where about as many of the things that
    are found are none as things are missed.
    """
    height, width = chances.shape[1:]
    known = 1.0 - chances[0] - chances[-1]
    rows, columns = np.nonzero(known >= FOREGROUND)
    if not len(rows):
        return []
    right = columns + 0.5 + offsets[0, rows, columns]
    down = rows + 0.5 + offsets[1, rows, columns]
    at = np.clip(down, 0, height - 1).astype(np.int64), np.clip(right, 0, width - 1).astype(np.int64)
    votes = np.zeros((height, width), np.float32)
    np.add.at(votes, at, 1.0)
    owner = _joined(_owners(votes)[at], np.stack([right, down], -1))
    found, by_pixel = [], chances[1:-1].transpose(1, 2, 0)
    for number in np.unique(owner[owner > 0]).tolist():
        mine = owner == number
        if mine.sum() < FEWEST:
            continue
        kept = _without_strays(rows[mine], columns[mine])
        mask = np.zeros((height, width), bool)
        mask[kept] = True
        found.append(named(by_pixel[kept].mean(0), mask, classes))
    return found


def named(chances: NDArray[np.floating], mask: NDArray[np.bool_], classes: Sequence[str]) -> Detection:
    """The thing with a `mask`, [H, W], by the `chances`, [C], of each of `classes`."""
    best = int(chances.argmax())
    return Detection(classes[best], float(np.sqrt(chances[best])), box_of(mask), mask, tuple(chances.tolist()))


def _without_strays(rows: NDArray[np.int64], columns: NDArray[np.int64]) -> tuple[NDArray[np.int64], ...]:
    """The rows and columns of the pixels at `rows` and `columns`, [P] each, without small patches beside others.

    Row by row. The largest patches stay, however small their share.
    """
    top, left = int(rows.min()), int(columns.min())
    part = np.zeros((int(rows.max()) - top + 1, int(columns.max()) - left + 1), bool)
    part[rows - top, columns - left] = True
    patches, _ = ndimage.label(part, np.ones((3, 3)))
    size = np.bincount(patches.ravel())
    size[0] = 0
    stays = size >= min(STRAY * size.sum(), size.max())
    down, right = np.nonzero(stays[patches] & part)
    return down + top, right + left


def _owners(votes: NDArray[np.float32]) -> NDArray[np.int64]:
    """For each place of a picture, [H, W], the number from 1 of the middle to which `votes` for it count."""
    smooth = ndimage.gaussian_filter(votes, SPREAD)
    peaks = (smooth == ndimage.maximum_filter(smooth, WINDOW)) & (smooth > FEWEST_VOTES)
    marks, _ = ndimage.label(peaks, np.ones((3, 3)))
    nearest = ndimage.distance_transform_edt(marks == 0, return_distances=False, return_indices=True)
    owners: NDArray[np.int64] = marks[tuple(nearest)].astype(np.int64)
    return owners


def _joined(owner: NDArray[np.int64], votes: NDArray[np.float64]) -> NDArray[np.int64]:
    """The numbers of the things, [P], to which pixels belong by their `owner`, [P], and `votes`, [P, 2] [pixels].

    Pixels of a large thing do not agree on its middle: middles that are near for the size of the thing become one.
    """
    numbers, mine, count = np.unique(owner, return_inverse=True, return_counts=True)
    sums = np.stack([np.bincount(mine, votes[:, axis]) for axis in range(2)], -1)
    middle, size, into = sums / count[:, None], count.astype(float), np.arange(len(numbers))
    kept: list[int] = []
    for k in np.argsort(-count, kind="stable").tolist():
        far = np.linalg.norm(middle[kept] - middle[k], axis=-1) / np.sqrt(size[kept] + size[k])
        if len(kept) and far.min() < NEAR:
            into[k] = kept[int(far.argmin())]
            size[into[k]] += size[k]
        else:
            kept.append(k)
    joined: NDArray[np.int64] = numbers[into][mine]
    return joined
