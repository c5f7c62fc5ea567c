"""Pictures as they should be, in tests/golden, and how alike two pictures are.

`python -m tests.effects.golden_pictures` makes them anew.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any, NamedTuple

import cv2
import numpy as np

from hazard_ms.cli.costs.effects import go_on
from tests.worlds.watching import made

FOLDER = Path(__file__).parent / "golden"
WIDTH, HEIGHT = 192, 128  # pixels
# frames at which they are taken
MOMENTS = {"HazardFire-v1": (240, 900), "HazardFlood-v1": (400, 1200), "HazardWind-v1": (150, 1400)}
SEEDS = {"HazardFire-v1": 3, "HazardFlood-v1": 3, "HazardWind-v1": 10}  # a kitchen, twice; a street on a bright day
SIGMA = 1.5  # of the window of SSIM [pixels] (Wang et al. 2004)
STEADY = (0.01 * 255) ** 2, (0.03 * 255) ** 2  # C1 and C2 of SSIM (Wang et al. 2004)
CELL = 16  # edge of the squares whose mean colours are compared [pixels] [ours]


class Likeness(NamedTuple):
    """How alike two pictures are: mean SSIM, 1 for the same; greatest difference of a square's mean colour, 0..255."""

    structure: float
    colour: float


def likeness(one: np.ndarray, other: np.ndarray) -> Likeness:
    """Of two pictures, [H, W, 3] uint8."""
    a, b = one.astype(np.float64), other.astype(np.float64)
    squares = [p.reshape(HEIGHT // CELL, CELL, WIDTH // CELL, CELL, 3).mean((1, 3)) for p in (a, b)]
    return Likeness(_ssim(a, b), float(np.abs(squares[0] - squares[1]).max()))


def _ssim(a: np.ndarray, b: np.ndarray) -> float:
    """Mean structural similarity of two pictures, [H, W, 3] (Wang et al. 2004)."""

    def smooth(image: np.ndarray) -> np.ndarray:
        return cv2.GaussianBlur(image, (11, 11), SIGMA)

    mean_a, mean_b = smooth(a), smooth(b)
    var_a, var_b, both = smooth(a * a) - mean_a**2, smooth(b * b) - mean_b**2, smooth(a * b) - mean_a * mean_b
    alike = (2 * mean_a * mean_b + STEADY[0]) * (2 * both + STEADY[1])
    return float((alike / ((mean_a**2 + mean_b**2 + STEADY[0]) * (var_a + var_b + STEADY[1]))).mean())


def started(env_id: str, effects: str = "full", lighting: str = "day") -> Any:
    """An environment at the start of the episode that the pictures show."""
    env = made(env_id, effects, lighting, width=WIDTH, height=HEIGHT)
    env.reset(seed=SEEDS[env_id])
    return env


def picture(env: Any) -> np.ndarray:
    """What is seen in third person now, [H, W, 3] uint8."""
    return env.render()[0].cpu().numpy()


def pictures(env: Any, env_id: str) -> list[np.ndarray]:
    """What is seen at the moments of `env_id`, from the start on."""
    taken, now = [], 0
    for moment in MOMENTS[env_id]:
        go_on(env, moment - now)
        now = moment
        taken.append(picture(env))
    return taken


def path(env_id: str, moment: int) -> Path:
    """Where the picture of `env_id` at frame `moment` lies."""
    return FOLDER / f"{env_id.removesuffix('-v1').removeprefix('Hazard').lower()}_{moment}.png"


def golden(env_id: str, moment: int) -> np.ndarray:
    """The picture as it should be, [H, W, 3] uint8."""
    image = cv2.imread(str(path(env_id, moment)))
    assert image is not None, f"{path(env_id, moment)} is missing: python -m tests.effects.golden_pictures"
    return image[..., ::-1]


def main() -> None:
    FOLDER.mkdir(exist_ok=True)
    for env_id in MOMENTS:
        env = started(env_id)
        for moment, image in zip(MOMENTS[env_id], pictures(env, env_id), strict=True):
            cv2.imwrite(str(path(env_id, moment)), image[..., ::-1])
        env.close()


if __name__ == "__main__":
    main()
