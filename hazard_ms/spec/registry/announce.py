"""Makes registered tasks and robots known to gymnasium and ManiSkill, now or as soon as these are imported.

Importing them here would cost every `import hazard_ms` seconds.
"""

from __future__ import annotations

import dataclasses
import importlib.util
import sys
from collections.abc import Callable, Sequence
from importlib.abc import MetaPathFinder
from importlib.machinery import ModuleSpec
from types import ModuleType
from typing import Any

from hazard_ms.spec import registry
from hazard_ms.spec.registry import Entry, RobotEntry, TaskEntry

ENVIRONMENT = "hazard_ms.env:HazardEnv"
SKILLS = "hazard_ms.sketch.environments.making:make"
MANY_SKILLS = "hazard_ms.sketch.environments.making:make_vector"


class _After(MetaPathFinder):
    """Calls a function once a module has been imported."""

    def __init__(self, module: str, then: Callable[[], None]) -> None:
        self._module, self._then = module, then

    def find_spec(self, name: str, path: Sequence[str] | None, target: ModuleType | None = None) -> ModuleSpec | None:
        if name != self._module:
            return None
        sys.meta_path.remove(self)
        spec = importlib.util.find_spec(name)
        if spec is not None and spec.loader is not None:
            loader: Any = spec.loader
            run = loader.exec_module

            def run_and_tell(module: ModuleType) -> None:
                run(module)
                self._then()

            loader.exec_module = run_and_tell
        return spec


def when_imported(module: str, then: Callable[[], None]) -> None:
    """Call `then` once `module` has been imported: now, if it has been."""
    if module in sys.modules:
        then()
    else:
        sys.meta_path.insert(0, _After(module, then))


def skills_id(task: str) -> str:
    """The id of a task's environment of skills: HazardFireSkills-v1 for HazardFire-v1."""
    name, _, version = task.rpartition("-v")
    return f"{name}Skills-v{version}"


def tell_gymnasium() -> None:
    """Register every task, present and future, with gymnasium."""
    import gymnasium
    from gymnasium.envs.registration import WrapperSpec

    def added(entry: Entry) -> None:
        if isinstance(entry, TaskEntry) and entry.name not in gymnasium.registry:
            gymnasium.register(
                id=entry.name,
                entry_point=ENVIRONMENT,
                max_episode_steps=entry.max_frames,
                disable_env_checker=True,  # it is written for unbatched numpy: see hazard_ms.NumpyEnv
                kwargs={"task": entry.name},
                additional_wrappers=(WrapperSpec("TimeLimit", "hazard_ms.env.time_limit:TimeLimit", kwargs={}),),
            )
            gymnasium.register(
                id=skills_id(entry.name),
                entry_point=SKILLS,
                vector_entry_point=MANY_SKILLS,
                kwargs={"task": entry.name},
            )

    def removed(entry: Entry) -> None:
        if isinstance(entry, TaskEntry):
            gymnasium.registry.pop(entry.name, None)
            gymnasium.registry.pop(skills_id(entry.name), None)

    registry.follow(added, removed)


def importable(spec: Any) -> Any:
    """Gymnasium's `spec` of one of our own tasks, with an id that says what to import: "hazard_ms:HazardFire-v1".

    A program that reads the id in a file, such as ManiSkill's replay_trajectory, makes the environment without knowing
    us. The spec of another's task is returned as it is: what has to be imported for it is not known.
    """
    entry = registry.TASKS.get(spec.id)
    ours = entry is not None and isinstance(entry.maker, str) and entry.maker.startswith("hazard_ms.")
    return dataclasses.replace(spec, id=f"hazard_ms:{spec.id}") if ours else spec


def tell_maniskill_of_tasks() -> None:
    """Put every task, present and future, into ManiSkill's REGISTERED_ENVS; the environment is imported on demand."""
    from hazard_ms.spec.undocumented import REGISTERED_ENVS, EnvSpec

    class Spec(EnvSpec):
        """Knows the class of the environment, which must not be imported yet, only when it is asked for it."""

        def __init__(self, entry: TaskEntry) -> None:
            super().__init__(entry.name, object, entry.max_frames, [], {"task": entry.name})
            del self.cls

        def __getattr__(self, name: str) -> Any:
            if name != "cls":
                raise AttributeError(name)
            self.cls = registry.load(ENVIRONMENT)
            return self.cls

    def added(entry: Entry) -> None:
        if isinstance(entry, TaskEntry):
            REGISTERED_ENVS.setdefault(entry.name, Spec(entry))

    registry.follow(added, lambda entry: REGISTERED_ENVS.pop(entry.name, None))


def tell_maniskill_of_robots() -> None:
    """Put every robot, present and future, into ManiSkill's REGISTERED_AGENTS; its class is imported on demand."""
    from hazard_ms.spec.undocumented import REGISTERED_AGENTS, AgentSpec

    class Spec(AgentSpec):
        """Knows the class of the robot, which must not be imported yet, only when it is asked for it."""

        def __init__(self, robot: Any) -> None:
            self._robot = robot
            self.asset_download_ids: list[str] = []

        def __getattr__(self, name: str) -> Any:
            if name != "agent_cls":
                raise AttributeError(name)
            self.agent_cls = registry.load(self._robot)
            return self.agent_cls

    def added(entry: Entry) -> None:
        if isinstance(entry, RobotEntry):
            REGISTERED_AGENTS.setdefault(entry.uid, Spec(entry.robot))

    def removed(entry: Entry) -> None:
        if isinstance(entry, RobotEntry):
            REGISTERED_AGENTS.pop(entry.uid, None)

    registry.follow(added, removed)


def announce() -> None:
    """Let gymnasium and ManiSkill know all that is registered, as soon as they are imported."""
    when_imported("gymnasium", tell_gymnasium)
    when_imported("mani_skill.utils.registration", tell_maniskill_of_tasks)
    when_imported("mani_skill.agents.registration", tell_maniskill_of_robots)
