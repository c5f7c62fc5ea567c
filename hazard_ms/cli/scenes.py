"""The commands `hazard-ms scenes ...`; each imports what it needs when it is called, so that help is quick."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import tyro

from hazard_ms.evaluation.choices import SPLITS, flag, offer
from hazard_ms.spec import registry

FAMILIES = ("indoor", "outdoor", "house", "house_flood", "gale")
MOST_WORKERS = 64  # processes [ours]

Output = Annotated[Path | None, flag("-o", "--output", old="out")]
Split = Annotated[str, offer(SPLITS)]
Family = Annotated[str, offer(FAMILIES)]


def list_scenes(split: Split = "", family: Family = "") -> int:
    """List the scenes of a split, or of all splits.

    Args:
        split: Name of a split; empty for all.
        family: Family of scenes; empty for all.
    """
    from hazard_ms.scenes.splits import scene

    for each in names_of(split, family):
        spec = scene(each)
        targets = ", ".join(f"{sum(t.category == c for t in spec.targets)} {c}" for c in spec.target_categories)
        print(f"{spec.split:11s} {each:16s} {len(spec.bodies):3d} things, {len(spec.fires)} fires; targets: {targets}")
    return 0


def make(name: tyro.conf.Positional[str], output: Output = None) -> int:
    """Generate a scene and write it as JSON.

    Args:
        name: Name of a scene, such as kitchen_a/07.
        output: File to write; by default the scene is printed.
    """
    from hazard_ms.scenes.schema import to_json
    from hazard_ms.scenes.splits import scene
    from hazard_ms.spec.storage.files import write

    text = to_json(scene(name))
    if output is None:
        print(text, end="")
        return 0
    write(output, text)
    print(f"scene: {output.resolve()}")
    return 0


def show(name: tyro.conf.Positional[str], output: Output = None) -> int:
    """Draw a labelled plan of a scene beside a view of it, as one picture.

    Args:
        name: Name of a scene, or a JSON file that holds one.
        output: File to write; by default the scene's name with .png, in the current folder.
    """
    from hazard_ms.validation.scene_checks import find

    spec = find(name)  # before what draws it, which takes seconds to load
    from hazard_ms.pictures.scene_plan import save

    path = output or Path(spec.name.replace("/", "_") + ".png")
    save(spec, path)
    print(f"picture: {path.resolve()}")
    return 0


def check(
    names: tyro.conf.Positional[tuple[str, ...]] = (),
    split: Split = "",
    family: Family = "",
    all: bool = False,
    workers: int = 2,
) -> int:
    """Check scenes: nothing overlaps, everything rests, targets are in reach, sizes are plausible.

    Exits with 1 if there is a problem.

    Args:
        names: Scenes, or JSON files that hold one.
        split: All scenes of a split.
        family: Family of scenes; empty for all.
        all: All scenes.
        workers: Processes that check at the same time.
    """
    from hazard_ms.spec.checks import whole
    from hazard_ms.validation.scene_checks import check_all

    _only_one_of(bool(names), bool(split or family), all)
    whole(workers, 1, MOST_WORKERS, "workers")
    return check_all(names or names_of(split, family), workers)


def bring(
    paths: tyro.conf.Positional[tuple[Path, ...]], output: Annotated[Path, flag("-o", "--output", old="out")]
) -> int:
    """Import scenes of the original benchmark: its folders with log.txt, info.json and flood.json.

    Exits with 1 if a scene cannot be read.

    Args:
        paths: Folders of scenes, or folders of such folders.
        output: Folder to write into, one JSON file for each scene.
    """
    from hazard_ms.scenes.original.importing import import_scenes

    return import_scenes(paths, output)


def reach(
    names: tyro.conf.Positional[tuple[str, ...]] = (),
    robots: Annotated[tuple[Annotated[str, offer(registry.ROBOTS)], ...], flag("-r")] = tuple(registry.ROBOTS),
    split: Split = "",
    family: Family = "",
    all: bool = False,
) -> int:
    """Print which targets robots can reach in scenes: through gaps in the furniture, with the length of their arms.

    Args:
        names: Scenes, JSON files that hold one, or folders of such files.
        robots: Robots.
        split: All scenes of a split.
        family: Family of scenes; empty for all.
        all: All scenes.
    """
    from hazard_ms.validation.scene_checks import print_reach

    _only_one_of(bool(names), bool(split or family), all)
    print_reach(names or names_of(split, family), robots)
    return 0


def names_of(split: str, family: str) -> tuple[str, ...]:
    """Names of the scenes of a split, of a family, or of both; of all where both are empty.

    Raises ValueError for an unknown split or family.
    """
    from hazard_ms.scenes.splits import families, scene_names, split_names
    from hazard_ms.spec.checks import one_of

    wanted = (one_of(family, families(), "family"),) if family else families()
    known = dict.fromkeys(s for f in wanted for s in split_names(f))
    if split:
        one_of(split, known, "split")
    names = (name for f in wanted for s in split_names(f) if split in ("", s) for name in scene_names(s, f))
    return tuple(dict.fromkeys(names))  # fires and floods share the homes to train in


def _only_one_of(*given: bool) -> None:
    if sum(given) != 1:
        raise ValueError("scenes must be given as names, or by --split and --family, or by --all")


SceneCommand = (
    Annotated[int, tyro.conf.subcommand(name="list", constructor=list_scenes)]
    | Annotated[int, tyro.conf.subcommand(name="make", constructor=make)]
    | Annotated[int, tyro.conf.subcommand(name="show", constructor=show)]
    | Annotated[int, tyro.conf.subcommand(name="check", constructor=check)]
    | Annotated[int, tyro.conf.subcommand(name="reach", constructor=reach)]
    | Annotated[int, tyro.conf.subcommand(name="import", constructor=bring)]
)
