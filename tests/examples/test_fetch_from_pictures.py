"""The example that fetches from pictures: where it looks from, what a walk sends there, and both policies at work."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import torch

from hazard_ms.demonstrations.options import RecordOptions
from hazard_ms.demonstrations.recording import RecordJob, attempt
from hazard_ms.evaluation.options import EpisodeOptions
from hazard_ms.robots.fetch import HazardFetch
from tests.worlds.registering import loaded, practising

EXAMPLES = Path(__file__).parents[2] / "examples"
EVERY = 3  # frames
ROOM = "practice/0"


@pytest.fixture(scope="module", autouse=True)
def practice() -> Iterator[Any]:
    with practising() as module:
        yield module


@pytest.fixture(scope="module")
def example() -> Iterator[Any]:
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(EXAMPLES)
        with loaded(EXAMPLES / "fetch_from_pictures.py") as module:
            yield module


@pytest.fixture(scope="module")
def plan(example: Any, practice: Any) -> Any:
    base = SimpleNamespace(specs=[practice.scene(ROOM, walking=True)], agent=SimpleNamespace(build=HazardFetch.build))
    return example.Plan(base)


@pytest.fixture(scope="module")
def looks(example: Any, tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("looks") / "looks.npz"
    example.look(out, each=24, rooms=1)
    return out


def clear(practice: Any, at: np.ndarray) -> float:
    """Distance of a point from the nearest wall or stand of ROOM [m]."""
    gaps = [*at, *(np.array([7.0, 6.0]) - at)]
    for stand in practice.scene(ROOM, walking=True).fixtures:
        middle, half = np.array(stand.position[:2]), stand.scale[0] / 2
        gaps.append(float(np.hypot(*(at - np.clip(at, middle - half, middle + half)))))
    return min(gaps)


def test_it_looks_from_where_the_robot_fits_and_often_at_the_thing(example: Any, practice: Any, plan: Any) -> None:
    chance = np.random.default_rng(0)
    poses = np.array([plan.look(chance) for _ in range(400)])
    assert min(clear(practice, pose[:2]) for pose in poses) > HazardFetch.build.radius
    before = np.array([plan.before(pose) for pose in poses])
    bearing, far = np.abs(np.arctan2(before[:, 1], before[:, 0])), np.hypot(*before.T)
    assert 0.1 < (bearing > example.EDGE).mean() < 0.5  # also where it sees nothing of it
    assert ((bearing < example.FACING) & (far < example.END)).mean() > 0.02  # and where it has arrived
    stands = np.array([one.position[:2] for one in practice.scene(ROOM, walking=True).fixtures])
    empty = stands[np.hypot(*(stands - plan.thing).T) > 0.1]
    gaps = empty - poses[:, None, :2]
    off = np.arctan2(gaps[..., 1], gaps[..., 0]) - poses[:, 2, None]
    beside = (np.hypot(*np.moveaxis(gaps, -1, 0)) < 1.0) & (np.cos(off) > np.cos(0.2)) & (bearing > 0.5)[:, None]
    assert beside.any(1).mean() > 0.05  # also before stands on which nothing is


def test_who_sends_what_a_walk_sends_arrives_before_the_thing(example: Any, practice: Any, plan: Any) -> None:
    """The robot moves by what is sent at each look alone: forward and turn in shares of the most of a frame."""
    chance, build, longest = np.random.default_rng(1), HazardFetch.build, 0
    for _ in range(25):
        pose, looks = plan.look(chance), 0
        while not plan.walk(pose)[0, 2]:  # it has not arrived
            for drive, turn in plan.walk(pose)[: example.LOOKS, :2]:
                for _ in range(EVERY):
                    pose[2] += turn * build.turn_step
                    pose[:2] += drive * build.forward_step * np.array([np.cos(pose[2]), np.sin(pose[2])])
                assert clear(practice, pose[:2]) > build.radius - 0.05
            looks += 1
            assert looks < 100
        longest = max(longest, looks)
        gap = plan.thing - pose[:2]
        assert np.hypot(*gap) <= example.END
        assert np.cos(np.arctan2(gap[1], gap[0]) - pose[2]) > np.cos(example.FACING)
        assert not plan.walk(pose)[:, :2].any()  # it stands from then on
        np.testing.assert_allclose(plan.before(pose), [np.hypot(*gap), 0.0], atol=0.1)
    assert longest > 10


def test_where_the_thing_is_hidden_it_turns_left_in_the_mirror_too(example: Any, plan: Any, tmp_path: Path) -> None:
    chance = np.random.default_rng(2)
    poses = [plan.look(chance) for _ in range(60)]
    chunks = np.stack([np.concatenate([np.ones((10, 11)), plan.walk(pose)], 1) for pose in poses]).astype(np.float32)
    pictures = {view: chance.integers(0, 255, (60, 3, 4, 6), np.uint8) for view in example.VIEWS}
    np.savez(tmp_path / "looks.npz", chunks=chunks, **pictures)
    rows = example.mirrored(tmp_path / "looks.npz")
    hidden = np.array([abs(np.arctan2(*plan.before(pose)[::-1])) > np.deg2rad(60.0) for pose in poses])
    assert 5 < hidden.sum() < 40
    assert (rows.chunks[:60][hidden][..., 11:14] == torch.tensor([0.0, 1.0, 0.0])).all()
    assert (rows.chunks[60:][hidden][..., 11:14] == torch.tensor([0.0, 1.0, 0.0])).all()
    assert (rows.chunks[60:, :, 15] == -rows.chunks[:60, :, 15]).all()
    assert (rows.chunks[60:][~hidden][..., 12] == -rows.chunks[:60][~hidden][..., 12]).all()
    assert (rows.chunks[60:][..., [*range(12), 13, 14]] == rows.chunks[:60][..., [*range(12), 13, 14]]).all()
    assert all((view[60:] == view[:60].flip(-1)).all() and len(view) == 120 for view in rows.pictures)
    assert rows.body.shape == (120, 1) and not rows.body.any()  # it feels nothing


@pytest.mark.render
def test_a_look_shows_the_thing_where_its_walk_has_it(example: Any, looks: Path) -> None:
    file = np.load(looks)
    assert file["far"].shape == (24, 3, 64, 256) and file["chunks"].shape == (24, example.act.CHUNK, 16)
    forward, left = file["chunks"][:, 0, -2:].T
    red, _, blue = file["far"].astype(int).transpose(1, 0, 2, 3)
    thing = (blue - red > 20) & (file["far"].sum(1) < 450)  # its stands are greener, and lighter
    seen = np.flatnonzero((np.abs(np.arctan2(left, forward)) < 0.8) & (np.hypot(forward, left) > 1.0))
    assert len(seen) > 4
    for k in seen:
        off_middle = 1.0 - np.mean(np.nonzero(thing[k])[1]) / 128.0  # to the left, in half widths
        np.testing.assert_allclose(off_middle, left[k] / forward[k] / np.tan(example.EDGE), atol=0.12)
    assert np.ptp(file["chunks"][:, :, :11], axis=(0, 1)).max() == 0.0  # the arm stays where it is


@pytest.mark.render
@pytest.mark.long
def test_beside_a_hazard_time_passes_between_looks(example: Any, looks: Path, tmp_path: Path) -> None:
    example.look(tmp_path / "wet.npz", each=24, rooms=1, hazards=("flood",))
    wet, dry = np.load(tmp_path / "wet.npz"), np.load(looks)
    np.testing.assert_allclose(wet["chunks"][:3], dry["chunks"][:3], atol=1e-2)  # the same walks, at first
    changed = np.abs(wet["near"].astype(int) - dry["near"]).mean((1, 2, 3))
    assert changed[-8:].mean() > 2.0 * changed[0] + 1.0  # the water rises


@pytest.mark.render
@pytest.mark.long
@pytest.mark.timeout(3600)
def test_one_walks_until_it_has_arrived_and_again_where_nothing_is_taken(
    example: Any, looks: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    episode = EpisodeOptions("HazardStow-v1", agent="oracle", seed=11, perturb="control:2")
    options = RecordOptions(
        episode, "oracle", verify=False, obs="rgb", cameras="head+wrist", every=EVERY, output=tmp_path
    )
    options.dataset.mkdir(parents=True)
    assert not attempt(RecordJob(episode, 60.0, record=options), lambda word: None).error
    monkeypatch.setattr(example.act, "BATCH", 8)
    example.walk([looks], out=tmp_path / "walk", minutes=0.02)
    example.act.train([options.dataset], out=tmp_path / "take", minutes=0.02)
    who = example.Fetching(tmp_path / "walk", tmp_path / "take")
    arrived, done = np.zeros(example.act.CHUNK), []

    def foreseen(seen: dict[str, Any]) -> np.ndarray:
        done.append("walk")
        numbers = np.zeros((example.act.CHUNK, 16))
        numbers[:, example.ARRIVED] = arrived
        return numbers

    monkeypatch.setattr(who.walker, "act", foreseen)
    monkeypatch.setattr(who.taker, "act", lambda seen: (done.append("take"), np.ones((example.act.CHUNK, 13)))[1])
    empty, full = {"agent_pos": np.zeros(8)}, {"agent_pos": np.ones(8)}
    assert who.coming(empty, 0).shape == (example.LOOKS, 13)
    arrived[1:] = 1.0
    assert who.coming(empty, 2).shape == (1, 13)  # it arrives a tenth of a second later
    arrived[:] = 1.0
    assert who.coming(empty, 3).shape == (example.act.CARRIED, 13)
    assert done == ["walk", "walk", "walk", "take"]
    who.coming(empty, 3 + example.TAKES - 1)
    who.coming(full, 3 + example.TAKES)
    away = who.coming(empty, 3 + example.TAKES + 4)  # it let go: it backs off, though it has arrived
    assert done[4:] == ["take", "take", "walk"] and away[:, 11:].tolist() == [[-1.0, 0.0]] * example.LOOKS
    who.coming(empty, 3 + example.TAKES + 4 + example.BACK)
    assert done[7:] == ["walk", "take"]
    arrived[:] = 0.0
    assert not who.coming(empty, 0)[:, 11:].any()  # of the next episode
    monkeypatch.undo()
    won = example.play(tmp_path / "walk", tmp_path / "take", episodes=1, seed=11, split="train")
    assert won in ([False], [True]) and "of 1 succeeded" in capsys.readouterr().out
