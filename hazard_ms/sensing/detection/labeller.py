"""Labellers stand between camera and map: they say which pixels are which thing, and which things an agent knows of.

`Labeller` is the contract and, as it stands, the simulator's truth, in which an agent's index of a thing is that along
B. `PublishedLabeller` takes categories and masks from a detector, and indices from the truth, as the paper did.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import torch
from numpy.typing import NDArray
from scipy import ndimage

from hazard_ms.sensing.camera import AGENT, NOTHING, STRUCTURE
from hazard_ms.sensing.detection.detector import Box, Detection, Detector, PrivilegedDetector, Truth, overlap
from hazard_ms.sensing.target_table import Target, TargetTable
from hazard_ms.sensing.view import View
from hazard_ms.simulation.world import World
from hazard_ms.spec.catalogue import CATEGORIES

THRESHOLD = 0.5  # score from which a detection counts [ours]


class Labeller:
    """The things of an episode of one environment, as its agent knows them: here, the truth."""

    withheld = False  # whether agents are kept from the labels of pictures
    needs_colours = False  # whether each look must show colours

    def __init__(self, world: World, containers: Sequence[str] = ()) -> None:
        """Begin an episode in `world`; `containers`: names of its carts."""
        self._world, self._table = world, TargetTable(world)
        self.names: tuple[str, ...] = world.names[0]  # by the agent's index
        self.containers: tuple[str, ...] = tuple(containers)  # names of those that are known to exist, or believed to
        # by the agent's index: whether it can move; in the world's own memory, so furniture that floats off is, too
        self.loose: NDArray[np.bool_] = world.movable[0].cpu().numpy()

    def view(self, rgb: NDArray[np.uint8] | None, true: View, frame: int) -> View:
        """The view that the agent gets of the picture `rgb`, [H, W, 3], of `frame`, whose labels are the `true` ones.

        Labels of its view are the agent's indices. There is no picture where the class needs no colours.
        """
        return true

    def index(self, name: str) -> int:
        """The agent's index of the thing called `name`. Raises ValueError if no thing has that name."""
        return self._world.index(0, name)

    def thing(self, index: int) -> int:
        """Index along B of what a hand meets where the agent believes the thing `index` to be; -1: nothing."""
        return index

    def reach_for(self, index: int) -> int:
        """Index along B of what a hand meets that now reaches for the thing `index`, and takes, whatever looks tell."""
        return self.thing(index)

    def half_width(self, index: int) -> float:
        """The greatest horizontal distance of a point of the thing `index` from its middle that is believed [m]."""
        return float(self._world.extent[0, index, :2].norm()) / 2

    def targets(self, damaged: frozenset[int] = frozenset()) -> tuple[Target, ...]:
        """The things to rescue as the agent knows them; `damaged`: indices of those that it has seen damaged."""
        return self._table.rows(self._world, 0, damaged)

    def damaged(self, true: NDArray[np.bool_]) -> NDArray[np.bool_] | None:
        """Whether an agent that sees a thing is told that it is damaged, from the `true` flags, [B]; None: never."""
        return true

    def unmapped(self) -> list[int]:
        """Indices of the things that are not on the map: they are in the hand or rescued."""
        world = self._world
        return torch.nonzero(world.held[0] | world.away[0]).flatten().tolist()

    @property
    def held(self) -> str | None:
        """Name of the thing in the hand."""
        held = torch.nonzero(self._world.held[0]).flatten().tolist()
        return self.names[held[0]] if held else None

    def missed(self, index: int) -> None:
        """Nothing that can be used was within reach where the agent believes the thing `index` to be."""

    def refused(self, index: int, other: bool) -> None:
        """The hand has not taken what the agent knows as the thing `index`; `other`: it met something else."""

    def took(self, index: int) -> None:
        """The hand has taken what the agent knows as the thing `index`."""


class DetectingLabeller(Labeller):
    """Base of labellers that ask a detector; labels that are neither things nor the robot's own are STRUCTURE."""

    withheld = True
    needs_colours = True

    def __init__(
        self, world: World, containers: Sequence[str], detector: Detector, threshold: float, fused: bool = False
    ) -> None:
        """Begin an episode in `world`; detections of `detector` with a score below `threshold` do not count.

        `fused`: whether looks are fused by the errors of the detector, where these are known.
        """
        super().__init__(world, containers)
        self._detector, self._threshold = detector, threshold
        self._confusion = detector.confusion if fused else None
        self._categories = tuple(thing.category for thing in world.specs[0].things)
        wanted = [target.category for target in self._table.rows(world)]
        wanted += [self._categories[world.index(0, name)] for name in containers]
        furniture = [name for name, row in CATEGORIES.items() if row.kind == "fixture"]
        detector.begin(tuple(dict.fromkeys([*wanted, *furniture])))

    def _detect(self, rgb: NDArray[np.uint8] | None, true: View, frame: int) -> list[Detection]:
        """What counts of the detections in a picture, the surest last. Raises ValueError for masks of another kind."""
        assert rgb is not None
        assert true.labels is not None
        if isinstance(self._detector, PrivilegedDetector):
            seed = int(self._world.chance.seed[0])
            self._detector.truth = Truth(true.labels, self._categories, seed, frame)
        self._detector.aim(true.intrinsic, true.cam2world)
        made = self._detector.detect(rgb.copy(), true.depth.copy())  # which it may write on
        found = [d for d in made if d.score >= self._threshold]
        for mask in (detection.mask for detection in found):
            if mask.shape != true.depth.shape or mask.dtype != bool:
                raise ValueError(f"a mask must be bool {true.depth.shape}, got {mask.dtype} {mask.shape}")
        return sorted((d for d in found if d.category in CATEGORIES), key=lambda d: d.score)

    def _own(self, labels: NDArray[np.int64]) -> NDArray[np.bool_]:
        """The pixels of the robot, [H, W], and of what it holds: it knows these from its joints."""
        held = torch.nonzero(self._world.held[0]).flatten().tolist()
        return np.isin(labels, [AGENT, *held])


def blank(own: NDArray[np.bool_], depth: NDArray[np.float32]) -> NDArray[np.int64]:
    """Labels of a picture in which nothing was detected, from the robot's `own` pixels and `depth` [m], [H, W] each."""
    return np.where(own, AGENT, np.where(depth == 0.0, NOTHING, STRUCTURE)).astype(np.int64)


class PublishedLabeller(DetectingLabeller):
    """A detection takes the index of the true thing of its category in view whose box overlaps its own most.

    Detections that overlap none are dropped. Whether things are damaged is the truth, too.
    """

    def view(self, rgb: NDArray[np.uint8] | None, true: View, frame: int) -> View:
        assert true.labels is not None
        own, boxes = self._own(true.labels), boxes_of(true.labels)
        labels = blank(own, true.depth)
        for detection in self._detect(rgb, true, frame):
            index = nearest(detection, boxes, self._categories)
            if index >= 0:
                labels[detection.mask & ~own] = index
        return replace(true, labels=labels)


def boxes_of(labels: NDArray[np.int64]) -> dict[int, Box]:
    """The tight boxes of the things in `labels`, [H, W], by index [pixels]."""
    parts = ndimage.find_objects(np.maximum(labels + 1, 0).astype(np.int32))
    return {
        index: (float(part[1].start), float(part[0].start), float(part[1].stop), float(part[0].stop))
        for index, part in enumerate(parts)
        if part is not None
    }


def nearest(detection: Detection, boxes: dict[int, Box], categories: Sequence[str]) -> int:
    """The index of the box whose thing has the detection's category and which overlaps its box most; -1 for none."""
    shares = {i: overlap(detection.box, box) for i, box in boxes.items() if categories[i] == detection.category}
    best = max(shares, key=lambda i: shares[i], default=-1)
    return best if best >= 0 and shares[best] > 0.0 else -1
