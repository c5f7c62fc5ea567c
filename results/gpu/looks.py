"""Draws one environment that a CPU simulates, on a GPU or on the CPU: pictures are quick, and episodes stay bit-exact.

What both draw is compared: labels and depth should differ only at outlines, where a pixel may go to either side.
"""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import gymnasium as gym
import numpy as np
import torch
from numpy.typing import NDArray

from hazard_ms.cli.costs.effects import ADVANCED, go_on
from hazard_ms.cli.costs.tables import table
from results.gpu.comparison import Course
from results.gpu.rates import PICTURES

SIDES = (128, 256, 512)  # of the pictures [pixels]
MODALITIES = ("rgb", "depth", "segmentation")
FIRST, COUNTED = 3, 15  # pictures before those that are timed, and those that are [ours]
NEAR = 2  # difference of depth that does not count [mm] [ours]
HEADINGS = (
    "task",
    "pixels a side",
    "on the GPU [ms]",
    "on the CPU [ms]",
    "labels differ [%]",
    "beyond a pixel [%]",
    "depth differs [%]",
    "colour differs [of 255]",
)


def looks(env_id: str, sides: Sequence[int], renderer: str, seed: int = 0) -> tuple[list[float], Course]:
    """Median times of pictures of each of the `sides` [pixels] drawn on `renderer` [s], and what the pictures show.

    "side/modality" -> [H, W, C]: rgb, depth [mm] and segmentation. The hazards have gone on for a while.
    """
    spans: list[float] = []
    shown: Course = {}
    for side in sides:
        span, picture = _look(env_id, side, renderer, seed)
        spans.append(span)
        shown.update({f"{side}/{name}": numbers for name, numbers in picture.items()})
    return spans, shown


def _look(env_id: str, side: int, renderer: str, seed: int) -> tuple[float, Course]:
    size = {"width": side, "height": side}
    made = gym.make(env_id, obs_mode=PICTURES, sim_backend="cpu", render_backend=renderer, sensor_configs=size)
    env: Any = made.unwrapped
    try:
        env.reset(seed=seed)
        go_on(env, ADVANCED)
        info, spans = env.get_info(), []
        for _ in range(FIRST + COUNTED):
            begun = time.perf_counter()
            head = env.get_obs(info)["sensor_data"][env.agent.head_camera]
            shown = {name: torch.as_tensor(head[name])[0].cpu().numpy() for name in MODALITIES}
            spans.append(time.perf_counter() - begun)
        return float(np.median(spans[FIRST:])), shown
    finally:
        made.close()


@dataclass(frozen=True)
class Difference:
    """The difference of two pictures of one scene.

    labels, depths: shares of the pixels at which they differ [-]; beyond: of those whose label is not found within a
    pixel of there in the other picture [-]; colour: mean difference, of 255.
    """

    labels: float
    beyond: float
    depths: float
    colour: float


def compare(side: int, a: Course, b: Course) -> Difference:
    """Compare the pictures of this `side` in what two renderers made, [H, W, C] each; depths in millimetres."""
    a, b = ({name: made[f"{side}/{name}"] for name in MODALITIES} for made in (a, b))
    one, two = (np.asarray(picture["segmentation"])[..., 0] for picture in (a, b))
    far = [made["depth"].astype(np.int32) & 0xFFFF for made in (a, b)]  # ManiSkill's int16 wraps at 32.767 m
    return Difference(
        labels=float((one != two).mean()),
        beyond=float((_unmatched(one, two) | _unmatched(two, one)).mean()),
        depths=float((np.abs(far[0] - far[1]) > NEAR).mean()),
        colour=float(np.abs(a["rgb"].astype(float) - b["rgb"].astype(float)).mean()),
    )


def _unmatched(one: NDArray[Any], two: NDArray[Any]) -> NDArray[np.bool_]:
    """Whether each label of `one`, [H, W], is nowhere within a pixel of its place in `two`, [H, W]."""
    near = np.lib.stride_tricks.sliding_window_view(np.pad(two, 1, mode="edge"), (3, 3))
    return (near != one[..., None, None]).all((-1, -2))


def looks_row(env_id: str, side: int, gpu: float, cpu: float | None, found: Difference | None) -> list[str]:
    """A row of the table: times on the GPU and on the CPU [s], and differences; None where the CPU cannot draw."""
    row = [env_id, str(side), f"{1e3 * gpu:.1f}"]
    if cpu is None or found is None:
        return [*row, *["none"] * (len(HEADINGS) - len(row))]
    shares = (f"{100 * share:.3f}" for share in (found.labels, found.beyond, found.depths))
    return [*row, f"{1e3 * cpu:.1f}", *shares, f"{found.colour:.2f}"]


def looks_table(rows: Sequence[Sequence[str]]) -> str:
    """The table of `looks_row`s."""
    return table(HEADINGS, rows)
