"""Episodes that are looked at as they go on.

`python -m tests.worlds.watching FRAMES EVERY RUN...` prints hashes of what is seen.

A RUN is task/effects/lighting. Runs of one process follow each other.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import gymnasium as gym
import numpy as np

import hazard_ms  # noqa: F401 registers the environments
from tests.worlds.episodes import actions, feed

TASKS = ("HazardFire-v1", "HazardFlood-v1", "HazardWind-v1")
WIDTH, HEIGHT = 72, 64  # pixels
SEED = 3
MODALITIES = ("rgb", "depth", "position", "segmentation", "normal")
TIMEOUT = 3000.0  # of a process [s]


def made(env_id: str, effects: str, lighting: str = "day", width: int = WIDTH, height: int = HEIGHT) -> Any:
    """A new environment with cameras of `width` x `height` pixels."""
    camera = {"width": width, "height": height}
    wanted: dict[str, Any] = {"obs_mode": "none", "render_mode": "rgb_array", "control_mode": "pd_joint_pos"}
    wanted |= {"effects": effects, "lighting": lighting}
    return gym.make(env_id, sensor_configs=camera, human_render_camera_configs=camera, **wanted).unwrapped


def seen(env: Any) -> dict[str, dict[str, np.ndarray]]:
    """The images [H, W, C] of the head camera and of the third person now, by camera and modality."""
    env.observer.show()
    env.scene.update_render(update_sensors=True, update_human_render_cameras=True)
    pictures = {}
    for name, camera in {**env._sensors, **env._human_render_cameras}.items():
        camera.capture()
        pictures[name] = {k: v[0].cpu().numpy() for k, v in camera.get_obs(**dict.fromkeys(MODALITIES, True)).items()}
        # as in observations, whatever the shaders give
        pictures[name]["segmentation"] = pictures[name]["segmentation"].astype(np.int16)
    return pictures


def watched(run: str, frames: int, every: int) -> dict[str, Any]:
    """Hashes of an episode in which the robot drives: "pictures", at each `every`-th frame, camera/modality -> hash.

    "state" at its end.
    """
    env = made(*run.split("/"))
    env.reset(seed=SEED)
    pictures = []
    for frame, action in enumerate(actions(env, SEED, frames)):
        if frame % every == 0:
            shown = seen(env)
            pictures.append(
                {
                    f"{c}/{m}": hashlib.sha256(image.tobytes()).hexdigest()[:16]
                    for c in shown
                    for m, image in shown[c].items()
                }
            )
        env.advance(action)
    state = hashlib.sha256()
    feed(state, env.get_state_dict())
    env.close()
    return {"pictures": pictures, "state": state.hexdigest()}


def start(frames: int, every: int, runs: list[str], hash_seed: int = 0) -> subprocess.Popen[str]:
    """A new process that watches `runs`."""
    command = [sys.executable, "-m", "tests.worlds.watching", str(frames), str(every), *runs]
    environ = {**os.environ, "PYTHONHASHSEED": str(hash_seed)}
    return subprocess.Popen(command, cwd=Path(__file__).parents[2], env=environ, stdout=subprocess.PIPE, text=True)


def told(process: subprocess.Popen[str]) -> dict[str, Any]:
    """What the process of `start` has seen: run -> what `watched` gives."""
    try:
        out, _ = process.communicate(timeout=TIMEOUT)
    finally:
        process.kill()
    assert process.returncode == 0
    return json.loads(out.strip().splitlines()[-1])


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("frames", type=int)
    parser.add_argument("every", type=int)
    parser.add_argument("runs", nargs="+")
    args = parser.parse_args()
    print(json.dumps({run: watched(run, args.frames, args.every) for run in args.runs}))


if __name__ == "__main__":
    main()
