"""One look of the head camera of one environment, in numpy: what the semantic map is made from."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from torch import Tensor

from hazard_ms.sensing.camera import metres


@dataclass(frozen=True)
class View:
    """One look of the head camera. `level` is the 16 x 16 hazard image: temperature [C] or water level [m]."""

    depth: NDArray[np.float32]  # [H, W], along the optical axis [m]; 0: nothing there
    intrinsic: NDArray[np.float32]  # [3, 3], pixels
    cam2world: NDArray[np.float32]  # [4, 4], of a camera that looks along its -z, y up
    labels: NDArray[np.int64] | None = None  # [H, W], see hazard_ms.sensing.camera; None: no segmentation
    level: NDArray[np.float32] | None = None  # [16, 16]

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
        """The view of one environment, of batched tensors as `camera` and `hazard_image` take and give them."""
        flat = depth[env, ..., 0] if depth.ndim == 4 else depth[env]
        return cls(
            metres(flat).cpu().numpy(),
            intrinsic[env].cpu().numpy(),
            cam2world[env].cpu().numpy(),
            None if labels is None else labels[env].cpu().numpy(),
            None if level is None else level[env].cpu().numpy(),
        )

    def points(self, row: NDArray[np.int64], column: NDArray[np.int64]) -> NDArray[np.float32]:
        """Points of the world [m] at the pixels (`row`, `column`), [P] each: [P, 3]."""
        far = self.depth[row, column]
        k, pose = self.intrinsic, self.cam2world
        right = (column.astype(np.float32) + (0.5 - k[0, 2])) / k[0, 0] * far
        up = (row.astype(np.float32) + (0.5 - k[1, 2])) / -k[1, 1] * far
        return np.stack([right, up, -far], axis=-1) @ pose[:3, :3].T + pose[:3, 3]

    def level_at(self, row: NDArray[np.int64], column: NDArray[np.int64]) -> NDArray[np.float32] | None:
        """Hazard level at pixels, [P]: that of the sample to the top left."""
        if self.level is None:
            return None
        height, width = self.depth.shape
        samples_y, samples_x = self.level.shape
        return self.level[row * samples_y // height, column * samples_x // width]
