"""Tasks played in scenes from files: those of the original benchmark, imported."""

from __future__ import annotations

import copy
import dataclasses
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import gymnasium as gym
import pytest

import hazard_ms  # noqa: F401 registers the environments
from hazard_ms.agents.base import agent
from hazard_ms.scenes.files import read_scenes
from hazard_ms.scenes.original.read import read
from hazard_ms.scenes.schema import to_json
from hazard_ms.skills.decision import PICK_UP
from hazard_ms.skills.executor import SkillEnv
from tests.worlds.files.original_folders import FIRE_INFO, FLOOD, add, folder, kitchen

ORIGINAL = Path(__file__).parents[3] / "shared" / "hazard_original" / "indoor"
INDOORS = ("mm_kitchen_2a-1", "mm_craftroom_3a-14")
published = pytest.mark.skipif(not ORIGINAL.exists(), reason="the original benchmark's scenes are not here")


@pytest.fixture(scope="module")
def scenes(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder of two scenes that hold 3 and 5 bodies."""
    made = tmp_path_factory.mktemp("original")
    fuller = [
        *copy.deepcopy(kitchen()),
        add(8, "apple", "apple", (-1.0, 0.0, 0.0)),
        add(9, "apple", "apple", (-1.0, 0.0, 1.0)),
    ]
    for name, log in (("mm_kitchen_2a-2", kitchen()), ("mm_kitchen_2a-10", fuller)):
        spec = read(folder(made / name, log, FIRE_INFO, FLOOD)).spec
        (made / f"{name}.json").write_text(to_json(spec))
    return made


@pytest.fixture(scope="module")
def env(scenes: Path) -> Iterator[Any]:
    made = gym.make("HazardFire-v1", scenes=scenes, obs_mode="none", render_backend="none")
    yield made
    made.close()


def test_seeds_choose_among_the_files(env: Any) -> None:
    for seed, (name, bodies) in enumerate([("mm_kitchen_2a-2", 3), ("mm_kitchen_2a-10", 5), ("mm_kitchen_2a-2", 3)]):
        env.reset(seed=seed)
        (spec,) = env.unwrapped.specs
        assert (spec.name, len(spec.bodies)) == (name, bodies)
        assert int(env.unwrapped.world.movable.sum()) == bodies
        env.step(env.action_space.sample() * 0)


def test_a_file_is_chosen_by_its_scene(env: Any) -> None:
    env.reset(seed=0, options={"scene": "mm_kitchen_2a-10"})
    assert env.unwrapped.specs[0].name == "mm_kitchen_2a-10"
    with pytest.raises(ValueError, match="must be one of mm_kitchen_2a-2, mm_kitchen_2a-10, got 'kitchen_a/00'"):
        env.reset(seed=0, options={"scene": "kitchen_a/00"})


def test_files_and_folders_and_lists(scenes: Path, tmp_path: Path) -> None:
    one, both = scenes / "mm_kitchen_2a-10.json", ("mm_kitchen_2a-2", "mm_kitchen_2a-10")
    assert tuple(read_scenes(str(one))) == both[1:]
    assert tuple(read_scenes([one, scenes / "mm_kitchen_2a-2.json"])) == both[::-1]
    assert tuple(read_scenes(scenes)) == both  # 2 before 10
    broken = tmp_path / "broken.json"
    broken.write_text("{")
    (tmp_path / "empty").mkdir()
    for bad, message in (
        (broken, "broken.json: a scene must be valid JSON"),
        (tmp_path / "none.json", "there is no file .*none.json"),
        (tmp_path / "empty", r"files \*.json, got 0"),
        ([one, one], "twice"),
        ([], "a JSON file, a folder of them, or a list"),
        (7, "got 7"),
        ([7], r"got \[7\]"),
    ):
        with pytest.raises(ValueError, match=message):
            read_scenes(bad)


def test_plain_shapes_collide_where_they_are_drawn(env: Any) -> None:
    """The jar rests on the cabinet's floor, inside of its walls, and the pot on its top, 0.92142 m high."""
    env.reset(seed=0)
    for _ in range(30):
        env.step(env.action_space.sample() * 0)
    base = env.unwrapped
    world, spec = base.world, base.specs[0]
    for i, b in enumerate(spec.bodies):
        bottom = float(world.position[0, i, 2] - world.extent[0, i, 2] / 2)
        low = {"pot_2": 0.92142, "jar_3": 0.101, "bottle_5": 0.0}[b.name]
        assert bottom == pytest.approx(low, abs=4e-3), b.name
        assert world.position[0, i, :2].tolist() == pytest.approx(b.position[:2], abs=5e-3)


@published
@pytest.mark.parametrize("name", INDOORS)
def test_fire_in_published_scenes(name: str, tmp_path: Path) -> None:
    spec = read(ORIGINAL / name).spec
    (tmp_path / "one.json").write_text(to_json(spec))
    env = gym.make("HazardFire-v1", scenes=tmp_path / "one.json", obs_mode="none", render_backend="none")
    env.reset(seed=0)
    for _ in range(60):
        _, _, terminated, truncated, info = env.step(env.action_space.sample() * 0)
        assert not info["sim_error"] and not terminated and not truncated
    assert int(info["targets"]) == len(spec.targets)
    env.close()


@published
@pytest.mark.long
@pytest.mark.render
@pytest.mark.parametrize("name", INDOORS)
def test_greedy_takes_something_in_published_scenes(name: str, tmp_path: Path) -> None:
    (tmp_path / "one.json").write_text(to_json(read(ORIGINAL / name).spec))
    made = gym.make("HazardFire-v1", scenes=tmp_path / "one.json", obs_mode="none", control_mode="pd_joint_pos")
    env = SkillEnv(made)
    decision, _ = env.reset(seed=0)
    player = agent("greedy")
    player.reset(env.brief())
    over = taken = False
    while not over and not taken:
        action = player.act(decision)
        decision, _, terminated, truncated, info = env.step(action)
        over, taken = bool(terminated or truncated), action.verb == PICK_UP and info["result"].ok
    assert taken
    env.env.close()


def test_the_task_itself_is_not_changed() -> None:
    from hazard_ms.scenes.files import playing
    from hazard_ms.tasks.fire import hazard_fire

    task = hazard_fire()
    assert playing(task, None) is task
    assert {f.name for f in dataclasses.fields(task)} >= {"scenes", "build"}
