"""The example of behaviour cloning: labels are what the skill did, and policies learn them and play."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import torch

from hazard_ms.skills.context import LowLevel
from tests.worlds.arena import Arena
from tests.worlds.registering import loaded
from tests.worlds.skill_room import BOXES

EXAMPLE = Path(__file__).parents[2] / "examples" / "clone_pick_up.py"
BY_THE_BOWL = (0.8, -0.5, -np.pi / 2)  # x, y [m] and heading [rad]
BOWL = np.array([0.6, 0.2, 0.04])  # where it lies before the robot [m]


@pytest.fixture(scope="module")
def example() -> Iterator[Any]:
    with loaded(EXAMPLE) as module:
        yield module


@pytest.fixture(scope="module")
def arena() -> Iterator[Arena]:
    made = Arena(BOXES)
    yield made
    made.close()


def demonstrated(example: Any, arena: Arena) -> tuple[np.ndarray, list[LowLevel]]:
    """Labels, [T, 10], of a pick-up of the bowl, and all actions that were sent."""
    arena.restart(*BY_THE_BOWL)
    frames: list[list[Any]] = [[], []]
    sent: list[LowLevel] = []
    step = arena.step
    arena.step = lambda action: (sent.append(action), step(action))  # type: ignore[method-assign,assign]
    try:
        index = arena.index("bowl")
        doing = example.pick_up(arena.stage, index)
        assert arena.run(example.disturbed(arena.stage, index, np.random.default_rng(1), frames, doing)).ok
    finally:
        del arena.step
    return np.array([label for _, label in frames[0]]), sent


def test_whoever_does_what_the_labels_say_picks_the_thing_up(
    example: Any, arena: Arena, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(example, "NOISE", 0.0)
    labels, _ = demonstrated(example, arena)
    outputs = iter(labels)
    arena.restart(*BY_THE_BOWL)
    result = arena.run(example.played(lambda now: next(outputs))(arena.stage, arena.index("bowl")))
    assert result.ok and result.frames == len(labels)


def test_what_is_sent_is_disturbed_and_labels_lead_back_to_what_the_skill_wants(example: Any, arena: Arena) -> None:
    """The skill moves no joint faster than the robot allows: labels that held the noise would."""
    labels, sent = demonstrated(example, arena)
    step = arena.agent.build.arm_step
    actions = np.array(sent[: len(labels)])[:, example.ARM]
    wanted = actions[:-1] + labels[1:, :7] * step
    assert np.abs(np.diff(wanted, axis=0)).max() < step + 1e-4
    assert np.abs(np.diff(actions, axis=0)).max() > 1.2 * step
    assert 0.3 * example.NOISE < (actions[1:] - wanted).std() < 1.7 * example.NOISE


def test_what_a_policy_reads_does_not_depend_on_where_in_the_room_it_is(example: Any, arena: Arena) -> None:
    """But for the room ahead, which is another one there."""
    read = []
    for x, y, heading in ((-2.0, 2.0, 0.0), (-1.0, -3.0, np.pi / 2)):
        arena.restart(x, y, heading)
        index = arena.index("bowl")
        where = np.array([x, y, 0.0]) + example.turned(heading) @ BOWL
        arena.world.position[0, index] = torch.from_numpy(where)
        read.append(example.PickUp(arena.stage, index).seen())
    assert len(read[0]) == 38
    np.testing.assert_allclose(read[0][:-4], read[1][:-4], atol=1e-3)
    np.testing.assert_allclose(read[0][17:20], BOWL, atol=1e-3)


def test_a_policy_reads_how_far_the_base_has_moved(example: Any, arena: Arena) -> None:
    arena.restart(-2.0, 2.0, 1.0)
    now = example.PickUp(arena.stage, arena.index("bowl"))
    x, y, _ = np.array([-2.0, 2.0, 0.0]) + example.turned(1.0) @ (0.3, -0.1, 0.0)
    arena.agent.place(torch.tensor([0]), torch.tensor([[x, y]]), torch.tensor([1.5]))
    np.testing.assert_allclose(now.seen()[26:29], [0.3, -0.1, 0.5], atol=1e-3)


@pytest.mark.long
def test_training_learns_what_can_be_learnt_and_repeats_itself(example: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(example, "EPOCHS", 8)
    chance = np.random.default_rng(0)
    seen = chance.normal(size=(2000, 38)).astype(np.float32)
    labels = np.tanh(seen @ chance.normal(size=(38, 10)) / 6.0).astype(np.float32)
    first, second, other = (example.train(list(zip(seen, labels, strict=True)), seed) for seed in (0, 0, 1))
    wanted = torch.from_numpy(labels)
    with torch.no_grad():
        error = float(example.loss(first(torch.from_numpy(seen)), wanted))
    assert error < 0.7 * float(example.loss(torch.zeros_like(wanted), wanted))
    for a, b, c in zip(first.parameters(), second.parameters(), other.parameters(), strict=True):
        assert torch.equal(a, b) and not torch.equal(a, c)


@pytest.mark.render
@pytest.mark.long
def test_a_policy_is_trained_and_scored(example: Any, capsys: pytest.CaptureFixture[str]) -> None:
    example.main(["--demonstrations", "6", "--scenes", "2", "--seeds", "1"])
    said = capsys.readouterr().out
    assert re.search(r"^6 demonstrations from \d+ pick-ups in train", said, re.M)
    able = int(re.search(r"the skill does (\d+) of \d+ pick-ups in 2 scenes of test", said)[1])  # type: ignore[index]
    assert able > 0 and re.search(r"clone, seed 0 +\d+ +\d+\.\d%", said)
    assert re.search(r"random +\d+ +\d+\.\d%", said)
