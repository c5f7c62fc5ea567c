"""Options of the commands that play episodes, as plain data: loading them for a help text imports nothing heavy."""

from __future__ import annotations

import re
import shlex
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated, Any

import tyro

from hazard_ms.agents.latency import CLOCKS, OFF
from hazard_ms.evaluation.choices import AVERTED, BACKENDS, LOOKS, flag, offer
from hazard_ms.evaluation.choices import EnvOptions as EnvOptions
from hazard_ms.spec import registry
from hazard_ms.spec.names import natural
from hazard_ms.spec.registry.detectors import DETECTORS, TRUTH

SCENE_FILE = ".json"  # how names of scene files end
EPISODES = 25  # of every agent, unless another number is asked for: a split of the original has as many scenes
MOST = 10**6  # episodes, seeds and frames between pictures: any larger number must be a mistake [-] [ours]
MOST_WORKERS = 1024  # processes [ours]
LONGEST_DECISION = 86_400.0  # [s] [ours]


@dataclass(frozen=True)
class EpisodeOptions(EnvOptions):
    """One episode: its environment, its seed or scene, and the agent that plays it."""

    agent: Annotated[str, offer(registry.AGENTS, "MODULE:CLASS"), flag("-a")] = "greedy"
    """Agent: a name, package.module:Class or file.py:Class; parameters follow as NAME:key=value,key=value."""
    seed: Annotated[int, flag("-s")] = 0
    """Seed of the episode."""
    scene: str | None = None
    """Scene, a name or a file NAME.json; chosen by the seed if not given."""
    clock: Annotated[str, offer(CLOCKS)] = OFF
    """Clock that lets hazards go on while the agent thinks: tokens of its model, wall time, or off."""
    perception: Annotated[str, offer((TRUTH, *DETECTORS))] = TRUTH
    """Source of the agent's labels: truth, or a detector; its file and parameters follow, NAME:FILE,key=value."""

    def check(self, teams: bool = False) -> None:
        """Check environment, agent, clock and perception; `teams`: whether several robots can be played here.

        Raises ValueError for what cannot be played.
        """
        from hazard_ms.sensing.detection.perception import parts
        from hazard_ms.spec.checks import one_of

        super().check(teams)
        one_of(self.clock, (OFF,) if self.team else CLOCKS, "clock of a team" if self.team else "clock")
        parts(self.perception)
        if self.team:
            one_of(self.perception, (TRUTH,), "perception of a team")
        else:
            self.check_goal()

    def check_goal(self) -> None:
        """Raises ValueError for a registered agent that cannot pursue the goal of the task."""
        name = self.agent.partition(":")[0]
        goals = registry.AGENTS[name].goals if name in registry.AGENTS else None
        if goals is None or (verb := self.goal.verb) in ("", *goals):
            return
        able = [entry.name for entry in registry.AGENTS.values() if entry.goals is None or verb in entry.goals]
        raise ValueError(
            f"agent must be one of {', '.join(able)}, or your own, in {self.env_id}, whose goal is to "
            f"{verb.replace('_', ' ')}, got {self.agent!r}"
        )

    @property
    def settings(self) -> dict[str, Any]:
        """Keywords of gym.make that change the episode, the file of its scene among them if it has one."""
        return {**super().settings, "scenes": self.scene} if self._from_file else super().settings

    @property
    def reset_options(self) -> dict[str, Any]:
        """Argument `options` of the environment's reset."""
        return {} if self.scene is None or self._from_file else {"scene": self.scene}

    @property
    def _from_file(self) -> bool:
        return self.scene is not None and self.scene.endswith(SCENE_FILE)

    @property
    def command(self) -> str:
        """The command that plays the episode again."""
        words = ["hazard-ms", "play", *self.words, "--agent", self.agent, "-s", str(self.seed)]
        words += ["--scene", self.scene] if self.scene is not None else []
        words += ["--clock", self.clock] * (self.clock != OFF)
        words += ["--perception", self.perception] * (self.perception != TRUTH)
        return shlex.join(words)


@dataclass(frozen=True)
class PlayOptions:
    """Options of `hazard-ms play`."""

    episode: EpisodeOptions = EpisodeOptions()
    output: Annotated[Path | None, flag("-o", "--output", old="video")] = None
    """Film to write, NAME.mp4; the result (.json) and a page (.html) are written beside it."""
    every: int = 6
    """Episode frames per picture of the film; the film runs that much faster."""

    def check(self) -> None:
        """Check all options. Raises ValueError for what cannot be played."""
        from hazard_ms.spec.checks import whole

        self.episode.check(teams=True)
        whole(self.every, 1, MOST, "every")
        if self.output is not None and self.output.suffix != ".mp4":
            raise ValueError(f"output must end in .mp4, got {self.output.name!r}")


@dataclass(frozen=True)
class ReplayOptions:
    """Options of `hazard-ms replay`."""

    files: tyro.conf.Positional[tuple[Path, ...]]
    """Results of episodes, NAME.json, or folders of them."""
    workers: int = 0
    """Processes; 0: one for each core."""
    load: tuple[str, ...] = ()
    """Modules, or files NAME.py, that register what the episodes need; results never load any themselves."""


@dataclass(frozen=True)
class SweepOptions:
    """Options of `hazard-ms evaluate`."""

    env: EnvOptions = EnvOptions(split="test")
    agents: tuple[Annotated[str, offer(registry.AGENTS, "MODULE:CLASS")], ...] = ("greedy", "random")
    """Agents, each as `hazard-ms play --agent` takes it."""
    scenes: Path | None = None
    """Folder of scene files to play instead of a split; seed s plays file s in the order of their names."""
    episodes: int = 0
    """Episodes per agent, one per seed; 0: 25, or one per file of --scenes."""
    seed: Annotated[int, flag("-s", "--seed", old="first")] = 0
    """First seed. Seed s plays the split's scene s, starting over after the last scene."""
    workers: int = 0
    """Processes; 0: one for each core."""
    backend: Annotated[str, offer(BACKENDS)] = "local"
    """Where to play: in this process, without limits on agents (serial), in local processes, or on a ray cluster."""
    address: str | None = None
    """Address of the ray cluster, such as auto; by default only this machine."""
    shard: str | None = None
    """Part i/N of the episodes to play, such as 2/3; by default the Slurm array job's."""
    averted: Annotated[str, offer(AVERTED)] = "task"
    """Report what agents avert, and the loads on the robot, which takes longer; task: if the task declares it."""
    clock: Annotated[str, offer(CLOCKS)] = OFF
    """Clock that lets hazards go on while an agent thinks: tokens of its model, wall time, or off."""
    perception: Annotated[str, offer((TRUTH, *DETECTORS))] = TRUTH
    """Source of the agents' labels: truth, or a detector; its file and parameters follow, NAME:FILE,key=value."""
    timeout: float = 60.0
    """Wall time for a decision [s]; an agent that takes longer loses the rest of its episode."""
    output: Annotated[Path, flag("-o", "--output", old="out")] = Path("evaluation")
    """Folder for the results, one file for each episode."""

    def episode_options(self) -> list[EpisodeOptions]:
        """The episodes, seed by seed. Raises ValueError for what cannot be played."""
        from hazard_ms.spec.checks import one_of, whole

        whole(self.episodes, 0, MOST, "episodes")
        whole(self.seed, 0, MOST, "seed")
        whole(self.workers, 0, MOST_WORKERS, "workers")
        one_of(self.backend, BACKENDS, "backend")
        if not 0.0 < self.timeout <= LONGEST_DECISION:
            raise ValueError(f"timeout must be more than 0 and at most {LONGEST_DECISION:g} s, got {self.timeout}")
        first = EpisodeOptions(**vars(self.env), clock=self.clock, perception=self.perception)
        for agent in self.agents or (first.agent,):
            replace(first, agent=agent).check(teams=True)
        files = self._files()
        seeds = range(self.seed, self.seed + self.count)
        scenes = [files[s % len(files)] if files else None for s in seeds]
        return [
            replace(first, agent=a, seed=s, scene=f) for s, f in zip(seeds, scenes, strict=True) for a in self.agents
        ]

    @property
    def count(self) -> int:
        """Episodes of every agent. Raises ValueError for a folder of scenes that holds none."""
        return self.episodes or len(self._files()) or EPISODES

    def _files(self) -> list[str]:
        """The files of the folder of scenes, scene-2 before scene-10; none if there is no folder."""
        if self.scenes is None:
            return []
        if not (found := sorted(self.scenes.glob(f"*{SCENE_FILE}"), key=lambda path: natural(path.stem))):
            raise ValueError(f"scenes must be a folder that holds files *{SCENE_FILE}, got {self.scenes}")
        return [str(path) for path in found]

    def place(self, episode: EpisodeOptions) -> Path:
        """The file of an episode's result."""
        e = episode
        scenes = e.split if e.scene is None else re.sub(r"[^\w.-]+", ".", Path(e.scene).stem)
        robots = [e.robot_uids] if isinstance(e.robot_uids, str) else e.robot_uids
        setting = [e.env_id, *e.hazards, scenes, e.physics, *e.strength, *robots] + ["affected"] * e.affects_agent
        setting += [getattr(e, name) for name in e.unusual(*LOOKS)]
        setting += [f"clock.{e.clock}"] * (e.clock != OFF) + [e.perception] * (e.perception != TRUTH)
        return self.output / (re.sub(r"[^\w.-]+", ".", "-".join([*setting, e.agent])) + f"-{e.seed:04d}.json")
