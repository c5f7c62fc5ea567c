"""The hazards of a batch on a GPU, without a simulator: as on the CPU, and as alone."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import torch
from torch.utils._python_dispatch import TorchDispatchMode

from hazard_ms.hazards.fire import coupling, fire
from hazard_ms.hazards.fire.realistic import blaze, front
from hazard_ms.hazards.presets import PRESETS
from hazard_ms.sketch.recording import record
from hazard_ms.tasks import task_of
from results.gpu.__main__ import TASKS
from results.gpu.laws import DEVICES, course, laws, rate
from results.gpu.rates import Rate
from results.gpu.resting import SPLIT, Batch

CHECKED = (0, 1, 30)
ROUNDING = 1e-6  # of what is below one, in its own unit
ON_GPU = pytest.param("gpu", marks=pytest.mark.gpu)


@pytest.mark.parametrize("simulator", ["cpu", ON_GPU])
@pytest.mark.parametrize("physics", PRESETS)
@pytest.mark.parametrize("env_id", TASKS)
def test_an_environment_of_a_batch_is_as_alone(env_id: str, physics: str, simulator: str) -> None:
    """But for rounding: in a batch things are padded to the scene that has most, and longer sums round differently."""
    several, alone = (course(env_id, count, simulator, physics, CHECKED) for count in (3, 1))
    few, many = (made["30/forces [N]"].shape[1] for made in (alone, several))  # things of a scene, padded in a batch
    compared = set()
    for name, numbers in alone.items():
        found = several[name][:1]
        if numbers.ndim > 1 and (numbers.shape[1], found.shape[1]) == (few, many):
            found = found[:, :few]
        if found.shape == numbers.shape:
            if numbers.dtype.kind == "f":
                np.testing.assert_allclose(found, numbers, rtol=1e-5, atol=ROUNDING, err_msg=name)
            else:
                np.testing.assert_array_equal(found, numbers, err_msg=name)
            compared.add(name.split("/")[1])
    assert {"forces [N]", "torques [N m]", "damage: damaged"} < compared and len(compared) >= 15, compared


@pytest.mark.gpu
@pytest.mark.parametrize("physics", PRESETS)
@pytest.mark.parametrize("env_id", TASKS)
def test_a_gpu_agrees_with_the_cpu(env_id: str, physics: str) -> None:
    """But for rounding, of which the remainders of compensated sums consist."""
    gpu, cpu = (course(env_id, 8, simulator, physics, CHECKED) for simulator in ("gpu", "cpu"))
    assert set(gpu) == set(cpu)
    for name, numbers in cpu.items():
        if numbers.dtype.kind == "f":
            scale = float(np.abs(numbers[np.isfinite(numbers)]).max(initial=0.0))
            np.testing.assert_allclose(gpu[name], numbers, rtol=1e-3, atol=max(1e-4 * scale, ROUNDING), err_msg=name)
        else:
            assert (gpu[name] != numbers).sum() <= 1e-3 * numbers.size, name


def test_a_fire_of_a_batch_is_the_fire_of_a_recorded_timeline() -> None:
    """A recording of the same scene and seed, in which nobody acts, has the same flames and temperatures."""
    task = task_of("HazardFire-v1", "paper")
    spec, frames = task.build(tuple(task.scenes(SPLIT))[1]), 90
    (line,) = record(task, "paper", (spec,), (1,), frames)
    batch = Batch("HazardFire-v1", 2, "cpu", "paper")
    for _ in range(frames):
        batch.step()
    things = len(spec.things)
    levels = batch.episode.levels(batch.episode.world.position)[1, :, :things].numpy()
    np.testing.assert_allclose(levels, line.levels[-1].astype(np.float32), rtol=1e-3)
    assert levels.max() > 25.0


def test_things_rest_while_they_are_pushed() -> None:
    batch = Batch("HazardWind-v1", 2, "cpu", "paper")
    before = batch.episode.world.position.clone()
    for _ in range(30):
        batch.step()
    assert (batch.episode.world.position == before).all()
    assert batch.handles.force.abs().max() > 0.0


def test_a_measurement_has_rates_differences_and_waits(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("results.gpu.laws.COMPARED", 2)
    found = laws("HazardFire-v1", "paper", (1, 2), "cpu")
    assert [made["num_envs"] for made in found["rates"]] == [1, 2]
    assert list(found["differences"]) == ["cpu and cpu", "cpu twice"] and found["waits"] == {}
    assert all("quantities." in text for text in found["differences"].values())
    assert found["too_many"] is None and rate("HazardFire-v1", 2, "cpu", "paper", frames=2).step > 0.0

    def full(env_id: str, size: int, *more: Any, **named: Any) -> Rate:
        if size == 4:
            raise torch.OutOfMemoryError
        return Rate(size, 0.1, 1.0, None)

    monkeypatch.setattr("results.gpu.laws.rate", full)
    found = laws("HazardFire-v1", "paper", (1, 4, 16), "cpu")
    assert [made["num_envs"] for made in found["rates"]] == [1] and found["too_many"] == 4
    assert set(DEVICES) == {"cpu", "gpu"}


class Operations(TorchDispatchMode):
    """Counts the operations of torch."""

    count = 0

    def __torch_dispatch__(self, func: Any, types: Any, args: Any = (), kwargs: Any = None) -> Any:
        self.count += 1
        return func(*args, **(kwargs or {}))


@pytest.mark.parametrize("physics", ["paper", "realistic"])
def test_where_nobody_may_ask_a_device_frames_in_which_nothing_is_due_start_few_operations(
    physics: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As on a GPU, where each operation takes the host's time, whatever it does."""
    for module in (fire, coupling, blaze, front):
        monkeypatch.setattr(module, "none_set", lambda mask: False)
    batch = Batch("HazardFire-v1", 4, "cpu", physics)
    counts = []
    for _ in range(10):
        with Operations() as found:
            batch.step()
        counts.append(found.count)
    warm = [count for frame, count in enumerate(counts, start=1) if frame % 5 == 0]
    idle = [count for frame, count in enumerate(counts, start=1) if frame % 5]
    assert max(idle) < min(warm) / 2, counts
