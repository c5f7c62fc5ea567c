"""The sheet docs/indoors.jpg: rooms on fire and under water, before and after a change of their looks.

`python -m tests.effects.indoor_sheet take FOLDER` takes its pictures with the code that is imported, and
`python -m tests.effects.indoor_sheet join BEFORE AFTER docs/indoors.jpg` puts those of two folders side by side.
"""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import NamedTuple

import cv2
import numpy as np

from hazard_ms.cli.costs.effects import go_on
from hazard_ms.evaluation.options import EpisodeOptions
from hazard_ms.pictures.frozen_episode import FrozenEpisode
from hazard_ms.pictures.options import IDLE, RenderOptions

SIZE = (330, 220)  # of a picture [pixels]
QUALITY = 80  # of JPEG: the sheet stays below 300 kB
SAMPLES = 8  # per pixel of ray-traced pictures


class Row(NamedTuple):
    """One picture of the sheet: a task, its physics, a scene, a frame and a shader."""

    env_id: str
    physics: str
    scene: str
    frame: int
    shader: str


ROWS = (
    Row("HazardFire-v1", "paper", "kitchen_a/03", 1150, "default"),
    Row("HazardFire-v1", "paper", "kitchen_a/03", 1150, "rt"),
    Row("HazardFire-v1", "realistic", "kitchen_a/03", 700, "default"),
    Row("HazardFlood-v1", "paper", "kitchen_a/03", 500, "default"),
    Row("HazardFlood-v1", "paper", "kitchen_a/03", 500, "rt"),
)


def take(folder: Path) -> None:
    """Write the pictures of ROWS, 0.png and so on."""
    folder.mkdir(parents=True, exist_ok=True)
    for k, row in enumerate(ROWS):
        episode = EpisodeOptions(env_id=row.env_id, physics=row.physics, seed=3, scene=row.scene, agent=IDLE)
        with FrozenEpisode(RenderOptions(output=Path("sheet.jpg"), episode=episode, frame=0)) as frozen:
            go_on(frozen.env, row.frame)
            picture = frozen.picture(frozen.view("third", *SIZE), row.shader, SAMPLES)
        cv2.imwrite(str(folder / f"{k}.png"), picture[..., ::-1])


def join(before: Path, after: Path, output: Path) -> None:
    """Write the sheet: a row for each picture, before on the left, after on the right."""
    rows = []
    for k, row in enumerate(ROWS):
        pair = np.hstack([cv2.imread(str(folder / f"{k}.png")) for folder in (before, after)])
        title = f"{row.env_id}, {row.physics}, frame {row.frame}, {row.shader.replace('default', 'raster')}"
        band = np.full((20, pair.shape[1], 3), 255, np.uint8)
        cv2.putText(band, f"{title}: before, after", (6, 14), cv2.FONT_HERSHEY_SIMPLEX, 0.42, (0, 0, 0), 1, cv2.LINE_AA)
        rows += [band, pair]
    cv2.imwrite(str(output), np.vstack(rows), [cv2.IMWRITE_JPEG_QUALITY, QUALITY, cv2.IMWRITE_JPEG_OPTIMIZE, 1])


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("what", choices=("take", "join"))
    parser.add_argument("paths", type=Path, nargs="+")
    args = parser.parse_args()
    (take if args.what == "take" else join)(*args.paths)


if __name__ == "__main__":
    main()
