"""The commands `hazard-ms scenes ...`. Each imports what it needs when it is called, so that `hazard-ms --help` is quick."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import tyro

from hazard_ms.spec import SceneSpec

Out = Annotated[Path | None, tyro.conf.arg(aliases=["-o"])]


def list_scenes(split: str = "", family: str = "") -> int:
    """List the scenes of a split, or of all splits.

    Args:
        split: Name of a split; empty for all.
        family: indoor or outdoor; empty for both.
    """
    from hazard_ms.scenes.splits import scene

    for each in names_of(split, family):
        spec = scene(each)
        targets = ", ".join(f"{sum(t.category == c for t in spec.targets)} {c}" for c in spec.target_categories)
        print(f"{spec.split:11s} {each:16s} {len(spec.bodies):3d} things, {len(spec.fires)} fires; targets: {targets}")
    return 0


def make(name: tyro.conf.Positional[str], out: Out = None) -> int:
    """Generate a scene and write it as JSON.

    Args:
        name: Name of a scene, kitchen_a/07 say.
        out: File to write; without it, the scene is printed.
    """
    from hazard_ms.scenes.schema import to_json
    from hazard_ms.scenes.splits import scene

    text = to_json(scene(name))
    if out is None:
        print(text, end="")
        return 0
    try:
        out.write_text(text, encoding="utf-8")
    except OSError as error:
        raise ValueError(f"{out} cannot be written: {error.strerror}") from None
    print(f"scene: {out.resolve()}")
    return 0


def show(name: tyro.conf.Positional[str], out: Out = None) -> int:
    """Draw a labelled plan of a scene beside a view of it, as one picture.

    Args:
        name: Name of a scene, or a JSON file that holds one.
        out: File to write; without it, the scene's name with .png in the current folder.
    """
    from hazard_ms.scene_picture import save

    spec = read(name)
    path = out or Path(spec.name.replace("/", "_") + ".png")
    save(spec, path)
    print(f"picture: {path.resolve()}")
    return 0


def check(names: tyro.conf.Positional[tuple[str, ...]] = (), split: str = "", family: str = "", all: bool = False, workers: int = 2) -> int:
    """Check scenes: nothing inside another, all at rest, targets in reach, sizes plausible. Ends with 1 if there is a problem.

    Args:
        names: Scenes, or JSON files that hold one.
        split: All scenes of a split.
        family: indoor or outdoor; empty for both.
        all: All scenes.
        workers: Processes that check at the same time.
    """
    from hazard_ms.scene_checks import check_all

    if bool(names) + bool(split or family) + all != 1:
        raise ValueError("hazard-ms scenes check wants either names, or a split, or --all")
    if not 1 <= workers <= 64:
        raise ValueError(f"workers is {workers}; 1 to 64 is allowed")
    return check_all(names or names_of(split, family), workers)


def bring(paths: tyro.conf.Positional[tuple[Path, ...]], out: Annotated[Path, tyro.conf.arg(aliases=["-o"])]) -> int:
    """Import scenes of the original benchmark: its folders with log.txt, info.json and flood.json. Ends with 1 if one cannot be read.

    Args:
        paths: Folders of scenes, or folders of such folders.
        out: Folder to write into, one JSON file for each scene.
    """
    from hazard_ms.importing import import_scenes

    return import_scenes(paths, out)


def names_of(split: str, family: str) -> tuple[str, ...]:
    """Names of the scenes of a split, of a family, or of both empty: all. Raises ValueError for names that are none."""
    from hazard_ms.scenes.splits import families, scene_names, split_names

    wanted = (family,) if family else families()
    known = dict.fromkeys(s for f in wanted for s in split_names(f))
    if split and split not in known:
        raise ValueError(f"no split is called {split!r}; there are {', '.join(known)}")
    return tuple(name for f in wanted for s in split_names(f) if split in ("", s) for name in scene_names(s, f))


def read(name: str) -> SceneSpec:
    """The scene of that name, or in the JSON file of that name."""
    from hazard_ms.scenes.schema import from_json
    from hazard_ms.scenes.splits import scene

    if not name.endswith(".json"):
        return scene(name)
    try:
        return from_json(Path(name).read_bytes())
    except OSError as error:
        raise ValueError(f"{name} cannot be read: {error.strerror}") from None


SceneCommand = (
    Annotated[int, tyro.conf.subcommand(name="list", constructor=list_scenes)]
    | Annotated[int, tyro.conf.subcommand(name="make", constructor=make)]
    | Annotated[int, tyro.conf.subcommand(name="show", constructor=show)]
    | Annotated[int, tyro.conf.subcommand(name="check", constructor=check)]
    | Annotated[int, tyro.conf.subcommand(name="import", constructor=bring)]
)
