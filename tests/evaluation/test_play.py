"""`hazard-ms play` from end to end: a short episode, its film, result and page, and the command that plays it again."""

from __future__ import annotations

import dataclasses
import gc
import json
import shlex
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import imageio_ffmpeg
import pytest

from hazard_ms.agents.base import Agent, known, open_targets
from hazard_ms.cli.__main__ import main
from hazard_ms.evaluation.options import EpisodeOptions, PlayOptions
from hazard_ms.evaluation.report import summary
from hazard_ms.evaluation.result import EpisodeResult
from hazard_ms.evaluation.runner import play
from hazard_ms.skills.brief import Brief, random_seed
from hazard_ms.skills.decision import EXPLORE, STOP, WALK_ONE_STEP, Action, Decision
from hazard_ms.skills.executor import SkillEnv

pytestmark = pytest.mark.render
ROOT = Path(__file__).parents[2]
SCENE, SEED = "kitchen_a/03", 11
HOLD = 45  # pictures for which the end is shown: 1.5 s of 30
EPISODE = EpisodeOptions(agent="tests.evaluation.test_play:Short", seed=SEED, scene=SCENE)


class Short(Agent):
    """Looks around, takes a step towards what is nearest, and stops."""

    def reset(self, brief: Brief) -> None:
        self.left = [STOP, WALK_ONE_STEP, EXPLORE]
        self.brief = brief

    def act(self, decision: Decision) -> Action:
        verb = self.left.pop()
        self.note = f"{verb}, seed {self.brief.random_seed}"
        near = next(iter(known(decision, open_targets(decision))), decision.names[next(iter(decision.map.objects))])
        return Action(verb, near if verb == WALK_ONE_STEP else None)


class AtOnce(Short):
    """Tells what it was told, and stops at once."""

    def reset(self, brief: Brief) -> None:
        super().reset(brief)
        self.left = [STOP]


class Breaks(Short):
    """Shoots a thing through the ceiling, which no agent can do by what it is given."""

    def act(self, decision: Decision) -> Action:
        for env in (each for each in gc.get_objects() if type(each) is SkillEnv):
            env.base.world.handles.bodies[0].linear_velocity = [0.0, 0.0, 900.0]
        return Action(EXPLORE)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("play")


@pytest.fixture(scope="module")
def again(folder: Path) -> Iterator[subprocess.Popen[str]]:
    """The command of the episode, running in a process of its own meanwhile, with fewer pictures of the film."""
    program, *words = shlex.split(EPISODE.command)
    assert program == "hazard-ms"
    command = [sys.executable, "-m", "hazard_ms.cli", *words, "--video", str(folder / "again.mp4"), "--every", "30"]
    started = subprocess.Popen(command, cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    yield started
    started.kill()
    started.wait()


@pytest.fixture(scope="module")
def result(folder: Path, again: subprocess.Popen[str]) -> EpisodeResult:
    assert main([*shlex.split(EPISODE.command)[1:], "-o", str(folder / "out.mp4")]) == 0
    return EpisodeResult.read(folder / "out.json")


def test_it_played_what_was_ordered(result: EpisodeResult) -> None:
    assert (result.scene, result.seed, result.ended, result.max_frames) == (SCENE, SEED, "stopped", 1500)
    assert [d.verb for d in result.decisions] == [EXPLORE, WALK_ONE_STEP, STOP]
    explored, walked, _ = result.decisions
    assert explored.ok and explored.frames == pytest.approx(60, abs=6)  # 12 turns of 30 degrees, 6 degrees per frame
    assert walked.target in {f.name for f in result.targets} and 0 < walked.frames <= 100
    assert [d.frame for d in result.decisions] == [0, explored.frames, result.frames]
    assert result.decisions[0].note == f"explore, seed {random_seed(SEED)}"
    assert result.tally.value == 0.0 and result.tally.rescued == 0 and len(result.targets) >= 5
    told = summary(result, EPISODE.goal)
    assert "rescued 0 of" in told and f"% of the value, in {result.frames} frames (stopped)" in told


def test_the_video_opens_and_shows_every_sixth_frame_and_the_end(result: EpisodeResult, folder: Path) -> None:
    reader = imageio_ffmpeg.read_frames(str(folder / "out.mp4"))
    meta = next(reader)
    pictures = list(reader)
    assert meta["size"] == (1280, 720) and meta["fps"] == pytest.approx(24.0) and meta["codec"] == "h264"
    assert len(pictures) == result.frames // 6 + 1 + HOLD
    assert all(len(picture) == 1280 * 720 * 3 for picture in pictures)
    assert pictures[0] != pictures[len(pictures) - HOLD]  # it moves


def test_the_result_reads_back_as_it_was(result: EpisodeResult, folder: Path) -> None:
    result.write(folder / "out.json")
    assert EpisodeResult.read(folder / "out.json") == result
    assert 0.5 < sum(result.phase_seconds.values()) / result.wall_seconds <= 1.0
    assert set(result.phase_seconds) == {"build", "looks", "agent", "physics"}
    assert [link.frame for link in result.links][:2] == [0, 50] and result.links[-1].frame == result.frames
    told = json.loads((folder / "out.json").read_text())
    assert told["score"] == {"value": 0.0, "step": None, "damage": None}
    assert set(told["versions"]) >= {"hazard-ms", "sapien", "mani-skill", "gymnasium", "torch", "numpy", "python"}
    assert "absent" not in told["versions"].values()


def test_the_page_holds_the_film_and_the_command(result: EpisodeResult, folder: Path) -> None:
    page = (folder / "out.html").read_text(encoding="utf-8")
    assert "data:video/mp4;base64," in page and result.command in page and "walk one step" in page.replace("_", " ")


def same(result: EpisodeResult) -> dict[str, Any]:
    """All that must not depend on the run."""
    row = result.to_dict()
    return {key: row[key] for key in row if key not in ("wall_seconds", "phase_seconds")}


def test_its_command_plays_the_same_episode_again(
    result: EpisodeResult, again: subprocess.Popen[str], folder: Path
) -> None:
    """To the same score, decisions and fates."""
    assert result.command == EPISODE.command
    out, error = again.communicate(timeout=200)
    assert again.returncode == 0, error[-2000:]
    assert all(f"again.{suffix}" in out for suffix in ("mp4", "json", "html"))
    assert same(EpisodeResult.read(folder / "again.json")) == same(result)


def test_a_broken_simulation_is_told_by_the_exit_code(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("HAZARD_MS_DUMPS", str(tmp_path))
    assert main(["play", "--agent", "tests.evaluation.test_play:Breaks", "--scene", SCENE]) == 1
    assert "(simulation error)" in capsys.readouterr().out


def test_another_seed_tells_the_agent_another_seed(folder: Path) -> None:
    """Without a film, nothing is written."""
    episode = dataclasses.replace(EPISODE, agent="tests.evaluation.test_play:AtOnce", seed=SEED + 1)
    made = play(episode)
    assert made.decisions[0].note == f"stop, seed {random_seed(SEED + 1)}" and (made.scene, made.frames) == (SCENE, 0)
    assert {p.stem for p in folder.iterdir()} <= {"out", "again"}


@pytest.mark.parametrize(
    ("options", "told"),
    [
        (PlayOptions(every=0), "every"),
        (PlayOptions(output=Path("film.avi")), "got 'film.avi'"),
        (PlayOptions(EpisodeOptions(lighting="dusk")), "lighting"),
        (PlayOptions(EpisodeOptions(robot_uids="fetsh")), "did you mean 'fetch'"),
        (PlayOptions(EpisodeOptions(load=("no_such_module",))), "no_such_module"),
    ],
)
def test_what_cannot_be_played_is_refused(options: PlayOptions, told: str) -> None:
    with pytest.raises(ValueError, match=told):
        options.check()
