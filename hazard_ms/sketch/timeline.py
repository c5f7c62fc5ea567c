"""Timelines: what happens in a scene from one frame on if nobody does anything, as a record that fits into a file.

    positions of the things that move, every `stride` frames [m]
    levels of the hazards at every thing, every `stride` frames
    the frame in which each thing is damaged, and in which a thing becomes safe by itself (wind can blow it into a cart)
    the flames on the floor, in the order of their birth

A file is the digest of its contents, then the contents: a file in which a single bit has changed is refused.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, fields, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hazard_ms.sketch import array_files
from hazard_ms.spec.foreign.files import read_foreign
from hazard_ms.spec.storage import files

FORMAT = 1  # goes up when older files can no longer be read
STRIDE = 10  # frames from sample to sample: water and flames change every 10 frames [ours]
PLAIN: dict[str, Callable[[Any], Any]] = {  # fields that are no arrays
    **dict.fromkeys(("scene", "task", "physics", "suite"), str),
    **dict.fromkeys(("seed", "first", "stride"), int),
    "names": lambda column: tuple(map(str, column.tolist())),
}


@dataclass(frozen=True, eq=False)
class Timeline:
    """The future of B things over S samples, of which M things move, under H hazards.

    Things are in the order of World's B without padding.
    """

    scene: str
    task: str  # id of the environment
    physics: str  # preset
    suite: str  # digest of all that the record follows from; empty if it continues a running episode
    seed: int
    first: int  # frame of the first sample
    stride: int  # frames from sample to sample
    names: tuple[str, ...]  # of the B things
    start: NDArray[np.float32]  # positions of their middles in the first sample [m], [B, 3]
    moves: NDArray[np.int16]  # which things ever move, [M]
    offsets: NDArray[np.float16]  # how far these are from `start` [m], [S, M, 3]
    levels: NDArray[np.float16]  # of the hazards at the things, in the hazards' units and order, [S, H, B]
    damaged_at: NDArray[np.int32]  # first frame in which each thing is damaged; -1: never, [B]
    safe_at: NDArray[np.int32]  # first frame in which each thing is safe; -1: never, [B]
    flame_birth: NDArray[np.int32]  # frame in which each flame on the floor appears, [F]
    flame_place: NDArray[np.float32]  # where it is, x and y [m], [F, 2]

    @property
    def frames(self) -> NDArray[np.int64]:
        """The frames of the samples, [S]."""
        return self.first + self.stride * np.arange(len(self.offsets))

    def index(self, name: str) -> int:
        """Index along B of the thing called `name`. Raises ValueError if nothing has that name."""
        if name not in self.names:
            raise ValueError(f"a thing in {self.scene} must be one of {', '.join(self.names)}, got {name!r}")
        return self.names.index(name)

    def positions(self, things: NDArray[np.integer]) -> NDArray[np.float32]:
        """Positions of `things`, indices [N] along B, in every sample [m], [S, N, 3]."""
        made = np.repeat(self.start[None, things], len(self.offsets), axis=0)
        column = {int(thing): m for m, thing in enumerate(self.moves)}
        for n, thing in enumerate(things):
            if int(thing) in column:
                made[:, n] += self.offsets[:, column[int(thing)]]
        return made

    def position_at(self, frame: float) -> NDArray[np.float32]:
        """Positions of all things at a frame [m], [B, 3], on straight lines between samples; at rest beyond them."""
        at = np.clip((frame - self.first) / self.stride, 0, len(self.offsets) - 1)
        low = int(at)
        high, share = min(low + 1, len(self.offsets) - 1), np.float32(at - low)
        made = self.start.copy()
        made[self.moves] += (1 - share) * self.offsets[low].astype(np.float32) + share * self.offsets[high]
        return made

    def whole_until(self) -> NDArray[np.float64]:
        """The last frame at which a rescue finds each thing whole; inf if it is never damaged, [B]."""
        return np.where(self.damaged_at < 0, np.inf, self.damaged_at - 1.0)

    def displaced(self, places: Mapping[int, tuple[float, float]], frame: float) -> Timeline:
        """A timeline with things, by index along B, at `places` [m] at a frame: they go on from there."""
        if not places:
            return self
        start, now = self.start.copy(), self.position_at(frame)
        for index, place in places.items():
            start[index, :2] += np.asarray(place, np.float32) - now[index, :2]
        return replace(self, start=start)

    def to_bytes(self) -> bytes:
        """The record as the content of a file."""
        return array_files.to_bytes(FORMAT, {f.name: getattr(self, f.name) for f in fields(self)})

    def write(self, path: Path) -> None:
        """Write the record to a file, whole or not at all. Raises ValueError where it cannot be written."""
        files.make_folder(path.parent)
        files.write(path, self.to_bytes())


def from_bytes(content: bytes) -> Timeline:
    """The record that `to_bytes` gave. Raises ValueError for any other content."""
    what = "a timeline"
    return array_files.made_from(Timeline, what, array_files.from_bytes(what, FORMAT, content), PLAIN)


def read(path: Path) -> Timeline:
    """The record in a file. Raises ValueError that names the file if there is none, or if it is damaged."""
    try:
        return from_bytes(read_foreign(path, array_files.LARGEST))
    except ValueError as error:
        raise ValueError(f"{path} must hold a timeline: {error}") from None
