"""Options of `hazard-ms render` and `hazard-ms gallery`, as plain data: loading them imports nothing heavy."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal

from hazard_ms.evaluation.choices import flag
from hazard_ms.evaluation.options import EpisodeOptions

IDLE = "idle"  # name of the agent under which the robot stands still
ENDINGS = (".png", ".jpg", ".jpeg")
LARGEST = 8192  # width or height [pixels]
SMALLEST = 16  # width or height [pixels]
MOST_SAMPLES = 65536  # samples per pixel [ours]
MOST_TURNS = 10_000  # pictures of a turntable [ours]


@dataclass(frozen=True)
class RenderOptions:
    """Options of `hazard-ms render`."""

    output: Annotated[Path | None, flag("-o")] = None
    """Picture to write: .png or .jpg."""
    turntable: Path | None = None
    """Film to write, .mp4, for which the camera circles the middle of the scene."""
    episode: EpisodeOptions = EpisodeOptions(agent=IDLE)
    frame: int = 0
    """Frame of the episode; it is played that far without drawing. With the agent `idle` the robot stands still."""
    shader: Literal["default", "rt-fast", "rt"] = "default"
    """Rasterised (default) or ray-traced, which is denoised if pyoidn is installed."""
    spp: int = 16
    """Samples per pixel of ray-traced pictures."""
    size: str = "1024"
    """Width and height in pixels, such as 1024 or 1024x768."""
    camera: Literal["third", "head", "home"] = "third"
    """View: third person, the camera in the robot's head, or all rooms of a home from above without its ceiling."""
    turns: int = 48
    """Number of pictures in the film of --turntable."""

    def check(self) -> None:
        """Check all options. Raises ValueError for what cannot be drawn."""
        from hazard_ms.spec.checks import whole  # loads torch

        self.episode.check()
        whole(self.frame, 0, self.episode.max_frames, "frame")
        whole(self.spp, 1, MOST_SAMPLES, "spp")
        whole(self.turns, 2, MOST_TURNS, "turns")
        self.pixels()
        if self.output is None and self.turntable is None:
            raise ValueError("output must be given as -o out.png, or --turntable out.mp4, or both, got neither")
        _writable(self.output, ENDINGS, "output")
        _writable(self.turntable, (".mp4",), "turntable")

    def pixels(self) -> tuple[int, int]:
        """Width and height [pixels]. Raises ValueError for a text that is not a size."""
        from hazard_ms.spec.checks import whole

        parts = self.size.lower().split("x")
        if len(parts) > 2 or not all(p.isdigit() for p in parts):
            raise ValueError(f"size must be like 1024 or 1024x768, got {self.size!r}")
        width, height = whole(int(parts[0]), SMALLEST, LARGEST, "width"), int(parts[-1])
        return width, whole(height, SMALLEST, LARGEST, "height")

    def kind(self) -> str:
        """Size, shader and samples in words, `512 x 512, rt, 4 samples` say."""
        width, height = self.pixels()
        how = "raster" if self.shader == "default" else f"{self.shader}, {self.spp} samples"
        return f"{width} x {height}, {how}"


@dataclass(frozen=True)
class GalleryOptions:
    """Options of `hazard-ms gallery`."""

    output: Annotated[Path, flag("-o")] = Path("docs/gallery")
    """Folder for the pictures and their page, README.md."""
    spp: int = 8
    """Samples per pixel of the ray-traced pictures."""

    def check(self) -> None:
        """Check all options. Raises ValueError for what cannot be made."""
        from hazard_ms.spec.checks import whole

        whole(self.spp, 1, MOST_SAMPLES, "spp")
        if self.output.exists() and not self.output.is_dir():
            raise ValueError(f"output must be a folder, got the file {self.output}")


def _writable(path: Path | None, endings: tuple[str, ...], what: str) -> None:
    """Raise ValueError unless `path` is none, or a file can be written there."""
    if path is None:
        return
    if path.suffix.lower() not in endings:
        raise ValueError(f"{what} must end in {' or '.join(endings)}, got {path.name!r}")
    if not path.parent.is_dir():
        raise ValueError(f"{what} must be in a folder that exists, got {path}: there is no folder {path.parent}")
