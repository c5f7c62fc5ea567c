"""The data that a task is made of, plain and frozen: its observations, its goal, its safe place."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from hazard_ms.spec.scene import SceneSpec

Bound = float | tuple[float, ...]  # of all numbers of a quantity, or of each one


@dataclass(frozen=True)
class Term:
    """One entry of what an environment tells: of its observations, or of `info`.

    Functions of a task get the `hazard_ms.tasks.episode.situation.Situation` of all E environments.
    """

    name: str
    of: Callable[[Any], Any]  # Situation -> tensor [E, *shape]; [E, B, *shape] of all things where `per_target`
    meaning: str
    shape: tuple[int, ...] = ()  # in one environment, or of one target
    unit: str = ""
    frame: str = ""  # of coordinates: "world"
    low: Bound = -math.inf  # range, in its unit
    high: Bound = math.inf
    entries: tuple[str, ...] = ()  # what each number along the last axis is, if there are several
    per_target: bool = False  # one row for each target
    hidden: bool = False  # told in state modes only: what else an agent must see for itself
    constant: bool = False  # the same as long as the scene stands


@dataclass(frozen=True)
class SafePlace:
    """The place where targets are safe."""

    name: str  # "bag"
    text: str  # in words, for agents: "the bag that you carry"
    # World -> (Drop -> things that are safe there now, [E, B], bool, or None); see hazard_ms.tasks.episode.safe_places
    rule: Callable[[Any], Callable[[Any], Any]]
    containers: tuple[str, ...] = ()  # categories of the things that have to be reached in order to put something there
    carried: bool = False  # the agent takes along what is safe, so that it is no longer in the scene
    # what lies where it was put when the task's time is up counts as rescued, too; episodes then go on to that time
    at_rest: bool = False


@dataclass(frozen=True)
class Goal:
    """The goal of a task and its rewards: functions of the Situation that give [E] each."""

    success: Callable[[Any], Any]  # bool: the episode ends, it is done
    dense: Callable[[Any], Any]  # reward of a frame, with hints on the way
    sparse: Callable[[Any], Any]  # reward of a frame, for what counts alone
    largest: float  # dense reward of one frame, by which the normalised one is divided
    least: float = 0.0  # dense reward of one frame
    fail: Callable[[Any], Any] | None = None  # bool: the episode ends, it can no longer be achieved; None: never
    info: tuple[Term, ...] = ()  # further entries of `info`
    done: str = "done"  # why an episode ended that succeeded, in words: "all rescued"
    # of the action that achieves it: walk_to, pick_up or drop for any one target, or a mitigation of the task; "": all
    # targets are to be rescued
    verb: str = ""


@dataclass(frozen=True)
class Task:
    """A task: its scenes, its hazards, its goal, and what the environment tells of it."""

    scenes: Callable[[str], tuple[str, ...]]  # split -> scene names
    build: Callable[[str], SceneSpec]  # scene name -> scene
    hazards: tuple[Any, ...]  # hazard_ms.hazards.base.Hazard, in the order in which they advance
    goal: Goal
    safe_place: SafePlace
    observations: tuple[Term, ...]  # beside the robot's joints and the cameras
    text: str = ""  # the task in words, for agents
    rewordings: tuple[tuple[str, ...], ...] = ()  # of `text`: those of each level of words in a perturbation, from 1
    splits: tuple[str, ...] = ("train", "test")
    name: str = ""  # "HazardFire-v1"; filled in by the registry, as is the next
    max_frames: int = 1500
    # doors divide its places: maps end below their lintels, and agents count on walls, as in any scene with inner walls
    several_rooms: bool = False
    # (Situation, environments that begin, [R]) -> None: puts robots elsewhere than their scenes say; None: it does not
    arrange: Callable[[Any, Any], None] | None = None
    # verbs of `hazard_ms.spec.registry.mitigations` that its agents have, beyond the six of the benchmark
    mitigations: tuple[str, ...] = ()
    # a hand that shuts at the handle of a door holds it, and the leaf follows the hand; False: skills alone turn leaves
    doors_by_hand: bool = False
    averted: bool = False  # sweeps tell what agents avert unless asked not to (docs/benchmark.md 4.3)

    @property
    def all_scenes(self) -> tuple[str, ...]:
        """Names of the scenes of all splits."""
        return tuple(dict.fromkeys(name for split in self.splits for name in self.scenes(split)))


@dataclass(frozen=True)
class Level:
    """The meaning of the numbers in `Hazard.image`, and how pictures, films and reports show them."""

    title: str  # "temperature"
    unit: str  # "°C"
    low: float  # shown as the lowest colour, in the unit
    high: float  # shown as the highest colour
    colours: str = "viridis"  # name of the colour map, as OpenCV and matplotlib call it
    tint: tuple[int, int, int] = (200, 120, 220)  # on maps: red, green, blue, 0 to 255
    least: float = -math.inf  # lowest that there can be: a bound of observations
    told_up_to: float = math.inf  # height at which pictures tell its highest number [m]; infinite: at what is seen


@dataclass(frozen=True)
class Quantity:
    """The meaning of a number that a hazard adds to `info`."""

    meaning: str
    unit: str = ""
    low: float = -math.inf
    high: float = math.inf
