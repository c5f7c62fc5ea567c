"""Many changes of scene: each episode is that of an environment made for it, and memory does not grow."""

from __future__ import annotations

import mmap
from typing import Any

import pytest

from hazard_ms.cli.costs import resets
from hazard_ms.cli.costs.resets import Resets, over_scenes
from hazard_ms.cli.costs.turns import Case
from hazard_ms.env.hazard_env import HazardEnv

FIRE = Case("HazardFire-v1", "fetch", "paper")


@pytest.mark.parametrize(
    ("env_id", "robot", "scenes", "rounds"),
    [
        ("HazardFlood-v1", "fetch", 3, 3),
        *(
            pytest.param(env_id, robot, 20, 10, marks=pytest.mark.long)
            for env_id, robot in (
                ("HazardFire-v1", "fetch"),
                ("HazardFlood-v1", "g1"),
                ("HazardWind-v1", "fetch"),
            )
        ),
    ],
)
def test_episodes_after_many_scenes_are_those_of_environments_made_for_them(
    env_id: str, robot: str, scenes: int, rounds: int
) -> None:
    made = over_scenes(Case(env_id, robot, "paper"), scenes, rounds)
    assert made.differing == ()
    assert [len(row) for row in made.seconds] == [scenes] * rounds
    if rounds > 3:
        assert made.growth < 0.5  # of 20 resets [MiB]; one scene holds more


def test_an_episode_that_depends_on_those_before_it_is_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    begun: list[int] = []
    plain = HazardEnv._initialize_episode

    def shifted(self: HazardEnv, env_idx: Any, options: dict[str, Any]) -> None:
        plain(self, env_idx, options)
        begun.append(1)
        if len(begun) == 6:  # that of `make`, two rounds of two scenes, and the third start in the first scene
            self.world.chance.frame += 1

    monkeypatch.setattr(HazardEnv, "_initialize_episode", shifted)
    assert over_scenes(FIRE, 2, 3).differing == (0,)


def test_growth_is_what_later_rounds_take() -> None:
    made = Resets(((1.0,),) * 4, (100.0, 200.0, 203.0, 206.0), ())
    assert made.growth == pytest.approx(3.0)


def test_memory_that_is_kept_shows() -> None:
    before = resets.resident()
    with mmap.mmap(-1, 256 * 2**20) as kept:  # from the system: what the process has freed is not used again
        for page in range(0, len(kept), mmap.PAGESIZE):
            kept[page] = 1
        assert resets.resident() - before == pytest.approx(256, abs=48)


def test_the_table_tells_first_times_from_later_ones() -> None:
    made = Resets(((0.2, 0.3, 0.4), (0.05, 0.05, 0.09), (0.06, 0.05, 0.05)), (900.0, 910.0, 909.0), (4,))
    row = resets.resets_table({FIRE: made}).splitlines()[-1]
    told = [cell.strip() for cell in row.split("|")[1:-1]]
    assert told == ["HazardFire-v1", "fetch", "paper", "300", "50", "90", "900", "909", "-1.00", "1"]


@pytest.mark.parametrize(("scenes", "rounds", "word"), [(1, 3, "scenes"), (2, 2, "rounds")])
def test_too_few_resets_are_refused(scenes: int, rounds: int, word: str) -> None:
    with pytest.raises(ValueError, match=word):
        over_scenes(FIRE, scenes, rounds)
