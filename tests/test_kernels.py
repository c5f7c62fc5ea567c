"""How kernels are started, and that their random numbers are those of hazard_ms.chance."""

from __future__ import annotations

import subprocess
import sys

import pytest
import torch
import warp as wp

from hazard_ms.chance import Chance
from hazard_ms.kernels import draws
from hazard_ms.launching import OPTIONS, Launches

wp.set_module_options(OPTIONS)


@wp.kernel
def scale(factor: float, given: wp.array2d(dtype=float), made: wp.array2d(dtype=float)):  # type: ignore[no-untyped-def, valid-type]
    e, b = wp.tid()
    made[e, b] = factor * given[e, b]


@wp.kernel
def numbers(  # type: ignore[no-untyped-def]
    stream: wp.uint32,
    seed: wp.array(dtype=wp.int64),  # type: ignore[valid-type]
    frame: wp.array(dtype=wp.int64),  # type: ignore[valid-type]
    made: wp.array2d(dtype=float),  # type: ignore[valid-type]
):
    e, k = wp.tid()
    made[e, k] = draws.uniform(draws.key_of(seed[e], frame[e], stream), k)


def test_a_repeated_launch_follows_its_arguments() -> None:
    """Other numbers, other tensors, other sizes, and tensors that were written meanwhile."""
    launches, given = Launches(), torch.rand(2, 3)
    made = torch.zeros(2, 3)
    launches.run(scale, (2, 3), 2.0, given, made)
    assert torch.equal(made, 2 * given)
    given += 1
    launches.run(scale, (2, 3), 2.0, given, made)
    assert torch.equal(made, 2 * given)
    launches.run(scale, (2, 3), 3.0, given, made)
    assert torch.equal(made, 3 * given)
    for shape in ((4, 5), (1, 2), (2, 3)):
        other, there = torch.rand(shape), torch.zeros(shape)
        launches.run(scale, shape, 3.0, other, there)
        assert torch.equal(there, 3 * other)
    assert torch.equal(made, 3 * given)  # what was written before stays


def test_results_are_kept_per_kernel() -> None:
    launches, like = Launches(), torch.rand(2, 3)
    (first,), (second,) = launches.results(scale, like), launches.results(scale, like)
    assert first is second and first.shape == like.shape and launches.results(numbers, like)[0] is not first


@pytest.mark.parametrize("count", [1, 7, 1000])
def test_random_numbers_of_kernels_are_those_of_chance_bit_for_bit(count: int) -> None:
    chance = Chance(4)
    chance.restart(torch.arange(4), torch.tensor([0, 3, 2**40 + 17, 2**62 + 2**31]))
    for frame in (0, 1, 2999):
        chance.frame[:] = frame
        made = torch.zeros(4, count)
        Launches().run(numbers, (4, count), draws.word("a.stream"), chance.seed, chance.frame, made)
        assert torch.equal(made, chance.uniform("a.stream", count))


def test_a_machine_without_a_gpu_is_not_scolded() -> None:
    made = subprocess.run([sys.executable, "-c", "import hazard_ms.launching"], capture_output=True, text=True, timeout=120, check=True)
    assert made.stdout == "" and "arp" not in made.stderr
