"""Whether a scene is at rest: what moves when it is left alone was floating, leaning or inside something else."""

from __future__ import annotations

from hazard_ms.spec import SceneSpec
from hazard_ms.standalone import PHYSICS_RATE, build

SECONDS = 1.0  # that a scene is left alone
STILL = 0.02  # how far a thing may move in that time [m]


def settle(spec: SceneSpec, seconds: float = SECONDS) -> dict[str, float]:
    """How far the middle of each body moves when the scene is left alone for `seconds` [m], the farthest of the whole way."""
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
    """What does not stay where the scene has it, in words."""
    return [
        f"{name} moves {far:.3f} m in {SECONDS} s; at most {STILL} m is allowed" for name, far in settle(spec).items() if not far <= STILL
    ]
