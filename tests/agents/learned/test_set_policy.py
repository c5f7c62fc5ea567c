"""A policy over sets: the order of slots changes nothing, and what is forbidden is never chosen."""

from __future__ import annotations

import numpy as np
import pytest
import torch
from torch import Tensor

from hazard_ms.agents.learned.set_policy import FORBIDDEN, SetPolicy, Shape, worthwhile
from hazard_ms.skills.options.options import CART, COUNT, END, FIRST, LANDMARK, LOOK

SHAPE = Shape(((20.0, 600.0),))
SETS = {
    "targets": (0, FIRST[CART]),
    "carts": (FIRST[CART], FIRST[LANDMARK]),
    "landmarks": (FIRST[LANDMARK], FIRST[LOOK]),
}


def policy(shape: Shape = SHAPE) -> SetPolicy:
    torch.manual_seed(0)
    return SetPolicy(shape).eval()


def decisions(made: SetPolicy, count: int = 40) -> tuple[Tensor, Tensor]:
    """Random features within their bounds, [N, F], with some targets rescued, and masks [N, A]."""
    chance = np.random.default_rng(1)
    space = made.layout.space()
    drawn = chance.uniform(space.low, space.high, (count, made.layout.size)).astype(np.float32)
    targets = made.layout.split(drawn)["targets"]
    targets[..., 2] = chance.random(targets.shape[:2]) < 0.3
    mask = chance.random((count, COUNT)) < 0.4
    mask[:, FIRST[END]] = True
    return torch.from_numpy(drawn), torch.from_numpy(mask)


def test_the_number_of_parameters_is_small() -> None:
    assert 13_000 <= sum(part.numel() for part in policy().parameters()) <= 60_000


@pytest.mark.parametrize("table", SETS)
def test_an_option_follows_its_thing_to_another_slot(table: str) -> None:
    made = policy()
    features, mask = decisions(made)
    start, end = SETS[table]
    order = torch.from_numpy(np.random.default_rng(2).permutation(end - start))
    moved, moved_mask = features.clone(), mask.clone()
    rows = torch.from_numpy(made.layout.split(features.numpy())[table].copy())
    made.layout.split(moved.numpy())[table][:] = rows[:, order].numpy()
    moved_mask[:, start:end] = mask[:, start:end][:, order]
    with torch.no_grad():
        one, other = made(features, mask), made(moved, moved_mask)
    torch.testing.assert_close(other[:, start:end], one[:, start:end][:, order], atol=1e-5, rtol=0)
    torch.testing.assert_close(other[:, FIRST[LOOK] :], one[:, FIRST[LOOK] :], atol=1e-5, rtol=0)


def test_a_forbidden_option_is_never_chosen() -> None:
    made = policy()
    features, mask = decisions(made, 400)
    logits = made(features, mask).detach()
    assert torch.equal(logits == FORBIDDEN, ~mask)
    assert float(logits.softmax(-1)[~mask].max()) == 0.0
    assert bool(mask[torch.arange(400), made.choose(features, mask)].all())


def test_rescued_targets_and_ignored_columns_change_nothing() -> None:
    made = policy(Shape(((20.0, 600.0),), ignored=("front", "explored")))
    features, mask = decisions(made)
    changed = features.clone()
    parts = made.layout.split(changed.numpy())
    saved = parts["targets"][..., 2] > 0
    parts["targets"][saved, 3:] *= 0.5  # all but known, held and rescued
    names = [column.name for column in made.layout.tables["global"][1]]
    for name in ("explored", "front_0"):
        parts["global"][..., names.index(name)] += 1.0
    closed = mask.clone()
    closed[:, : FIRST[CART]] &= torch.from_numpy(~saved)
    torch.testing.assert_close(made(changed, closed), made(features, closed), atol=1e-5, rtol=0)
    parts["global"][..., names.index("remaining")] += 1.0
    assert not torch.allclose(made(changed, closed), made(features, closed), atol=1e-4)


def test_stopping_is_left_for_when_nothing_can_be_done() -> None:
    mask = np.zeros((3, COUNT), bool)
    mask[:, [FIRST[LOOK], FIRST[END]]] = True
    mask[1, FIRST[LANDMARK]] = mask[2, 0] = True
    assert worthwhile(mask)[:, FIRST[END]].tolist() == [True, False, False]
    assert mask[:, FIRST[END]].all() and (worthwhile(mask)[:, : FIRST[END]] == mask[:, : FIRST[END]]).all()


@pytest.mark.parametrize(
    ("more", "told"), [({"width": 0}, "width"), ({"heads": 7}, "heads"), ({"blocks": 0}, "blocks")]
)
def test_an_impossible_shape_is_refused(more: dict[str, int], told: str) -> None:
    with pytest.raises(ValueError, match=f"{told} of a policy must"):
        Shape(((0.0, 1.0),), **more)  # type: ignore[arg-type]
