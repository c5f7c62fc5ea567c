"""Files of earlier runs that mean harm, each decided by its number alone, and what reads them as the package does."""

from __future__ import annotations

import contextlib
import dataclasses
import functools
import io
import json
import random
import shutil
import sqlite3
import tempfile
from collections.abc import Callable
from contextlib import closing, redirect_stdout
from pathlib import Path
from typing import Any

import numpy as np
import torch

from hazard_ms.agents.learned import weights
from hazard_ms.agents.learned.map_policy import MapPolicy, MapShape
from hazard_ms.agents.learned.set_policy import SetPolicy, Shape
from hazard_ms.agents.llm.cache import Cache, Stored
from hazard_ms.cli.web import rescue
from hazard_ms.demonstrations import reading
from hazard_ms.demonstrations.layout import MANIFEST, content_of, hashes_of
from hazard_ms.demonstrations.merging import merge
from hazard_ms.demonstrations.repair import repair
from hazard_ms.demonstrations.stats import stats
from hazard_ms.demonstrations.verify import verify
from hazard_ms.evaluation.options import EpisodeOptions
from hazard_ms.evaluation.page import page
from hazard_ms.evaluation.regret.causes import PARTS, DecisionRegret, EpisodeRegret, beside, digest, place_of
from hazard_ms.evaluation.regret.decision_page import decision_page, read_trace
from hazard_ms.evaluation.result import DecisionRecord, EpisodeResult, Link
from hazard_ms.learning.checks import Check, curve_of
from hazard_ms.sketch import array_files, fit_times, scene_cache, skill_times, timeline
from hazard_ms.skills.options.options import COUNT
from hazard_ms.spec.foreign.arrays import read_arrays
from hazard_ms.spec.foreign.files import read_foreign
from tests.worlds.halls import future, hall
from tests.worlds.hostile import sights
from tests.worlds.hostile.mutations import mutated, replaced
from tests.worlds.recordings import stored
from tests.worlds.results import result_of
from tests.worlds.sketch_scenes import scene

FIRE = "HazardFire-v1"
NAME = "0123456789abcdef"  # of a rescue
OPTIONS = EpisodeOptions(agent="greedy", seed=3)
DECISIONS = (
    DecisionRecord(0, "walk_to", "book_1", True, "", 90, note="near"),
    DecisionRecord(90, "stop", None, True, "", 0),
)
RESULT = dataclasses.replace(
    result_of(OPTIONS, saved=True), decisions=DECISIONS, links=(Link(0, "0" * 64),), phase_seconds={"agent": 0.5}
)
SAID = {
    "text": "A",
    "thought": "",
    "seconds": 1.0,
    "tokens": [10, 1],
    "cached": False,
    "refused": False,
    "truncated": False,
}
TRACED = {"frame": 0, "asked": [{"role": "user", "content": "Choose."}], "options": {"A": "stop"}, "replies": [SAID]}
TRACED |= {"letter": "A", "action": "stop", "note": "", "fallback": False}
PROBED = {"robot": "fetch", "verb": "pick_up", "ok": True, "reason": "", "frames": 90, "height": 0.5, "clearance": 0.3}


@dataclasses.dataclass(frozen=True)
class Kind:
    """One kind of files: how honest ones are made in a folder, and what reads those in a folder."""

    make: Callable[[Path], object]
    read: Callable[[Path], object]
    relist: bool = False  # whether a manifest can be told of the hostile files


def make_regret(folder: Path) -> None:
    RESULT.write(folder / "one.json")
    judged = DecisionRegret(0, "walk_to", "book_1", 0.9, 0.1, 0.0, 0.0, "planning", "It went elsewhere.")
    lost = dict.fromkeys(PARTS, 0.05)
    made = EpisodeRegret(digest(folder / "one.json"), "greedy", 3, "kitchen_b/00", 0.9, 0.5, lost, (judged,))
    made.write(place_of(folder / "one.json"))


def read_regret(folder: Path) -> None:
    found = beside(folder / "one.json")
    decision_page([TRACED], "title", EpisodeResult.read(folder / "one.json"), found)


def make_journal(folder: Path) -> None:
    taken = (rescue.Taken("walk_to", "book_1", 4, "near"), rescue.Taken("stop", None))
    rescue.keep(folder, rescue.Rescue(rescue.WATCH, OPTIONS, taken=taken, name=NAME))


def make_dataset(folder: Path) -> None:
    decisions = {"frame": np.array([0, 2], np.int32), "option": np.array([0, 1]), "mask": np.ones((2, COUNT), bool)}
    stored(folder, 3, played=RESULT, decisions=decisions)


def read_dataset(folder: Path) -> None:
    """Each way of reading a dataset, as each command does; the first that refuses it does not spare the others."""
    refusals = []
    for read in (_read_all, verify, stats, lambda f: merge([f], f / "merged"), repair, verify):
        try:
            read(folder)
        except ValueError as error:
            refusals.append(error)
    if refusals:
        raise refusals[0]


def _read_all(folder: Path) -> None:
    for entry in reading.entries(folder):
        with contextlib.suppress(ValueError):
            reading.read_episode(folder / entry.name).privileged()
    for demonstration in reading.demonstrations(folder):
        demonstration.privileged()


def make_policies(folder: Path) -> None:
    for name, policy in (("one", SetPolicy(Shape(((20.0, 600.0),)))), ("map", MapPolicy(MapShape(((20.0, 600.0),))))):
        packed, told = weights.contents(policy, FIRE, {"command": "none"})
        (folder / f"{name}.safetensors").write_bytes(packed)
        (folder / f"{name}.json").write_text(told)


def read_policies(folder: Path) -> None:
    weights.sees_map(folder / "map.safetensors")
    weights.load(folder / "one.safetensors", FIRE)
    weights.load_map(folder / "map.safetensors", FIRE)


def make_state(folder: Path) -> None:
    check = dataclasses.asdict(Check(1000, 9.0, 0.5, 0.5, 0.4, 0.5))
    torch.save({"curve": [check], "policy": {"a": torch.ones(3)}}, folder / "one.training")


def read_state(folder: Path) -> None:
    try:
        curve_of(weights.packed_state(folder / "one.training"))
    except Exception as error:  # as what resumes a training does
        raise ValueError(f"the training state must be one that hazard_ms saved, got {error!r}") from None


def make_answers(folder: Path) -> None:
    path = folder / "answers.sqlite"
    for key in ("a", "b"):
        Cache(path).put(key, Stored({"choices": [{"message": {"content": "A"}}]}, 1.5), "localhost", "greedy")
    with closing(sqlite3.connect(path, isolation_level=None)) as opened:
        opened.execute("PRAGMA journal_mode=DELETE")  # so that all is in one file


def read_answers(folder: Path) -> None:
    for writable in (False, True):
        found = Cache(folder / "answers.sqlite", writable)
        for key in ("a", "b", "c"):
            found.get(key)
    found.put("d", Stored({}, 1.0), "localhost", "greedy")


KINDS = {
    "results": Kind(lambda f: RESULT.write(f / "one.json"), lambda f: page(EpisodeResult.read(f / "one.json"))),
    "regrets": Kind(make_regret, read_regret),
    "journals": Kind(make_journal, lambda f: rescue.read(f, NAME, ())),
    "datasets": Kind(make_dataset, read_dataset, relist=True),
    "arrays": Kind(
        lambda f: np.savez(f / "a.npz", a=np.ones((3, 2)), b=np.arange(5)), lambda f: read_arrays(f / "a.npz")
    ),
    "timelines": Kind(
        lambda f: future(hall(1.0, 2.0)).write(f / "a.timeline"), lambda f: timeline.read(f / "a.timeline")
    ),
    "sketches": Kind(
        lambda f: (f / "a.scene").write_bytes(scene_cache.to_bytes(scene([(0.0, 0.0), (1.0, 2.0)], (1,)))),
        lambda f: scene_cache.from_bytes(read_foreign(f / "a.scene", array_files.LARGEST)),
    ),
    "skill-times": Kind(
        lambda f: shutil.copyfile(skill_times.SHIPPED, f / "times.json"),
        lambda f: skill_times.load("fetch", f / "times.json"),
    ),
    "probes": Kind(
        lambda f: (f / "a.jsonl").write_text(3 * (json.dumps({**PROBED, "distance": 0.0}) + "\n")),
        lambda f: list(fit_times.probed(f / "a.jsonl")),
    ),
    "policies": Kind(make_policies, read_policies),
    "states": Kind(make_state, read_state),
    "traces": Kind(
        lambda f: (f / "a.jsonl").write_text(3 * (json.dumps(TRACED) + "\n")),
        lambda f: decision_page(read_trace(f / "a.jsonl"), "title"),
    ),
    "answers": Kind(make_answers, read_answers),
    "captured": Kind(sights.make_captured, sights.read_captured),
    "detections": Kind(sights.make_detections, sights.read_detections),
    "detectors": Kind(sights.make_detectors, sights.read_detectors),
    "replies": Kind(sights.make_reply, sights.read_reply),
}


@functools.cache
def honest(corpus: str) -> dict[str, bytes]:
    """Honest files of a corpus by their paths; they are read once."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        KINDS[corpus].make(folder)
        found = {
            str(path.relative_to(folder)): path.read_bytes() for path in sorted(folder.rglob("*")) if path.is_file()
        }
        with redirect_stdout(io.StringIO()):
            KINDS[corpus].read(folder)
    return found


def record(corpus: str, number: int, folder: Path, secret: Path, module: Path) -> tuple[str, Callable[[], Any]]:
    """Make the hostile files of a number in a `folder`; which one is hostile, and what reads them.

    `secret` and `module`: files outside, which some of them name.
    """
    draw = random.Random(f"{corpus} {number}")
    kind, files = KINDS[corpus], honest(corpus)
    for name, content in files.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(content)
    victim = draw.choice(sorted(name for name in files if files[name]))
    if draw.random() < 0.05:
        replaced(folder / victim, secret, draw)
    else:
        content = mutated(victim, files[victim], draw)
        (folder / victim).write_bytes(
            content.replace(b"/etc/passwd", str(secret).encode()).replace(b"file:///dev/zero", str(module).encode())
        )
        if kind.relist and victim != MANIFEST and draw.random() < 0.8:
            _relist(folder)
    return victim, functools.partial(kind.read, folder)


def _relist(folder: Path) -> None:
    """Let the manifest of a dataset list the files of its episode as they are now."""
    row = json.loads((folder / MANIFEST).read_text())
    hashes = hashes_of(folder / row["name"])
    (folder / MANIFEST).write_text(
        json.dumps({**row, "files": hashes, "content": content_of(hashes)}, sort_keys=True) + "\n"
    )
