"""A watcher that takes down an episode while it is played: every frame, every decision."""

from __future__ import annotations

import copy
from dataclasses import replace
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray

from hazard_ms.demonstrations.layout import STATE_EVERY
from hazard_ms.demonstrations.watching.played_options import PlayedOptions
from hazard_ms.demonstrations.watching.prompts import prompt
from hazard_ms.demonstrations.watching.sentences import WAITING, sentence
from hazard_ms.evaluation.watchers import Watcher
from hazard_ms.skills.context import LowLevel
from hazard_ms.skills.decision import VERBS, Action, Decision, Result
from hazard_ms.skills.executor import SkillEnv
from hazard_ms.skills.options.features import Encoder

Arrays = dict[str, NDArray[Any]]

TYPES = {  # of arrays whose numbers are not float32
    "held": np.int16,
    "subtask": np.int16,
    "decision": np.int16,
    "terminated": np.bool_,
    "truncated": np.bool_,
    "success": np.bool_,
    "state_frame": np.int32,
    "frame": np.int32,
    "verb": np.int8,
    "target": np.int16,
    "ok": np.bool_,
    "frames": np.int32,
    "mask": np.bool_,
    "option": np.int16,
    "option_start": np.bool_,
}


class Recorder(Watcher):
    """Takes down an episode; `frames()`, `decisions()` and `meta()` give what it has, in the form of the files."""

    def __init__(self, privileged: bool, state: bool = False) -> None:
        """Record a teacher; `privileged`: whether it tells the map what is hidden.

        With `state`, observations of the mode "state" are recorded, in which the environment must have been made.
        """
        self._privileged, self._with_obs = privileged, state

    def begin(self, env: SkillEnv, decision: Decision) -> None:
        """Take down the first state; nothing may have been told to the map before."""
        self._env = env
        base = env.base
        self._seen = copy.deepcopy(env.seen) if self._privileged else env.seen
        if self._privileged:  # features are those of an agent that was told nothing
            env.maps.append(self._seen)
        self._encoder = Encoder([(h.level.low, h.level.high) for h in base.task.hazards], base.agent.build.radius)
        self._options = PlayedOptions()
        self._frames: dict[str, list[Any]] = {}
        self._decisions: dict[str, list[Any]] = {}
        self._prompts: list[dict[str, Any]] = []
        self._subtasks = {WAITING: 0}
        self._subtask = 0
        self._done = 0  # decisions that have ended
        self._brief, self._meta = env.brief(), _described(env)
        self._put_state()

    def decided(self, decision: Decision, action: Action, note: str) -> None:
        """Take down a decision as an agent without privileges sees it; `note` is part of the result."""
        table = self._env.base.observer.table
        seen = replace(
            decision,
            map=self._seen.frozen(),
            targets=table.rows(self._env.base.world, 0, self._seen.seen_damaged),
        )
        label = self._options.decided(seen, action)
        text = sentence(action, decision)
        self._subtask = self._subtasks.setdefault(text, len(self._subtasks))
        self.option_starts = label.starts
        self._prompts.append(prompt(self._brief, seen, label.menu))
        target = -1 if action.target is None else _names(self._env).index(action.target)
        _put(
            self._decisions,
            frame=decision.frame,
            verb=_verbs(self._env).index(action.verb),
            target=target,
            features=self._encoder.encode(seen, label.menu),
            mask=label.menu.mask,
            option=label.number,
            option_start=label.starts,
        )

    def frame(self, action: LowLevel) -> None:
        """Take down a frame that passed under `action`, [A], in the units of the robot's controllers."""
        base = self._env.base
        info = base.get_info()
        broken = bool(info["sim_error"][0])
        reward = 0.0 if broken else float(base.get_reward(None, torch.as_tensor(action)[None], info)[0])
        _put(
            self._frames,
            action=np.array(action, np.float32),
            reward=reward,
            success=bool(info["success"][0]),
            terminated=not broken and bool(info["success"][0] or info["fail"][0]),
            truncated=broken or self._env.frame >= self._env.max_frames,
            subtask=self._subtask,
            decision=self._done,
        )
        self._put_state()

    def ended(self, result: Result) -> None:
        """Take down how an action ended."""
        _put(self._decisions, ok=result.ok, frames=result.frames)
        self._options.ended(result)
        self._done += 1
        self._subtask = 0  # what passes before the next action, it waits

    def _put_state(self) -> None:
        """Take down the state between two frames."""
        base, robot = self._env.base, self._env.base.agent
        _put(
            self._frames,
            qpos=robot.robot.get_qpos()[0].cpu().numpy().copy(),
            qvel=robot.robot.get_qvel()[0].cpu().numpy().copy(),
            base=np.array(robot.base(), np.float32),
            hand=robot.hand().astype(np.float32),
            held=int(base.hand.held[0]),
        )
        if base.task.hazards:
            levels = base.episode.levels(robot.gripper_pose()[0][:, None])
            _put(self._frames, hazard=levels[0, :, 0].cpu().numpy().copy())
        if self._with_obs:
            _put(self._frames, obs=base.get_obs()[0].cpu().numpy().copy())
        if self._env.frame % STATE_EVERY == 0:
            _put(self._frames, state_frame=self._env.frame, state=base.get_state()[0].cpu().numpy().copy())

    def frames(self) -> Arrays:
        """The arrays of frames.npz, [T, ...] or [T + 1, ...] each, as docs/demonstrations.md lists them."""
        return _arrays(self._frames)

    def decisions(self) -> Arrays:
        """The arrays of decisions.npz, [N, ...] each, as docs/demonstrations.md lists them."""
        return _arrays(self._decisions)

    def meta(self) -> dict[str, Any]:
        """The entries of episode.json that only the environment knows."""
        return {**self._meta, "subtasks": list(self._subtasks), "prompts": self._prompts}


def _described(env: SkillEnv) -> dict[str, Any]:
    """What stays the same throughout an episode."""
    base, brief = env.base, env.brief()
    return {
        "instruction": brief.text,
        "robot": brief.robot,
        "control_mode": base.agent.control_mode,
        "joints": [joint.name for joint in base.agent.robot.active_joints],
        "fps": float(base.control_freq),
        "hazards": [f"{hazard.name}.{hazard.level.title}" for hazard in base.task.hazards],
        "things": _names(env),
        "targets": [target.name for target in brief.targets],
        "verbs": _verbs(env),
        "seeds": {"episode": int(base.world.chance.seed[0]), "agent": brief.random_seed},
        "reward_mode": base.reward_mode,
    }


def _verbs(env: SkillEnv) -> list[str]:
    return [*VERBS, *env.verbs]


def _names(env: SkillEnv) -> list[str]:
    """Names of the things, and behind them, in tasks with mitigations, those of doors and windows."""
    return [*env.base.world.names[0], *(env.stage.doors.names if env.base.task.mitigations else ())]


def _put(arrays: dict[str, list[Any]], **entries: Any) -> None:
    for name, entry in entries.items():
        arrays.setdefault(name, []).append(entry)


def _arrays(lists: dict[str, list[Any]]) -> Arrays:
    return {name: np.asarray(entries, TYPES.get(name, np.float32)) for name, entries in lists.items()}
