"""Students of labels: the loss against its known minimum, and what is learned in a few seconds."""

from __future__ import annotations

from typing import Any

import pytest
import torch

from hazard_ms.learning import cloning
from hazard_ms.learning.cloning import CHOICE_TRIALS, SOFT, Round, Student, loss, scores, train
from hazard_ms.learning.comparison import table
from hazard_ms.learning.labels import Labels
from hazard_ms.sketch.policies import POLICIES
from tests.worlds.sketch_scenes import chancy_times, random_scene

FIRE = [(20.0, 600.0)]


def test_the_loss_is_least_where_options_are_as_likely_as_they_are_worth() -> None:
    """Shares in proportion to exp(worth / SOFT): there the gradient is zero, and any other logits are worse."""
    chance = torch.Generator().manual_seed(0)
    worth = torch.rand(5, 7, generator=chance) * 0.1
    mask = torch.rand(5, 7, generator=chance) < 0.7
    mask[:, 0] = True
    best = (worth / SOFT).masked_fill(~mask, -1e9).requires_grad_()
    least = loss(best, mask, worth)
    least.backward()
    assert best.grad is not None and float(best.grad.abs().max()) < 1e-6
    for _ in range(20):
        other = best.detach() + torch.randn(5, 7, generator=chance) * mask
        assert float(loss(other, mask, worth)) > float(least.detach())


@pytest.mark.long
def test_a_student_learns_in_rounds_and_stays_as_in_its_best() -> None:
    scenes = [random_scene(seed) for seed in range(12)]
    student, told = Student(FIRE, 0), list[Round]()
    before = scores(scenes, chancy_times(), student.play).mean()
    done = train(student, scenes, scenes, chancy_times(), 0, 2, 64, told.append)
    assert done == told and [each.number for each in done] == [0, 1] and done[1].labels > done[0].labels
    best = max(each.student for each in done)
    assert scores(scenes, chancy_times(), student.play, CHOICE_TRIALS).mean() == pytest.approx(best)
    rule = scores(scenes, chancy_times(), POLICIES["rule"]).mean()
    assert best > before + 0.02 and best > rule, (before, rule, best)
    text, usual = table(scenes, chancy_times(), {"mine": student.play}), scores(scenes, chancy_times(), student.play)
    assert f"{usual.mean():.3f}" in next(line for line in text.splitlines() if line.endswith("mine"))


def test_the_student_goes_on_after_its_options_from_the_third_round_on(monkeypatch: pytest.MonkeyPatch) -> None:
    judges, collect = [], cloning.collect

    def watched(*given: Any) -> Labels:
        judges.append(given[3])
        return collect(*given)

    monkeypatch.setattr(cloning, "collect", watched)
    student, scenes = Student(FIRE, 0), [random_scene(seed) for seed in range(2)]
    train(student, scenes, scenes, chancy_times(), 0, 4, 4, lambda _: None)
    assert judges == [POLICIES["greedy"]] * 2 + [student.play] * 2


def test_a_student_is_as_after_its_best_round_also_where_that_is_not_the_last(monkeypatch: pytest.MonkeyPatch) -> None:
    values, weights = iter([0.0, 0.5, 0.9, 0.3]), []  # of the judge, and after each round
    monkeypatch.setattr(cloning, "_value", lambda *given: next(values))
    student, scenes = Student(FIRE, 0), [random_scene(seed) for seed in range(2)]

    def now() -> torch.Tensor:
        return torch.cat([part.detach().flatten() for part in student.policy.parameters()])

    train(student, scenes, scenes, chancy_times(), 0, 3, 4, lambda _: weights.append(now()))
    assert torch.equal(now(), weights[1]) and not torch.equal(weights[1], weights[2])


def test_training_is_repeatable() -> None:
    scenes = [random_scene(seed) for seed in range(3)]
    weights = []
    for _ in range(2):
        student = Student(FIRE, 4)
        train(student, scenes, scenes, chancy_times(), 4, 1, 8, lambda _: None)
        weights.append(torch.cat([part.flatten() for part in student.policy.parameters()]))
        torch.manual_seed(99)  # of no consequence
    assert torch.equal(*weights)
    with pytest.raises(ValueError, match="rounds must be at least 1, got 0"):
        train(student, scenes, scenes, chancy_times(), 4, 0, 8, lambda _: None)
