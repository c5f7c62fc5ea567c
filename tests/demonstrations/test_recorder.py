"""A recording holds what happened: a second environment, stepped with the recorded actions, passes through it."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from typing import Any

import cv2
import gymnasium as gym
import numpy as np
import pytest
import torch

import hazard_ms  # noqa: F401 registers the environments
from hazard_ms.agents.base import PrivilegedAgent
from hazard_ms.demonstrations.layout import LABEL_SHIFT, NO_LABEL
from hazard_ms.demonstrations.options import RecordOptions
from hazard_ms.demonstrations.reading import Demonstration, demonstrations, entries
from hazard_ms.demonstrations.recording import RecordJob, attempt
from hazard_ms.demonstrations.watching.recorder import Recorder
from hazard_ms.evaluation.options import EpisodeOptions
from hazard_ms.evaluation.runner import play
from hazard_ms.sensing.sighting import Sighting
from hazard_ms.skills.actions import wait
from hazard_ms.skills.brief import Brief
from hazard_ms.skills.decision import STOP, VERBS, WALK_ONE_STEP, Action, Decision
from hazard_ms.skills.executor import SkillEnv

pytestmark = pytest.mark.render
EPISODE = EpisodeOptions(agent="tests.demonstrations.test_recorder:Told", seed=11, scene="kitchen_a/03")
WAITED, EVERY = 5, 16  # frames


class Told(PrivilegedAgent):
    """Waits, tells the map where a target is that it has not seen, takes a step towards it, and stops."""

    def attach(self, env: SkillEnv) -> None:
        self.env = env

    def reset(self, brief: Brief) -> None:
        self.left = [STOP, WALK_ONE_STEP]

    def act(self, decision: Decision) -> Action:
        verb = self.left.pop()
        if verb == STOP:
            return Action(STOP)
        self.env.run(wait(self.env.stage, WAITED))
        hidden = next(t for t in decision.targets if t.index not in decision.map.objects)
        place = self.env.base.world.position[0, hidden.index].cpu().numpy()
        seen = self.env.seen
        seen.objects = {**seen.objects, hidden.index: Sighting(place, 0.1, float(place[2]) + 0.1, 0, 0)}
        return Action(verb, hidden.name)


@pytest.fixture(scope="module")
def recorded(tmp_path_factory: pytest.TempPathFactory) -> Demonstration:
    output = tmp_path_factory.mktemp("demos")
    options = RecordOptions(
        agent=EPISODE.agent, keep=0.0, verify=False, every=EVERY, obs="state+rgb+depth+segmentation", output=output
    )
    options.dataset.mkdir(parents=True)
    outcome = attempt(RecordJob(EPISODE, 60.0, record=options), lambda word: None)
    assert not outcome.error
    (made,) = demonstrations(options.dataset)
    return made


@pytest.fixture(scope="module")
def second(recorded: Demonstration) -> Iterator[Any]:
    """A second environment at the start of the same episode."""
    mode = recorded.meta["control_mode"]
    env = gym.make("HazardFire-v1", obs_mode="state", control_mode=mode)
    yield env
    env.close()


def test_the_instruction_is_what_the_environment_tells_a_policy(recorded: Demonstration, second: Any) -> None:
    """One sentence for training and evaluation: policies fail on other words than they were trained on."""
    assert recorded.meta["instruction"] == second.get_wrapper_attr("task_description") == second.unwrapped.task.text
    assert recorded.meta["prompts"][0]["text"].startswith(recorded.meta["instruction"] + "\n")


def test_a_second_environment_passes_through_the_recorded_states(recorded: Demonstration, second: Any) -> None:
    """Bit by bit: joints, poses, observations, rewards and, every tenth frame, the state of everything."""
    frames, base = recorded.frames, second.unwrapped
    obs, _ = second.reset(seed=EPISODE.seed, options=EPISODE.reset_options)
    fire = base.episode.states["fire"]
    assert recorded.meta["hazards"] == ["fire.temperature"] and 19.0 < frames["hazard"].min()  # [C], in a room
    states = dict(zip(frames["state_frame"].tolist(), frames["state"], strict=True))
    assert len(frames["action"]) == recorded.result.frames > WAITED and list(states)[:2] == [0, 10]
    for t in range(len(frames["action"]) + 1):
        assert np.array_equal(frames["qpos"][t], base.agent.robot.get_qpos()[0].numpy()), t
        assert np.array_equal(frames["qvel"][t], base.agent.robot.get_qvel()[0].numpy()), t
        assert np.array_equal(frames["base"][t], np.float32(base.agent.base())), t
        assert np.array_equal(frames["hand"][t], base.agent.gripper_pose()[0][0].numpy()), t
        assert frames["held"][t] == int(base.hand.held[0])
        assert np.array_equal(frames["obs"][t], obs[0].numpy()), t
        there = torch.from_numpy(frames["hand"][t])[None, None]
        assert np.array_equal(frames["hazard"][t], [float(base.task.hazards[0].image(fire, base.world, there))]), t
        if t in states:
            assert np.array_equal(states.pop(t), base.get_state()[0].numpy()), t
        if t < len(frames["action"]):
            obs, reward, terminated, truncated, info = second.step(frames["action"][t])
            assert frames["reward"][t] == np.float32(float(reward))
            assert (frames["terminated"][t], frames["truncated"][t]) == (bool(terminated), bool(truncated))
            assert frames["success"][t] == bool(info["success"])
    assert not states


def test_a_recorded_state_can_be_restored(recorded: Demonstration, second: Any) -> None:
    base = second.unwrapped
    second.reset(seed=EPISODE.seed, options=EPISODE.reset_options)
    base.set_state(recorded.frames["state"][1:2])
    assert int(base.world.frame[0]) == recorded.frames["state_frame"][1] == 10
    assert np.allclose(base.agent.robot.get_qpos()[0].numpy(), recorded.frames["qpos"][10], atol=1e-5)


def test_every_frame_belongs_to_a_subtask_and_a_decision(recorded: Demonstration) -> None:
    frames, meta = recorded.frames, recorded.meta
    names = [meta["subtasks"][k] for k in frames["subtask"]]
    walk, stop = recorded.result.decisions
    assert names[:WAITED] == ["wait"] * WAITED and set(names[WAITED:]) == {f"walk one step towards {walk.target}"}
    assert (walk.waited, walk.frames) == (WAITED, len(names) - WAITED) and stop.verb == STOP
    assert set(frames["decision"].tolist()) == {0} and meta["subtasks"][-1] == "stop"


def test_decisions_are_those_of_the_result(recorded: Demonstration) -> None:
    decisions = recorded.decisions
    for k, told in enumerate(recorded.result.decisions):
        assert VERBS[decisions["verb"][k]] == told.verb
        assert (told.target is None) == (decisions["target"][k] < 0)
        assert told.target is None or recorded.meta["things"][decisions["target"][k]] == told.target
        assert (decisions["frame"][k], decisions["ok"][k], decisions["frames"][k]) == (told.frame, told.ok, told.frames)
    assert len(recorded.meta["prompts"]) == len(recorded.result.decisions) == len(decisions["features"])


def test_what_a_teacher_knows_is_kept_apart(recorded: Demonstration) -> None:
    """The target that it was told of is unknown in features and prompt; its place is under privileged/ alone."""
    name = recorded.result.decisions[0].target
    slot = recorded.meta["targets"].index(name)
    decisions, truth = recorded.decisions, recorded.privileged()
    assert decisions["option"][0] == slot and not decisions["mask"][0, slot]
    assert re.search(rf"- {name}: worth \d, not seen yet\n", recorded.meta["prompts"][0]["text"])
    assert truth["position"].shape == (2, len(recorded.meta["targets"]), 3)
    assert truth["best"][0] == pytest.approx(recorded.meta["reach"]) and 0.0 < truth["best"][0] <= 1.0
    worth = truth["option_value"][0]
    assert np.nanmax(worth) <= truth["best"][0] + 1e-6 and worth[-1] == 0.0  # to stop rescues nothing


@pytest.mark.long
def test_features_are_those_of_an_agent_that_is_told_nothing() -> None:
    """Two recorders of one episode: one beside a teacher that may tell the map, one that reads the map itself."""
    episode = EpisodeOptions(agent="tests.evaluation.test_play:Short", seed=11, scene="kitchen_a/03")
    apart, direct = Recorder(privileged=True), Recorder(privileged=False)
    play(episode, [apart, direct])
    for name, numbers in direct.decisions().items():
        assert np.array_equal(apart.decisions()[name], numbers), name
    assert apart.meta()["prompts"] == direct.meta()["prompts"] and direct.decisions()["mask"].any()


def test_pictures_are_those_of_the_head_camera(recorded: Demonstration) -> None:
    names = sorted(path.name for path in (recorded.folder / "depth").iterdir())
    assert names == [f"{t:06d}.png" for t in range(0, recorded.result.frames + 1, EVERY)]
    assert names == sorted(path.name for path in (recorded.folder / "labels").iterdir())
    env = SkillEnv.make("HazardFire-v1")
    env.reset(seed=EPISODE.seed, options=EPISODE.reset_options)
    rgb, view = env.base.observer.look()
    film = cv2.VideoCapture(str(recorded.video))
    assert film.get(cv2.CAP_PROP_FPS) == pytest.approx(recorded.meta["fps"] / EVERY)
    pictures = []
    while (read := film.read())[0]:
        pictures.append(read[1][..., ::-1])
    assert len(pictures) == len(names)
    assert np.abs(pictures[0].astype(float) - rgb.cpu().numpy()).mean() < 4.0  # of 255: what compression costs
    depth = cv2.imread(str(recorded.folder / "depth" / names[0]), cv2.IMREAD_UNCHANGED)
    assert depth.dtype == np.uint16 and np.abs(depth * 1e-3 - view.depth).max() <= 0.0005 + 1e-6
    labels = cv2.imread(str(recorded.folder / "labels" / names[0]), cv2.IMREAD_UNCHANGED).astype(int)
    assert view.labels is not None and len(np.unique(labels)) > 5
    assert np.array_equal(np.where(labels == NO_LABEL, -3, labels - LABEL_SHIFT), view.labels)
    env.close()


def test_the_entry_says_what_the_episode_is(recorded: Demonstration) -> None:
    (entry,) = entries(recorded.folder.parent)
    assert entry.name == "kitchen_a-03-s000011" == recorded.folder.name and entry.frames == recorded.result.frames
    assert entry.recipe["obs"] == "state+rgb+depth+segmentation" and entry.recipe["every"] == EVERY
    assert recorded.meta["privileged"] is True and recorded.meta["teacher"] == EPISODE.agent
    written = json.loads((recorded.folder / "episode.json").read_bytes())["result"]
    assert (written["wall_seconds"], written["versions"], written["machine"]) == (0.0, {}, {})
