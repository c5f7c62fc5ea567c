"""The page docs/observations.md, made from the same table as `hazard-ms describe`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from hazard_ms.sensing.observation_table import JOINT_MARGIN, OBSERVATION_VERSION, Row
from hazard_ms.skills.options.description import bounds, entries, sections_of
from hazard_ms.skills.options.feature_columns import FEATURES_VERSION, MEASURED_VERSION
from hazard_ms.skills.options.features import Encoder
from hazard_ms.skills.options.interface import describe
from hazard_ms.tasks.episode.rewards import FOR_HOLDING, FOR_NEARNESS, PER_RESCUE

HEAD = f"""# What a learner sees, does and gets

`hazard-ms describe --markdown > docs/observations.md` generates this page, and a test compares the two. For a single
environment and mode, run `hazard-ms describe -e ENV --obs-mode MODE --robot-uids ROBOT`, with `--json` for programs.

Version of the layout of observations: **{OBSERVATION_VERSION}**; of the features of skills: **{FEATURES_VERSION}**.
Adding or moving a key, or changing its shape, type or range, changes the version.

Shapes are for one environment; ManiSkill puts the number of environments in front. Ranges are the observation space's.
Positions and velocities have no bounds. Joints may be {JOINT_MARGIN} rad or m beyond their limits.
"""
FEW = 7  # numbers of a key that are told in its own line
REWARD = f"""
## Reward

The dense reward of a frame is {PER_RESCUE:g} for each target that becomes safe in it, half for a damaged one; plus
{FOR_HOLDING:g} while a target is in the hand; plus {FOR_NEARNESS:g} (1 - tanh d), where d [m] is the distance from the
gripper to the box of the nearest target that is not safe yet. A frame in which the simulation
breaks gives 0.

"""
SKILLS = """
## Skills

Every task has a skill environment, such as `gym.make("hazard_ms:HazardFireSkills-v1")`. The observation is one
vector; `[a +b i]` are the numbers a, a + b, a + 2 b, ... of slots 0, 1, 2, ... The unit says what a number of 1
means. Targets and carts keep their slots throughout an episode; landmarks are chosen again at every decision. An
empty slot is all zeros. A hazard's level is 0 and 1 at the ends of its usual range. `action_masks()` marks the
valid options.
"""
MEASURES = f"""
### Measures

`HazardHouseFireSkills-v1`, and every task with a fire and the skill `extinguish`, has its own layout, version
**{MEASURED_VERSION}**: the above followed by these numbers and options, with values of targets in units of 20
instead of 5. Fires are chosen again at every decision, those with most flames first. An extinguisher in the hand does
not count as `holding`: it is put down before a target is fetched.

"""


def page(env_ids: Sequence[str], robot_names: Sequence[str]) -> str:
    """The whole page on these tasks and robots. It makes each environment once, so that it takes a minute."""
    first = env_ids[0]
    robots = {robot: sections_of(first, "state_dict", robot) for robot in robot_names}
    parts = [HEAD, "\n## The robot\n\nIn all modes.\n"]
    for robot, sections in robots.items():
        parts += [f"\n### {robot}\n\n", _table([r for r in sections["observation"] if r.key.startswith("agent/")])]
    parts.append("\n## The task\n\nIn all modes; a target's place, damage and hazards only in state modes.\n")
    tasks = {t: robots["fetch"] if t == first else sections_of(t, "state_dict", "fetch") for t in env_ids}
    parts += ["\n", _table(_of_tasks(tasks))]
    parts += ["\n## Cameras\n\nIn image modes, per camera; here for 256 x 256 pixels.\n\n", _table(_images())]
    parts += [_flat(env_ids, robot_names), "\n## Actions\n"]
    for robot, sections in robots.items():
        parts += [f"\n### {robot}, default control mode\n\n", _table(sections["action"])]
    parts += [REWARD, _table(robots["fetch"]["reward"])]
    info = sections_of(first, "none", "fetch")["info"]
    parts += ["\n## Info\n\n", _table(info), SKILLS]
    for name, rows in sections_of(first.replace("-v", "Skills-v"), "state", "fetch").items():
        parts += [f"\n### {name.capitalize()}\n\n", _table(rows)]
    parts += [MEASURES, _table(measure_rows())]
    return "".join(parts)


def measure_rows() -> list[Row]:
    """The rows of observations and actions that only tasks with measures have."""
    sections = describe(Encoder([(0.0, 1.0)], 0.0, measures=True))
    plain = describe(Encoder([(0.0, 1.0)], 0.0))
    return [row for name in ("observation", "action") for row in sections[name][len(plain[name]) :]]


def _of_tasks(tasks: Mapping[str, Mapping[str, list[Row]]]) -> list[Row]:
    """The rows of all tasks' own entries; where ranges differ, the meaning tells them."""
    shown: dict[str, Row] = {}
    for task, sections in tasks.items():
        for row in (r for r in sections["observation"] if r.key.startswith("extra/")):
            known = shown.setdefault(row.key, row)
            if (row.low, row.high) != (known.low, known.high):
                shown[row.key] = replace(known, meaning=f"{known.meaning}; {bounds(row)} in {task}")
    return list(shown.values())


def _images() -> list[Row]:
    """Rows of cameras in every image mode."""
    found: dict[str, Row] = {}
    for mode in ("rgb+depth+segmentation+position+normal+albedo", "pointcloud", "sensor_data"):
        for row in sections_of("HazardFire-v1", mode, "fetch")["observation"]:
            if row.key.startswith(("sensor", "pointcloud")):
                found.setdefault(row.key, row)
    return [found[key] for key in sorted(found)]  # ManiSkill gives textures in any order


def _flat(env_ids: Sequence[str], robot_names: Sequence[str]) -> str:
    """Where the parts of the flat observation are, for each task and robot."""
    made = '\n## The vector of `obs_mode="state"`\n\nFrom index to index, the last excluded.\n'
    for robot in robot_names:
        columns = {task: sections_of(task, "state", robot)["observation"] for task in env_ids}
        made += f"\n### {robot}\n\n| task | part | from | to |\n|---|---|---|---|\n"
        for task, rows in columns.items():
            for row in rows:
                start, end = row.key.partition("[")[2].partition("]")[0].split(":")
                made += f"| {task} | {row.key.partition(' ')[2]} | {start} | {end} |\n"
    return made


def _table(rows: Sequence[Row]) -> str:
    """Rows as a table of Markdown; after it, a table of the numbers of each row that has many different ones."""
    made = "| key | shape | type | unit | frame | range | meaning |\n|---|---|---|---|---|---|---|\n"
    long = [row for row in rows if len(row.entries) > FEW]
    for row in rows:
        unit, told = row.unit, ""
        if row in long:
            unit, told = "", ", see below"
        elif row.entries:
            differ = isinstance(row.low, tuple) or isinstance(row.high, tuple)
            unit = "" if differ else row.unit
            told = ": " + ", ".join(f"{i}: {text}" if differ else text.split(" ")[0] for i, text in entries(row))
        shape = " x ".join(map(str, row.shape))
        cells = (f"`{row.key}`", shape, row.dtype, unit, row.frame, bounds(row), row.meaning + told)
        made += "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |\n"
    return made + "".join(_numbers(row) for row in long)


def _numbers(row: Row) -> str:
    """The numbers of a row, one a line."""
    made = f"\n`{row.key}`:\n\n| index | number | unit | range |\n|---|---|---|---|\n"
    units = row.unit.split(", ")
    for k, name in enumerate(row.entries):
        made += f"| {k} | {name} | {units[k % len(units)]} | {bounds(row, k)} |\n"
    return made
