"""Names are registered once, found everywhere, and taken back everywhere; plugins are files or modules."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from typing import Any

import gymnasium as gym
import pytest

import hazard_ms
from hazard_ms.spec import registry
from hazard_ms.spec.checks import one_of
from hazard_ms.tasks import task_of
from tests.worlds.registering import loaded, registered_task

ROOT = Path(__file__).parents[3]
PLUGIN = """
import hazard_ms
hazard_ms.register_task("HazardPlugin-v7", "hazard_ms.tasks.flood:hazard_flood", max_frames=70)
hazard_ms.register_agent("plugged", "hazard_ms.agents.random:Random")
"""


def test_what_is_registered_is_known_to_gymnasium_as_long_as_it_is() -> None:
    with registered_task("HazardTwin-v3", "hazard_ms.tasks.fire:hazard_fire", 40) as name:
        assert gym.spec(name).max_episode_steps == 40 == task_of(name, "paper").max_frames
        assert task_of(name, "paper").name == name
        registry.register_task(name, "hazard_ms.tasks.fire:hazard_fire", 40)  # the same again
        with pytest.raises(ValueError, match="must be new, got 'HazardTwin-v3'"):
            registry.register_task(name, "hazard_ms.tasks.fire:hazard_fire", 41)
    assert name not in registry.TASKS and name not in gym.registry
    with pytest.raises(KeyError, match="HazardTwin-v3"):
        registry.unregister(registry.TaskEntry(name, None))


def test_maniskill_knows_tasks_and_robots_once_it_is_imported() -> None:
    """In a process of its own; the classes behind the names are imported only when they are asked for."""
    code = (
        "import sys, hazard_ms\n"
        "import mani_skill.envs\n"
        "from mani_skill.utils.registration import REGISTERED_ENVS\n"
        "from mani_skill.agents.registration import REGISTERED_AGENTS\n"
        "hazard_ms.register_task('HazardLate-v0', 'hazard_ms.tasks.fire:hazard_fire', 9)\n"
        "early = 'hazard_ms.env' in sys.modules, 'hazard_ms.robots.fetch' in sys.modules\n"
        "late = REGISTERED_ENVS['HazardLate-v0']\n"
        "print(early, late.max_episode_steps, late.default_kwargs, late.cls.__name__)\n"
        "print(REGISTERED_AGENTS['hazard_fetch'].agent_cls.__name__, REGISTERED_AGENTS['hazard_g1'].agent_cls.uid)\n"
    )
    out = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, cwd=ROOT)
    assert out.stdout.splitlines() == [
        "(False, False) 9 {'task': 'HazardLate-v0'} HazardEnv",
        "HazardFetch hazard_g1",
    ]
    assert "already registered" not in out.stderr


@pytest.mark.parametrize(
    ("kind", "name", "told"),
    [
        ("task", "HazardFire", "must look like 'Name-v0', got 'HazardFire'"),
        ("task", "a b-v1", "must look like 'Name-v0'"),
        ("task", None, "must look like 'Name-v0', got None"),
        ("hazard", "earth quake", "must look like 'name', got 'earth quake'"),
        ("agent", "mine:Mine", "must look like 'name' or 'group/name', got 'mine:Mine'"),
        ("agent", "paper/", "must look like 'name' or 'group/name'"),
        ("agent", "/greedy", "must look like 'name' or 'group/name'"),
        ("agent", "a/b/c", "must look like 'name' or 'group/name'"),
        ("agent", "../greedy", "must look like 'name' or 'group/name'"),
        ("hazard", "earth/quake", "must look like 'name', got 'earth/quake'"),
        ("robot", "", "must look like 'name', got ''"),
        ("hazard", "fire", "must be new, got 'fire'"),
        ("agent", "greedy", "must be new, got 'greedy'"),
    ],
)
def test_names_that_cannot_be_are_refused(kind: str, name: Any, told: str) -> None:
    with pytest.raises(ValueError, match=told):
        getattr(hazard_ms, f"register_{kind}")(name, "package.module:thing")


@pytest.mark.parametrize("frames", [0, -1, 1.5, True, "9"])
def test_lengths_that_cannot_be_are_refused(frames: Any) -> None:
    with pytest.raises(ValueError, match="max_frames must be a whole number from 1"):
        registry.register_task("HazardLength-v0", "package.module:thing", frames)
    with pytest.raises(ValueError, match=r"split_frames\['hard'\] must be a whole number from 1"):
        registry.register_task("HazardLength-v0", "package.module:thing", 9, {"hard": frames})
    assert "HazardLength-v0" not in registry.TASKS


def test_the_tables_cannot_be_written_past_the_registry() -> None:
    with pytest.raises(TypeError):
        registry.TASKS["HazardPast-v0"] = None  # type: ignore[index]


def test_every_entry_of_the_package_can_be_loaded() -> None:
    entries = [
        *registry.TASKS.values(),
        *registry.HAZARDS.values(),
        *registry.ROBOTS.values(),
        *registry.AGENTS.values(),
    ]
    for entry in entries:
        for value in vars(entry).values():
            for text in value if isinstance(value, tuple) else (value,):
                if isinstance(text, str) and ":" in text:
                    assert callable(registry.load(text)), text
    assert {registry.load(r.robot).uid for r in registry.ROBOTS.values()} == {r.uid for r in registry.ROBOTS.values()}


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("hazard_ms.tasks.fire", "must be package.module:attribute"),
        (":thing", "must be package.module:attribute"),
        ("hazard_ms.no_such:thing", "module that can be imported"),
        ("hazard_ms.tasks.fire:no_such", "attribute of hazard_ms.tasks.fire"),
    ],
)
def test_texts_that_name_nothing_are_refused(text: str, told: str) -> None:
    with pytest.raises(ValueError, match=told):
        registry.load(text)


def test_an_unknown_name_is_told_with_the_nearest() -> None:
    with pytest.raises(ValueError, match=r"task must be one of .*HazardFlood-v1.*'HazardFlod-v1'.*HazardFlood-v1"):
        registry.find(registry.TASKS, "HazardFlod-v1", "task")
    assert registry.find(registry.AGENTS, one_of("greedy", registry.AGENTS, "agent"), "agent").name == "greedy"


def test_a_maker_must_give_what_it_is_registered_for() -> None:
    with (
        registered_task("HazardOdd-v0", lambda physics: "no task") as name,
        pytest.raises(ValueError, match="must return a Task, got str"),
    ):
        task_of(name, "paper")


def test_a_plugin_is_a_file_that_runs_once_or_a_module(tmp_path: Path) -> None:
    file = tmp_path / "plugin.py"
    file.write_text(PLUGIN)
    with loaded(file) as module:
        assert registry.load_plugin(str(file)) is module
        assert registry.TASKS["HazardPlugin-v7"].max_frames == 70 and "plugged" in registry.AGENTS
    assert "HazardPlugin-v7" not in registry.TASKS and "plugged" not in registry.AGENTS
    assert registry.load_plugin("hazard_ms.spec.registry") is registry
    for wrong in (str(tmp_path / "absent.py"), "no_such_module", "no/such/path"):
        with pytest.raises(ValueError, match="load must be"):
            registry.load_plugin(wrong)
    file.write_text("1 / 0")
    for _ in range(2):  # a plugin that failed is not taken for loaded
        with pytest.raises(ZeroDivisionError):
            registry.load_plugin(str(file))


def test_names_at_the_top_of_the_package_are_imported_on_demand() -> None:
    for name in hazard_ms.__all__:
        assert getattr(hazard_ms, name) is not None and name in dir(hazard_ms)
    with pytest.raises(AttributeError, match="'Acton'"):
        hazard_ms.Acton  # noqa: B018
