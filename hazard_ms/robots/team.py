"""Several robots in one environment, by ManiSkill's convention: actions and observations are dicts by the robot's name.

Names are those of the robots with their number, "fetch-0" and "g1-1". Cameras are called by the robot that carries them
and their own name, "fetch-0-head".
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from mani_skill.agents.multi_agent import MultiAgent

from hazard_ms.spec.registry.robots import robot_name

OWN_BITS = 0b1110  # of collision group 2, by which parts of one robot pass through one another: those of ManiSkill's G1
OWN_HIGH_BITS = 0b111 << 29  # 29: links of a robot without collisions of its own; 30, 31: what Fetch glides over
STEP = 3  # by which these bits are shifted from robot to robot


class Team(MultiAgent[Any]):
    """The robots of one environment as one agent of ManiSkill's."""

    def __init__(self, robots: Sequence[Any]) -> None:
        """Put together `robots` that have been loaded; renames their cameras, and lets them collide with each other."""
        self.agents, self.scene = list(robots), robots[0].scene
        self.agents_dict = {f"{robot_name(robot.uid)}-{number}": robot for number, robot in enumerate(robots)}
        self.sensor_configs = []
        self._sensor_config_agent_map = {}
        for number, (name, robot) in enumerate(self.agents_dict.items()):
            robot.head_camera = f"{name}-{robot.head_camera}"
            for config in robot._sensor_configs:
                self.sensor_configs.append(config)
                self._sensor_config_agent_map[config.uid] = number
            _set_apart(robot, number)

    def get_proprioception(self) -> dict[str, Any]:
        """Positions and velocities of the joints of each robot, by its name, as ManiSkill gives them."""
        return {name: robot.get_proprioception() for name, robot in self.agents_dict.items()}

    def before_simulation_step(self) -> None:
        """Let those controllers go on that have something to do in the middle of a frame."""
        for robot in self.agents:
            robot.before_simulation_step()

    def set_controller_state(self, state: dict[str, Any]) -> None:
        """Restore the states of the controllers of those robots that have one in `state`, by name."""
        for name, one in state.items():
            self.agents_dict[name].set_controller_state(one)


def _set_apart(robot: Any, number: int) -> None:
    """Give the parts of robot `number` bits of its own: with those of another robot they would pass through it."""
    for shape in (s for link in robot.robot.links for body in link._bodies for s in body.collision_shapes):
        groups = shape.get_collision_groups()
        low, high = groups[2] & OWN_BITS, groups[2] & OWN_HIGH_BITS
        groups[2] ^= low | high
        groups[2] |= low << STEP * number | high >> STEP * number
        shape.set_collision_groups(groups)


def team_of(env: Any) -> dict[str, Any]:
    """The robots of `env`, a BaseEnv that has loaded them, by name; its MultiAgent, if it has one, becomes a Team."""
    if not isinstance(env.agent, MultiAgent):
        return {f"{robot_name(env.agent.uid)}-0": env.agent}
    env.agent = Team(env.agent.agents)
    return dict(env.agent.agents_dict)
