"""Skills of several robots at the same time: each robot is asked again when its own skill is over.

Every robot has a map of its own. All are told what is rescued, and where the other robots' bases and hands are: paths
go round them, no base drives at one that is close ahead, and who may reach out lets pass who walks close by. All else
they must tell one another.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Any

import gymnasium as gym

from hazard_ms.env import HazardEnv
from hazard_ms.env.time_limit import is_bare
from hazard_ms.sensing.detection.perception import TRUTH, perception
from hazard_ms.skills.actions import skill
from hazard_ms.skills.brief import Brief
from hazard_ms.skills.context import LowLevel
from hazard_ms.skills.decision import (
    DROP,
    PICK_UP,
    STOP,
    WALK_ONE_STEP,
    WALK_TO,
    Action,
    Decision,
    Message,
    Result,
)
from hazard_ms.skills.doing import Doing
from hazard_ms.skills.failures import BLOCKED
from hazard_ms.skills.knowledge import Knowledge, OneRobot
from hazard_ms.skills.mitigations.offers import check
from hazard_ms.skills.spacing import would_touch
from hazard_ms.skills.telling import named_in
from hazard_ms.spec.registry.mitigations import TELL
from hazard_ms.spec.registry.robots import robot_names, skill_control_mode

WALKING, REACHING = (WALK_TO, WALK_ONE_STEP), (PICK_UP, DROP)  # verbs
PASSING = 1.3  # distance of two bases within which a robot that may reach out lets one that walks pass [m] [ours]
PATIENCE = 90  # frames for which it does so at most in an action [ours]


class TeamSkills:
    """Runs the skills of all robots of a hazard environment, one or more, frame by frame. Perception is the truth."""

    def __init__(self, env: gym.Env) -> None:
        """Wrap `env`. Raises ValueError for environments in which skills cannot act."""
        base: Any = env.unwrapped
        if not isinstance(base, HazardEnv):
            raise ValueError(f"the environment of skills must be a HazardEnv, got {type(base).__name__}")
        for name, robot in base.robots.items():
            if robot.control_mode != robot.skill_control_mode:
                wanted, given = robot.skill_control_mode, robot.control_mode
                raise ValueError(f"gym.make's control_mode must be {wanted!r} for skills of {name}, got {given!r}")
        if not base.observer.renders:
            raise ValueError(
                "render_backend must be a renderer, got none: skills look through a camera (see `hazard-ms doctor`)"
            )
        self.env, self.base, self.names = env, base, tuple(base.robots)
        self.watch: Callable[[dict[str, LowLevel]], None] | None = None  # called after each frame, with its moves
        self._limit = None if env.spec is None else env.spec.max_episode_steps
        self._running: dict[str, Doing] = {}  # what each robot does
        self._stopped: set[str] = set()
        self._over = True

    @classmethod
    def make(cls, env_id: str, robot_uids: Any, **keywords: Any) -> TeamSkills:
        """A new environment for the skills of the robots `robot_uids`, made with `keywords` of gym.make.

        Raises ValueError for keywords that are not allowed, and where nothing renders.
        """
        mode = skill_control_mode(robot_names(robot_uids)[0])
        made = gym.make(env_id, **{"obs_mode": "none", "control_mode": mode, "robot_uids": robot_uids, **keywords})
        try:
            return cls(made)
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
    def collisions(self) -> int:
        """Collisions of robots with one another so far."""
        return 0 if self.base.contacts is None else int(self.base.contacts.record.count[0])

    @property
    def free(self) -> tuple[str, ...]:
        """Names of the robots that need an action: they have not stopped, and no skill of theirs runs."""
        return tuple(n for n in self.names if n not in self._running and n not in self._stopped)

    @property
    def stopped(self) -> frozenset[str]:
        """Names of the robots that have stopped for good."""
        return frozenset(self._stopped)

    @property
    def doing(self) -> dict[str, Action]:
        """The actions that are under way, by robot."""
        return {name: doing.action for name, doing in self._running.items()}

    def brief(self, name: str) -> Brief:
        """Everything that the agent of the robot `name` is told before the episode."""
        return self.knowledge[name].brief(self.names.index(name))

    def reset(
        self, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[dict[str, Decision], dict[str, Any]]:
        """Start an episode, as the environment's own reset, with a first look of every robot; decisions by name."""
        _, info = self.env.reset(seed=seed, options=options)
        base = self.base
        self.knowledge: dict[str, Knowledge] = {}
        for member, observer in zip(base.members, base.observers, strict=True):
            episode = member.situation.episode
            robot = OneRobot(member.agent, member.world, member.hand, episode, float(base.control_timestep))
            known = Knowledge(base, robot, observer, perception(TRUTH), self.max_frames)
            known.stage.others = tuple(m.agent for m in base.members if m is not member)
            known.look()
            self.knowledge[member.name] = known
        self._running, self._stopped, self._over = {}, set(), False
        return {name: self.decision(name) for name in self.names}, info

    def decision(self, name: str) -> Decision:
        """All that the robot `name` may know now."""
        others = {other: robot.base()[:2] for other, robot in self.base.robots.items() if other != name}
        return self.knowledge[name].decision(others)

    def step(self, actions: Mapping[str, Action]) -> tuple[dict[str, Decision], bool, bool, dict[str, Any]]:
        """Begin `actions`, one for each robot that is free, and let time pass until a skill is over.

        An action that takes no frame costs one, in which the robot stands. The episode terminates with the goal, or
        when all have stopped. Returns the decisions of the robots that are free then, whether the episode is
        terminated, whether it is truncated, and info with the `Result` of each action that ended as "results".

        Raises ValueError for robots that are not free or left out, and for actions that are none or name nothing that
        is there; the episode is left unchanged.
        """
        self.check(actions)
        for name, action in actions.items():
            if action.verb == STOP:
                self._stopped.add(name)
            else:
                self._running[name] = Doing(action, skill(self.knowledge[name].stage, action), self.frame)
        results: dict[str, Result] = {}
        info = self.base.get_info()
        while self._running and not results and not self._over:
            waiting = {name for name in self._running if self._waits(name)}
            info = self._frame({name: self._move(name, name in waiting) for name in self.names})
            for name, doing in [*self._running.items()]:
                result = self._go_on(doing, name in waiting)
                if result is not None:
                    results[name] = self._finish(name, result)
        terminated = bool(info["success"][0] or info["fail"][0]) or not (self._running or self.free)
        for name in [*self._running] if terminated or self._over else ():
            results[name] = self._finish(name, self._running[name].break_off(self.frame))
        truncated, self._over = self._over, self._over or terminated
        info["results"] = results
        return {name: self.decision(name) for name in self.free}, terminated, truncated and not terminated, info

    def _move(self, name: str, waits: bool) -> LowLevel:
        """What a robot does in the coming frame; it stands where nothing runs, and stays as it is while it waits."""
        doing, stage = self._running.get(name), self.knowledge[name].stage
        if waits:
            return stage.still()
        return stage.act() if doing is None or doing.move is None else doing.move

    def _go_on(self, doing: Doing, waits: bool) -> Result | None:
        """Let an action decide on its next move, unless it waits; one that has waited for too long is broken off."""
        if not waits:
            return doing.go_on(self.frame)
        return doing.break_off(self.frame, BLOCKED) if doing.waited > PATIENCE else None

    def _waits(self, name: str) -> bool:
        """Whether a robot lets another one pass: its arm may reach out, and that one walks close by, or they meet.

        It does so for PATIENCE; after that, who would meet another's body has waited for too long, and others go on.
        """
        doing = self._running[name]
        meets = would_touch(self.knowledge[name].stage)
        waits = meets or (doing.action.verb in REACHING and self._passed_by(name))
        doing.waited += waits
        return waits and (meets or doing.waited <= PATIENCE)

    def _passed_by(self, name: str) -> bool:
        """Whether another robot walks close by."""
        here = self.base.robots[name].base()[:2]
        walkers = (other for other, o in self._running.items() if other != name and o.action.verb in WALKING)
        return any(math.dist(here, self.base.robots[other].base()[:2]) < PASSING for other in walkers)

    def check(self, actions: Mapping[str, Action]) -> None:
        """Check `actions` as `step` does. Raises ValueError for what it refuses."""
        if self._over:
            raise ValueError("the episode must be running, but it is over: call reset first")
        if set(actions) != set(self.free):
            raise ValueError(f"actions must be for {', '.join(self.free)}, got them for {', '.join(actions) or 'none'}")
        for name, action in actions.items():
            if not isinstance(action, Action):
                raise ValueError(f"the action of {name} must be an Action(verb, target), got {action!r}")
            check(action, self.knowledge[name].stage, self.knowledge[name].verbs)

    def _frame(self, moves: dict[str, LowLevel]) -> dict[str, Any]:
        """Let one frame pass; wrappers of others see it."""
        given = moves if len(moves) > 1 else moves[self.names[0]]
        info = self.base.advance(given) if is_bare(self.env) else self.env.step(given)[4]
        over = bool(info["success"][0] or info["fail"][0] or info["sim_error"][0])
        self._over = over or self.frame >= self.max_frames
        if self.watch is not None:
            self.watch(moves)
        return info

    def _finish(self, name: str, result: Result) -> Result:
        """Note that the action of the robot `name` has ended with `result`, after a look."""
        action = self._running.pop(name).action
        self.knowledge[name].ended(action, result)
        if action.verb == TELL and result.ok:
            self._hand_over(name, str(action.target))
        if not bool(self.base.episode.sim_error[0]):
            self.knowledge[name].look()
        return result

    def _hand_over(self, name: str, text: str) -> None:
        """Let all others hear what the robot `name` tells, and where it has seen the things in it."""
        knows = self.knowledge[name]
        named = [knows.labeller.index(thing) for thing in named_in(text, knows.labeller.names)]
        seen = {index: knows.seen.objects[index] for index in named if index in knows.seen.objects}
        for other in self.names:
            if other != name:
                self.knowledge[other].hear(Message(self.frame, name, text), seen)

    def rest(self, frames: int) -> None:
        """Let `frames` frames pass in which all robots stand, whatever is under way; fewer if the simulation breaks."""
        for _ in range(frames):
            if not bool(self.base.episode.sim_error[0]):
                self._frame({name: self.knowledge[name].stage.act() for name in self.names})

    def close(self) -> None:
        """Close the environment."""
        self.env.close()
