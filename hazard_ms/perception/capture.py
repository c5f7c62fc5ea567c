"""`hazard-ms perception capture`: takes the pictures of many scenes in processes of their own, and puts them together.

A scene is first a folder `.kitchen_a-07.part-PID`, locked by the process that fills it. Its files are brought to the
disk before the folder gets its name. A process that is killed leaves a part, which the next run deletes; whole scenes
are not taken again.
"""

from __future__ import annotations

import json
import os
from dataclasses import dataclass, replace
from pathlib import Path

import torch
from tqdm import tqdm

from hazard_ms.evaluation.choices import RAY
from hazard_ms.evaluation.spread import spread
from hazard_ms.evaluation.workers import SILENCE, Job, Outcome, Say, Word
from hazard_ms.perception import coco, layout
from hazard_ms.perception.card import card, licences
from hazard_ms.perception.options import CaptureOptions
from hazard_ms.perception.scene import capture_scene
from hazard_ms.spec.checks import one_of
from hazard_ms.spec.foreign.files import sha256_of
from hazard_ms.spec.storage.files import flush, make_folder, write, write_together
from hazard_ms.spec.storage.parts import part_of
from hazard_ms.tasks import task_of
from hazard_ms.tasks.spare import spare_names

ELSEWHERE = "another process is taking its pictures"


@dataclass(frozen=True)
class CaptureJob(Job):
    """The scene of which pictures are to be taken, and how."""

    capture: CaptureOptions = CaptureOptions()


def capture(options: CaptureOptions) -> int:
    """Take the pictures that are not there yet, and write the files of the split. Returns 1 if a scene failed, else 0.

    Raises ValueError for what cannot be captured, and where the folder holds pictures of another recipe.
    """
    options.check()
    coco.tools()
    if options.backend == RAY:  # whose processes are elsewhere
        options = replace(options, output=options.output.absolute())
    wanted = _scenes(options)
    home = options.dataset / options.env.split
    make_folder(home)
    done = {scene for scene in wanted if _whole(home / layout.folder_of(scene), options)}
    jobs = [CaptureJob(options.episode(scene, 0), SILENCE, capture=options) for scene in wanted if scene not in done]
    if done:
        print(f"{len(done)} of {len(wanted)} scenes are already captured", flush=True)
    failed = 0
    taken = spread(jobs, options.workers, options.backend, options.address, attempt)
    with taken as outcomes, tqdm(total=len(jobs) * options.per_scene, unit="picture", disable=not jobs) as bar:
        for job, outcome in outcomes:
            bar.update(options.per_scene)
            failed += bool(outcome.error)
            if outcome.error:
                bar.write(f"{job.options.scene}: no pictures: {outcome.error}")
    count = assemble(options.dataset, options.env.split)
    print(f"{options.dataset / layout.instances(options.env.split)}: {count} pictures")
    return int(failed > 0)


def _scenes(options: CaptureOptions) -> tuple[str, ...]:
    """Names of the scenes: those that `options` name, or all of the split and the spare ones.

    Raises ValueError for a split that the task does not have, and for scenes that are not in it.
    """
    env = options.env
    task = task_of(env.env_id, env.physics, env.hazards or None, env.severity)
    one_of(options.env.split, task.splits, "split")
    known = (*task.scenes(options.env.split), *spare_names(task.scenes(options.env.split), options.spare))
    for scene in options.scenes:
        one_of(scene, known, f"a scene of the split {env.split!r}")
    return tuple(dict.fromkeys(options.scenes)) or known


def attempt(job: Job, say: Say) -> Outcome:
    """Take the pictures of one scene in this process, with one thread."""
    assert isinstance(job, CaptureJob) and job.options.scene is not None
    torch.set_num_threads(1)
    options, scene = job.capture, job.options.scene
    options.env.check()  # loads what third parties register
    place = options.dataset / options.env.split / layout.folder_of(scene)
    try:
        with part_of(place) as part:
            if part is None:
                return Outcome(None, ELSEWHERE)
            if not place.exists():
                capture_scene(options, scene, part, lambda: say(Word(None)))
                _publish(part, place)
        return Outcome(None)
    except Exception as error:
        return Outcome(None, f"{type(error).__name__}: {error}")


def _publish(part: Path, place: Path) -> None:
    """Add the checksums, bring all files of `part` to the disk, and give the folder its name."""
    names = [path.relative_to(part).as_posix() for path in part.rglob("*") if path.is_file()]
    (part / layout.SUMS).write_text(layout.sums_of(part, names), encoding="utf-8")
    for path in [*(p for p in part.rglob("*")), part]:
        flush(path)
    os.replace(part, place)
    flush(place.parent)


def _whole(place: Path, options: CaptureOptions) -> bool:
    """Whether the pictures of a scene are there. Raises ValueError if they are of another recipe."""
    if not place.exists():
        return False
    recipe = layout.read_scene(place)["recipe"]
    wanted = json.loads(layout.text_of(options.recipe))
    if recipe != wanted:
        others = {k: recipe.get(k) for k in {**recipe, **wanted} if recipe.get(k) != wanted.get(k)}
        raise ValueError(
            f"output must hold pictures with { ({k: wanted.get(k) for k in others}) } only, got {place} with {others}; "
            "name another folder"
        )
    return True


def assemble(dataset: Path, split: str) -> int:
    """Write the COCO file of a split from the folders of its scenes, and the dataset's card, tables and checksums.

    Returns the number of pictures. Raises ValueError for a folder that cannot be read.
    """
    places = sorted(p for p in (dataset / split).iterdir() if p.is_dir() and not p.name.startswith("."))
    scenes = [layout.read_scene(place) for place in places]
    if not scenes:
        return 0
    images = sorted((row for scene in scenes for row in scene["images"]), key=lambda row: row["id"])
    rows = sorted((row for scene in scenes for row in scene["annotations"]), key=lambda row: row["id"])
    told = {
        "info": {
            "description": f"{scenes[0]['recipe']['env_id']}, split {split}: pictures of hazards, made with hazard_ms",
            "version": str(layout.FORMAT),
            "recipe": scenes[0]["recipe"],
        },
        "licenses": [],
        "categories": layout.categories(),
        "images": images,
        "annotations": rows,
    }
    write(dataset / layout.instances(split), layout.text_of(told))
    texts = {layout.CARD: card(dataset), layout.LICENCES: licences(dataset), layout.TABLE: labels_table(dataset)}
    write_together({dataset / name: text for name, text in texts.items()})
    write(dataset / layout.SUMS, _all_sums(dataset, texts))
    return len(images)


def labels_table(dataset: Path) -> str:
    """The meaning of the ids in ids pictures, as JSON: of each scene, the name and category of each number."""
    found = {}
    for rows in map(layout.read_scene, layout.scene_folders(dataset)):
        found[rows["scene"]] = {str(k + 1): row for k, row in enumerate(rows["things"])}
    return layout.text_of({"0": "no thing: floor, walls, sky", "scenes": found}, 1)


def _all_sums(dataset: Path, texts: dict[str, str]) -> str:
    """The checksums of all files of a dataset; those of the scenes are taken from their own lists."""
    every: dict[str, str] = {}
    for place in layout.scene_folders(dataset):
        where = place.relative_to(dataset).as_posix()
        known = layout.read_sums(place / layout.SUMS)
        every |= {f"{where}/{name}": digest for name, digest in known.items()}
    for path in [*dataset.glob(layout.instances("*")), *(dataset / name for name in texts)]:
        every[path.name] = sha256_of(path)
    return "".join(f"{digest}  {name}\n" for name, digest in sorted(every.items()))
