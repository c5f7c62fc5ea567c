"""Records timelines: of whole episodes in which nobody does anything, and of the rest of a running one.

Hazards that push nothing, such as fire, need no simulator: many scenes are advanced at once, and a copy of a running
episode is advanced exactly, since all chance is counted. Where things float off or are blown away, each scene is
simulated once without a robot; what follows a running episode is then that record, with every thing as far off its
recorded way as it is now, and hazards that see it there.
"""

from __future__ import annotations

import contextlib
import dataclasses
import functools
import hashlib
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Protocol

import numpy as np
import torch
from numpy.typing import NDArray

from hazard_ms.hazards.base import loosened, pushes
from hazard_ms.hazards.fire.fire_state import FireState
from hazard_ms.hazards.presets import FREQUENCIES
from hazard_ms.scenes import solids
from hazard_ms.scenes.schema import to_json
from hazard_ms.simulation import bare_scene, building
from hazard_ms.simulation.world import World
from hazard_ms.sketch.timeline import STRIDE, Timeline, read
from hazard_ms.spec import SceneSpec, Task
from hazard_ms.spec.storage.cache import home
from hazard_ms.tasks.episode import snapshot
from hazard_ms.tasks.episode.episode import Episode

STILL = 0.01  # what never gets farther than this from its start is at rest [m] [ours]
NOWHERE = 1e3  # where the hand is put when nobody acts [m]
LAWS = ("hazards", "simulation", "tasks/episode")  # folders whose code decides what happens
PACKAGE = Path(__file__).parents[1]


class Running(Protocol):
    """The part of a running environment that recordings need; `hazard_ms.env.HazardEnv` has it."""

    world: World
    episode: Episode
    task: Task
    physics: str
    specs: tuple[SceneSpec, ...]


def recorded(task: Task, physics: str, spec: SceneSpec, seed: int) -> Timeline:
    """The timeline of an episode of `task`, kept in the cache folder: recorded when it is first asked for.

    A damaged file is replaced. Raises ValueError for an unknown preset of `physics`.
    """
    name = f"{spec.name.replace('/', '-')}-{seed}-{suite_of(task, physics, spec)[:16]}.timeline"
    path = home() / "timelines" / task.name / name
    with contextlib.suppress(ValueError):
        return read(path)
    (made,) = record(task, physics, (spec,), (seed,))
    with contextlib.suppress(ValueError):  # a cache that cannot be written to only costs time
        made.write(path)
    return made


def record(
    task: Task, physics: str, specs: Sequence[SceneSpec], seeds: Sequence[int], frames: int | None = None
) -> list[Timeline]:
    """The timelines of episodes of `task` in the scenes `specs`, each with the seed of the same number.

    `frames`: their length, by default that of the task. Raises ValueError for an unknown preset of `physics`, and
    unless there are as many seeds as scenes.
    """
    if len(specs) != len(seeds):
        raise ValueError(f"seeds must be {len(specs)}, one for each scene, got {len(seeds)}")
    length = task.max_frames if frames is None else frames
    if pushes(task.hazards):
        rollouts = [_simulated(task, physics, spec, seed) for spec, seed in zip(specs, seeds, strict=True)]
    else:
        world = building.make_world(tuple(specs), torch.device("cpu"))
        rollouts = [begun(task, physics, world, seeds)]
    made = [line for rollout in rollouts for line in rollout.run(length)]
    return [
        dataclasses.replace(line, task=task.name, physics=physics, suite=suite_of(task, physics, spec, length))
        for line, spec in zip(made, specs, strict=True)
    ]


def ahead(env: Running, frames: int | None = None) -> Timeline:
    """The timeline of the one running episode of `env` from its present on if nobody acts; `env` is left as it is.

    `frames`: how long, by default until the task's limit. Things in the hand stay there.
    """
    left = max(0, env.task.max_frames - int(env.world.frame[0])) if frames is None else frames
    return dataclasses.replace(rollout_of(env).run(left)[0], task=env.task.name, physics=env.physics)


def rollout_of(env: Running, copies: int = 1) -> Rollout:
    """The rollout of the one running episode of `env` from its present on, in equal `copies` without a simulator."""
    rollout = Rollout(_copied(env, copies), 1.0 / FREQUENCIES[env.physics][0])
    if pushes(env.task.hazards):
        free = env.world.movable[0] & ~env.world.held[0] & ~env.world.away[0]
        past = recorded(env.task, env.physics, env.specs[0], int(env.world.chance.seed[0]))
        rollout.drift = _drift(past, int(env.world.frame[0]), free)
    return rollout


def suite_of(task: Task, physics: str, spec: SceneSpec, frames: int | None = None) -> str:
    """A digest of all that determines a timeline, except the seed: scene, models, hazards, laws and length."""
    sizes = [(solids.extent_of(thing), solids.mass_of(thing)) for thing in spec.things]
    length = task.max_frames if frames is None else frames
    parts = (task.name, repr(task.hazards), FREQUENCIES[physics], length, STRIDE, to_json(spec), sizes, _laws())
    return hashlib.sha256("\0".join(map(str, parts)).encode()).hexdigest()


@functools.lru_cache(maxsize=1)
def _laws() -> str:
    """A digest of the code that decides what happens."""
    files = (path for name in LAWS for path in sorted((PACKAGE / name).rglob("*.py")))
    return hashlib.sha256(b"\0".join(path.read_bytes() for path in files)).hexdigest()


class Rollout:
    """E episodes in which nobody acts, with or without simulators; those that drift do so alike."""

    def __init__(self, episode: Episode, frame_seconds: float) -> None:
        self.episode, self.world, self.frame_seconds = episode, episode.world, frame_seconds
        self.physics_step: Callable[[], None] | None = None  # the physics of one frame
        self.drift: Callable[[int], torch.Tensor] | None = None  # frame -> how far things then are from here [m]
        self._first, self._start = int(self.world.frame[0]), self.world.position.clone()

    def run(self, frames: int) -> list[Timeline]:
        """Let `frames` pass, and return the timelines."""
        world, first = self.world, int(self.world.frame[0])
        places, levels = [world.position.clone()], [self.episode.levels(world.position)]
        for frame in range(1, frames + 1):
            self.advance(frame)
            if frame % STRIDE == 0:
                places.append(world.position.clone())
                levels.append(self.episode.levels(world.position))
        return [self._timeline(e, first, torch.stack(places), torch.stack(levels)) for e in range(world.num_envs)]

    def advance(self, frame: int) -> None:
        """Let one frame pass: the frame after the beginning with the number `frame`, from 1 on."""
        if self.drift is not None:
            self.world.position.copy_(self._start + self.drift(self._first + frame))
        if self.physics_step is not None:
            self.physics_step()
        self.episode.advance(self.frame_seconds)
        if self.physics_step is not None:
            hand = (torch.full((1, 3), NOWHERE), torch.tensor([[1.0, 0.0, 0.0, 0.0]]))
            self.episode.use_hand(hand, torch.zeros(1, dtype=torch.bool), lambda: -hand[0])

    def _timeline(self, e: int, first: int, places: torch.Tensor, levels: torch.Tensor) -> Timeline:
        """The timeline of episode `e` from all `places` [m], [S, E, B, 3], and `levels`, [S, E, H, B]."""
        spec, episode = self.world.specs[e], self.episode
        things = len(spec.things)
        offsets = (places[:, e, :things] - places[0, e, :things]).cpu().numpy()
        moves = np.flatnonzero(np.linalg.norm(offsets, axis=-1).max(0) > STILL)
        birth, flames = _flames(episode, e)
        return Timeline(
            scene=spec.name,
            task="",
            physics="",
            suite="",
            seed=int(self.world.chance.seed[e]),
            first=first,
            stride=STRIDE,
            names=self.world.names[e],
            start=places[0, e, :things].cpu().numpy(),
            moves=moves.astype(np.int16),
            offsets=offsets[:, moves].astype(np.float16),
            levels=levels[:, e, :, :things].cpu().numpy().astype(np.float16),
            damaged_at=episode.damage.frame[e, :things].cpu().numpy().astype(np.int32),
            safe_at=episode.rescue.frame[e, :things].cpu().numpy().astype(np.int32),
            flame_birth=birth,
            flame_place=flames,
        )


def _flames(episode: Episode, e: int) -> tuple[NDArray[np.int32], NDArray[np.float32]]:
    """Frames of birth, [F], and places x, y [m], [F, 2], of all flames on the floor of episode `e`."""
    for state in episode.states.values():
        if isinstance(state, FireState):
            there = state.flame_cell[e] >= 0
            birth, place = state.flame_birth[e, there], state.flame_place[e, there, :2]
            return birth.cpu().numpy().astype(np.int32), place.cpu().numpy()
    return np.zeros(0, np.int32), np.zeros((0, 2), np.float32)


def begun(task: Task, physics: str, world: World, seeds: Sequence[int]) -> Rollout:
    """Episodes at frame 0."""
    episode, rows = Episode(world, task.hazards, task.safe_place), torch.arange(world.num_envs)
    episode.begin(rows, torch.tensor(list(seeds)))
    episode.begin_hazards(rows)
    return Rollout(episode, 1.0 / FREQUENCIES[physics][0])


def _simulated(task: Task, physics: str, spec: SceneSpec, seed: int) -> Rollout:
    """One episode at frame 0 in a simulator of its own, without a robot."""
    control, rate = FREQUENCIES[physics]
    scene = bare_scene.build(spec, rate=rate, loose=loosened(task.hazards, spec))
    rollout = begun(task, physics, scene.world, (seed,))

    def physics_step() -> None:
        for _ in range(rate // control):
            rollout.episode.push(1.0 / rate)
            scene.step()
        scene.world.read()

    rollout.physics_step = physics_step
    return rollout


def _copied(env: Running, copies: int) -> Episode:
    """Equal `copies` of the episode of `env` as it is now, without its simulator."""
    real = env.world
    world = building.make_world(env.specs * copies, real.device)
    world.agent_build = real.agent_build
    if real.team is not None:
        world.team = dataclasses.replace(real.team, places=real.team.places.expand(copies, -1, -1).clone())
    if real.equipment is not None and real.equipment.board.any():  # those that stand go on to hold water back
        world.equip(real.equipment.of)
    episode, rows = Episode(world, env.task.hazards, env.task.safe_place), torch.arange(copies, device=real.device)
    saved = {
        name: {k: v.expand(copies, -1) for k, v in part.items()} for name, part in snapshot.save(env.episode).items()
    }
    snapshot.restore(episode, saved, rows)  # of a team, with the first hand alone
    for name in ("position", "rotation", "velocity", "angular_velocity", "agent_position", "agent_heading", "held"):
        getattr(world, name).copy_(getattr(real, name))
    return episode


def _drift(past: Timeline, now: int, free: torch.Tensor) -> Callable[[int], torch.Tensor]:
    """How far each thing of a recorded episode is at a later frame from where it is `now` [m], [B, 3].

    Things that are not `free`, bool [B], stay.
    """
    here = past.position_at(now)

    def drift(frame: int) -> torch.Tensor:
        moved = torch.from_numpy(past.position_at(frame) - here).to(free.device)
        return torch.where(free[:, None], moved, 0.0)

    return drift
