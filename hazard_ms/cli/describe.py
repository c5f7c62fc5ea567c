"""The command `hazard-ms describe`: what a learner exchanges with an environment, number by number."""

from __future__ import annotations

import json as json_format
from typing import Annotated

from hazard_ms.evaluation.choices import flag, offer
from hazard_ms.spec.registry import ROBOTS, TASKS, load_plugin

MODES = ("state", "state_dict", "rgb+depth+segmentation", "pointcloud", "sensor_data", "none")


def env_ids() -> tuple[str, ...]:
    """Ids of the environments of all registered tasks, and of their environments of skills."""
    return (*TASKS, *(name.replace("-v", "Skills-v") for name in TASKS))


def describe(
    env_id: Annotated[str, offer(env_ids()), flag("-e")] = "HazardFire-v1",
    obs_mode: Annotated[str, offer(MODES, "A+B"), flag("-o")] = "state_dict",
    robot_uids: Annotated[str, offer(ROBOTS), flag("--robot", "-r")] = "fetch",
    control_mode: str | None = None,
    affects_agent: bool = False,
    load: tuple[str, ...] = (),
    json: bool = False,
    markdown: bool = False,
) -> int:
    """Print what each number of observation, action, reward and info is: its shape, type, unit, frame and range.

    Args:
        env_id: Environment, or its environment of skills.
        obs_mode: Observation mode; skills have only one.
        robot_uids: Robot.
        control_mode: Control mode, by default the robot's own.
        affects_agent: Let the hazards act on the robot, which adds entries of info.
        load: Modules, or files NAME.py, that register your own tasks and robots.
        json: Print everything as JSON.
        markdown: Print the page docs/observations.md, which describes all environments, instead.
    """
    from hazard_ms.skills.options.description import lines, plain, sections_of
    from hazard_ms.skills.options.interface_page import page
    from hazard_ms.spec.checks import one_of

    for module in load:
        load_plugin(module)
    if markdown:
        print(page(tuple(TASKS), tuple(ROBOTS)), end="")
        return 0
    name = one_of(env_id.removeprefix("hazard_ms:"), env_ids(), "env_id")
    sections = sections_of(name, obs_mode, robot_uids, control_mode=control_mode, affects_agent=affects_agent)
    if json:
        print(json_format.dumps({title: [plain(row) for row in rows] for title, rows in sections.items()}, indent=1))
        return 0
    for title, rows in sections.items():
        print(title.upper())
        for row in rows:
            print("\n".join(lines(row)))
    return 0
