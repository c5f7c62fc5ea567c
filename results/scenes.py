"""Searches for homes that tell agents apart: `python results/scenes.py grid`, then `search`, then `table`.

    grid     plays six homes for each of a few settings of their generator, and prints a row each
    rates    plays twelve homes in floods whose water rises at each of RATES, and prints a row each
    search   goes through candidates for the scenes of `test` and `held_out`, those of fires and those of floods, until
             one of each tells agents apart
    table    prints what the chosen scenes are like, from the rows of the search

Candidates are numbered. The scene is the first that meets all criteria, else, of those looked at, the one that fits
best but for what measures gain; number 0 if none was looked at. `search` adds a row to scenes.csv for each candidate
that it has looked at, and resumes where it stopped; then it writes the numbers of the chosen ones into the package.
What is played: results/scene_plays.py; what is lost: results/scene_futures.py. Criteria: `Play.tells`.
"""

from __future__ import annotations

import csv
import dataclasses
import itertools
import sys
import time
from pathlib import Path

import numpy as np
import torch

from hazard_ms.scenes.floor import cell_of, connected, free_floor
from hazard_ms.scenes.generate.house import chosen, homes
from hazard_ms.scenes.splits import scene_names
from hazard_ms.spec import SceneSpec
from results.scene_futures import FIRE, FLOOD, Change, losses
from results.scene_plays import Play, changes, play

ROWS = Path(__file__).with_name("scenes.csv")
COLUMNS = ("scene", "number", "risk", "nearest", "plain", "best", "measures", "chosen")
SPLITS = ("test", "held_out")
FAMILIES = {"house": FIRE, "house_flood": FLOOD}  # scenes, and the hazard for which they are chosen
TOGETHER = 2  # scenes whose candidates are simulated in one batch
MOST = 12  # candidates for one scene
RADIUS = 0.3  # of a disc in which Fetch's base, 0.28 m, fits [m]
LARGEST = 120.0  # home [m2] [docs/benchmark.md 1.1]
ENTERED = 0.05  # share of the floor of a room to which a robot must get [ours]
GRID = tuple(
    {"fires": fires, "fire_distance": distance, "fire_reach": reach, "targets": targets}
    for fires, distance, reach, targets in (
        ((2, 3), 0.5, 1.5, (14, 20)),
        ((3,), 1.0, 2.0, (16, 20)),
        ((3,), 1.5, 2.5, (16, 20)),
        ((3,), 1.5, 3.5, (16, 20)),
        ((3,), 2.0, 3.5, (16, 20)),
        ((4,), 1.5, 2.5, (18, 20)),
    )
)
RATES = (60, 40, 30)  # frames in which water rises by 0.01 m
RATE_HOMES = tuple(f"house_flood_test_1/{n:02d}" for n in range(12))
GRID_HOMES = tuple(f"house_test_1/{n:02d}" for n in range(6))


def plays(env_id: str, specs: list[SceneSpec], quick: bool = False, every: int | None = None) -> list[Play]:
    """What agents make of each scene; `quick` as for `play`, `every` as for `losses`."""
    offered = [changes(env_id, spec) for spec in specs]
    cases = [(spec, change) for spec, many in zip(specs, offered, strict=True) for change in (Change(), *many)]
    made, found = losses(env_id, cases, every=every), []
    for spec, many in zip(specs, offered, strict=True):
        alone, *after = made[: 1 + len(many)]
        del made[: 1 + len(many)]
        found.append(play(env_id, spec, alone, list(zip(many, after, strict=True)), quick))
    return found


def grid() -> None:
    """Print what homes of each setting are like, on average."""
    base = homes.layout_of("house_test_1", "test")
    print("| fires | from targets [m] | within [m] | targets | at risk | nearest | plain | best | tell |")
    print("|---|---|---|---|---|---|---|---|---|")
    for setting in GRID:
        layout = dataclasses.replace(base, **setting)
        found = plays(FIRE, [homes.candidate(layout, name, "test", 0) for name in GRID_HOMES])
        fires, targets = ("-".join(map(str, setting[k])) for k in ("fires", "targets"))
        means = " | ".join(f"{mean:.0f}" for mean in means_of(found))
        tell = sum(p.tells(FIRE) for p in found)
        print(
            f"| {fires} | {layout.fire_distance} | {layout.fire_reach} | {targets} | {means} | {tell} of {len(found)} |"
        )


def rates() -> None:
    """Print what homes are like in floods of each rate, on average."""
    print("| 0.01 m every | at risk | nearest | plain | best | tell |\n|---|---|---|---|---|---|")
    for frames in RATES:
        homes_of = [candidate(name, "test", 0) for name in RATE_HOMES]
        found = plays(FLOOD, homes_of, quick=True, every=frames)
        means = " | ".join(f"{mean:.0f}" for mean in means_of(found))
        print(f"| {frames} frames | {means} | {sum(p.tells(FLOOD) for p in found)} of {len(found)} |", flush=True)


def means_of(found: list[Play]) -> list[float]:
    """Means of what is at risk, and of what the three agents avert, in per cent."""
    return [100.0 * float(np.mean([getattr(p, k) for p in found])) for k in ("risk", "nearest", "plain", "best")]


def search(minutes: float) -> None:
    """Look at candidates for as long as this, or until each scene has one."""
    until = time.monotonic() + 60.0 * minutes
    split_of = {name: split for split in SPLITS for family in FAMILIES for name in scene_names(split, family)}
    done = {name: read(name) for name in split_of}
    while time.monotonic() < until:
        open_ = [n for n, rows in done.items() if len(rows) < MOST and not any(r["chosen"] == "1" for r in rows)]
        # those of `test` first, and of them those with the fewest candidates so far
        first = sorted(open_, key=lambda n: (split_of[n] != "test", len(done[n])))
        if not first:
            break
        env_id = env_of(first[0])
        now = [name for name in first if env_of(name) == env_id][:TOGETHER]
        specs = [candidate(name, split_of[name], len(done[name])) for name in now]
        for name, spec, found in zip(now, specs, plays(env_id, specs, quick=True), strict=True):
            row = [name, len(done[name]), *(f"{v:.3f}" for v in dataclasses.astuple(found)[:4])]
            row += [found.measures, int(found.tells(env_id) and sound(spec))]
            with ROWS.open("a", newline="") as file:
                csv.writer(file, lineterminator="\n").writerow(row)
            done[name] = read(name)
        print(f"{sum(any(r['chosen'] == '1' for r in rows) for rows in done.values())} chosen", flush=True)
    write({name: best(split_of[name], rows) for name, rows in done.items() if rows})


def best(split: str, rows: list[dict[str, str]]) -> int:
    """The number of the candidate of a `split` that fits best, of those that are sound.

    Raises ValueError where there is none of them.
    """
    for row in sorted(rows, key=fitness, reverse=True):
        if sound(candidate(row["scene"], split, int(row["number"]))):
            return int(row["number"])
    raise ValueError(f"{rows[0]['scene']} must have rooms that a robot gets into, got none in {len(rows)} candidates")


def sound(spec: SceneSpec) -> bool:
    """Whether a home has LARGEST m2 at most, and a robot gets into every room with doors as they begin."""
    if spec.room.size[0] * spec.room.size[1] > LARGEST:
        return False
    reached = connected(free_floor(spec, RADIUS), spec.agent_start.position)
    for area in spec.room.areas:
        (i0, j0), (i1, j1) = cell_of(area.min), cell_of(area.max)
        if reached[i0:i1, j0:j1].mean() <= ENTERED:
            return False
    return True


def fitness(row: dict[str, str]) -> float:
    """How well a candidate fits: by its worst margin, measures left aside unless it meets all criteria."""
    found, env_id = played(row), env_of(row["scene"])
    return float(found.tells(env_id)) + found.margin(env_id)


def env_of(name: str) -> str:
    """The task for which a scene is chosen."""
    (family,) = (f for f in FAMILIES for split in SPLITS if name in scene_names(split, f))
    return FAMILIES[family]


def played(row: dict[str, str]) -> Play:
    """What a row says."""
    return Play(*(float(row[k]) for k in COLUMNS[2:6]), int(row["measures"]))


def candidate(name: str, split: str, number: int) -> SceneSpec:
    """The candidate of this `number` for the scene `name`."""
    return homes.candidate(homes.layout_of(name.split("/")[0], split), name, split, number)


def read(name: str) -> list[dict[str, str]]:
    """The rows of the candidates for the scene `name` so far."""
    if not ROWS.exists():
        ROWS.write_text(",".join(COLUMNS) + "\n")
    with ROWS.open(newline="") as file:
        return [row for row in csv.DictReader(file) if row["scene"] == name]


def write(numbers: dict[str, int]) -> None:
    """Write the numbers of the chosen candidates, but for 0, into the package."""
    path = Path(chosen.__file__)
    head, _, _ = path.read_text().partition("CHOSEN")
    lines = "".join(f'    "{name}": {number},\n' for name, number in sorted(numbers.items()) if number)
    path.write_text(head + "CHOSEN: dict[str, int] = {\n" + lines + "}\n")


def table() -> None:
    """Print what the scenes are like, from scenes.csv."""
    with ROWS.open(newline="") as file:
        rows = list(csv.DictReader(file))
    print("| task | scenes | candidates | tell | but for measures | at risk | nearest | plain | best |")
    print("|---|---|---|---|---|---|---|---|---|")
    for (family, env_id), split in itertools.product(FAMILIES.items(), SPLITS):
        names = scene_names(split, family)
        mine = [r for r in rows if r["scene"] in names]
        looked = len(mine)
        mine = [r for r in mine if int(r["number"]) == chosen.CHOSEN.get(r["scene"], 0)]
        kept = [played(r) for r in mine]
        if kept:
            means = " | ".join(f"{mean:.0f}" for mean in means_of(kept))
            told, nearly = sum(r["chosen"] == "1" for r in mine), sum(p.margin(env_id) >= 0.0 for p in kept)
            print(f"| {env_id} | `{split}` | {looked} | {told} of {len(kept)} | {nearly} | {means} |")


def main(command: str, minutes: str = "10") -> None:
    """Do what the command says; `minutes` that a search may take."""
    torch.set_num_threads(1)
    {"grid": grid, "rates": rates, "table": table, "search": lambda: search(float(minutes))}[command]()


if __name__ == "__main__":
    main(*sys.argv[1:])
