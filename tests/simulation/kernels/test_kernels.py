"""How kernels are started, and that their random numbers are those of hazard_ms.simulation.chance."""

from __future__ import annotations

import copy
import gc
import os
import shlex
import subprocess
import sys
import types
from pathlib import Path

import pytest
import torch
import warp as wp

from hazard_ms.hazards.presets import flood
from hazard_ms.simulation.chance import Chance
from hazard_ms.simulation.kernels import draws
from hazard_ms.simulation.kernels.launch import OPTIONS, Launches, of_environments
from tests.worlds.flood_worlds import Thing, begin, frames, room

wp.set_module_options(OPTIONS)


@wp.kernel
def scale(factor: float, given: wp.array2d(dtype=float), made: wp.array2d(dtype=float)):  # type: ignore[no-untyped-def, valid-type]
    e, b = wp.tid()
    made[e, b] = factor * given[e, b]


@wp.struct
class Scaled:
    factor: float
    given: wp.array(dtype=float)  # type: ignore[valid-type]


@wp.kernel
def scale_struct(scaled: Scaled, made: wp.array(dtype=float)):  # type: ignore[no-untyped-def, valid-type]
    b = wp.tid()
    made[b] = scaled.factor * scaled.given[b]


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
    for other in (torch.rand(2, 3), torch.rand(2, 3), torch.rand(3, 2).T, torch.rand(2, 6)[:, ::2]):
        launches.run(scale, (2, 3), 3.0, other, made)  # of the same shape, side by side or not
        assert torch.equal(made, 3 * other)


def test_a_struct_is_filled_anew_only_when_its_source_has_other_tensors_or_numbers() -> None:
    launches, made = Launches(), torch.zeros(2)
    source = types.SimpleNamespace(factor=2.0, given=torch.tensor([1.0, 2.0]), unused="x")
    first = launches.struct(Scaled, source)
    launches.run(scale_struct, (2,), first, made)
    assert made.tolist() == [2.0, 4.0]
    source.given += 1.0
    assert launches.struct(Scaled, source) is first  # the same memory
    launches.run(scale_struct, (2,), first, made)
    assert made.tolist() == [4.0, 6.0]
    for name, value, want in (("factor", 3.0, [6.0, 9.0]), ("given", torch.tensor([5.0, 7.0]), [15.0, 21.0])):
        setattr(source, name, value)
        again = launches.struct(Scaled, source)
        assert again is not first
        launches.run(scale_struct, (2,), again, made)
        assert made.tolist() == want


def test_a_struct_keeps_its_tensors_alive() -> None:
    launches, made = Launches(), torch.zeros(2)
    filled = launches.struct(Scaled, types.SimpleNamespace(factor=1.0, given=torch.tensor([5.0, 7.0])))
    gc.collect()
    noise = [torch.full((2,), -1.0) for _ in range(100)]  # would take the place of what is freed
    launches.run(scale_struct, (2,), filled, made)
    assert made.tolist() == [5.0, 7.0] and len(noise) == 100


def test_a_struct_is_pointed_at_other_tensors_before_and_after_its_first_launch() -> None:
    launches, made = Launches(), torch.zeros(2)
    source = types.SimpleNamespace(factor=2.0, given=torch.tensor([1.0, 2.0]))
    launches.struct(Scaled, source)
    for numbers in ([3.0, 4.0], [5.0, 6.0], [7.0, 8.0, 9.0], [1.0, 1.0]):
        source.given = torch.tensor(numbers)
        gc.collect()
        noise = [torch.full((2,), -1.0) for _ in range(100)]  # would take the place of what is freed
        launches.run(scale_struct, (2,), launches.struct(Scaled, source), made)
        assert made.tolist() == [2.0 * n for n in numbers[:2]] and len(noise) == 100


def test_a_launch_without_any_array_is_refused() -> None:
    with pytest.raises(ValueError, match="arguments must hold at least one tensor, got none"):
        Launches().run(scale, (1, 1), 2.0)


def test_nothing_to_do_is_no_launch() -> None:
    launches, made = Launches(), torch.zeros(2, 3)
    launches.run(scale, (2, 0), 2.0, torch.rand(2, 0), torch.zeros(2, 0))
    launches.run(scale, (2, 3), 2.0, torch.ones(2, 3), made)
    assert (made == 2).all()


def test_results_are_kept_per_kernel_and_size() -> None:
    launches, like = Launches(), torch.rand(2, 3)
    (first,), (second,) = launches.results(scale, like), launches.results(scale, like)
    assert first is second and first.shape == like.shape and launches.results(numbers, like)[0] is not first
    assert launches.results(scale, torch.rand(4, 5))[0].shape == (4, 5)
    assert launches.results(scale, torch.rand(4, 5) > 0.5)[0].dtype == torch.bool


def test_a_world_that_was_used_can_be_copied() -> None:
    law, world = flood("paper"), room([Thing((0.2, 0.2, 0.2))])
    state = begin(law, world)
    frames(law, state, world, 3)
    other = copy.deepcopy(world)
    other.position += 1.0
    frames(law, begin(law, other), other, 3)
    assert not torch.equal(other.position, world.position) and len(world.launches._made) > 0


@pytest.mark.parametrize("shape", [(3, 4, 3), (2, 3), (2, 4, 2)])
def test_points_of_other_environments_are_refused(shape: tuple[int, ...]) -> None:
    with pytest.raises(ValueError, match=r"points must have the shape \[2, P, 3\] or \[1, P, 3\], got \["):
        of_environments(torch.zeros(shape), 2)
    shared = of_environments(torch.rand(1, 4, 3), 2)
    assert shared.shape == (2, 4, 3) and torch.equal(shared[0], shared[1])


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
    made = subprocess.run(
        [sys.executable, "-c", "import hazard_ms.simulation.kernels.launch"],
        capture_output=True,
        text=True,
        timeout=120,
        check=True,
    )
    assert made.stdout == "" and "arp" not in made.stderr


def test_kernels_are_kept_where_hazard_ms_keeps_everything(tmp_path: Path) -> None:
    """And a process goes on where nothing can be kept, and without a standard error."""
    code = "import hazard_ms.simulation.kernels.launch, warp; print(warp.config.kernel_cache_dir)"
    for home, inside in ((tmp_path, True), (Path("/proc/nowhere"), False)):
        environ = {k: v for k, v in os.environ.items() if k != "WARP_CACHE_PATH"} | {"HAZARD_MS_HOME": str(home)}
        command = f"exec {shlex.quote(sys.executable)} -c {shlex.quote(code)} 2>&-"
        made = subprocess.run(
            ["/bin/sh", "-c", command], stdout=subprocess.PIPE, text=True, timeout=120, check=True, env=environ
        )
        assert made.stdout.startswith(str(tmp_path / "kernels")) == inside and made.stdout.strip()


@pytest.mark.gpu
@pytest.mark.skipif(not torch.cuda.is_available(), reason="needs an NVIDIA GPU")
@pytest.mark.parametrize("side", [False, True])
def test_kernels_on_a_gpu_agree_and_keep_their_place(side: bool) -> None:
    """In torch's own stream and in another one: what was written before is read, what comes after sees the results."""
    stream = torch.cuda.Stream() if side else torch.cuda.current_stream()
    launches = Launches()
    with torch.cuda.stream(stream):
        given, made = torch.zeros(512, 4096, device="cuda"), torch.zeros(512, 4096, device="cuda")
        for k in range(1, 50):
            given.fill_(float(k))
            launches.run(scale, (512, 4096), 2.0, given, made)
            assert bool((made == 2.0 * k).all())
