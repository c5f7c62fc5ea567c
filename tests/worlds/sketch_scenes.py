"""Scenes of the sketch made of a few points: straight ways, open sight, fates that the test chooses."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hazard_ms.sketch.rescues.scene import LOOKS, SketchScene
from hazard_ms.sketch.skill_times import SKILLS, SkillRow, SkillTimes

FRAMES_PER_METRE, SETTLE, ARRIVED = 62.0, 3.0, 0.5  # of a walk [frames/m], [frames], [m]
PICK_FRAMES, BAG_FRAMES, CART_FRAMES, LOOK_FRAMES, LOST_FRAMES = 94, 4, 158, 60, 20
OFTEN = {"pick_up": PICK_FRAMES, "bag": BAG_FRAMES, "cart": CART_FRAMES, "explore": LOOK_FRAMES, "no_path": LOST_FRAMES}


def sure_times() -> SkillTimes:
    """Skills that always work and always take the same time; walks without a path take LOST_FRAMES."""
    return SkillTimes("fetch", tuple(SkillRow(s, 1, 1.0, (OFTEN[s],), (OFTEN[s],)) for s in SKILLS))


def chancy_times() -> SkillTimes:
    """Skills that fail now and then, and take their time."""
    chancy = (
        SkillRow("pick_up", 9, 0.7, (50, 90, 180), (20, 60), height=(-np.inf, 0.5)),
        SkillRow("pick_up", 9, 0.5, (70, 120), (30, 60, 70), height=(0.5, np.inf)),
        SkillRow("cart", 9, 0.6, (100, 170), (60, 110)),
    )
    plain = (row for row in sure_times().rows if row.skill not in ("pick_up", "cart"))
    return SkillTimes("fetch", (*chancy, *plain))


def ways(stand: NDArray[np.float64], position: NDArray[np.float64]) -> dict[str, NDArray[np.float64]]:
    """Straight ways from stands [m], [P, 2], to sites [m], [S, 2], that end ARRIVED before the site."""
    off = position[None] - stand[:, None]
    far = np.hypot(off[..., 0], off[..., 1])
    length = np.maximum(far - ARRIVED, 0.0)
    share = length[..., None] / np.maximum(far, 1e-9)[..., None] * np.arange(1, LOOKS + 1) / LOOKS
    heading = np.arctan2(off[..., 1], off[..., 0])
    return {
        "travel": FRAMES_PER_METRE * length + SETTLE,
        "first": heading,
        "last": heading,
        "way": stand[:, None, None] + share[..., None] * off[:, :, None],
    }


def grid(low: float, high: float, cell: float) -> dict[str, Any]:
    """A square grid of cells from `low` to `high` [m], with a stand in the middle of each."""
    count = round((high - low) / cell)
    y, x = np.divmod(np.arange(count**2), count)
    return {
        "stand": low + (np.stack([x, y], axis=-1) + 0.5) * cell,
        "stand_of": np.arange(count**2),
        "grid_origin": (low, low),
        "grid_cell": cell,
        "grid_shape": (count, count),
    }


def scene(position: Sequence[tuple[float, float]], targets: Sequence[int] = (), **more: Any) -> SketchScene:
    """A scene of sites at `position` [m], the start first, with `targets` at some; `more` replaces parts.

    `cells`: its grid, as from `grid`. Everything is seen from everywhere, nothing is damaged, and there are neither
    carts nor landmarks.
    """
    places = np.array(position, dtype=np.float64)
    count, marks = len(targets), len(more.get("landmark_site", ()))
    cells = more["cells"] if "cells" in more else grid(-5.25, 20.25, 0.5)
    more = {name: value for name, value in more.items() if name != "cells"}
    stands = len(cells["stand"])
    plain: dict[str, Any] = {
        "name": "hand/00",
        "max_frames": 1500,
        "heading": 0.0,
        "position": places,
        "target_site": np.array([targets], np.int64).reshape(1, count),
        "cart_site": np.zeros(0, np.int64),
        "landmark_site": np.zeros(0, np.int64),
        "value": np.full(count, 5.0),
        "height": np.full(count, 0.1),
        "clearance": np.full(count, 0.3),
        "damaged_at": np.full(count, -1),
        "safe_at": np.full(count, -1),
        "level": np.zeros((1, count, 1)),
        "limit": np.full((count, 1), np.inf),
        "traits": np.tile([1.0, 0.0, 300.0], (count, 1)),
        "pixels": np.full((stands, len(places)), 99.0),
        "spots": np.full((stands, marks), 2**16 - 1, np.uint16),
    }
    made = {**plain, **cells, **ways(cells["stand"], places), **more}
    return SketchScene(**{name: np.asarray(v) if isinstance(v, list) else v for name, v in made.items()})


def random_scene(seed: int, carts: int = 0, moving: bool = False) -> SketchScene:
    """A small scene drawn from `seed`: 2 to 5 targets, some damaged in time, patchy sight, some ways closed."""
    chance = np.random.default_rng(seed)
    targets, marks, extra = int(chance.integers(2, 6)), int(chance.integers(0, 5)), 4 if moving else 0
    sites = 1 + targets + carts + marks + extra
    position = chance.uniform(0.0, 8.0, (sites, 2))
    course = np.arange(1, 1 + targets)[None].repeat(40 if moving else 1, axis=0)
    if moving:  # the first target goes on to further sites
        for k in range(extra):
            course[5 + 8 * k :, 0] = 1 + targets + carts + marks + k
    cells = grid(0.0, 8.0, 2.0)
    travel = ways(cells["stand"], position)["travel"]
    travel[:, chance.random(sites) < 0.15] = np.inf
    return scene(
        [tuple(p) for p in position],
        range(1, 1 + targets),
        name=f"drawn/{seed:02d}",
        max_frames=int(chance.integers(300, 2500)),
        heading=float(chance.uniform(-3.0, 3.0)),
        cells=cells,
        travel=travel,
        target_site=course,
        cart_site=np.arange(1 + targets, 1 + targets + carts),
        landmark_site=np.arange(1 + targets + carts, 1 + targets + carts + marks),
        value=chance.choice([1.0, 5.0], targets),
        height=chance.uniform(0.0, 1.0, targets),
        damaged_at=chance.integers(-600, 1200, targets).clip(-1),
        safe_at=np.where(chance.random(targets) < 0.2 * moving, 350, -1),
        level=chance.uniform(0.0, 300.0, (150, targets, 1)),
        pixels=chance.choice([0.0, 0.5, 1.5, 2.5, 9.0], (16, sites)),
        spots=chance.integers(0, 2**16, (16, marks)).astype(np.uint16),
    )
