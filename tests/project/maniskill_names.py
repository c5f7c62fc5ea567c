"""What hazard_ms uses of ManiSkill and SAPIEN: modules that they document, and names that they do not.

As a program it says which of the latter are gone from what is installed here, a line each, and ends with 1 if any is.
"""

from __future__ import annotations

import ast
import importlib.util
import sys
from collections.abc import Iterator
from functools import cache
from pathlib import Path

from hazard_ms.spec.undocumented import MODULES
from tests.project.imports import PACKAGE, module_of, room

THEIRS = ("mani_skill", "sapien")
# what the reference of ManiSkill 3, its guides for tasks, robots, controllers, sensors and wrappers, and the manual of
# SAPIEN name: a module, or one name of a module; what ends with a dot stands for all below it
DOCUMENTED = (
    "mani_skill",
    "mani_skill.envs",
    "mani_skill.envs.sapien_env",
    "mani_skill.envs.scene",
    "mani_skill.agents.base_agent",
    "mani_skill.agents.multi_agent",
    "mani_skill.agents.controllers",
    "mani_skill.agents.registration.register_agent",
    "mani_skill.agents.robots.",
    "mani_skill.sensors.camera",
    "mani_skill.render.ShaderConfig",
    "mani_skill.utils.building.",
    "mani_skill.utils.common",
    "mani_skill.utils.registration.register_env",
    "mani_skill.utils.sapien_utils",
    "mani_skill.utils.structs",
    "mani_skill.utils.structs.",
    "mani_skill.utils.wrappers.",
    "sapien",
    "sapien.physx",
    "sapien.render",
)
# methods that ManiSkill's templates and guides tell tasks, robots and controllers to write
HOOKS = {
    "_after_control_step",
    "_after_init",
    "_after_reconfigure",
    "_after_simulation_step",
    "_before_control_step",
    "_before_simulation_step",
    "_controller_configs",
    "_default_human_render_camera_configs",
    "_default_sensor_configs",
    "_default_sim_config",
    "_get_obs_extra",
    "_initialize_episode",
    "_load_agent",
    "_load_lighting",
    "_load_scene",
    "_sensor_configs",
}
INHERITED = {"env": "envs", "robots": "agents", "effects": "sensors"}  # rooms with subclasses of ManiSkill's: of which


def undocumented_imports(path: Path) -> Iterator[str]:
    """Names that a file imports of ManiSkill and SAPIEN and that are not DOCUMENTED."""
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            named = [(alias.name, alias.name) for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            named = [(str(node.module), f"{node.module}.{alias.name}") for alias in node.names]
        else:
            continue
        for module, name in named:
            if module.split(".")[0] in THEIRS and not is_documented(module, name):
                yield name


def is_documented(module: str, name: str) -> bool:
    """Whether DOCUMENTED has the module, or the name in it; names with an underscore never are."""
    if any(part.startswith("_") for part in name.split(".")):
        return False
    return any(one in (module, name) or (one.endswith(".") and module.startswith(one)) for one in DOCUMENTED)


@cache
def private_names(*below: str) -> set[str]:
    """Names with one underscore that the Python code of a package of theirs defines, or of a folder in it."""
    spec = importlib.util.find_spec(below[0])
    assert spec is not None and spec.submodule_search_locations
    found: set[str] = set()
    for path in Path(spec.submodule_search_locations[0], *below[1:]).rglob("*.py*"):
        if path.suffix in (".py", ".pyi") and "examples" not in path.parts:
            for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
                if isinstance(node, ast.FunctionDef):
                    found.add(node.name)
                elif isinstance(node, ast.Attribute) and isinstance(node.ctx, ast.Store):
                    found.add(node.attr)
                elif isinstance(node, ast.AnnAssign) and isinstance(node.target, ast.Name):
                    found.add(node.target.id)
    return {name for name in found if name.startswith("_") and not name.startswith("__")}


def attributes(path: Path) -> Iterator[str]:
    """Private names of ManiSkill and SAPIEN that a file of hazard_ms reads, sets, calls or overrides; without HOOKS.

    Of `self` they count in the rooms that have subclasses of ManiSkill's.
    """
    parts = INHERITED.get(room(module_of(path)))
    every = private_names(THEIRS[0]) | private_names(THEIRS[1])
    own = private_names("mani_skill", parts) if parts else set[str]()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Attribute):
            of_self = isinstance(node.value, ast.Name) and node.value.id in ("self", "cls")
            if node.attr in (own if of_self else every) - HOOKS:
                yield node.attr
        elif isinstance(node, ast.ClassDef):
            yield from {f.name for f in node.body if isinstance(f, ast.FunctionDef)} & (own - HOOKS)


@cache
def rooms_by_attribute() -> dict[str, set[str]]:
    """Private names of theirs that hazard_ms uses -> its rooms that do."""
    found: dict[str, set[str]] = {}
    for path in sorted(PACKAGE.rglob("*.py")):
        for name in attributes(path):
            found.setdefault(name, set()).add(room(module_of(path)))
    return found


def gone(attributes: set[str]) -> list[str]:
    """Those of the names in MODULES that cannot be imported, and of `attributes` that nothing of theirs defines."""
    from hazard_ms.spec import undocumented

    lines = []
    for name, module in MODULES.items():
        try:
            getattr(undocumented, name)
        except ImportError as error:
            lines.append(f"{module}.{name}: {error}")
    every = {name for package in THEIRS for name in private_names(package)}
    return lines + [f"{name}: no code defines it" for name in sorted(attributes - every)]


if __name__ == "__main__":
    missing = gone(set(sys.argv[1:]))
    print("\n".join(missing))
    sys.exit(bool(missing))
