"""Measures what effects cost in a picture, as ratios to a picture without them, for `hazard-ms bench --effects`.

Full and fast have shader packs of their own: full is compared with SAPIEN's default pack, and so is fast, which
replaces it where pictures must be cheap. Compare the ratios: times belong to the machine, and to what else it does.
"""

from __future__ import annotations

import time
from typing import Any

import gymnasium as gym
import numpy as np
from sapien.render import RenderBodyComponent

from hazard_ms.effects.streets.street import CLOUDS, FIRM, LOOSE
from hazard_ms.evaluation.options import EnvOptions
from hazard_ms.spec.checks import whole

MODES = ("off", "fast", "full")  # the first is what the others are compared with
BARE = "no town"  # full, in the open, without the town around a street
SIDE = 256  # of the picture [pixels]
ADVANCED = 450  # the frame of the episode at which the hazard is looked at


def costs(env_id: str, rounds: int, seed: int) -> dict[str, list[float]]:
    """Times of pictures with rgb, depth and segmentation in each mode, in the open also without the town [s].

    The modes are taken in turn `rounds` times, so that those of one turn can be compared in pairs. Raises ValueError
    for an unknown task and for too few rounds.
    """
    EnvOptions(env_id).check()
    whole(rounds, 3, 10**5, "rounds")
    made = {mode: _advanced(env_id, mode, seed) for mode in MODES}
    if _town(made["full"].unwrapped):
        made[BARE] = _advanced(env_id, "full", seed)
        for body in _town(made[BARE].unwrapped):
            body.visibility = 0.0
        _picture(made[BARE].unwrapped)
    spans: dict[str, list[float]] = {mode: [] for mode in made}
    for _ in range(rounds):
        for mode, env in made.items():
            spans[mode].append(_picture(env.unwrapped))
    for env in made.values():
        env.close()
    return spans


def report(env_id: str, rounds: int, seed: int) -> str:
    """The table of `costs`."""
    spans = costs(env_id, rounds, seed)
    found = {mode: float(np.median(times)) for mode, times in spans.items()}
    lines = [f"{env_id}, {SIDE} pixels, rgb+depth+segmentation, frame {ADVANCED}, median of {rounds} pictures in turn"]
    lines += [
        f"  {mode:7s} {1000 * span:8.2f} ms  {span / found[MODES[0]]:5.2f} x {MODES[0]}" for mode, span in found.items()
    ]
    if BARE in spans:
        low, middle, high = np.percentile(np.divide(spans["full"], spans[BARE]), (25, 50, 75))
        lines.append(f"  full beside {BARE}, in pairs: {middle:.2f} x, the middle half {low:.2f} to {high:.2f} x")
    return "\n".join(lines)


def _advanced(env_id: str, mode: str, seed: int) -> gym.Env:
    """An environment whose hazard has gone on for ADVANCED frames."""
    size = {"width": SIDE, "height": SIDE}
    env: Any = gym.make(env_id, obs_mode="rgb+depth+segmentation", effects=mode, sensor_configs=size)
    env.reset(seed=seed)
    base = env.unwrapped
    go_on(base, ADVANCED)
    for _ in range(2):  # shaders are compiled at the first picture
        _picture(base)
    return env


def _town(base: Any) -> list[Any]:
    """The bodies of the town around the scene of a HazardEnv; none indoors."""
    entities = [e for e in base.scene.sub_scenes[0].entities if e.name in (FIRM, LOOSE, CLOUDS)]
    return [e.find_component_by_type(RenderBodyComponent) for e in entities]


def go_on(base: Any, frames: int) -> None:
    """Let the hazards of a HazardEnv go on for this many frames, while all things stay where they are.

    That is quick, and the same on any machine.
    """
    for _ in range(frames):
        base.world.chance.tick()
        for hazard in base.task.hazards:
            hazard.advance(base.episode.states[hazard.name], base.world, 1.0 / base.control_freq)


def _picture(base: Any) -> float:
    """Time that making and fetching a picture takes [s]."""
    start = time.perf_counter()
    base.observer.show()
    base.scene.update_render(update_sensors=True, update_human_render_cameras=False)
    base.capture_sensor_data()
    base.get_sensor_images()
    return time.perf_counter() - start
