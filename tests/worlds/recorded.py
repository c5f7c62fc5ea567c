"""Datasets of demonstrations that nobody played: few frames, numbers that tell where they stand."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import gymnasium as gym
import numpy as np

import hazard_ms  # noqa: F401 registers the environments
from hazard_ms.demonstrations.layout import MANIFEST, Entry, content_of, hashes_of, name_of
from hazard_ms.evaluation.options import EpisodeOptions
from tests.worlds.episodes import actions
from tests.worlds.results import result_of

JOINTS, NUMBERS, WIDTH = 15, 13, 4  # joints and numbers of an action of Fetch; numbers of an observation
FPS = 30.0
PIXELS = 64  # height and width of pictures
TASKS = ["Rescue everything.", "Rescue the books."]
VALUES = [0.0, 0.5, 0.0, np.nan]  # of the options of every decision
SUBTASKS = ("wait", "walk to book_1", "pick up book_1")


def counted(episode: int, kind: int, frames: int, width: int) -> np.ndarray:
    """Numbers [frames, width] that occur nowhere else: episode, kind, frame and column are their digits."""
    rows, columns = np.mgrid[:frames, :width]
    return (episode * 1000 + kind * 100 + rows + columns / 64).astype(np.float32)


def frames_of(episode: int, frames: int, state: bool) -> dict[str, np.ndarray]:
    """Arrays of frames.npz; the last frame ends the episode with success, and rewards are 1, 2, 3, ..."""
    last = np.arange(frames) == frames - 1
    made = {
        "action": counted(episode, 1, frames, NUMBERS),
        "qpos": counted(episode, 2, frames + 1, JOINTS),
        "qvel": counted(episode, 3, frames + 1, JOINTS),
        "base": counted(episode, 4, frames + 1, 3),
        "hand": counted(episode, 5, frames + 1, 3),
        "held": np.where(np.arange(frames + 1) > frames // 2, 0, -1).astype(np.int16),
        "subtask": (np.arange(frames) * len(SUBTASKS) // frames).astype(np.int16),
        "decision": np.zeros(frames, np.int16),
        "reward": np.arange(1, frames + 1, dtype=np.float32),
        "terminated": last,
        "truncated": np.zeros(frames, bool),
        "success": last,
    }
    return {**made, "obs": counted(episode, 6, frames + 1, WIDTH)} if state else made


def subtasks_of(episode: int) -> list[str]:
    """The sentences of an episode by their numbers; every second episode has them the other way round."""
    return list(SUBTASKS if episode % 2 == 0 else reversed(SUBTASKS))


def decisions_of() -> dict[str, np.ndarray]:
    """Arrays of decisions.npz: three decisions, of which the second goes on with the option of the first."""
    return {
        "frame": np.array([0, 2, 4], np.int32),
        "option": np.array([1, 1, 3], np.int16),
        "option_start": np.array([True, False, True]),
        "mask": np.tile(np.array([False, True, False, True]), (3, 1)),
    }


def prompts_of() -> list[dict[str, Any]]:
    return [{"text": f"Situation {k}\nA) fetch book_1\nB) stop", "options": {"A": 1, "B": 3}} for k in range(3)]


def film(path: Path, levels: list[int], rate: int) -> None:
    """Write a film of grey pictures, each with one level from 0 to 255, as recordings are encoded."""
    import av

    with av.open(str(path), "w") as file:
        stream = file.add_stream("libx264", rate=rate, options={"crf": "10", "bf": "0", "g": "10"})
        stream.width = stream.height = PIXELS
        stream.pix_fmt = "yuv420p"
        for level in levels:
            picture = av.VideoFrame.from_ndarray(np.full((PIXELS, PIXELS, 3), level, np.uint8), format="rgb24")
            file.mux(stream.encode(picture))
        file.mux(stream.encode())


def level(episode: int, frame: int) -> int:
    """The grey of the picture before a frame."""
    return 20 + 60 * episode + 5 * frame


def dataset(
    folder: Path, lengths: tuple[int, ...] = (5, 8), obs: str = "none", every: int = 0, robot: str = "fetch"
) -> Path:
    """Write a dataset whose episode k has lengths[k] frames and seed 10 + k. Returns its folder.

    Unless `obs` is none or state, it has a picture before every `every`-th frame.
    """
    for number, frames in enumerate(lengths):
        made = put(folder, number, frames_of(number, frames, "state" in obs), obs, every, robot)
        if obs not in ("none", "state"):
            levels = [level(number, frame) for frame in range(0, frames + 1, every)]
            film(made / "head.mp4", levels, round(FPS / every))
        enter(folder, made.name)
    return folder


def driven(folder: Path, frames: int = 6, seed: int = 4) -> Path:
    """Write a dataset of one episode that was driven through the real environment, with random turns."""
    env = gym.make("HazardFire-v1", obs_mode="none", render_backend="none", control_mode="pd_joint_pos")
    try:
        env.reset(seed=seed)
        base = env.unwrapped
        sent = actions(env, seed, frames)
        joints = [base.agent.robot.get_qpos()[0].numpy().copy()]
        for action in sent:
            env.step(action)
            joints.append(base.agent.robot.get_qpos()[0].numpy().copy())
        arrays = {
            **frames_of(0, frames, False),
            "action": sent,
            "qpos": np.array(joints, np.float32),
            "state_frame": np.array([frames], np.int32),
            "state": base.get_state().numpy(),
        }
        enter(folder, put(folder, 0, arrays, scene=base.specs[0].name, seed=seed).name)
    finally:
        env.close()
    return folder


def put(
    folder: Path,
    number: int,
    arrays: dict[str, np.ndarray],
    obs: str = "none",
    every: int = 0,
    robot: str = "fetch",
    scene: str = "kitchen_b/00",
    seed: int | None = None,
) -> Path:
    """Write the folder of an episode, without its line in the manifest."""
    episode = EpisodeOptions(agent="oracle", seed=10 + number if seed is None else seed, robot_uids=robot)
    result = replace(result_of(episode, saved=True), scene=scene)
    made = folder / name_of(result.scene, result.seed)
    (made / "privileged").mkdir(parents=True)
    meta = {
        "teacher": "oracle",
        "privileged": True,
        "obs": obs,
        "every": every,
        "fps": FPS,
        "instruction": TASKS[number % 2],
        "subtasks": subtasks_of(number),
        "prompts": prompts_of(),
        "robot": robot,
        "control_mode": "pd_joint_pos",
        "joints": [f"joint_{k}" for k in range(JOINTS)],
        "reward_mode": "dense",
    }
    (made / "episode.json").write_text(json.dumps({"result": result.to_dict(), **meta}))
    np.savez_compressed(made / "frames.npz", **arrays)
    np.savez_compressed(made / "decisions.npz", **decisions_of())
    np.savez_compressed(made / "privileged/truth.npz", option_value=np.array([VALUES] * 3, np.float32))
    return made


def enter(folder: Path, name: str) -> None:
    """Append the line of an episode to the manifest, with the hashes that its files have now."""
    hashes = hashes_of(folder / name)
    entry = Entry(name, 0, "", 0, 0, 0.0, content_of(hashes), hashes, {})
    with (folder / MANIFEST).open("a") as file:
        file.write(entry.line())
