"""The house rules that a machine can check: imports point one way, no unsafe calls, files stay small."""

from __future__ import annotations

import ast
import subprocess
import sys
from pathlib import Path

import pytest

PACKAGE = Path(__file__).parents[1] / "hazard_ms"
LAYERS = (  # a module may import only from layers to its left, or from its own
    ("__init__",),
    ("catalogue_original", "plain"),
    (
        "spec",
        "checks",
        "casting",
        "machine",
        "vulkan",
        "rendering",
        "drivers",
        "findings",
        "doctor",
        "catalogue",
        "chance",
        "launching",
        "order",
        "evaluating_order",
    ),
    ("assets", "scenes"),
    ("kernels",),
    ("world",),
    ("hazards",),
    ("hand", "guard", "episode", "simulator", "surfaces", "building", "lighting"),
    ("standalone", "settling", "scene_picture", "contact_sheet", "intake", "providers"),
    ("tasks",),
    ("effects",),
    ("sensing",),
    ("robots",),
    ("observing", "rewards", "snapshot"),
    ("env", "wrappers"),
    ("skills",),
    ("agents",),
    ("evaluation",),
    ("play", "bench", "bench_looks", "bench_kernels", "importing", "validation"),
    ("pictures", "evaluating"),
    ("scene_commands", "scene_checks", "cli", "asset_commands"),
)


def layer(module: str) -> int:
    top = module.split(".")[0]
    found = [i for i, names in enumerate(LAYERS) if top in names]
    assert found, f"hazard_ms.{module} stands in no layer of {__file__}"
    return found[0]


def imports(path: Path) -> list[str]:
    """Modules of hazard_ms that the file imports when it runs; those for type checking alone do not count."""
    tree = ast.parse(path.read_text())
    typing_only = {
        id(n)
        for block in ast.walk(tree)
        if isinstance(block, ast.If) and "TYPE_CHECKING" in ast.unparse(block.test)
        for n in ast.walk(block)
    }
    found = []
    for node in ast.walk(tree):
        if id(node) in typing_only:
            continue
        if isinstance(node, ast.ImportFrom) and node.module == "hazard_ms":
            found += [a.name if (PACKAGE / f"{a.name}.py").exists() or (PACKAGE / a.name).is_dir() else "__init__" for a in node.names]
        elif isinstance(node, ast.ImportFrom) and (node.module or "").startswith("hazard_ms."):
            found.append(str(node.module).removeprefix("hazard_ms."))
        elif isinstance(node, ast.Import):
            found += [a.name.removeprefix("hazard_ms.") for a in node.names if a.name.startswith("hazard_ms.")]
    return found


def module_of(path: Path) -> str:
    parts = path.relative_to(PACKAGE).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" and len(parts) > 1 else parts)


@pytest.mark.parametrize("path", sorted(PACKAGE.rglob("*.py")), ids=module_of)
def test_imports_point_one_way(path: Path) -> None:
    mine = module_of(path)
    for used in imports(path):
        assert layer(used) <= layer(mine), f"{mine} imports {used}, which lies above it"


def test_the_import_check_can_fail(tmp_path: Path) -> None:
    bad = tmp_path / "bad.py"
    bad.write_text("from hazard_ms.env import HazardEnv\nfrom hazard_ms import cli\n")
    assert imports(bad) == ["env", "cli"]
    assert layer("env") > layer("hazards.fire")


@pytest.mark.parametrize("path", sorted(PACKAGE.rglob("*.py")), ids=module_of)
def test_files_stay_small(path: Path) -> None:
    assert len(path.read_text().splitlines()) <= 300


def test_importing_the_package_loads_nothing_heavy() -> None:
    """torch, SAPIEN and ManiSkill cost seconds: only making an environment may load them."""
    heavy = ("torch", "warp", "sapien", "mani_skill", "scipy", "numpy", "gymnasium")
    code = f"import sys, hazard_ms; print([m for m in {heavy} if m in sys.modules])"
    out = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, cwd=PACKAGE.parent)
    assert out.stdout.strip() == "[]"


@pytest.mark.parametrize(
    "imports",
    [
        "import hazard_ms, gymnasium",
        "import gymnasium, hazard_ms",
        "import hazard_ms; from gymnasium.envs.registration import registry; import gymnasium",
    ],
)
def test_the_environments_are_registered_in_whatever_order_things_are_imported(imports: str) -> None:
    code = f"{imports}; print(gymnasium.spec('HazardFire-v1').max_episode_steps)"
    out = subprocess.run([sys.executable, "-W", "error", "-c", code], capture_output=True, text=True, check=True, cwd=PACKAGE.parent)
    assert out.stdout.strip() == "1500"
