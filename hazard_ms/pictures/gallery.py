"""The gallery: pictures of every task at several moments and of all places, rasterised and ray-traced.

They are taken from outside and through the robot's eyes, by day, in the evening and at night.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

from hazard_ms.effects.raytracing.still import Image
from hazard_ms.evaluation.options import EpisodeOptions
from hazard_ms.pictures.files import encoded
from hazard_ms.pictures.frozen_episode import FrozenEpisode
from hazard_ms.pictures.options import IDLE, RenderOptions
from hazard_ms.spec.storage.files import make_folder, write_together

SIZE, HEAD_SIZE = (480, 320), (320, 320)  # of pictures from the corner, and through the robot's eyes [pixels]
QUALITY = 76  # of JPEG: all pictures together stay below 1.5 MB
PAGE = "README.md"
SHADERS = ("default", "rt-fast")  # of the two pictures of each frame


class Show(NamedTuple):
    """An episode, the frames at which pictures are taken, and the light."""

    env_id: str
    seed: int
    lighting: str
    frames: tuple[int, ...]
    camera: str
    about: str
    scene: str | None = None  # by the seed if not given


SHOWS = (
    Show(
        "HazardFire-v1",
        3,
        "day",
        (150, 400, 700, 1100),
        "third",
        "Fire spreads over floor and furniture, and chars what it burns.",
    ),
    Show("HazardFire-v1", 3, "night", (700,), "third", "The same fire at night."),
    Show("HazardFire-v1", 3, "evening", (700,), "head", "The same fire in the evening, as the robot sees it."),
    Show(
        "HazardFlood-v1",
        5,
        "day",
        (120, 350, 700, 1200),
        "third",
        "Water comes in from one wall, rises, and lifts what floats.",
    ),
    Show("HazardFlood-v1", 5, "evening", (350,), "third", "The same flood in the evening."),
    Show("HazardFlood-v1", 5, "day", (350,), "head", "The same flood, as the robot sees it."),
    Show(
        "HazardWind-v1",
        3,
        "day",
        (30, 150, 400, 900),
        "third",
        "Wind blows things over the street, with leaves, paper and dust.",
    ),
    Show("HazardWind-v1", 3, "evening", (400,), "third", "The same street in the evening."),
    Show("HazardWind-v1", 3, "night", (400,), "third", "The same street at night, by its lamps."),
    Show("HazardWind-v1", 3, "day", (150,), "head", "The same street, as the robot sees it."),
    Show("HazardFire-v1", 0, "day", (800,), "third", "Fire in a living room.", "living_room_a/02"),
    Show("HazardFlood-v1", 0, "day", (450,), "third", "Water in a craft room.", "craft_room_a/01"),
    Show("HazardFire-v1", 0, "evening", (800,), "third", "Fire in the kitchen of the test split.", "kitchen_b/03"),
    Show("HazardWind-v1", 0, "day", (200,), "third", "Wind over a crossing.", "crossing/02"),
    Show("HazardWind-v1", 0, "evening", (200,), "third", "Wind in a park.", "park/04"),
    Show("HazardWind-v1", 0, "day", (200,), "third", "Wind over the car park of the test split.", "parking/01"),
)


def make(folder: Path, samples: int, shows: tuple[Show, ...] = SHOWS) -> Path:
    """Make the pictures of `shows` and their page in `folder`, ray-traced with `samples` per pixel.

    Returns the page. Raises ValueError where they cannot be written; what was there is then as before.
    """
    make_folder(folder)
    contents: dict[Path, str | bytes] = {}
    lines = [
        "# Gallery",
        "",
        "Made by `hazard-ms gallery`. Left: rasterised, as observations are. Right: ray-traced (`--shader rt-fast`).",
        "",
    ]
    for show in shows:
        lines += [f"## {show.env_id}, {show.lighting}", "", show.about, ""]
        lines += ["| frame | rasterised | ray-traced |", "|---|---|---|", *_rows(contents, folder, show, samples), ""]
    page = folder / PAGE
    contents[page] = "\n".join(lines)
    write_together(contents)
    return page


def _rows(contents: dict[Path, str | bytes], folder: Path, show: Show, samples: int) -> Iterator[str]:
    """Take the pictures of one episode, and add them to `contents`; yields the table's row of each frame."""
    episode = EpisodeOptions(env_id=show.env_id, seed=show.seed, scene=show.scene, lighting=show.lighting, agent=IDLE)
    with FrozenEpisode(RenderOptions(output=Path(PAGE).with_suffix(".jpg"), episode=episode)) as frozen:
        for frame in show.frames:
            frozen.play(frame)
            names = [_name(show, frame, shader) for shader in SHADERS]
            for shader, name in zip(SHADERS, names, strict=True):
                contents[folder / name] = encoded(_picture(frozen, show, shader, samples), ".jpg", QUALITY)
            yield f"| {frame} | " + " | ".join(f"![{show.about}]({name})" for name in names) + " |"


def _picture(frozen: FrozenEpisode, show: Show, shader: str, samples: int) -> Image:
    size = HEAD_SIZE if show.camera == "head" else SIZE
    return frozen.picture(frozen.view(show.camera, *size), shader, samples)


def _name(show: Show, frame: int, shader: str) -> str:
    """The name of a picture's file."""
    task = show.env_id.removeprefix("Hazard").partition("-")[0].lower()
    place = f"{show.scene.partition('/')[0]}_" if show.scene else ""
    return f"{task}_{place}{show.lighting}_{show.camera}_{frame:04d}_{shader.replace('default', 'raster')}.jpg"
