"""Counter-based random numbers: an independent computation, statistics, and independence of everything but the key."""

from __future__ import annotations

import math
import zlib

import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st

from hazard_ms.simulation.chance import Chance

SAMPLES = 200_000


def chance(seeds: list[int], frame: int = 0) -> Chance:
    made = Chance(len(seeds))
    made.restart(torch.arange(len(seeds)), torch.tensor(seeds))
    made.frame[:] = frame
    return made


def lowbias32(x: int) -> int:
    """C. Wellons' hash-prospector, in plain integers."""
    x ^= x >> 16
    x = x * 0x7FEB352D % 2**32
    x ^= x >> 15
    x = x * 0x846CA68B % 2**32
    return x ^ (x >> 16)


def test_the_mixer_is_lowbias32() -> None:
    """Values of the published C function at 0, 1 and 2^32 - 1, and a draw computed in plain integers."""
    key = lowbias32((123456789 % 2**32) ^ zlib.crc32(b"fire.spread"))
    key = lowbias32(lowbias32(key ^ (123456789 >> 32)) ^ 42)
    expected = [((lowbias32(key ^ lowbias32(i + 1)) >> 9) + 0.5) / 2**23 for i in range(6)]
    assert chance([123456789], 42).uniform("fire.spread", 2, 3).flatten().tolist() == expected


@settings(max_examples=60, deadline=None)
@given(seed=st.integers(0, 2**62), frame=st.integers(0, 10**6), name=st.text(min_size=1, max_size=8))
def test_any_draw_matches_plain_integers(seed: int, frame: int, name: str) -> None:
    key = lowbias32((seed % 2**32) ^ zlib.crc32(name.encode()))
    key = lowbias32(lowbias32(key ^ (seed >> 32)) ^ frame)
    expected = [((lowbias32(key ^ lowbias32(i + 1)) >> 9) + 0.5) / 2**23 for i in range(4)]
    assert chance([seed], frame).uniform(name, 4)[0].tolist() == expected


@settings(max_examples=30, deadline=None)
@given(seeds=st.lists(st.integers(0, 2**32 - 1), min_size=1, max_size=8), frame=st.integers(0, 3000))
def test_a_draw_does_not_depend_on_the_neighbours(seeds: list[int], frame: int) -> None:
    together = chance(seeds, frame).uniform("gust", 5)
    for e, seed in enumerate(seeds):
        assert torch.equal(together[e], chance([seed], frame).uniform("gust", 5)[0])


def test_a_larger_draw_begins_like_a_smaller_one() -> None:
    """So padding a batch to more lattices or things changes nothing."""
    few, more = chance([5]).uniform("x", 3, 2), chance([5]).uniform("x", 9, 2)
    assert torch.equal(few, more[:, :3])


def test_restart_sets_only_its_rows() -> None:
    made = chance([1, 2, 3], frame=9)
    made.restart(torch.tensor([1]), torch.tensor([77]))
    assert made.seed.tolist() == [1, 77, 3] and made.frame.tolist() == [9, 0, 9]
    made.tick()
    assert made.frame.tolist() == [10, 1, 10]


def test_uniform_stays_inside_the_open_interval() -> None:
    """The largest word must not round to 1 in float32: 23 bits and a half fit."""
    assert torch.tensor((2**32 - 1) >> 9).float().add(0.5).div(2.0**23).item() < 1.0
    draws = chance(list(range(20))).uniform("x", SAMPLES)
    assert 0.0 < draws.min().item() and draws.max().item() < 1.0


@pytest.mark.parametrize("axis", ["index", "frame", "seed", "stream"])
def test_uniform_is_uniform_along_every_part_of_the_key(axis: str) -> None:
    """Chi-square over 100 bins, and no correlation of neighbours, within 5 standard deviations."""
    if axis == "index":
        draws = chance([11]).uniform("x", SAMPLES)[0]
    elif axis == "frame":
        source = Chance(SAMPLES)
        source.frame[:] = torch.arange(SAMPLES)
        draws = source.uniform("x", 1)[:, 0]
    elif axis == "seed":
        draws = chance(list(range(SAMPLES))).uniform("x", 1)[:, 0]
    else:
        draws = torch.cat([chance([3]).uniform(f"stream {k}", 1)[0] for k in range(4000)])
    n = len(draws)
    observed = torch.histc(draws, 100, 0.0, 1.0).double()
    chi2 = ((observed - n / 100) ** 2 / (n / 100)).sum().item()
    assert abs(chi2 - 99) < 5 * math.sqrt(2 * 99)
    centred = draws.double() - 0.5
    assert abs((centred[1:] * centred[:-1]).mean().item()) < 5 / 12 / math.sqrt(n)
    assert abs(centred.mean().item()) < 5 * math.sqrt(1 / 12 / n)


def test_streams_frames_and_seeds_are_uncorrelated() -> None:
    base = chance([1], 1).uniform("a", SAMPLES)[0].double() - 0.5
    for other in (
        chance([1], 1).uniform("b", SAMPLES),
        chance([1], 2).uniform("a", SAMPLES),
        chance([2], 1).uniform("a", SAMPLES),
    ):
        assert abs((base * (other[0].double() - 0.5)).mean().item()) < 5 / 12 / math.sqrt(SAMPLES)


def test_normal_moments() -> None:
    draws = chance([4]).normal("x", SAMPLES)[0].double()
    assert torch.isfinite(draws).all()
    assert abs(draws.mean().item()) < 5 / math.sqrt(SAMPLES)
    assert draws.var().item() == pytest.approx(1.0, abs=5 * math.sqrt(2 / SAMPLES))
    assert (draws**3).mean().item() == pytest.approx(0.0, abs=5 * math.sqrt(15 / SAMPLES))
    assert (draws**4).mean().item() == pytest.approx(3.0, abs=5 * math.sqrt(96 / SAMPLES))
    assert (draws.abs() > 1.96).double().mean().item() == pytest.approx(0.05, abs=5 * math.sqrt(0.0475 / SAMPLES))


@pytest.mark.parametrize("device", ["cpu", "meta", pytest.param("cuda", marks=pytest.mark.gpu)])
def test_what_is_due_is_known_without_a_device(device: str) -> None:
    """A meta tensor holds no numbers: whoever asked it would fail, as whoever asks a GPU waits."""
    made, counts = Chance(3, device), [0, 0, 0]
    for frame in range(60):
        if frame == 7:
            made.restart(torch.tensor([1]), torch.tensor([5]))
            counts[1] = 0
        if frame == 31:
            made.restart(torch.tensor([0, 2]), torch.tensor([6, 7]), torch.tensor([12, 4]))
            counts[0], counts[2] = 12, 4
        for every in (1, 5, 10):
            due = made.due(every)
            assert (due is not None) == any(count % every == 0 for count in counts), (frame, every)
            if due is not None and device != "meta":
                assert due.tolist() == [count % every == 0 for count in counts] and due.device.type == device
        made.tick()
        counts = [count + 1 for count in counts]
