"""The table of `hazard-ms danger`: which targets count as moved or damaged, and what its rows say."""

from __future__ import annotations

import numpy as np
import pytest

from hazard_ms.sketch.rescues import danger
from hazard_ms.sketch.timeline import Timeline
from hazard_ms.spec import SceneSpec, Task
from tests.worlds.wind_worlds import Thing, street

SPEC = street([Thing(), Thing(), Thing(category="bottle"), Thing()]).specs[0]  # boxes are its targets


def line() -> Timeline:
    """40 frames, a sample every 10: box 0 goes 0.2 m and, by frame 30, 0.3 m; box 1 is damaged in frame 20, box 3 in
    frame 21; the bottle flies off.
    """
    names = tuple(body.name for body in SPEC.bodies)
    offsets = np.zeros((5, 2, 3), np.float16)
    offsets[1:3, 0, 0], offsets[3:, 0, 1], offsets[:, 1, 2] = 0.2, -0.3, 9.0
    never = np.full(4, -1, np.int32)
    flames = np.zeros(0, np.int32), np.zeros((0, 2), np.float32)
    start, levels = np.ones((4, 3), np.float32), np.zeros((5, 1, 4), np.float16)
    moves, damaged = np.array([0, 2], np.int16), np.array([-1, 20, 5, 21], np.int32)
    return Timeline(SPEC.name, "", "", "", 0, 0, 10, names, start, moves, offsets, levels, damaged, never, *flames)


def test_targets_count_as_moved_beyond_a_quarter_metre_and_as_damaged_from_their_frame_on() -> None:
    moved, damaged = danger.fates(line(), SPEC, (10, 20, 30, 40))
    assert moved.tolist() == [[False] * 3, [False] * 3, [True, False, False], [True, False, False]]
    assert damaged.tolist() == [[False] * 3, [False, True, False], [False, True, True], [False, True, True]]


def test_a_row_is_over_evenly_spread_scenes_and_names_what_it_is_of(monkeypatch: pytest.MonkeyPatch) -> None:
    built: list[str] = []
    seeds: list[int] = []
    names = tuple("abcdefg")

    def build(scene: str) -> SceneSpec:
        built.append(scene)
        return SPEC

    def recorded(task: Task, physics: str, spec: SceneSpec, seed: int) -> Timeline:
        seeds.append(seed)
        return line()

    def task(name: str, physics: str, hazards: None, severity: str) -> Task:
        assert (name, physics, hazards, severity) == ("HazardWind-v1", "realistic", None, "extreme")
        return Task(
            scenes=lambda split: names if split == "train" else (),
            build=build,
            hazards=(),
            goal=None,  # type: ignore[arg-type]
            safe_place=None,  # type: ignore[arg-type]
            observations=(),
            max_frames=40,
        )

    monkeypatch.setattr(danger, "task_of", task)
    monkeypatch.setattr(danger, "recorded", recorded)
    row = danger.row("HazardWind-v1", "realistic", "extreme", 3)
    assert built == ["a", "c", "e"] and seeds == [0, 1, 2]
    third = 1 / 3
    assert row.moved == pytest.approx((0, 0, third, third)) and row.damaged == pytest.approx((0, third, 2 / 3, 2 / 3))
    assert row.lost == pytest.approx((0, third, 1, 1)) and row.targets == 9
    assert "| extreme | 9 |   0    0   33   33 |   0   33   67   67 |   0   33  100  100 |" in row.line


def test_unknown_tasks_and_too_many_scenes_are_refused() -> None:
    with pytest.raises(
        ValueError, match="env_id must be one of HazardFire-v1, HazardFlood-v1, HazardWind-v1, HazardCompound-v1"
    ):
        next(danger.rows(["HazardWalkTo-v1"], 1))
    with pytest.raises(ValueError, match="scenes must be a whole number from 1 to"):
        danger.row("HazardWind-v1", "paper", "severe", 0)
    with pytest.raises(ValueError, match="split of outdoor scenes must be one of train, test, hard"):
        danger.row("HazardWind-v1", "paper", "severe", 1, "large")


def test_rows_are_of_the_asked_split_presets_severities_and_seeds(monkeypatch: pytest.MonkeyPatch) -> None:
    seen: list[tuple[str, str, str, str]] = []

    def recorded(task: Task, physics: str, spec: SceneSpec, seed: int) -> Timeline:
        seen.append((task.name, physics, spec.name, str(seed)))
        return line()

    monkeypatch.setattr(danger, "recorded", recorded)
    monkeypatch.setattr(danger, "fates", lambda *_: np.zeros((2, 4, 3), bool))
    found = list(danger.rows(["HazardCompound-v1"], 2, "hard", ("paper", "realistic"), ("severe", "extreme"), 7))
    assert [(row.physics, row.severity) for row in found] == [
        ("paper", ""),
        ("realistic", "severe"),
        ("realistic", "extreme"),
    ]
    scenes = [("kitchen_b_hard/00", "7"), ("kitchen_b_hard/12", "8")]
    assert seen == [("HazardCompound-v1", row.physics, *of) for row in found for of in scenes]
    assert next(iter(danger.report(["HazardCompound-v1"], 2, "hard", ("paper",)))).startswith("2 scenes of `hard`")
