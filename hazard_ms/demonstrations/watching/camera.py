"""A watcher that takes the pictures of a robot's cameras: a film of each, and depth and labels that its head sees."""

from __future__ import annotations

import contextlib
from pathlib import Path
from types import TracebackType

import cv2
import numpy as np
from torch import Tensor

from hazard_ms.demonstrations.layout import DEPTH, FILM, HEAD, LABEL_SHIFT, LABELS, NO_LABEL
from hazard_ms.evaluation.video import Video
from hazard_ms.evaluation.watchers import Watcher
from hazard_ms.skills.context import LowLevel
from hazard_ms.skills.decision import Decision
from hazard_ms.skills.executor import SkillEnv
from hazard_ms.spec.storage.files import drafts

MILLIMETRES = 1000.0  # in a metre
MOST_DEPTH = 65535  # that 16 bits hold [mm]
NOTHING = -3  # the label of a pixel without a surface, as `sensing.camera` has it

# Closed groups of pictures without B-frames: any picture is found from the key frame before it, and they come in order.
# One thread and no word about the encoder: the same pictures give the same bytes.
CLOSED = ("-preset", "veryfast", "-crf", "18", "-g", "30", "-bf", "0", "-flags", "+cgop+bitexact", "-threads", "1")
EXACT = ("-fflags", "+bitexact", "-map_metadata", "-1")


class Cameras(Watcher):
    """Takes a picture at the start of an episode and after every so many frames. A context manager."""

    def __init__(self, part: Path, kinds: tuple[str, ...], every: int, mounted: tuple[str, ...] = ()) -> None:
        """Write into the folder `part`, at every so many frames.

        `kinds`: some of rgb, depth, segmentation; `mounted`: cameras beside that of the head, which give rgb alone.
        """
        self._part, self._kinds, self._every, self._mounted = part, kinds, every, mounted
        self._stack = contextlib.ExitStack()
        self._films: dict[str, Video] = {}

    def begin(self, env: SkillEnv, decision: Decision) -> None:
        """Take the first picture."""
        self._env = env
        for kind, name in (("depth", DEPTH), ("segmentation", LABELS)):
            if kind in self._kinds:
                (self._part / name).mkdir()
        self._take()

    def frame(self, action: LowLevel) -> None:
        """Take a picture if it is time; `action`, [A], in the units of the robot's controllers, is not looked at."""
        if self._env.frame % self._every == 0:
            self._take()

    def _take(self) -> None:
        rgb, view = self._env.base.observer.look()
        name = f"{self._env.frame:06d}.png"
        if "rgb" in self._kinds:
            self._film(HEAD, rgb)
            for camera in self._mounted:
                self._film(camera, self._env.base.observer.picture(camera))
        if "depth" in self._kinds:
            far = np.rint(view.depth * MILLIMETRES).clip(0, MOST_DEPTH)
            _save(self._part / DEPTH / name, far.astype(np.uint16))
        if "segmentation" in self._kinds and view.labels is not None:
            labels = np.where(view.labels == NOTHING, NO_LABEL, view.labels + LABEL_SHIFT)
            _save(self._part / LABELS / name, labels.astype(np.uint16))

    def _film(self, camera: str, picture: Tensor) -> None:
        """Append a `picture`, [H, W, 3], uint8, to the film of a camera."""
        pixels = picture.cpu().numpy()
        if camera not in self._films:
            high, wide = pixels.shape[:2]
            (draft,) = self._stack.enter_context(drafts(self._part / (camera + FILM)))
            rate = float(self._env.base.control_freq) / self._every
            self._films[camera] = self._stack.enter_context(Video(draft, (wide, high), rate, (*CLOSED, *EXACT)))
        self._films[camera].add(pixels)

    def __enter__(self) -> Cameras:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._stack.__exit__(kind, error, trace)


def _save(path: Path, image: np.ndarray) -> None:
    """Write an image, [H, W], uint16, as PNG."""
    path.write_bytes(cv2.imencode(".png", image)[1].tobytes())
