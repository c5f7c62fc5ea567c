"""The network of the original's learner: its size, what it reads, and how actions are drawn."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import torch

from hazard_ms.agents.learned import weights
from hazard_ms.agents.learned.map_policy import MapPolicy, MapShape
from hazard_ms.skills.options.paper_actions import COUNT
from hazard_ms.skills.options.paper_map import AGENT, HEIGHT, LEVEL, THING
from tests.worlds.policies import stored, stored_map

FIRE = ((20.0, 600.0),)


def policy(**more: object) -> MapPolicy:
    torch.manual_seed(0)
    return MapPolicy(MapShape(FIRE, **{"share": 0.125, **more})).eval()  # type: ignore[arg-type]


def maps(count: int = 8) -> torch.Tensor:
    """Maps with random numbers, and a few things."""
    chance = np.random.default_rng(0)
    made = chance.random((count, 5, 64, 64)).astype(np.float32)
    made[:, THING] = np.where(chance.random((count, 64, 64)) < 0.1, 0.25, -1.0)
    made[:, AGENT] = 0.0
    return torch.from_numpy(made)


def features(made: MapPolicy, seen: torch.Tensor) -> torch.Tensor:
    with torch.no_grad():
        return made.features(seen)


def drawn_of(made: MapPolicy, seen: torch.Tensor, mask: torch.Tensor, chance: torch.Tensor) -> np.ndarray:
    """The actions that numbers `chance` draw at one map."""
    count = len(chance)
    return made.draw(seen.expand(count, -1, -1, -1), mask.expand(count, -1), chance).numpy()


def test_the_widths_are_those_of_the_original() -> None:
    """Convolutions of 3 x 3 from 5 planes on, 4 x 4 cells of 32 planes, then 512, 256 and 6 numbers."""
    planes, rest = [5, 32, 64, 128, 64, 32], [4 * 4 * 32, 512, 256, 6]
    want = sum(9 * a * b + b for a, b in zip(planes, planes[1:], strict=False))
    want += sum(a * b + b for a, b in zip(rest, rest[1:], strict=False))
    assert sum(part.numel() for part in MapPolicy(MapShape(FIRE)).parameters()) == want == 581_606
    half = sum(part.numel() for part in MapPolicy(MapShape(FIRE, 0.5)).parameters())
    assert half == 146_422 and MapShape(FIRE, 0.5).width == 128


def test_the_mark_of_the_agent_is_not_lost() -> None:
    made, seen = policy(), maps(1)
    moved = seen.clone()
    seen[0, AGENT, 10, 10] = -2.0
    moved[0, AGENT, 40, 40] = -2.0
    assert not torch.allclose(features(made, seen), features(made, moved), atol=1e-5)


def test_ignored_planes_and_levels_away_from_things_change_nothing() -> None:
    seen = maps()
    higher, hotter, hotter_things = seen.clone(), seen.clone(), seen.clone()
    higher[:, HEIGHT] += 1.0
    hotter[:, LEVEL] += (seen[:, THING] < 0.0) * 3.0
    hotter_things[:, LEVEL] += (seen[:, THING] >= 0.0) * 3.0
    blind, seeing = policy(ignored=(HEIGHT,), at_things=True), policy()
    want = features(blind, seen)
    torch.testing.assert_close(features(blind, higher), want)
    torch.testing.assert_close(features(blind, hotter), want)
    assert not torch.allclose(features(blind, hotter_things), want, atol=1e-4)
    for other in (higher, hotter):
        assert not torch.allclose(features(seeing, other), features(seeing, seen), atol=1e-4)


def test_actions_are_drawn_as_often_as_they_are_likely_and_never_what_is_forbidden() -> None:
    made, seen = policy(), maps(1)
    made.score.weight.data *= 300.0
    mask = torch.tensor([[True, False, True, True, True, False]])
    with torch.no_grad():
        want = made(seen, mask).softmax(-1)[0]
    chance = torch.arange(0.00005, 1.0, 0.0001)
    drawn = np.concatenate([drawn_of(made, seen, mask, some) for some in chance.split(500)])
    share = np.bincount(drawn, minlength=COUNT) / len(drawn)
    np.testing.assert_allclose(share, want.numpy(), atol=2e-4)
    assert share[1] == share[5] == 0.0 and 0.1 < share.max() < 0.95
    last = torch.tensor([1.0])
    assert int(made.draw(seen, mask, last)) == 4  # beyond the sum of all


def test_an_untrained_policy_likes_all_actions_alike() -> None:
    with torch.no_grad():
        likely = policy()(maps(), torch.ones(8, COUNT, dtype=torch.bool)).softmax(-1)
    assert float((likely - 1 / COUNT).abs().max()) < 0.02


def test_files_hold_sixteen_bits_and_come_back(tmp_path: Path) -> None:
    path = stored_map(tmp_path / "one.safetensors", masked=True)
    torch.manual_seed(0)
    want, got = MapPolicy(MapShape(FIRE, 0.125, True)), weights.load_map(path, "HazardFire-v1")
    numbers = sum(part.numel() for part in want.parameters())
    assert got.shape == want.shape and 2 * numbers < path.stat().st_size < 2 * numbers + 2000
    for name, part in want.state_dict().items():
        assert torch.equal(got.state_dict()[name], part.half().float())
    assert weights.sees_map(path) and not weights.sees_map(tmp_path / "none.safetensors")


def test_policies_of_the_other_kind_are_refused(tmp_path: Path) -> None:
    one, other = stored_map(tmp_path / "one.safetensors"), stored(tmp_path / "other.safetensors")
    with pytest.raises(ValueError, match="features_version must be 1, got None; `hazard-ms train bc"):
        weights.load(one, "HazardFire-v1")
    with pytest.raises(ValueError, match="map_version must be 1, got None; `hazard-ms train ppo --actions paper"):
        weights.load_map(other, "HazardFire-v1")
    assert not weights.sees_map(other)


def test_an_impossible_share_is_refused() -> None:
    for share in (0.0, 0.01, 1.5, float("nan")):
        with pytest.raises(ValueError, match="share of a policy must be from 1/32 to 1"):
            MapShape(FIRE, share)
