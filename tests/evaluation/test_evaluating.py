"""`hazard-ms evaluate`: which episodes it plays, that it resumes, and that its table is that of the scores."""

from __future__ import annotations

from pathlib import Path

import pytest

from hazard_ms.evaluation import sweep
from hazard_ms.evaluation.metrics import Fate
from hazard_ms.evaluation.options import EnvOptions, SweepOptions
from hazard_ms.evaluation.result import EpisodeResult


def result(options: SweepOptions, place: int, saved: bool) -> EpisodeResult:
    episode = options.episode_options()[place]
    fate = Fate("book_1", "book", 5.0, saved, False, 100 if saved else None)
    lost = Fate("pan_1", "pan", 5.0, False, False, None)
    return EpisodeResult(
        env_id=episode.env_id,
        agent=episode.agent,
        seed=episode.seed,
        scene="kitchen_b/00",
        settings=episode.settings,
        frames=1500,
        max_frames=1500,
        ended="time",
        targets=(fate, lost),
        decisions=(),
        command="",
    )


def test_every_agent_plays_every_seed_in_a_file_of_its_own(tmp_path: Path) -> None:
    options = SweepOptions(agents=("greedy:give_up=2", "random"), episodes=3, seed=10, output=tmp_path)
    episodes = options.episode_options()
    wanted = [(agent, seed) for agent in options.agents for seed in (10, 11, 12)]
    assert sorted((e.agent, e.seed) for e in episodes) == sorted(wanted)
    assert all(e.split == "test" for e in episodes)
    places = {options.place(e) for e in episodes}
    assert len(places) == 6 and {place.parent for place in places} == {tmp_path}


def test_every_setting_has_files_of_its_own(tmp_path: Path) -> None:
    usual = EnvOptions(split="test")
    changes = ({"lighting": "night"}, {"effects": "off"}, {"physics": "realistic"}, {"affects_agent": True})
    others = [EnvOptions(**{"split": "test", **change}) for change in changes]  # type: ignore[arg-type]
    sweeps = [SweepOptions(env, episodes=1, output=tmp_path) for env in (usual, *others)]
    assert len({sweep.place(sweep.episode_options()[0]) for sweep in sweeps}) == len(sweeps)


@pytest.mark.parametrize("bad", [{"episodes": 0}, {"workers": -1}, {"seed": -1}, {"env": EnvOptions("HazardQuake-v1")}])
def test_bad_options_are_refused(bad: dict[str, object]) -> None:
    with pytest.raises(ValueError, match=next(iter(bad))):
        SweepOptions(**bad).episode_options()  # type: ignore[arg-type]


def test_what_is_there_is_not_played_again_and_the_table_holds_its_scores(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Greedy saves one of two equal targets in both episodes, random in one of two: 50 and 25 per cent."""
    options = SweepOptions(EnvOptions(split="test", lighting="night"), episodes=2, output=tmp_path)
    for k, episode in enumerate(options.episode_options()):
        saved = episode.agent == "greedy" or episode.seed == 0
        result(options, k, saved).write(options.place(episode))
    before = {p.name: p.stat().st_mtime_ns for p in tmp_path.iterdir()}
    assert sweep.evaluate(options) == 0
    assert {p.name: p.stat().st_mtime_ns for p in tmp_path.iterdir()} == before
    printed = capsys.readouterr().out
    assert "50.0 [50.0, 50.0]" in printed and "25.0 [0.0, 50.0]" in printed and "2/4" in printed and "1/4" in printed
    assert "lighting night" in printed and "greedy: ended by 2 time; failures: none" in printed
