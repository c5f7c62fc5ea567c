"""What `hazard-ms render` and `hazard-ms gallery` are asked for: plain data, so that the command's help loads nothing heavy."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import tyro

from hazard_ms import MAX_FRAMES

SHADERS = ("default", "rt-fast", "rt")
CAMERAS = ("third", "head")
ENDINGS = (".png", ".jpg", ".jpeg")
LARGEST = 8192  # width or height [pixels]
MOST_SAMPLES = 65536


@dataclass(frozen=True)
class RenderOrder:
    """Which picture is to be taken."""

    output: Annotated[Path | None, tyro.conf.arg(aliases=["-o"])] = None
    """The picture: .png or .jpg."""
    turntable: Path | None = None
    """A film around the middle of the scene: .mp4."""
    env_id: Annotated[str, tyro.conf.arg(aliases=["-e"])] = "HazardFire-v1"
    """Task."""
    seed: Annotated[int, tyro.conf.arg(aliases=["-s"])] = 0
    """Seed of the episode."""
    frame: int = 0
    """Frame of the episode; it is played that far without drawing."""
    agent: str = "idle"
    """idle: the robot stands still; or the name of an agent, or package.module:Class."""
    scene: str | None = None
    """Name of a scene; by the seed if not given."""
    split: str = "train"
    """Split from which the seed chooses the scene."""
    physics: str = "paper"
    """Preset of the hazards."""
    robot: Annotated[str, tyro.conf.arg(aliases=["-r"])] = "fetch"
    """The rescuer: fetch or g1."""
    shader: str = "default"
    """default (raster), rt-fast or rt (ray-traced; denoised where pyoidn is installed)."""
    spp: int = 16
    """Samples per pixel, ray-traced."""
    size: str = "1024"
    """Width and height in pixels, as 1024 or 1024x768."""
    camera: str = "third"
    """third (person) or head (camera of the robot)."""
    light: str = "day"
    """day, evening, night, failing or random."""
    turns: int = 48
    """Pictures of the turntable."""

    def check(self) -> None:
        """Raise ValueError for what cannot be drawn."""
        from hazard_ms.checks import one_of, whole  # loads torch
        from hazard_ms.lighting import LIGHTINGS

        one_of(self.env_id, MAX_FRAMES, "environment")
        one_of(self.shader, SHADERS, "shader")
        one_of(self.camera, CAMERAS, "camera")
        one_of(self.light, LIGHTINGS, "light")
        whole(self.frame, 0, MAX_FRAMES[self.env_id], "frame")
        whole(self.spp, 1, MOST_SAMPLES, "spp")
        whole(self.turns, 2, 10_000, "turns")
        self.pixels()
        if self.output is None and self.turntable is None:
            raise ValueError("there is no file to write: give -o out.png, --turntable out.mp4, or both")
        _writable(self.output, ENDINGS, "picture")
        _writable(self.turntable, (".mp4",), "turntable")

    def pixels(self) -> tuple[int, int]:
        """Width and height. Raises ValueError for what is no size."""
        from hazard_ms.checks import whole

        parts = self.size.lower().split("x")
        if len(parts) > 2 or not all(p.isdigit() for p in parts):
            raise ValueError(f"size is {self.size!r}; 1024 or 1024x768 are allowed")
        return whole(int(parts[0]), 16, LARGEST, "width"), whole(int(parts[-1]), 16, LARGEST, "height")

    def kind(self) -> str:
        """Size, shader and samples, as `512 x 512, rt, 4 samples`."""
        width, height = self.pixels()
        return f"{width} x {height}, " + ("raster" if self.shader == "default" else f"{self.shader}, {self.spp} samples")


@dataclass(frozen=True)
class GalleryOrder:
    """Which gallery is to be made."""

    output: Annotated[Path, tyro.conf.arg(aliases=["-o"])] = Path("docs/gallery")
    """Folder for the pictures and their page, README.md."""
    spp: int = 8
    """Samples per pixel of the ray-traced pictures."""

    def check(self) -> None:
        """Raise ValueError for what cannot be made."""
        from hazard_ms.checks import whole

        whole(self.spp, 1, MOST_SAMPLES, "spp")
        if self.output.exists() and not self.output.is_dir():
            raise ValueError(f"{self.output} is a file; a folder is allowed")


def _writable(path: Path | None, endings: tuple[str, ...], what: str) -> None:
    """Raise ValueError unless `path` is none, or a file can be written there."""
    if path is None:
        return
    if path.suffix.lower() not in endings:
        raise ValueError(f"the {what} is {path.name}; a name that ends in {' or '.join(endings)} is allowed")
    if not path.parent.is_dir():
        raise ValueError(f"{path} cannot be written: there is no folder {path.parent}")
