"""Options of `hazard-ms demos record` as plain data: loading them for a help text imports nothing heavy."""

from __future__ import annotations

from dataclasses import dataclass, fields
from pathlib import Path
from typing import Annotated, Any

from hazard_ms.demonstrations.layout import HEAD, plain
from hazard_ms.evaluation.choices import BACKENDS, flag, offer
from hazard_ms.evaluation.options import MOST, MOST_WORKERS, EnvOptions, EpisodeOptions

STATE, NONE = "state", "none"
PICTURES = ("rgb", "depth", "segmentation")
OBSERVATIONS = (NONE, STATE, "rgb", "rgb+depth+segmentation")  # that help texts offer


@dataclass(frozen=True)
class RecordOptions:
    """Options of `hazard-ms demos record`."""

    env: EnvOptions = EnvOptions()
    agent: Annotated[str, offer(("oracle", "planner"), "any agent"), flag("-a")] = "oracle"
    """Teacher, as `hazard-ms play --agent` takes it."""
    episodes: Annotated[int, flag("-n")] = 20
    """Episodes, one for each seed; those already recorded are not played again."""
    seed: Annotated[int, flag("-s")] = 0
    """First seed."""
    obs: Annotated[str, offer(OBSERVATIONS)] = NONE
    """What to record besides joints, poses and actions: none, or state, rgb, depth, segmentation, joined by +."""
    cameras: Annotated[str, offer(("head", "head+wrist", "head+wrist+shoulder"))] = HEAD
    """Cameras of the robot whose rgb is filmed: head, and others, joined by +."""
    every: int = 3
    """Frames of the episode from one picture to the next."""
    keep: float = 0.8
    """Lowest value of an episode to keep, as a share of what the best plan reaches from its start; 0: keep all. The
    others go into failures/."""
    verify: bool = True
    """Simulate each episode again in a new environment, and keep it only if all hashes are equal."""
    workers: int = 0
    """Processes; 0: one for each core."""
    backend: Annotated[str, offer(BACKENDS)] = "local"
    """Where to record: in this process (serial), in local processes, or on a ray cluster that shares the output."""
    address: str | None = None
    """Address of the ray cluster, such as auto; by default only this machine."""
    output: Annotated[Path, flag("-o")] = Path("demos")
    """Folder for datasets; that of this task and agent is OUTPUT/TASK/AGENT."""

    def check(self) -> None:
        """Check all options. Raises ValueError for what cannot be recorded."""
        from hazard_ms.spec.checks import one_of, whole  # loads torch

        whole(self.episodes, 1, MOST, "episodes")
        whole(self.seed, 0, MOST, "seed")
        whole(self.every, 1, MOST, "every")
        whole(self.workers, 0, MOST_WORKERS, "workers")
        one_of(self.backend, BACKENDS, "backend")
        if not 0.0 <= self.keep <= 1.0:
            raise ValueError(f"keep must be a share from 0 to 1, got {self.keep}")
        for part in self.obs.split("+"):
            one_of(part, (STATE, *PICTURES) if "+" in self.obs else (NONE, STATE, *PICTURES), "obs")
        self.episode_options()[0].check()
        self._check_cameras()

    def _check_cameras(self) -> None:
        """Check the names of cameras. Raises ValueError for those that the robot lacks, and where nothing is filmed."""
        from hazard_ms.spec.checks import one_of
        from hazard_ms.spec.registry import ROBOTS, load

        assert isinstance(self.env.robot_uids, str)  # its check sees to it
        known = (HEAD, *load(ROBOTS[self.env.robot_uids].robot).mounted_cameras)
        for name in self.cameras.split("+"):
            one_of(name, known, "cameras")
        if HEAD not in self.cameras.split("+") or (self.mounted and "rgb" not in self.pictures):
            raise ValueError(f"cameras must include {HEAD}, and others only with rgb in obs, got {self.cameras!r}")

    @property
    def mounted(self) -> tuple[str, ...]:
        """The cameras beside that of the head, which the environment has to be asked for."""
        return tuple(name for name in dict.fromkeys(self.cameras.split("+")) if name != HEAD)

    @property
    def pictures(self) -> tuple[str, ...]:
        """The kinds of pictures that are recorded."""
        return tuple(kind for kind in PICTURES if kind in self.obs.split("+"))

    @property
    def state(self) -> bool:
        """Whether observations of the mode "state" are recorded."""
        return STATE in self.obs.split("+")

    @property
    def dataset(self) -> Path:
        """Folder of the dataset."""
        return self.output / self.env.env_id / plain(self.agent)

    @property
    def recipe(self) -> dict[str, Any]:
        """The settings that all episodes of a dataset have in common."""
        others = {"cameras": list(self.mounted)} if self.mounted else {}
        return {
            "env_id": self.env.env_id,
            "agent": self.agent,
            "settings": self.env.settings,
            "obs": "+".join([STATE] * self.state + list(self.pictures)) or NONE,
            "every": self.every if self.pictures else 0,
            "keep": self.keep,
            **others,
        }

    def episode_options(self) -> list[EpisodeOptions]:
        """The episodes, seed by seed."""
        env = {f.name: getattr(self.env, f.name) for f in fields(EnvOptions)}
        return [EpisodeOptions(**env, agent=self.agent, seed=self.seed + k) for k in range(self.episodes)]
