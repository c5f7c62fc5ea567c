"""ManiSkill's own command-line tools, with our tasks and robots known to them.

    python -m hazard_ms.cli.maniskill replay_trajectory --traj-path trajectory.h5 --use-env-states
    python -m hazard_ms.cli.maniskill demo_random_action -e HazardFlood-v1 --render-backend cpu
    python -m hazard_ms.cli.maniskill --load my_tasks.py demo_random_action -e MyTask-v1

The first argument that is not ours names a module of ManiSkill, by its last part or in full; all others are its own.
"""

from __future__ import annotations

import argparse
import importlib.util
import pkgutil
import runpy
import sys
from collections.abc import Sequence

from hazard_ms.spec.registry import find, load_plugin

PACKAGES = ("mani_skill.trajectory", "mani_skill.examples", "mani_skill.utils")  # where short names are looked up


def modules() -> dict[str, str]:
    """Modules of ManiSkill that can be run: last part of the name -> full name."""
    found: dict[str, str] = {}
    for package in PACKAGES:
        spec = importlib.util.find_spec(package)
        for module in pkgutil.iter_modules(spec.submodule_search_locations if spec else None):
            if not module.ispkg:
                found.setdefault(module.name, f"{package}.{module.name}")
    return found


def full_name(module: str) -> str:
    """The full name of the module that is called `module`. Raises ValueError for one that ManiSkill does not have."""
    if "." in module:
        if module.startswith("mani_skill.") and importlib.util.find_spec(module) is not None:
            return module
        raise ValueError(f"MODULE must be a module of mani_skill, got {module!r}")
    return find(modules(), module, "MODULE")


def main(arguments: Sequence[str] | None = None) -> None:
    """Run a module of ManiSkill as its own command would."""
    parser = argparse.ArgumentParser(
        prog="python -m hazard_ms.cli.maniskill",
        description="Run a command-line tool of ManiSkill with hazard_ms imported.",
    )
    parser.add_argument("--load", action="append", default=[], help="file or module that registers tasks or robots")
    parser.add_argument("module", metavar="MODULE", help="replay_trajectory, demo_random_action, demo_robot, ...")
    parser.add_argument("arguments", nargs=argparse.REMAINDER, metavar="...", help="arguments of that module")
    chosen = parser.parse_args(arguments)
    try:
        for plugin in chosen.load:
            load_plugin(plugin)
        name = full_name(chosen.module)
    except ValueError as error:
        parser.error(str(error))
    sys.argv = [name, *chosen.arguments]
    runpy.run_module(name, run_name="__main__", alter_sys=True)


if __name__ == "__main__":
    main()
