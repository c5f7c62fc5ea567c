"""Whole episodes with effects.

Labels and what happens stay as without, pixels are those of any process, and nothing is left behind.
"""

from __future__ import annotations

import itertools
import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from hazard_ms.simulation.drawing.lighting import LIGHTINGS
from tests.worlds.watching import TASKS, start, told

pytestmark = [pytest.mark.long, pytest.mark.render, pytest.mark.timeout(3600)]

EVERY, LOOKS = 5, 200  # frames between two looks at an episode, and number of looks
LIGHTS = {"full": ("day", "night", "failing"), "fast": ("day", "failing")}  # in which labels are looked at, by effects
# of the soak, per task; before memory must be flat; at each end of the rest, for the mean
RESETS, WARM, PART = 170, 70, 40
# of resident memory from one end of the rest to the other, at most [MiB]: records kept of each episode alone take 25,
# and the allocator takes one step of 5 now and then
GROWTH = 12.5
EFFECTS = ("full", "fast", "off")


@pytest.mark.parametrize("effects", LIGHTS)
@pytest.mark.parametrize("env_id", TASKS)
def test_labels_of_an_episode_are_those_without_effects(env_id: str, effects: str) -> None:
    """Segmentation, depth, positions and normals, pixel for pixel: by head and in third person, in several lights."""
    plain, lights = f"{env_id}/off/day", [f"{env_id}/{effects}/{light}" for light in LIGHTS[effects]]
    found = {run: result["pictures"] for run, result in told(start(EVERY * LOOKS, EVERY, [plain, *lights])).items()}
    labels = [name for name in found[lights[0]][0] if not name.endswith("/rgb")]
    # the fast pack knows no normals
    assert len(labels) == 2 * (4 if effects == "full" else 3) and len(found[plain]) == LOOKS
    for run, number in itertools.product(lights, range(LOOKS)):
        assert {n: found[run][number][n] for n in labels} == {n: found[plain][number][n] for n in labels}, (
            run,
            number * EVERY,
        )
    colours = [name for name in found[plain][0] if name.endswith("/rgb")]
    changed = [any(a[n] != b[n] for n in colours) for a, b in zip(found[plain], found[lights[0]], strict=True)]
    assert np.mean(changed) > 0.9
    assert len({json.dumps(p) for p in found[plain]}) > LOOKS / 2, "nothing moved, so the test shows little"


@pytest.mark.parametrize("env_id", TASKS)
def test_no_look_and_no_light_changes_an_episode(env_id: str) -> None:
    """The hash of all state after 120 frames, with pictures in between, for all looks and lights."""
    runs = [f"{env_id}/{effects}/{light}" for effects, light in itertools.product(EFFECTS, LIGHTINGS)]
    looked_at = told(start(120, 20, runs))
    never = told(start(120, 1000, runs[:1]))  # but at its start
    assert {result["state"] for result in looked_at.values()} == {never[runs[0]]["state"]}
    assert len(looked_at) == 15


def test_three_processes_draw_the_same_pixels() -> None:
    """All pictures of all tasks, in processes with different hash seeds and in a different order of tasks."""
    runs = [f"{env_id}/{rest}" for env_id in TASKS for rest in ("full/day", "fast/failing")]
    first, second, third = (
        told(start(60, 10, order, seed)) for seed, order in ((0, runs), (1, runs[::-1]), (4242, runs[2:] + runs[:2]))
    )
    assert first == second == third
    assert len({json.dumps(result["pictures"]) for result in first.values()}) == len(runs)


@pytest.mark.parametrize("env_id", TASKS)
def test_500_resets_of_three_tasks_leave_nothing_behind(env_id: str) -> None:
    """Memory is flat, and each episode has exactly the entities, materials and lights of a new environment."""
    left = resets(env_id, "full", RESETS)
    rest = np.array(left["memory"][WARM:])
    assert rest[-PART:].mean() - rest[:PART].mean() < GROWTH, rest
    every = len(left["fresh"])
    for number, count in enumerate(left["counts"]):
        assert count == left["fresh"][number % every], number
    assert {c["effects"] > 0 for c in left["counts"]} == {True}
    for living in left["objects"]:
        assert living["Looks"] == 1 and living["Effect"] == left["fresh"][living["seed"]]["effects"], living


def resets(env_id: str, effects: str, count: int) -> dict[str, Any]:
    """What `tests.effects.resetting` tells of `count` episodes, from a process of its own."""
    command = [sys.executable, "-m", "tests.effects.resetting", env_id, effects, str(count)]
    done = subprocess.run(
        command, cwd=Path(__file__).parents[2], stdout=subprocess.PIPE, text=True, timeout=3500, check=True
    )
    return json.loads(done.stdout.strip().splitlines()[-1])
