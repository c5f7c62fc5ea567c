"""Puts together what an environment has of each of its robots: build, senses, and of several the watch on contacts."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from hazard_ms.sensing.display import Display
from hazard_ms.sensing.labels import labels_of
from hazard_ms.sensing.observations import Observer
from hazard_ms.simulation.crew import Crew
from hazard_ms.simulation.drawing.moved_cameras import MovedCameras
from hazard_ms.simulation.world import World
from hazard_ms.tasks.episode.encounters import Contacts


def enlist(world: World, robots: Iterable[Any]) -> None:
    """Tell `world` which `robots` take part: one, or those of a team, in order."""
    builds = tuple(robot.build for robot in robots)
    world.agent_build = builds[0]
    if len(builds) > 1:
        places = world.agent_position[:, None].repeat(1, len(builds), 1)
        world.team, world.agent_position = Crew(builds, places), places[:, 0]


def observers(env: Any) -> tuple[Observer, ...]:
    """The senses of each robot of `env`, a BuiltEnv whose scenes have just been built."""
    robots = [*env.robots.values()]
    labels = labels_of(env.scene, env.actors, [robot.robot for robot in robots], env.bags)
    cameras = (env._sensors, env._human_render_cameras)
    moved = MovedCameras(env._sensors, env.perturbation.camera)
    bags = [*zip(robots, env.bags, strict=True)]
    display = Display(env.situation, env.scene, bags, env.lights, cameras, env.effects_mode, moved)
    how = (env.task.observations, display, env._sensors, labels, env.senses, env.perturbation.noise)
    return tuple(Observer(member.situation, *how) for member in env.members)


def contacts(env: Any) -> Contacts | None:
    """The watch on contacts between the robots of `env`, kept in the records of its episode; None for one robot."""
    if len(env.robots) == 1:
        return None
    made = Contacts(env.scene.sub_scenes[0].physx_system, [*env.robots.values()], env.control_freq)
    env.episode.others["encounters"] = made.record
    return made
