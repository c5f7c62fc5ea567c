"""A floor with boxes on it, in real physics: robots and skills can be tested there without assets and rendering."""

from __future__ import annotations

from dataclasses import dataclass, field

import gymnasium as gym
import numpy as np
import sapien
import torch
from mani_skill.envs.sapien_env import BaseEnv
from mani_skill.utils.registration import REGISTERED_ENVS, register_env
from mani_skill.utils.structs.types import SimConfig

from hazard_ms.sensing.semantic_map import SemanticMap
from hazard_ms.sensing.sighting import Sighting
from hazard_ms.simulation.robot import Robot
from hazard_ms.simulation.world import World
from hazard_ms.skills.context import LowLevel, Skill, Stage
from hazard_ms.skills.decision import Result
from hazard_ms.spec import AgentStart, Body, Fixture, Room, SceneSpec
from hazard_ms.spec.registry import ROBOTS
from hazard_ms.tasks.episode.grasp import Hand, places, update

ENV_ID = "HazardTestArena-v1"
BAG_REACH = 0.45  # as in the environment [m]
ROOM = 4.0  # what is explored: this far from the origin to all sides [m]


@dataclass(frozen=True)
class Box:
    name: str
    centre: tuple[float, float, float]
    size: tuple[float, float, float]
    mass: float = 0.0  # 0: fixed
    target: bool = True


class ArenaEnv(BaseEnv):
    SUPPORTED_ROBOTS = tuple(kind.uid for kind in ROBOTS.values())
    boxes: tuple[Box, ...] = ()
    rate = (120, 30)

    @property
    def _default_sim_config(self) -> SimConfig:
        return SimConfig(sim_freq=self.rate[0], control_freq=self.rate[1])

    def _load_agent(self, options: dict) -> None:
        super()._load_agent(options, sapien.Pose())

    def _load_scene(self, options: dict) -> None:
        self.actors = {}
        for box in (Box("floor", (0, 0, -0.5), (20, 20, 1)), *self.boxes):
            builder = self.scene.create_actor_builder()
            half = [s / 2 for s in box.size]
            builder.add_box_collision(half_size=half, density=max(box.mass, 1.0) / float(np.prod(box.size)))
            builder.initial_pose = sapien.Pose(list(box.centre))
            self.actors[box.name] = builder.build(box.name) if box.mass else builder.build_static(box.name)

    def _initialize_episode(self, env_idx: torch.Tensor, options: dict) -> None:
        self.agent.place(env_idx, torch.zeros(len(env_idx), 2), torch.zeros(len(env_idx)))
        for box in self.boxes:
            if box.mass:
                self.actors[box.name].set_pose(sapien.Pose(list(box.centre)))
                self.actors[box.name].set_linear_velocity([0, 0, 0])
                self.actors[box.name].set_angular_velocity([0, 0, 0])


if ENV_ID not in REGISTERED_ENVS:
    register_env(ENV_ID)(ArenaEnv)


def _spec(boxes: tuple[Box, ...]) -> SceneSpec:
    def base(box: Box) -> tuple[float, float, float]:
        return box.centre[0], box.centre[1], box.centre[2] - box.size[2] / 2

    bodies = tuple(Body(b.name, "bottle" if b.target else "book", "", base(b)) for b in boxes if b.mass)
    fixtures = tuple(Fixture(b.name, "table", "", base(b)) for b in boxes if not b.mass)
    return SceneSpec("arena", Room((8.0, 8.0)), fixtures, bodies, ("bottle",), (), AgentStart((0.0, 0.0)))


@dataclass
class Arena:
    """Boxes as a World, a hand that holds, and a map that shows everything within the room."""

    boxes: tuple[Box, ...]
    rate: tuple[int, int] = (120, 30)
    control_mode: str = "pd_joint_pos"
    robot: str = "fetch"
    looks: int = 0
    env: gym.Env = field(init=False)

    def __post_init__(self) -> None:
        self.boxes = tuple(sorted(self.boxes, key=lambda b: b.mass == 0.0))  # bodies, then fixtures
        kind = type("ArenaOf", (ArenaEnv,), {"boxes": self.boxes, "rate": self.rate})
        REGISTERED_ENVS[ENV_ID].cls = kind
        self.env = gym.make(
            ENV_ID,
            robot_uids=ROBOTS[self.robot].uid,
            control_mode=self.control_mode,
            obs_mode="none",
            reward_mode="none",
            render_backend="none",
            sim_backend="physx_cpu",
        )
        self.base = self.env.unwrapped
        self.restart()

    @property
    def agent(self) -> Robot:
        return self.base.agent

    def restart(self, x: float = 0.0, y: float = 0.0, heading: float = 0.0, known: bool = True) -> None:
        self.env.reset(seed=0, options={"reconfigure": True})
        self.agent.place(torch.tensor([0]), torch.tensor([[x, y]]), torch.tensor([heading]))
        spec = _spec(self.boxes)
        sizes, masses = [b.size for b in self.boxes], [max(b.mass, 1.0) for b in self.boxes]
        self.world = World.of((spec,), [sizes], [masses])
        self.hand = Hand.allocate({"E": 1, "B": len(self.boxes)}, "cpu")
        self.map = SemanticMap((x, y), np.array([b.mass > 0.0 for b in self.boxes]))
        self.looks = 0
        if known:
            self.look()
        self.stage = Stage(self, self.map, self.look)
        self.looks = 0

    def index(self, name: str) -> int:
        return self.world.index(0, name)

    def look(self) -> None:
        """See everything: an ideal camera, so that these tests are about moving."""
        self.looks += 1
        seen = self.map
        y, x = np.mgrid[0 : len(seen.explored), 0 : len(seen.explored)]
        x, y = seen.origin[0] + (x + 0.5) * seen.cell, seen.origin[1] + (y + 0.5) * seen.cell
        seen.explored |= (np.abs(x) < ROOM) & (np.abs(y) < ROOM)
        seen._firm[:] = 0.0
        for i in range(len(self.boxes)):
            if bool(self.world.held[0, i] | self.world.safe[0, i]):
                continue
            centre, half = self.world.position[0, i].numpy(), self.world.extent[0, i].numpy() / 2
            under = (np.abs(x - centre[0]) < half[0] + 0.05) & (np.abs(y - centre[1]) < half[1] + 0.05)
            seen._firm[under] = np.maximum(seen._firm[under], centre[2] + half[2])
            seen.objects[i] = Sighting(centre.copy(), float(np.hypot(*half[:2])), float(centre[2] + half[2]), 0, 99)

    def step(self, action: LowLevel) -> None:
        self.env.step(action)
        for i, box in enumerate(self.boxes):
            if box.mass:
                pose = self.base.actors[box.name].pose
                self.world.position[0, i], self.world.rotation[0, i] = pose.p[0], pose.q[0]
        self.world.chance.tick()
        gripper, rotation = self.agent.gripper_pose()
        dropped = int(update(self.hand, self.world, gripper, rotation, self.agent.grip_closed())[0])
        if dropped >= 0 and float((gripper - self.agent.bag_position()).norm()) < BAG_REACH:
            self.world.safe[0, dropped] = self.world.away[0, dropped] = True
        self._carry()

    def _carry(self) -> None:
        """What is held follows the gripper and touches nothing."""
        gripper, rotation = self.agent.gripper_pose()
        _, base, turn = places(self.hand, self.world, gripper, rotation)
        for i in torch.nonzero(self.world.held[0] | self.world.safe[0]).flatten().tolist():
            actor = self.base.actors[self.boxes[i].name]
            actor.set_pose(sapien.Pose(base[0, i].numpy(), turn[0, i].numpy()))
            actor.set_linear_velocity([0, 0, 0])
            for shape in actor._bodies[0].collision_shapes:
                shape.set_collision_groups([0, 0, 0, 0])

    def run(self, doing: Skill, limit: int = 1500) -> Result:
        """Do a skill to its end and check that it counts its frames right; more than `limit` frames is a hang."""
        frames = 0
        try:
            action = next(doing)
            while True:
                assert action.shape == self.agent.single_action_space.shape and np.isfinite(action).all()
                self.step(action)
                frames += 1
                assert frames <= limit, "a skill hangs"
                action = next(doing)
        except StopIteration as ended:
            assert ended.value.frames == frames
            return ended.value

    def close(self) -> None:
        self.env.close()
