"""Episodes with a detector: the truth is withheld everywhere, and without faults it makes no difference."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from hazard_ms.agents.base import agent
from hazard_ms.evaluation.comparison.folders import groups, title
from hazard_ms.evaluation.options import EpisodeOptions, SweepOptions
from hazard_ms.evaluation.replay import episode_of
from hazard_ms.evaluation.result import EpisodeResult
from hazard_ms.evaluation.runner import Runner, agent_of
from hazard_ms.evaluation.sweep import kept
from hazard_ms.sensing.detection.noisy import Noisy
from hazard_ms.sensing.detection.perception import perception
from hazard_ms.skills.executor import SkillEnv
from tests.worlds.results import result_of

TASK = "HazardFire-v1"
SMALL = {"sensor_configs": {"width": 96, "height": 96}, "effects": "off"}
LAST = 160  # frame at which a run ends: it has looked around and walked
SEED = 3


class Forgetful(Noisy):
    """Overwrites the truth that it was shown, which must not matter to anybody."""

    def detect(self, rgb: Any, depth: Any) -> Any:
        found = super().detect(rgb, depth)
        self.truth.labels[...] = np.random.default_rng(0).integers(-3, len(self.truth.categories), depth.shape)
        return found


@pytest.fixture(scope="module")
def env() -> Iterator[SkillEnv]:
    made = SkillEnv.make(TASK, **SMALL)
    yield made
    made.close()


def played(env: SkillEnv, text: str, kind: type[Noisy] | None = None, who: str = "greedy") -> tuple[Any, ...]:
    """The links and decisions of a run under a perception; `kind` replaces its detector."""
    made = perception(text)
    env._perception = made if kind is None else replace(made, detector=kind())
    run = Runner(env, agent(who)).run(SEED, until_frame=LAST)
    return run.links, tuple((d.verb, d.target, d.ok, d.frames) for d in run.decisions)


@pytest.mark.render
def test_without_faults_and_with_the_indices_of_the_truth_it_makes_no_difference(env: SkillEnv) -> None:
    truth = played(env, "truth")
    assert len(truth[1]) > 1 and played(env, "noisy:association=paper") == truth
    assert played(env, "noisy:association=paper,miss=1") != truth


@pytest.mark.render
def test_what_a_detector_has_not_told_makes_no_difference(env: SkillEnv) -> None:
    assert played(env, "noisy", Forgetful) == played(env, "noisy")


@pytest.mark.render
def test_agents_get_no_labels_and_no_names_of_the_truth(env: SkillEnv) -> None:
    played(env, "noisy")
    decision = env.decision()
    assert decision.images is not None and decision.images.segmentation is None
    assert len(decision.map.objects) > 3 and all("#" in name for name in decision.names)
    assert {a.target for a in decision.available} - {None} <= set(decision.names)
    assert all("#" in t.name for t in env.brief().targets)
    assert decision.map.clears, "what detectors overlook must not bar ways for ever"
    played(env, "truth")
    assert (images := env.decision().images) is not None and images.segmentation is not None
    assert not env.decision().map.clears


@pytest.mark.render
@pytest.mark.parametrize("name", ["greedy", "planner"])
def test_with_the_truth_beliefs_change_nothing(env: SkillEnv, name: str) -> None:
    """Not a bit of the simulation: the chain of hashes is the same, and every decision."""
    off = {"greedy": "false", "planner": "0"}[name]
    usual = played(env, "truth", who=name)
    assert played(env, "truth", who=f"{name}:belief={off}") == usual and len(usual[1]) > 1


@pytest.mark.render
def test_the_camera_has_the_eyes_of_the_perception() -> None:
    """96 x 64 pixels with 90 degrees over the width: a focal length of 48 pixels both ways."""
    made = SkillEnv.make(TASK, "noisy:eyes=96x64/90", effects="off")
    try:
        decision, _ = made.reset(seed=SEED)
        assert decision.images is not None and decision.images.depth.shape == (64, 96)
        intrinsic = made.base.observer.camera.get_params()["intrinsic_cv"][0].cpu().numpy()
        assert np.diag(intrinsic)[:2].tolist() == pytest.approx([48.0, 48.0], rel=1e-4)
    finally:
        made.close()


def test_a_result_of_other_eyes_is_another_episode(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """When a detector gets other eyes, what it played before is replayed with the old ones, and played anew."""
    sweep = SweepOptions(episodes=1, perception="noisy", agents=("greedy",), output=tmp_path)
    (episode,) = sweep.episode_options()
    old = replace(result_of(episode), perception="noisy")
    assert old.eyes == "256/120"
    old.write(sweep.place(episode))
    assert kept(sweep, episode) == old
    monkeypatch.setattr(Noisy, "eyes", "512/120")
    assert kept(sweep, episode) is None
    assert episode_of(old).perception == "noisy:eyes=256/120"
    assert "eyes 512/120" in title(replace(old, eyes="512/120")) and "eyes" not in title(old)


def test_who_sees_what_is_hidden_needs_the_truth() -> None:
    with pytest.raises(ValueError, match="perception must be truth for oracle, which sees what is hidden"):
        agent_of(EpisodeOptions(agent="oracle", perception="noisy"))
    assert not agent_of(EpisodeOptions(agent="greedy", perception="noisy")).privileged


def test_results_tell_the_perception_and_are_not_compared_with_others(tmp_path: Path) -> None:
    usual = result_of(EpisodeOptions())
    noisy = replace(usual, perception="noisy:miss=0.2")
    usual.write(tmp_path / "one.json")
    noisy.write(tmp_path / "two.json")
    assert EpisodeResult.read(tmp_path / "two.json") == noisy
    assert episode_of(noisy).perception == "noisy:miss=0.2" and episode_of(usual).perception == "truth"
    titles = [group.title for group in groups([tmp_path])[0]]
    assert len(titles) == 2 and sum("perception noisy:miss=0.2" in title for title in titles) == 1


def test_results_of_different_perceptions_have_different_files() -> None:
    places = set()
    for text in ("truth", "noisy", "noisy:miss=0.2", "noisy:miss=0.2,association=paper"):
        sweep = SweepOptions(episodes=1, perception=text)
        places |= {sweep.place(episode).name for episode in sweep.episode_options()}
    assert len(places) == 4 * 2  # greedy and random
    assert all(":" not in name and "," not in name and "=" not in name for name in places)


def test_a_perception_that_cannot_be_is_refused_before_the_first_episode() -> None:
    with pytest.raises(ValueError, match="perception must be one of"):
        SweepOptions(episodes=1, perception="nosy").episode_options()
