"""A long empty hall with boxes on a line, and what happens there if nobody acts, as a test chooses."""

from __future__ import annotations

import numpy as np

from hazard_ms.sketch.timeline import Timeline
from hazard_ms.spec import AgentStart, Body, Fixture, Room, SceneSpec

SIZE = 0.2  # edges of the boxes [m]
CART = 0.5  # edges of the cart [m]


def hall(*at: float, cart: float | None = None) -> SceneSpec:
    """Boxes on a line `at` distances from the robot's start [m], and perhaps a cart there."""
    bodies = tuple(
        Body(f"box_{k}", "box", "plain_box", (1.0 + x, 3.0, 0.0), scale=(SIZE,) * 3) for k, x in enumerate(at)
    )
    fixtures = (
        () if cart is None else (Fixture("cart", "cart", "plain_box", (1.0 + cart, 3.0, 0.0), scale=(CART,) * 3),)
    )
    return SceneSpec("test/hall", Room((40.0, 6.0)), fixtures, bodies, ("box",), (), AgentStart((1.0, 3.0)))


def future(spec: SceneSpec, speed: float = 0.0, damaged: int = -1, alone: bool = False) -> Timeline:
    """300 frames in which box 0 goes along x at `speed` [m/frame], and is damaged in a frame or becomes safe alone."""
    things = len(spec.things)
    offsets = np.zeros((31, 1, 3), np.float16)
    offsets[:, 0, 0] = 10 * speed * np.arange(31)
    damaged_at, safe_at = np.full(things, -1, np.int32), np.full(things, -1, np.int32)
    damaged_at[0], safe_at[0] = damaged, 50 if alone else -1
    return Timeline(
        scene=spec.name,
        task="",
        physics="paper",
        suite="",
        seed=0,
        first=0,
        stride=10,
        names=tuple(thing.name for thing in spec.things),
        start=np.array([thing.position for thing in spec.things], np.float32),
        moves=np.array([0], np.int16),
        offsets=offsets,
        levels=np.zeros((31, 1, things), np.float16),
        damaged_at=damaged_at,
        safe_at=safe_at,
        flame_birth=np.zeros(0, np.int32),
        flame_place=np.zeros((0, 2), np.float32),
    )
