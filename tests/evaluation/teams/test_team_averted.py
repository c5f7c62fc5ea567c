"""What a team averts: its losses are found as those of one robot are."""

from __future__ import annotations

from pathlib import Path

import pytest

from hazard_ms.evaluation.attempts import attempt
from hazard_ms.evaluation.averted.alone import asked, losses
from hazard_ms.evaluation.options import EnvOptions, SweepOptions
from hazard_ms.evaluation.workers import Job
from hazard_ms.skills.decision import STOP

PAIR = ("fetch", "fetch")


def options_of(robots: str | tuple[str, ...], folder: Path) -> SweepOptions:
    env = EnvOptions("HazardFire-v1", split="hard", robot_uids=robots, effects="off")
    return SweepOptions(env, agents=("auction",), episodes=1, averted="yes", backend="serial", output=folder)


def test_it_is_told_where_the_task_declares_it() -> None:
    assert asked(SweepOptions(EnvOptions("HazardHouseFire-v1", robot_uids=PAIR)))
    assert not asked(SweepOptions(EnvOptions("HazardFire-v1", robot_uids=PAIR)))


@pytest.mark.render
def test_if_nobody_acts_as_much_is_lost_as_beside_one_robot(tmp_path: Path) -> None:
    """All robots stand to the end. A team that stops at once loses just that."""
    lost = []
    for robots in ("fetch", PAIR):
        options = options_of(robots, tmp_path)
        lost.append([*losses(options, options.episode_options()).values()])
    assert lost[0] == lost[1] and lost[0][0] is not None and lost[0][0].targets > 0
    (episode,) = options.episode_options()
    stops = Job(episode, 60.0, ((STOP, None), (STOP, None)), averted=True, robots=episode.team)
    result = attempt(stops, lambda word: None).result
    assert result is not None and result.lost == lost[1][0] and result.ended == "stopped" and result.frames == 0
