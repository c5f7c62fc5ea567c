"""The options of an environment, and the names that help texts and the completion of shells offer for any option.

Other values are let through to the check of the option, which accepts what a third party registered and names the
nearest name for what is unknown. Nothing heavy is imported, so that help is quick.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any

import tyro
from tyro.constructors import PrimitiveConstructorSpec

from hazard_ms.spec import registry
from hazard_ms.spec.perturbation import canonical

if TYPE_CHECKING:
    from hazard_ms.spec import Goal

# As hazards.presets, spec.severity, simulation.lighting, env and scenes.splits name them; tests/cli compares them.
PRESETS = ("paper", "shipped", "realistic")
SEVERITIES = ("moderate", "severe", "extreme")
LIGHTINGS = ("day", "evening", "night", "failing", "random")
EFFECTS = ("full", "fast", "off")
SPLITS = ("train", "test", "large", "new_objects", "hard", "held_out")

RAY = "ray"
BACKENDS = ("serial", "local", RAY)  # where episodes are played, recorded and pictures taken
AVERTED = ("task", "yes", "no")  # whether sweeps tell what is averted
LOOKS = ("lighting", "effects", "perturb")  # options that are told only where they are not the usual ones
HUMAN = "human"  # the agent of episodes that people played: no choice, nobody could ask it


class Offered(tuple[str, ...]):
    """Names that are offered but not enforced: any text that is not an option counts as one of them."""

    def __contains__(self, text: object) -> bool:
        return not str(text).startswith("-")


def offer(names: Iterable[str], other: str = "") -> PrimitiveConstructorSpec[str]:
    """A rule for tyro: read any text, and offer `names`; `other` describes what is accepted besides."""
    offered = Offered(names)
    return PrimitiveConstructorSpec(
        nargs=1,
        metavar="{" + ",".join([*offered, *([other] if other else [])]) + "}",
        instance_from_str=lambda words: words[0],
        is_instance=lambda value: isinstance(value, str),
        str_from_instance=lambda value: [value],
        choices=offered,
    )


def offer_several(names: Iterable[str]) -> PrimitiveConstructorSpec[str | tuple[str, ...]]:
    """A rule for tyro as `offer`, for one text, or a tuple of several."""
    offered = Offered(names)
    return PrimitiveConstructorSpec(
        nargs="*",
        metavar="{" + ",".join(offered) + "} ...",
        instance_from_str=lambda words: words[0] if len(words) == 1 else tuple(words),
        is_instance=lambda value: isinstance(value, (str, tuple)),
        str_from_instance=lambda value: [value] if isinstance(value, str) else list(value),
        choices=offered,
    )


def flag(*spellings: str, old: str | None = None) -> Any:
    """Further spellings of an option: a short one, and one of `old`.

    Help texts show tyro's name last. Where there is an old spelling, that is tyro's name, and `spellings` hold the
    option's own.
    """
    return tyro.conf.arg(name=old, aliases=list(spellings))


def team_names(robot_uids: Any) -> tuple[str, ...]:
    """The names that an environment gives to the robots `robot_uids`; empty for a single robot."""
    several = robot_uids if isinstance(robot_uids, (tuple, list)) else ()
    return tuple(f"{robot}-{number}" for number, robot in enumerate(several))


@dataclass(frozen=True)
class EnvOptions:
    """The environment that episodes are played in: names and defaults are those of the keywords of gym.make."""

    env_id: Annotated[str, offer(registry.TASKS), flag("-e")] = "HazardFire-v1"
    """Task."""
    split: Annotated[str, offer(SPLITS)] = "train"
    """Split that seeds choose scenes from; large and new_objects are for tasks in rooms; hard has less time."""
    physics: Annotated[str, offer(PRESETS)] = "paper"
    """Preset of the hazards."""
    severity: Annotated[str, offer(SEVERITIES)] = "severe"
    """Strength of the hazards in the preset realistic."""
    hazards: tuple[Annotated[str, offer(registry.HAZARDS)], ...] = ()
    """Hazards of HazardCompound-v1 (by default its usual ones) or of practice tasks."""
    robot_uids: Annotated[
        str | tuple[str, ...], offer_several(registry.ROBOTS), flag("-r", "--robot-uids", old="robot")
    ] = "fetch"
    """Robot; in `play` and `evaluate` two to four form a team, which needs a team agent."""
    affects_agent: bool = False
    """Let hazards act on the robot; in homes and gales they always do."""
    lighting: Annotated[str, offer(LIGHTINGS), flag("--lighting", old="light")] = "day"
    """Light of the scene; with random, the seed decides."""
    effects: Annotated[str, offer(EFFECTS)] = "full"
    """Look of the hazards."""
    perturb: str = ""
    """How the episode differs from training, by kind and level 1 to 3, such as lighting:2,camera:1."""
    load: tuple[str, ...] = ()
    """Modules, or files NAME.py, that register your own tasks, hazards, robots and agents."""

    def __post_init__(self) -> None:
        """Write perturbation and robots in their one way. Raises ValueError where that cannot be."""
        object.__setattr__(self, "perturb", canonical(self.perturb))
        robots = self.robot_uids if isinstance(self.robot_uids, str) else tuple(self.robot_uids)
        if not robots:
            raise ValueError(f"robot_uids must be at least one robot, got {self.robot_uids!r}")
        object.__setattr__(self, "robot_uids", robots[0] if len(robots) == 1 and isinstance(robots, tuple) else robots)

    def check(self, teams: bool = False) -> None:
        """Load the modules of `load`, and check every name; `teams`: whether several robots can be played here.

        Raises ValueError for what cannot be played.
        """
        from hazard_ms.spec.checks import one_of  # loads torch
        from hazard_ms.spec.severity import chosen
        from hazard_ms.tasks.perturbing import check_perturbation

        for module in self.load:
            registry.load_plugin(module)
        robots = (self.robot_uids,) if isinstance(self.robot_uids, str) else self.robot_uids
        for robot in robots:
            one_of(robot, registry.ROBOTS, "robot_uids")
        if len(robots) > (most := registry.MOST_ROBOTS if teams else 1):
            many = f"{most} robots" if teams else "one robot here: only `play`, `evaluate` and `replay` take teams"
            raise ValueError(f"robot_uids must be at most {many}, got {len(robots)}")
        known = {"env_id": registry.TASKS, "physics": PRESETS}
        for what, names in {**known, "lighting": LIGHTINGS, "effects": EFFECTS}.items():
            one_of(getattr(self, what), names, what)
        chosen(self.severity, self.physics)
        for name in self.hazards:
            one_of(name, registry.HAZARDS, "hazards")
        if self.perturb:
            check_perturbation(self.perturb, self.env_id, self.physics, self.hazards, self.severity)

    @property
    def goal(self) -> Goal:
        """The goal of the task, which must be registered."""
        from hazard_ms.tasks import task_of  # loads torch

        return task_of(self.env_id, self.physics).goal

    @property
    def team(self) -> tuple[str, ...]:
        """Names of the robots of a team; none for a single robot."""
        return team_names(self.robot_uids)

    @property
    def max_frames(self) -> int:
        """Frames of an episode, at most."""
        return registry.TASKS[self.env_id].frames(self.split)

    @property
    def settings(self) -> dict[str, Any]:
        """Keywords of gym.make that change the episode; LOOKS only where they are not the usual ones."""
        names = ["split", "physics", *["severity" for _ in self.strength], "robot_uids", "affects_agent"]
        made = {name: getattr(self, name) for name in [*names, *self.unusual(*LOOKS)]}
        made["affects_agent"] |= registry.affects_agent(self.env_id)
        return {**made, "hazards": list(self.hazards)} if self.hazards else made

    @property
    def strength(self) -> list[str]:
        """The severity, where the preset has several."""
        return [self.severity] if self.physics == "realistic" else []

    def unusual(self, *names: str) -> list[str]:
        """The options, out of those called `names`, that differ from their defaults."""
        return [n for n in names if getattr(self, n) != EnvOptions.__dataclass_fields__[n].default]

    @property
    def words(self) -> list[str]:
        """Command-line words that give the same environment again."""
        made = ["-e", self.env_id, "--split", self.split, "--physics", self.physics]
        for name in self.unusual("severity", "robot_uids", *LOOKS):
            value = getattr(self, name)
            made += ["--" + name.replace("_", "-"), *([value] if isinstance(value, str) else value)]
        made += ["--affects-agent"] * self.affects_agent
        for name in ("hazards", "load"):
            made += ["--" + name.replace("_", "-"), *getattr(self, name)] if getattr(self, name) else []
        return made
