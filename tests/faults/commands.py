"""The commands that write files, each in its quickest form, and what must be true of the files that they leave."""

from __future__ import annotations

import json
import os
import re
import struct
import sys
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path

import cv2
import imageio_ffmpeg

from hazard_ms.scenes.files import read_scene
from tests.worlds.files.checkout import ROOT, THIS_PYTHON, locked, pins, small_checkout
from tests.worlds.files.original_folders import WIND_INFO, street
from tests.worlds.files.original_folders import folder as original_folder
from tests.worlds.files.user_models import desk

HAZARD_MS = [sys.executable, "-m", "hazard_ms.cli"]
STOPPING = "tests.examples.stopping:Stopping"
GALLERY = """
import sys
from pathlib import Path
from hazard_ms.pictures import gallery
show = gallery.SHOWS[0]._replace(frames=(30, 60))
gallery.SIZE = (96, 64)
try:
    gallery.make(Path(sys.argv[1]), 1, (show,))
except ValueError as error:
    sys.exit(f"error: {error}")
"""
KERNEL = """
import sys
try:
    import gymnasium as gym, hazard_ms
    env = gym.make("HazardWind-v1", obs_mode="none", render_backend="none")
    env.reset(seed=0)
    env.step(None)
except ValueError as error:
    sys.exit(f"error: {error}")
"""


@dataclass(frozen=True)
class Command:
    """A command: its words for an output folder and a seed; the seed tells older files from newer ones."""

    name: str
    words: Callable[[Path, int], list[str]]
    environ: Callable[[Path], Mapping[str, str]] = field(default=lambda folder: {})
    once: bool = False  # a second time it has nothing to do
    refuses_two: bool = False  # the second of two at once may be refused with a clear message


def play(folder: Path, seed: int) -> list[str]:
    film = str(folder / "film.mp4")
    return [*HAZARD_MS, "play", "-a", STOPPING, "-s", str(seed), "-o", film, "--every", "10"]


def evaluate(folder: Path, seed: int) -> list[str]:
    words = ["evaluate", "--agents", STOPPING, "--episodes", "2", "--workers", "1", "-s", str(seed)]
    return [*HAZARD_MS, *words, "-o", str(folder)]


def import_scene(folder: Path, seed: int) -> list[str]:
    source = folder.parent / "original" / "street-1"
    if not source.exists():
        original_folder(source, street(), WIND_INFO)
    return [*HAZARD_MS, "scenes", "import", str(source), "-o", str(folder)]


def add(folder: Path, seed: int) -> list[str]:
    model = folder.parent / "desk.obj"
    if not model.exists():
        desk().export(model)
    name = f"my_desk_{'ab'[seed]}"
    words = [str(model), "--category", "table", "--name", name, "--licence", "own work", "--size", "1.2"]
    return [*HAZARD_MS, "assets", "add", *words]


def set_up(folder: Path, seed: int) -> list[str]:
    checkout = folder.parent / "checkout"
    if not checkout.exists():
        wanted = ("gymnasium", "numpy", "cloudpickle", "typing-extensions", "farama-notifications")
        versions = locked(THIS_PYTHON)
        hashes = {name: found for name, _, found in pins((ROOT / "requirements.lock").read_text())}
        wanted_pins = [f"{name}=={versions[name]}" for name in wanted]
        checkout.mkdir()
        small_checkout(checkout, "".join(f"{pin} {' '.join(hashes[pin])}\n" for pin in wanted_pins))
    return [str(checkout / "run"), "python", "-c", "import gymnasium"]


def home_of_set_up(folder: Path) -> dict[str, str]:
    python = getattr(sys, "_base_executable", sys.executable)
    return {"HAZARD_MS_HOME": str(folder), "HAZARD_MS_PYTHON": python, "HAZARD_MS_NO_SYSTEM": "1"}


COMMANDS = (
    Command("play", play),
    Command("evaluate", evaluate),
    Command("render", lambda f, s: [*HAZARD_MS, "render", "--size", "96", "-s", str(s), "-o", str(f / "picture.png")]),
    Command("gallery", lambda f, s: [sys.executable, "-c", GALLERY, str(f)]),
    Command("scenes make", lambda f, s: [*HAZARD_MS, "scenes", "make", f"kitchen_a/0{s}", "-o", str(f / "scene.json")]),
    Command("scenes import", import_scene),
    Command("assets add", add, lambda f: {"HAZARD_MS_ASSETS": str(f)}, refuses_two=True),
    Command(
        "first compile", lambda f, s: [sys.executable, "-c", KERNEL], lambda f: {"WARP_CACHE_PATH": str(f)}, once=True
    ),
    Command("./run", set_up, home_of_set_up, once=True),
)


def half_written(folder: Path) -> Iterator[str]:
    """What is wrong with the files of `folder` that a user or the package could take for whole ones."""
    for path in sorted(folder.rglob("*")):
        if (
            path.is_symlink()
            or not path.is_file()
            or any(part.startswith(".") for part in path.relative_to(folder).parts)
        ):
            continue
        check = CHECKS.get(path.suffix)
        if check and (fault := check(path)):
            yield f"{path.name}: {fault}"
    yield from disagreeing(folder)


def disagreeing(folder: Path) -> Iterator[str]:
    """Film, result and page of `play` belong to one episode."""
    result, page = folder / "film.json", folder / "film.html"
    present = [path.suffix for path in (result, page, folder / "film.mp4") if path.exists()]
    if 0 < len(present) < 3:
        yield f"only {present} of film, result and page"
    elif present:
        seed = json.loads(result.read_text())["seed"]
        if not re.search(rf"(-s|--seed)[ =]{seed}\b", page.read_text()):
            yield "the page is of another episode than the result"


def json_fault(path: Path) -> str:
    try:
        json.loads(path.read_text())
        if path.parent.name == "out-scenes":
            read_scene(path)
    except ValueError as error:
        return f"{error}"
    return ""


def film_fault(path: Path) -> str:
    try:
        frames, seconds = imageio_ffmpeg.count_frames_and_secs(str(path))
    except (RuntimeError, OSError) as error:
        return f"cannot be opened: {error}"[:100]
    return "" if frames > 0 and seconds > 0 else "holds nothing"


def glb_fault(path: Path) -> str:
    data = path.read_bytes()
    whole = len(data) > 12 and data[:4] == b"glTF" and struct.unpack("<I", data[8:12])[0] == len(data)
    return "" if whole else "cut off"


CHECKS: dict[str, Callable[[Path], str]] = {
    ".json": json_fault,
    ".html": lambda p: "" if p.read_text().rstrip().endswith("</html>") else "cut off",
    ".mp4": film_fault,
    ".png": lambda p: "" if cv2.imread(str(p)) is not None and p.read_bytes()[-8:-4] == b"IEND" else "cut off",
    ".jpg": lambda p: "" if cv2.imread(str(p)) is not None and p.read_bytes()[-2:] == b"\xff\xd9" else "cut off",
    ".md": lambda p: "" if p.read_text().endswith("|\n") or p.read_text().strip() else "empty",
    ".glb": glb_fault,
}


def environment(command: Command, folder: Path, **changes: str | None) -> dict[str, str]:
    """The variables under which `command` runs; None takes one away."""
    found = {**os.environ, "PYTHONPATH": str(ROOT), "OMP_NUM_THREADS": "1", **command.environ(folder)}
    found.update({name: value for name, value in changes.items() if value is not None})
    return {name: value for name, value in found.items() if changes.get(name, "") is not None}
