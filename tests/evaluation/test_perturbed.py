"""Results of episodes under a perturbation are kept apart from all others, and say which one it was."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from hazard_ms.evaluation import sweep
from hazard_ms.evaluation.comparison.folders import groups
from hazard_ms.evaluation.options import EnvOptions, EpisodeOptions, SweepOptions
from hazard_ms.evaluation.replay import episode_of
from hazard_ms.evaluation.result import EpisodeResult
from hazard_ms.evaluation.runner import environment
from tests.worlds.results import result_of

TEXT = "camera:1,lighting:2"


def sweep_of(perturb: str, output: Path) -> SweepOptions:
    """The options of a sweep of two episodes of an agent."""
    return SweepOptions(EnvOptions(split="test", perturb=perturb), agents=("greedy",), episodes=2, output=output)


def test_a_result_names_the_perturbation_in_one_way(tmp_path: Path) -> None:
    (episode, _) = sweep_of(TEXT, tmp_path).episode_options()
    place = sweep_of(TEXT, tmp_path).place(episode)
    result_of(episode).write(place)
    told = json.loads(place.read_text())
    assert told["settings"]["perturb"] == "lighting:2,camera:1" and "lighting.2.camera.1" in place.name
    assert "--perturb lighting:2,camera:1" in episode.command
    assert episode_of(EpisodeResult.read(place)).perturb == "lighting:2,camera:1"


def test_level_0_is_no_perturbation(tmp_path: Path) -> None:
    usual, none = sweep_of("", tmp_path), sweep_of("lighting:0", tmp_path)
    assert usual == none and "perturb" not in usual.episode_options()[0].settings
    assert usual.place(usual.episode_options()[0]) == none.place(none.episode_options()[0])


def test_resuming_takes_no_result_of_another_perturbation(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    mild, strong, usual = (sweep_of(text, tmp_path) for text in ("lighting:1", "lighting:2", ""))
    for options in (mild, strong, usual):
        for episode in options.episode_options():
            result_of(episode).write(options.place(episode))
    assert len(list(tmp_path.iterdir())) == 6
    assert sweep.evaluate(strong) == 0
    assert "perturb lighting:2" in capsys.readouterr().out
    episode = strong.episode_options()[0]
    assert sweep.kept(strong, episode) is not None
    strong.place(episode).write_text(mild.place(mild.episode_options()[0]).read_text())  # under another's name
    assert sweep.kept(strong, episode) is None
    strong.place(episode).write_text(usual.place(usual.episode_options()[0]).read_text())
    assert sweep.kept(strong, episode) is None


def test_reports_show_another_perturbation_as_another_group(tmp_path: Path) -> None:
    for text in ("", "lighting:1", "lighting:2"):
        for episode in sweep_of(text, tmp_path).episode_options():
            result_of(episode).write(sweep_of(text, tmp_path).place(episode))
    titles = [group.title for group in groups([tmp_path])[0]]
    assert len(titles) == 3 and sum("perturb lighting:2" in title for title in titles) == 1


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ({"perturb": "light:1"}, "a kind in perturb must be one of"),
        ({"perturb": "hazard:1"}, "hazard in perturb must be 0 for all physics but 'realistic', got 1"),
        (
            {"perturb": "hazard:1", "physics": "realistic", "severity": "extreme"},
            "severity must be 'severe' beside hazard",
        ),
        ({"perturb": "objects:1", "env_id": "HazardWind-v1"}, "objects in perturb must be 0 for HazardWind-v1"),
    ],
)
def test_what_cannot_be_is_refused_before_anything_is_played(options: dict[str, Any], said: str) -> None:
    with pytest.raises(ValueError, match=said):
        SweepOptions(EnvOptions(**options)).episode_options()


@pytest.mark.render
def test_the_episode_is_played_so() -> None:
    played = environment(EpisodeOptions(perturb="words:1,start:2", seed=2))
    try:
        played.reset(2)
        assert str(played.base.perturbation) == "words:1,start:2"
        assert played.brief().text in played.base.task.rewordings[0]  # what agents are told
    finally:
        played.close()
