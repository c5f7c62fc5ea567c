"""SkillEnv: the environment at the level of decisions. An action is a verb and a target; it takes as many frames as it needs."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import gymnasium as gym
import numpy as np
import torch

from hazard_ms.env import HazardEnv
from hazard_ms.sensing.semantic_map import SemanticMap, cells_for
from hazard_ms.skills.actions import skill
from hazard_ms.skills.decision import DROP, EXPLORE, PICK_UP, STOP, WALK_ONE_STEP, WALK_TO, Action, Decision, Images, Result
from hazard_ms.skills.failures import EPISODE_OVER
from hazard_ms.skills.stage import LowLevel, Skill, Stage
from hazard_ms.spec import Body, Fixture

CART = "cart"  # category of the containers of a task whose safe place is a cart


class SkillEnv:
    """Runs actions of the benchmark in a hazard environment with one scene. Low-level skills run too: `run(skill)`.

    `watch` is called after every frame with the low-level action: for videos and recorders.
    """

    def __init__(self, env: gym.Env, watch: Callable[[LowLevel], None] | None = None) -> None:
        base = env.unwrapped
        if not isinstance(base, HazardEnv):
            raise ValueError(f"skills run in a HazardEnv; this is a {type(base).__name__}")
        if base.num_envs != 1:
            raise ValueError(f"num_envs is {base.num_envs}; skills run in an environment with num_envs=1")
        wanted = base.agent.skill_control_mode
        if base.agent.control_mode != wanted:
            raise ValueError(f"control_mode is {base.agent.control_mode!r}; skills of this robot need {wanted!r}")
        if not base.observer.renders:
            raise ValueError("nothing renders here; skills look through the head camera: see `hazard-ms doctor`")
        self.env = env
        self._limit = None if env.spec is None else env.spec.max_episode_steps
        self.base = base
        self.watch = watch
        self.stage: Stage
        self._over = True

    @property
    def max_frames(self) -> int:
        """Length of an episode at most."""
        return int(self._limit or self.base.task.max_frames)

    @property
    def frame(self) -> int:
        """Frames since the start of the episode."""
        return int(self.base.world.frame[0])

    def reset(self, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[Decision, dict[str, Any]]:
        """Start an episode, as the environment's own reset, with a first look."""
        _, info = self.env.reset(seed=seed, options=options)
        world = self.base.world
        start = (float(world.agent_position[0, 0]), float(world.agent_position[0, 1]))
        self._seen = SemanticMap(start, world.movable[0].cpu().numpy(), cells=cells_for(self.base.specs[0].room.size))
        self.stage = Stage(self.base, self._seen, self.look)
        self._images: Images | None = None
        self._last: tuple[Action | None, Result | None] = (None, None)
        self._reward = 0.0
        self._over = False
        self.look()
        return self.decision(), info

    def step(self, action: Action) -> tuple[Decision, float, bool, bool, dict[str, Any]]:
        """Do `action` to its end. Returns the next decision, the reward summed over its frames, and how the episode stands.

        Raises ValueError for what is no action, or names nothing that there is; the episode is then as it was before.
        """
        if self._over:
            raise ValueError("the episode is over; call reset first")
        if not isinstance(action, Action):
            raise ValueError(f"{action!r} is no Action; give Action(verb, target)")
        self._check(action)
        doing = skill(self.stage, action)
        self._reward = 0.0
        result = self.run(doing)
        if action.verb == PICK_UP and result.ok and action.target is not None:
            self._seen.forget(self.base.world.index(0, action.target))
        self._last = (action, result)
        info = self.base.get_info()
        terminated = action.verb == STOP or bool(info["success"][0])
        truncated = self._out_of_time()
        self._over = terminated or truncated
        if not bool(info["sim_error"][0]):
            self.look()
        info["result"] = result
        return self.decision(), self._reward, terminated, truncated, info

    def _check(self, action: Action) -> None:
        if action.target is None:
            return
        if action.verb in (EXPLORE, STOP):
            raise ValueError(f"the target of {action.verb} is {action.target!r}; none is allowed")
        if action.verb == DROP and action.target not in self._containers():
            allowed = ", ".join(["none", *self._containers()])
            raise ValueError(f"the target of drop is {action.target!r}; allowed: {allowed}")

    def close(self) -> None:
        """Close the environment."""
        self.env.close()

    def run(self, doing: Skill) -> Result:
        """Drive a skill to its end, or to the end of the episode."""
        frames = 0
        try:
            action = next(doing)
            while True:
                if self._out_of_time():
                    doing.close()
                    return Result(False, EPISODE_OVER, frames)
                info = self.base.advance(action)
                frames += 1
                self._reward += float(self.base.get_reward(None, torch.as_tensor(action)[None], info)[0])
                if self.watch is not None:
                    self.watch(action)
                action = next(doing)
        except StopIteration as ended:
            result: Result = ended.value
            return result

    def _out_of_time(self) -> bool:
        return self.frame >= self.max_frames or bool(self.base.episode.sim_error[0])

    def look(self) -> None:
        """Look through the head camera and enter what is seen into the map."""
        rgb, view = self.base.observer.look()
        world, base = self.base.world, self.base
        gone = torch.nonzero(world.held[0] | world.away[0]).flatten().tolist()
        where = (float(world.agent_position[0, 0]), float(world.agent_position[0, 1]))
        for index in gone:
            self._seen.forget(index)
        self._seen.update(view, self.frame, where, gone, base.episode.damage.damaged[0].cpu().numpy())
        self._seen.mark_free(where, base.agent.build.radius)
        hazard = np.zeros((1, 1), np.float32) if view.level is None else view.level
        self._images = Images(rgb.cpu().numpy().copy(), view.depth, view.labels, hazard)

    def decision(self) -> Decision:
        """All that an agent may know now."""
        world, stage = self.base.world, self.stage
        x, y, heading = stage.robot.base()
        held = world.names[0][stage.held] if stage.held >= 0 else None
        containers = self._containers()
        return Decision(
            frame=self.frame,
            max_frames=self.max_frames,
            agent_position=(x, y),
            agent_heading=heading,
            held=held,
            targets=self.base.observer.table.rows(world, 0, self._seen.seen_damaged),
            containers=containers,
            map=self._seen,
            images=self._images,
            available=self._available(held, containers),
            names=world.names[0],
            last_action=self._last[0],
            last_result=self._last[1],
        )

    def _containers(self) -> tuple[str, ...]:
        if self.base.task.safe_place != CART:
            return ()
        spec = self.base.specs[0]
        things: tuple[Body | Fixture, ...] = (*spec.bodies, *spec.fixtures)
        return tuple(t.name for t in things if t.category == CART)

    def _available(self, held: str | None, containers: tuple[str, ...]) -> tuple[Action, ...]:
        """What makes sense to try: things that are known, and of these only targets can be picked up."""
        world = self.base.world
        made = [Action(EXPLORE), Action(STOP)]
        if held is not None:
            made += [Action(DROP), *(Action(DROP, c) for c in containers if world.index(0, c) in self._seen.objects)]
        for index in sorted(self._seen.objects):
            name = world.names[0][index]
            made += [Action(WALK_TO, name), Action(WALK_ONE_STEP, name)]
            if held is None and bool(world.target[0, index] & ~world.safe[0, index]):
                made.append(Action(PICK_UP, name))
        return tuple(made)
