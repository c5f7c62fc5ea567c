"""ManiSkill's trajectories: one .h5 with everything that has a frame, and a .json that describes the episodes.

The layout is that of `mani_skill.utils.wrappers.record.RecordEpisode` 3.0.1: in `traj_K`, T actions stand between T + 1
observations and states.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from hazard_ms.demonstrations.export.simulator import simulated
from hazard_ms.demonstrations.export.source import HIDDEN, STATE, Source
from hazard_ms.demonstrations.reading import Demonstration

BACKEND = "physx_cpu"  # of all recordings: ManiSkill's word for it
LEVEL = 5  # of gzip, as in RecordEpisode
ARRAYS = {  # arrays of frames.npz under their names in ManiSkill
    "action": ("actions", np.float32),
    "terminated": ("terminated", bool),
    "truncated": ("truncated", bool),
    "success": ("success", bool),
    "reward": ("rewards", np.float32),
    "subtask": ("subtask", np.int16),
}


def write(source: Source, folder: Path) -> str:
    """Write `trajectory.OBS.CONTROL.physx_cpu.h5` and its .json into `folder`. Returns the name of the .h5.

    Raises ValueError for an episode that does not come out as it was recorded, where it has to be simulated again.
    """
    import h5py

    common = source.common
    obs = source.obs or (STATE if common.observed else HIDDEN)
    name = f"trajectory.{obs}.{common.control_mode}.{BACKEND}"
    episodes = []
    with h5py.File(folder / f"{name}.h5", "w") as file, simulated(source) as play:
        for number, one in enumerate(source):
            seen, states = play(one) if play else ({}, {})
            if source.obs is None and common.observed:
                seen = one.frames["obs"]
            group = file.create_group(f"traj_{number}", track_order=True)
            _add(group, "obs", seen)
            for key, (theirs, dtype) in ARRAYS.items():
                _add(group, theirs, one.frames[key].astype(dtype))
            if source.states:
                _add(group, "env_states", states)
            if source.privileged:
                _add(group, "privileged", one.privileged())
            episodes.append(_episode(number, one, source))
    (folder / f"{name}.json").write_text(json.dumps(_description(source, obs, episodes), indent=2) + "\n")
    return f"{name}.h5"


def _add(group: Any, key: str, tree: Any) -> None:
    """Add nested arrays to a group of the file; all but small ones are compressed."""
    if isinstance(tree, Mapping):
        inner = group.create_group(key, track_order=True)
        for name, entry in tree.items():
            _add(inner, name, entry)
    else:
        group.create_dataset(key, data=tree, compression="gzip", compression_opts=LEVEL)


def _episode(number: int, one: Demonstration, source: Source) -> dict[str, Any]:
    """The entry of an episode in the .json."""
    options = source.options(one)
    return {
        "episode_id": number,
        "episode_seed": options.seed,
        "control_mode": source.common.control_mode,
        "elapsed_steps": len(one.frames["action"]),
        "reset_kwargs": {"options": options.reset_options, "seed": options.seed},
        "success": bool(one.frames["success"][-1]),
        "info": {
            "scene": one.result.scene,
            "value": one.result.tally.value,
            "ended": one.result.ended,
            "instruction": one.meta["instruction"],
            "subtasks": one.meta["subtasks"],  # what the numbers of `subtask` stand for
            "teacher": one.meta["teacher"],
            "privileged": one.meta["privileged"],
        },
    }


def _description(source: Source, obs: str, episodes: list[dict[str, Any]]) -> dict[str, Any]:
    """The .json as a whole."""
    common = source.common
    modes = {"obs_mode": obs, "control_mode": common.control_mode, "reward_mode": common.reward_mode}
    return {
        "env_info": {
            "env_id": f"hazard_ms:{common.env_id}",  # a tool that makes it imports the package by itself
            "env_kwargs": {**modes, "sim_backend": BACKEND, **common.settings},
            "max_episode_steps": common.max_frames,
        },
        "episodes": episodes,
        "source_type": "motionplanning",
        "source_desc": f"Rescues by the agent {common.agent} of hazard_ms. {source.action_text}",
    }
