"""Many episodes in one environment with effects.

`python -m tests.effects.resetting TASK EFFECTS RESETS` prints what each has left in memory.
"""

from __future__ import annotations

import argparse
import gc
import json
from collections import Counter
from pathlib import Path
from typing import Any

from sapien.render import RenderBodyComponent, RenderCameraComponent, RenderPointLightComponent

from hazard_ms.cli.costs.effects import go_on
from hazard_ms.effects.entities import PREFIX, materials
from tests.worlds.watching import made, seen

SEEDS = 8  # the episodes' seeds, in turn: scenes of many sizes
LATER = 150  # frames after the start of an episode at which it is looked at: all effects are in use
COLLECTED = 25  # resets from one search for effects of dead episodes to the next


def counted(env: Any) -> dict[str, int]:
    """What the renderer holds for the scene of `env`: number of each kind."""
    (scene,) = env.scene.sub_scenes
    found = Counter(entities=len(scene.entities), effects=sum(e.name.startswith(PREFIX) for e in scene.entities))
    for entity in scene.entities:
        body = entity.find_component_by_type(RenderBodyComponent)
        found["bodies"] += body is not None
        found["shapes"] += len(body.render_shapes) if body else 0
        found["materials"] += len(materials(entity))
        found["cameras"] += entity.find_component_by_type(RenderCameraComponent) is not None
        found["lamps"] += entity.find_component_by_type(RenderPointLightComponent) is not None
    system = scene.render_system
    found["drawn"] = len(system.render_bodies)
    found["lights"], found["taking"] = len(system.lights), len(system.cameras)
    return dict(found)


def living() -> dict[str, int]:
    """How many objects of hazard_ms.effects the process holds, by class."""
    gc.collect()
    names = (type(o).__qualname__ for o in gc.get_objects() if str(type(o).__module__).startswith("hazard_ms.effects"))
    return dict(Counter(names))


def begun(env: Any, number: int) -> dict[str, int]:
    """Start the episode `number` of `env`, look at it while its hazard is at work, and count what it holds."""
    env.reset(seed=number % SEEDS)
    seen(env)
    go_on(env, LATER)
    seen(env)
    return counted(env)


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("env_id")
    parser.add_argument("effects")
    parser.add_argument("resets", type=int)
    args = parser.parse_args()
    env = made(args.env_id, args.effects, "random")
    counts, memory, objects = [], [], []
    for number in range(args.resets):
        counts.append(begun(env, number))
        memory.append(int(Path("/proc/self/statm").read_text().split()[1]) * 4096 / 2**20)  # resident [MiB]
        if number % COLLECTED == COLLECTED - 1:
            objects.append({"seed": number % SEEDS, **living()})
    env.close()
    fresh = []
    for number in range(SEEDS):
        env = made(args.env_id, args.effects, "random")
        fresh.append(begun(env, number))
        env.close()
    print(json.dumps({"counts": counts, "memory": memory, "objects": objects, "fresh": fresh}))


if __name__ == "__main__":
    main()
