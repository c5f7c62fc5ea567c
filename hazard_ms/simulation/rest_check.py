"""Whether a scene is at rest: what moves when it is left alone was floating, leaning or inside something else."""

from __future__ import annotations

from hazard_ms.simulation.bare_scene import PHYSICS_RATE, build
from hazard_ms.spec import SceneSpec

SECONDS = 1.0  # time for which a scene is left alone [s]
MOST_MOTION = 0.02  # distance that a thing may move in that time [m]


def settle(spec: SceneSpec, seconds: float = SECONDS) -> dict[str, float]:
    """Greatest distance [m] of each body's middle from its start while the scene is left alone for `seconds` [s]."""
    alone = build(spec)
    world = alone.world
    world.read()
    start, moved = world.position.clone(), world.mass * 0.0
    for _ in range(round(seconds * PHYSICS_RATE)):
        alone.step()
        world.read()
        moved = moved.maximum((world.position - start).norm(dim=-1))
    return {body.name: float(far) for body, far in zip(spec.bodies, moved[0], strict=False)}


def check(spec: SceneSpec) -> list[str]:
    """Describe every thing that does not stay where the scene has it; empty if all do."""
    return [
        f"{name} must move at most {MOST_MOTION} m in {SECONDS} s, got {far:.3f} m"
        for name, far in settle(spec).items()
        if not far <= MOST_MOTION
    ]
