"""Thinking takes time: the frames of three clocks by hand, and what passes in an episode."""

from __future__ import annotations

import pytest

from hazard_ms.agents.base import Agent
from hazard_ms.agents.latency import Thought, frames_of, seconds_of
from hazard_ms.evaluation.metrics import Fate
from hazard_ms.evaluation.options import EpisodeOptions, SweepOptions
from hazard_ms.evaluation.replay import job_of
from hazard_ms.evaluation.result import DecisionRecord, EpisodeResult
from hazard_ms.evaluation.runner import Runner, result_of
from hazard_ms.skills.brief import Brief
from hazard_ms.skills.decision import EXPLORE, STOP, Action, Decision
from hazard_ms.skills.executor import SkillEnv

FRAME = 1 / 30  # [s]
SEED = 3
TYPICAL = Thought(seconds=2.0, prompt=800, answer=40, calls=1)  # 0.3 + 0.16 + 0.8 = 1.26 s by tokens: 37.8 frames


class Thinker(Agent):
    """Looks around once, and then stops; each takes it a given thought."""

    def __init__(self, thought: Thought | None) -> None:
        self.thought = thought

    def reset(self, brief: Brief) -> None:
        self._looked = False

    def act(self, decision: Decision) -> Action:
        looked, self._looked = self._looked, True
        return Action(STOP if looked else EXPLORE)


@pytest.mark.parametrize(
    ("clock", "thought", "seconds", "frames"),
    [
        ("tokens", TYPICAL, 1.26, 38),
        ("tokens", Thought(9.0, 1600, 80, 2), 2.52, 76),
        ("tokens", Thought(9.0, 0, 0, 0), 0.0, 0),
        ("tokens", None, 0.0, 0),
        ("wall", TYPICAL, 2.0, 60),
        ("wall", None, 0.7, 21),
        ("off", TYPICAL, 0.0, 0),
        ("off", None, 0.0, 0),
    ],
)
def test_frames_of_a_thought(clock: str, thought: Thought | None, seconds: float, frames: int) -> None:
    """Measured were 0.7 s."""
    assert seconds_of(clock, thought, 0.7) == pytest.approx(seconds)
    assert frames_of(seconds_of(clock, thought, 0.7), FRAME) == frames


def test_a_frame_that_has_begun_counts() -> None:
    assert [frames_of(t, FRAME) for t in (0.0, 0.001, 1 / 30, 0.034, 0.1, 1.2)] == [0, 1, 1, 2, 3, 36]


def test_by_the_clock_the_hazard_goes_on_before_the_action(env: SkillEnv) -> None:
    off = Runner(env, Thinker(TYPICAL)).run(SEED)
    on = Runner(env, Thinker(TYPICAL), clock="tokens").run(SEED)
    assert [d.waited for d in off.decisions] == [0, 0] and [d.waited for d in on.decisions] == [38, 38]
    assert [d.thought for d in on.decisions] == [pytest.approx(1.26)] * 2
    assert [d.frames for d in on.decisions] == [d.frames for d in off.decisions]
    assert on.links[-1].frame == off.links[-1].frame + 2 * 38
    wall = Runner(env, Thinker(TYPICAL), clock="wall").run(SEED)
    assert [d.waited for d in wall.decisions] == [60, 60], "as the agent tells it"


def test_without_a_clock_thoughts_change_nothing(env: SkillEnv) -> None:
    before = Runner(env, Thinker(None)).run(SEED)
    off = Runner(env, Thinker(TYPICAL), clock="off").run(SEED)
    assert (off.links, off.decisions, off.ended) == (before.links, before.decisions, before.ended)


def test_a_thought_that_outlasts_the_episode_ends_it(env: SkillEnv) -> None:
    played = Runner(env, Thinker(Thought(100.0, 0, 0, 1)), clock="wall").run(SEED)
    assert env.frame == env.max_frames and played.decisions[0].reason == "episode_over"
    assert played.decisions[0].waited == env.max_frames and len(played.decisions) == 1 and played.ended == "time"


def test_a_replay_waits_as_long_and_no_longer(env: SkillEnv) -> None:
    options = EpisodeOptions(seed=SEED, clock="tokens")
    played = Runner(env, Thinker(TYPICAL), clock=options.clock).run(SEED)
    job = job_of(result_of(options, env, played))
    assert job.waits == (38, 38) and job.options.clock == "off"


def test_latency_and_its_share_are_scores_where_there_is_a_clock() -> None:
    fates = (Fate("pen_1", "pen", 1.0, False, False),)
    walk = DecisionRecord(0, "walk_to", "pen_1", True, "", 62, waited=38, thought=1.26)
    made = [
        EpisodeResult("E", "llm", 0, "s", {}, 100, 1500, "time", fates, (walk,), "", clock=clock)
        for clock in ("tokens", "off")
    ]
    assert made[0].latency == 1.26 and made[0].latency_share == pytest.approx(0.38)
    assert made[0].to_dict()["score"]["latency_share"] == pytest.approx(0.38)
    assert set(made[1].to_dict()["score"]) == {"value", "step", "damage"}
    assert EpisodeResult.from_dict(made[0].to_dict()) == made[0]


def test_results_with_a_clock_have_files_and_commands_of_their_own() -> None:
    sweep = SweepOptions(agents=("greedy",), episodes=1, clock="wall")
    (timed,) = sweep.episode_options()
    (untimed,) = SweepOptions(agents=("greedy",), episodes=1).episode_options()
    assert sweep.place(timed) != sweep.place(untimed) and "clock.wall" in sweep.place(timed).name
    assert timed.command == f"{untimed.command} --clock wall"
    for options in (EpisodeOptions(clock="sundial"), SweepOptions(clock="sundial")):
        with pytest.raises(ValueError, match="clock must be one of off, tokens, wall, got 'sundial'"):
            options.check() if isinstance(options, EpisodeOptions) else options.episode_options()
