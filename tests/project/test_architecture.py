"""The house rules that a machine can check: imports point one way and in no circle, rooms are few, files small."""

from __future__ import annotations

import ast
import subprocess
import sys
from pathlib import Path

import pytest

from tests.project.imports import PACKAGE, ROOT, arrows, circles, graph, imports, module_of, modules, room, rooms

LAYERS = (  # a room may import only from rooms to its left, or from those beside it
    ("spec", "machine"),
    ("__init__",),
    ("scenes",),
    ("simulation",),
    ("robots",),
    ("hazards",),
    ("effects", "tasks"),
    ("sensing",),
    ("env",),
    ("skills", "lerobot"),
    ("sketch",),
    ("agents",),
    ("evaluation",),
    ("pictures", "demonstrations", "learning", "perception"),
    ("validation",),
    ("cli",),
)
MOST_ROOMS = 24
MOST_ARROWS = 109  # pairs of rooms of which one imports from the other: for a new one, another must go
MOST_FILES = 16  # of a folder
MOST_LINES = 250  # of a file
HEAVY = ("torch", "warp", "sapien", "mani_skill", "scipy", "numpy", "gymnasium")  # that take seconds to import
FILES = sorted(PACKAGE.rglob("*.py"))


def layer(module: str) -> int:
    found = [i for i, names in enumerate(LAYERS) if room(module) in names]
    assert found, f"hazard_ms.{module} must stand in a layer of {__file__}"
    return found[0]


@pytest.mark.parametrize("module", modules())
def test_imports_point_one_way(module: str) -> None:
    """Those inside functions and for type checking, too."""
    for used in graph()[module]:
        assert layer(used) <= layer(module), f"{module} imports {used}, which lies above it"


def test_no_module_imports_itself_through_others() -> None:
    assert circles(graph()) == []


def test_no_room_imports_itself_through_others() -> None:
    edges: dict[str, set[str]] = {}
    for a, b in arrows():
        edges.setdefault(a, set()).add(b)
    assert circles(edges) == []


def test_the_rooms_are_few_and_so_are_the_ways_between_them() -> None:
    assert len(rooms()) <= MOST_ROOMS, rooms()
    assert len(arrows()) <= MOST_ARROWS, sorted(arrows())


def test_the_checks_can_fail(tmp_path: Path) -> None:
    bad = tmp_path / "bad.py"
    bad.write_text(
        "from typing import TYPE_CHECKING\nfrom hazard_ms.scenes import choice\nimport hazard_ms.spec\n"
        "if TYPE_CHECKING:\n    from hazard_ms.env import HazardEnv\n"
        "def late():\n    from hazard_ms import cli, __version__\n"
    )
    assert set(imports(bad, modules())) == {"scenes.choice", "spec", "env", "cli", "__init__"}
    assert layer("env") > layer("hazards.fire") > layer("spec")
    assert circles({"a": {"b"}, "b": {"c"}, "c": {"a", "d"}, "d": set()}) == [["a", "b", "c"]]
    assert circles({"a": {"b", "c"}, "b": {"c"}, "c": set()}) == []


def test_folders_are_small() -> None:
    sizes = {folder: len(list(folder.glob("*.py"))) for folder in {path.parent for path in FILES}}
    assert {str(folder): size for folder, size in sizes.items() if size > MOST_FILES} == {}


def test_files_are_small() -> None:
    every = [*FILES, *(ROOT / "tests").rglob("*.py"), *(ROOT / "examples").glob("*.py")]
    lengths = {str(path.relative_to(ROOT)): len(path.read_text().splitlines()) for path in every}
    assert {name: length for name, length in lengths.items() if length > MOST_LINES} == {}


def test_the_oracle_alone_of_all_agents_can_know_the_future() -> None:
    """Imports through other modules count, too."""

    def used(module: str, seen: set[str]) -> set[str]:
        for other in graph()[module] - seen:
            seen |= {other} | used(other, seen | {other})
        return seen

    future = {"sketch.timeline", "sketch.recording"}
    mitigating = {f"agents.mitigating.{name}" for name in ("barred", "choice", "doing", "prospects")}  # of the oracle
    gale = {"agents.gale.truth"}
    judge = {"agents.aims", "agents.action_values", "agents.judge"}  # of decisions, which regret asks
    privileged = {module for module in modules() if room(module) == "agents" and used(module, set()) & future}
    assert privileged == {"agents.oracle", "agents.teams.oracle", "agents.truth", *judge, *mitigating, *gale}


def test_nobody_reaches_into_an_environment() -> None:
    """`env._x` belongs to the environment: others ask its public parts."""
    owners = ("env", "base", "unwrapped")
    for path in FILES:
        if room(module_of(path)) == "env":
            continue
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.Attribute) and node.attr.startswith("_") and not node.attr.startswith("__"):
                owner = node.value
                name = owner.id if isinstance(owner, ast.Name) else getattr(owner, "attr", "")
                assert name not in owners, f"{path.relative_to(ROOT)}:{node.lineno} reads {name}.{node.attr}"


def test_importing_the_package_loads_nothing_heavy() -> None:
    """torch, SAPIEN and ManiSkill cost seconds: only making an environment may load them."""
    code = f"import sys, hazard_ms, hazard_ms.spec.registry; print([m for m in {HEAVY} if m in sys.modules])"
    out = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, cwd=ROOT)
    assert out.stdout.strip() == "[]"


@pytest.mark.parametrize(
    "order",
    [
        "import hazard_ms, gymnasium",
        "import gymnasium, hazard_ms",
        "import hazard_ms; from gymnasium.envs.registration import registry; import gymnasium",
    ],
)
def test_the_environments_are_registered_in_whatever_order_things_are_imported(order: str) -> None:
    code = f"{order}; print(gymnasium.spec('HazardFire-v1').max_episode_steps)"
    out = subprocess.run(
        [sys.executable, "-W", "error", "-c", code], capture_output=True, text=True, check=True, cwd=ROOT
    )
    assert out.stdout.strip() == "1500"
