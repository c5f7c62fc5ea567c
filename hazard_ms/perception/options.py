"""Options of `hazard-ms perception capture` as plain data: loading them for a help text imports nothing heavy."""

from __future__ import annotations

import math
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Annotated, Any, Literal

from hazard_ms.evaluation.choices import BACKENDS, EFFECTS, LIGHTINGS, flag, offer
from hazard_ms.evaluation.options import MOST, MOST_WORKERS, EnvOptions, EpisodeOptions

VARIED = "varied"  # light or effects are drawn anew for every stop or picture
SMALLEST, LARGEST = 64, 4096  # edge of a picture [pixels] [ours]
ANGLE = 1.2  # usual field of view of a picture [rad] [ours]
FOV = 68.755  # the same, rounded [degrees]
NARROWEST, WIDEST = 10.0, 150.0  # of them [degrees] [ours]
MOST_SAMPLES = 65536  # samples per pixel [ours]
SPARED, MOST_SPARE = "train", 10_000  # split that may have spare scenes, and of each place how many [ours]


@dataclass(frozen=True)
class CaptureOptions:
    """Options of `hazard-ms perception capture`."""

    env: EnvOptions = EnvOptions()
    per_scene: int = 200
    """Pictures of each scene."""
    scenes: tuple[str, ...] = ()
    """Names of scenes; by default all of the split."""
    spare: int = 0
    """Scenes of each place beyond those of the split train, numbered from 25 on; they belong to no split."""
    size: int = 512
    """Width and height of a picture in pixels."""
    fov: float = FOV
    """Field of view in degrees; the robots' head cameras have 120."""
    last_frame: int | None = None
    """Last frame of an episode to take pictures of; 0: only scenes that no hazard has changed yet."""
    shader: Literal["default", "rt-fast", "rt"] = "default"
    """Rasterised (default) or ray-traced, which takes seconds per picture."""
    spp: int = 4
    """Samples per pixel of ray-traced pictures."""
    lights: Annotated[str, offer((VARIED, *LIGHTINGS))] = VARIED
    """Light of the scenes; varied draws one for each stop."""
    looks: Annotated[str, offer((VARIED, *EFFECTS))] = VARIED
    """Look of the hazards; varied takes 80 % full, 10 % fast and 10 % off (raster only)."""
    amodal: bool = False
    """Add the masks of targets as they would be seen with nothing in front of them (slow)."""
    thermal: bool = False
    """Add what a thermal camera shows, in degrees C."""
    degraded: bool = False
    """Take colour and depth through the simulated smoke, rain and water; depth is lost beyond the range of sight."""
    seed: Annotated[int, flag("-s")] = 0
    """Seed of all episodes, viewpoints and lights."""
    workers: int = 1
    """Processes; 0: one for each core."""
    backend: Annotated[str, offer(BACKENDS)] = "local"
    """Where to capture: in this process (serial), in local processes, or on a ray cluster that shares the output."""
    address: str | None = None
    """Address of the ray cluster, such as auto; by default only this machine."""
    output: Annotated[Path, flag("-o")] = Path("perception")
    """Folder for datasets; that of this task is OUTPUT/TASK."""

    def check(self) -> None:
        """Check all options. Raises ValueError for what cannot be captured."""
        from hazard_ms.spec.checks import one_of, whole  # loads torch

        self.env.check()
        whole(self.per_scene, 1, MOST, "per_scene")
        whole(self.spare, 0, MOST_SPARE, "spare")
        if self.spare and self.env.split != SPARED:
            raise ValueError(
                f"spare must be 0 in the split {self.env.split}, got {self.spare}: spare scenes are for {SPARED}"
            )
        whole(self.size, SMALLEST, LARGEST, "size")
        if not NARROWEST <= self.fov <= WIDEST:
            raise ValueError(f"fov must be from {NARROWEST:g} to {WIDEST:g} degrees, got {self.fov!r}")
        if self.last_frame is not None:
            whole(self.last_frame, 0, self.env.max_frames - 1, "last_frame")
        whole(self.spp, 1, MOST_SAMPLES, "spp")
        whole(self.seed, 0, MOST, "seed")
        whole(self.workers, 0, MOST_WORKERS, "workers")
        one_of(self.backend, BACKENDS, "backend")
        one_of(self.lights, (VARIED, *LIGHTINGS), "lights")
        one_of(self.looks, (VARIED, *EFFECTS), "looks")
        usual = EnvOptions()
        for name in ("lighting", "effects"):
            if getattr(self.env, name) != getattr(usual, name):
                other = {"lighting": "lights", "effects": "looks"}[name]
                raise ValueError(f"{name} must be left out, got {getattr(self.env, name)!r}; use --{other}")

    @property
    def dataset(self) -> Path:
        """Folder of the dataset."""
        return self.output / self.env.env_id

    @property
    def recipe(self) -> dict[str, Any]:
        """The settings that all pictures of a split have in common."""
        names = ("per_scene", "size", "shader", "lights", "looks", "amodal", "seed")
        made: dict[str, Any] = {"env_id": self.env.env_id, "settings": self.env.settings}
        made |= {name: getattr(self, name) for name in names}
        made |= {} if self.fov == FOV else {"fov": self.fov}
        made |= {} if self.last_frame is None else {"last_frame": self.last_frame}
        made |= {name: True for name in ("thermal", "degraded") if getattr(self, name)}
        return made if self.shader == "default" else {**made, "spp": self.spp}

    @property
    def angle(self) -> float:
        """The field of view [rad]."""
        return ANGLE if self.fov == FOV else math.radians(self.fov)

    @property
    def frames(self) -> int:
        """Frames of an episode over which pictures are spread."""
        return self.env.max_frames if self.last_frame is None else self.last_frame + 1

    def episode(self, scene: str, seed: int) -> EpisodeOptions:
        """The episode of `scene` in which nobody acts."""
        env = {f.name: getattr(self.env, f.name) for f in fields(EnvOptions)}
        return EpisodeOptions(**env, scene=scene, seed=seed)
