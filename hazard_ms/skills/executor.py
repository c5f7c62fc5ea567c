"""SkillEnv, the environment at the level of decisions: an action is a verb and a target, and takes many frames."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, cast

import gymnasium as gym
import torch

from hazard_ms.env import HazardEnv
from hazard_ms.env.time_limit import is_bare
from hazard_ms.sensing.detection.labeller import Labeller
from hazard_ms.sensing.detection.perception import TRUTH, camera_of
from hazard_ms.sensing.detection.perception import perception as perception_of
from hazard_ms.sensing.semantic_map import SemanticMap
from hazard_ms.skills.actions import skill
from hazard_ms.skills.brief import Brief
from hazard_ms.skills.context import LowLevel, Skill, Stage
from hazard_ms.skills.decision import STOP, Action, Decision, Result
from hazard_ms.skills.failures import EPISODE_OVER
from hazard_ms.skills.knowledge import Knowledge
from hazard_ms.skills.mitigations.offers import check
from hazard_ms.spec.registry.robots import skill_control_mode


class SkillEnv:
    """Runs actions of the benchmark in a hazard environment with one scene. Low-level skills run too: `run(skill)`.

    Wrappers of the environment, such as ManiSkill's RecordEpisode, see every frame. Without any, frames are quicker:
    they leave out the observation.

    `skill` makes the generator that does an action: the benchmark's, unless it is set. `watch` is called after every
    frame with the low-level action, for films and recorders. At `until_frame` an action is broken off, and `step` says
    that the episode is truncated: for pictures of a frame. Looks are entered into all `maps`, of which the first is
    `seen`: privileged agents write into that one, so recorders may add their own.
    """

    def __init__(self, env: gym.Env, watch: Callable[[LowLevel], None] | None = None, perception: str = TRUTH) -> None:
        """Wrap `env`; `perception`: what tells agents of things, see `hazard_ms.sensing.detection.perception`.

        Raises ValueError for environments in which skills cannot act, and for a perception that cannot be.
        """
        base = env.unwrapped
        if not isinstance(base, HazardEnv):
            raise ValueError(f"the environment of skills must be a HazardEnv, got {type(base).__name__}")
        if base.num_envs != 1:
            raise ValueError(f"num_envs must be 1 for skills, got {base.num_envs}")
        if len(base.robots) != 1:
            raise ValueError(
                f"robot_uids must be one robot for SkillEnv, got {len(base.robots)}: TeamSkills plays several"
            )
        wanted = base.agent.skill_control_mode
        if base.agent.control_mode != wanted:
            given = base.agent.control_mode
            raise ValueError(f"gym.make's control_mode must be {wanted!r} for skills of this robot, got {given!r}")
        if not base.observer.renders:
            raise ValueError(
                "render_backend must be a renderer, got none: skills look through a camera (see `hazard-ms doctor`)"
            )
        self.env = env
        self._bare = is_bare(env)
        self._limit = None if env.spec is None else env.spec.max_episode_steps
        self.base = base
        self.watch, self.skill = watch, skill
        self._perception = perception_of(perception)
        self.until_frame: int | None = None
        self.colours = True  # whether decisions have pictures with colours: other looks take a third of the time
        self.look_seconds = 0.0  # wall time spent in looks since it was made
        self._over = True

    @classmethod
    def make(cls, env_id: str, perception: str = TRUTH, **keywords: Any) -> SkillEnv:
        """A new environment for skills, made with `keywords` of gym.make, in the control mode that skills need.

        Its head camera has the eyes of the `perception` unless `keywords` have `sensor_configs`.

        Raises ValueError for keywords and a `perception` that are not allowed, and where nothing renders.
        """
        mode = skill_control_mode(keywords.get("robot_uids", "fetch"))
        made = gym.make(env_id, **{"obs_mode": "none", "control_mode": mode, **camera_of(perception), **keywords})
        try:
            return cls(made, perception=perception)
        except ValueError:
            made.close()
            raise

    @property
    def max_frames(self) -> int:
        """Length of an episode at most."""
        return int(self._limit or self.base.task.max_frames)

    @property
    def frame(self) -> int:
        """Frames since the start of the episode."""
        return int(self.base.world.frame[0])

    @property
    def seen(self) -> SemanticMap:
        """The map of what has been seen so far; every look brings it up to date."""
        return self._knowledge.seen

    @property
    def maps(self) -> list[SemanticMap]:
        """All maps into which looks are entered, `seen` first."""
        return self._knowledge.maps

    @property
    def stage(self) -> Stage:
        """The episode as its skills see it."""
        return self._knowledge.stage

    @property
    def labeller(self) -> Labeller:
        """The things of the episode as its agent knows them; the map refers to them by their index there."""
        return self._knowledge.labeller

    @property
    def verbs(self) -> tuple[str, ...]:
        """The verbs that its agents have beyond the six of the benchmark; without a detector those of the task."""
        return self._knowledge.verbs

    def brief(self) -> Brief:
        """Everything that an agent is told before the episode: nothing that shows which scene it is."""
        return self._knowledge.brief()

    def reset(self, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[Decision, dict[str, Any]]:
        """Start an episode, as the environment's own reset, which says what it refuses, with a first look."""
        _, info = self.env.reset(seed=seed, options=options)
        senses = (self.base.observer, self._perception)
        self._knowledge = Knowledge(self.base, self.base, *senses, self.max_frames, self.look)
        self._reward, self._over = 0.0, False
        self.look(self.colours)
        return self.decision(), info

    def step(self, action: Action) -> tuple[Decision, float, bool, bool, dict[str, Any]]:
        """Do `action` to its end.

        Returns the next decision, the reward summed over its frames, whether the episode is terminated, whether it is
        truncated, and info, with the `Result` of the action as "result".

        Raises ValueError for anything but an Action, and for names that nothing has; the episode is left unchanged.
        """
        if self._over:
            raise ValueError("the episode must be running, but it is over: call reset first")
        if not isinstance(action, Action):
            raise ValueError(f"an action must be an Action(verb, target), got {action!r}")
        check(action, self.stage, self.verbs)
        self._reward, doing = 0.0, self.skill(self.stage, action)
        result = self.run(doing)
        self._knowledge.ended(action, result)
        info = self.base.get_info()
        terminated = action.verb == STOP or bool(info["success"][0]) or bool(info["fail"][0])
        truncated = self._broken_off()
        self._over = terminated or truncated
        if not bool(info["sim_error"][0]):
            self.look(self.colours)
        info["result"] = result
        return self.decision(), self._reward, terminated, truncated, info

    def close(self) -> None:
        """Close the environment."""
        self.env.close()

    def run(self, doing: Skill) -> Result:
        """Drive a skill to its end, or to the end of the episode."""
        frames = 0
        try:
            action = next(doing)
            while True:
                if self._broken_off():
                    doing.close()
                    return Result(False, EPISODE_OVER, frames)
                self._reward += self._frame(action)
                frames += 1
                if self.watch is not None:
                    self.watch(action)
                action = next(doing)
        except StopIteration as ended:
            return cast(Result, ended.value)

    def _frame(self, action: LowLevel) -> float:
        """Let one frame pass, and return its reward; wrappers of others see every frame, as recorders must."""
        if not self._bare:
            return float(self.env.step(action)[1])
        info = self.base.advance(action)
        if self.base.reward_mode == "none" or bool(info["sim_error"][0]):
            return 0.0
        return float(self.base.get_reward(None, torch.as_tensor(action)[None], info)[0])

    def _broken_off(self) -> bool:
        last = self.max_frames if self.until_frame is None else min(self.until_frame, self.max_frames)
        return self.frame >= last or bool(self.base.episode.sim_error[0])

    def look(self, colours: bool = False) -> None:
        """Look through the head camera, with `colours` or where a detector needs them, and enter what is seen."""
        before = self._knowledge.look_seconds
        self._knowledge.look(colours)
        self.look_seconds += self._knowledge.look_seconds - before

    def decision(self) -> Decision:
        """All that an agent may know now; the map is a copy that cannot be written to."""
        return self._knowledge.decision()
