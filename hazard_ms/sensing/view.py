"""One look of the head camera of one environment, in numpy; semantic maps are made from such looks."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from torch import Tensor

from hazard_ms.sensing.camera import metres


@dataclass(frozen=True)
class View:
    """One look of the head camera. `level` holds the hazard images of the task's K hazards, in the hazards' units."""

    depth: NDArray[np.float32]  # [H, W], along the optical axis [m]; 0 where there is nothing
    intrinsic: NDArray[np.float32]  # [3, 3] [pixels]
    cam2world: NDArray[np.float32]  # [4, 4], of a camera that looks along its -z axis with y up
    labels: NDArray[np.int64] | None = None  # [H, W], see hazard_ms.sensing.camera; None without a segmentation
    level: NDArray[np.float32] | None = None  # [K, 16, 16]

    @classmethod
    def of(
        cls,
        depth: Tensor,
        intrinsic: Tensor,
        cam2world: Tensor,
        labels: Tensor | None = None,
        level: Tensor | None = None,
        env: int = 0,
    ) -> View:
        """The view of environment `env` from the batched images of E environments.

        `depth` [E, H, W] or [E, H, W, 1] in [m], or int16 in [mm]; `intrinsic` [E, 3, 3] in [pixels];
        `cam2world` [E, 4, 4]; `labels` [E, H, W]; `level` [E, K, 16, 16].
        """
        flat = depth[env, ..., 0] if depth.ndim == 4 else depth[env]
        return cls(
            metres(flat).cpu().numpy(),
            intrinsic[env].cpu().numpy(),
            cam2world[env].cpu().numpy(),
            None if labels is None else labels[env].cpu().numpy(),
            None if level is None else level[env].reshape(-1, *level.shape[-2:]).cpu().numpy(),
        )

    @property
    def sampled(self) -> NDArray[np.float32]:
        """The points at the samples of the hazard images at which something is seen [m], world frame, [P, 3].

        At the other samples, those of the sky, the images hold the levels of a place far away. Empty without images.
        """
        if self.level is None:
            return np.zeros((0, 3), np.float32)
        sizes = zip(self.level.shape[1:], self.depth.shape, strict=True)
        firsts = [(np.arange(count) * size + count - 1) // count for count, size in sizes]
        row, column = (part.ravel() for part in np.meshgrid(*firsts, indexing="ij"))
        seen = self.depth[row, column] > 0.0
        return self.points(row[seen], column[seen])

    def points(self, row: NDArray[np.int64], column: NDArray[np.int64]) -> NDArray[np.float32]:
        """Points [m], world frame, [P, 3], that are seen at the pixels `row` [P], `column` [P]."""
        far = self.depth[row, column]
        k, pose = self.intrinsic, self.cam2world
        right = (column.astype(np.float32) + (0.5 - k[0, 2])) / k[0, 0] * far
        up = (row.astype(np.float32) + (0.5 - k[1, 2])) / -k[1, 1] * far
        return np.stack([right, up, -far], axis=-1) @ pose[:3, :3].T + pose[:3, 3]

    def pixel_of(self, point: NDArray[np.floating]) -> tuple[int, int, float] | None:
        """Row and column of the pixel in which `point` [m], [3], world frame, lies, and its depth [m]; None outside."""
        k, pose = self.intrinsic, self.cam2world
        right, up, back = (np.asarray(point) - pose[:3, 3]) @ pose[:3, :3]
        if back >= 0.0:
            return None
        column = int(np.floor(k[0, 2] + k[0, 0] * right / -back))
        row = int(np.floor(k[1, 2] - k[1, 1] * up / -back))
        inside = 0 <= row < self.depth.shape[0] and 0 <= column < self.depth.shape[1]
        return (row, column, float(-back)) if inside else None

    def level_at(self, row: NDArray[np.int64], column: NDArray[np.int64]) -> NDArray[np.float32] | None:
        """Levels of the hazards at pixels, [P] each: [K, P], in their units; those of the sample to the top left."""
        if self.level is None:
            return None
        height, width = self.depth.shape
        _, samples_y, samples_x = self.level.shape
        return self.level[:, row * samples_y // height, column * samples_x // width]
