"""Names of ManiSkill and SAPIEN that they do not document are imported in one file, and all stand on one page."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from hazard_ms.spec import undocumented
from tests.project import maniskill_names as names
from tests.project.imports import PACKAGE, ROOT

PAGE = ROOT / "docs/maniskill_internals.md"
ONE = PACKAGE / "spec/undocumented.py"


def rows(heading: str) -> list[list[str]]:
    """The rows of the table below a heading of the page, cells as text."""
    section = PAGE.read_text(encoding="utf-8").split(f"## {heading}\n")[1].split("\n## ")[0]
    return [line.strip("| ").split(" | ") for line in section.splitlines() if line.startswith("| `")]


def coded(cell: str) -> list[str]:
    return re.findall(r"`([^`]+)`", cell)


def test_one_file_alone_imports_what_is_not_documented() -> None:
    found = {path: set(names.undocumented_imports(path)) for path in PACKAGE.rglob("*.py")}
    assert found.pop(ONE) == {f"{module}.{name}" for name, module in undocumented.MODULES.items()}
    assert {str(path): used for path, used in found.items() if used} == {}, "hazard_ms.spec.undocumented has such names"


def test_an_undocumented_import_is_noticed(tmp_path: Path) -> None:
    path = tmp_path / "bad.py"
    path.write_text(
        "import sapien\nfrom mani_skill.utils.structs.pose import Pose\nfrom mani_skill.render import ShaderConfig\n"
        "def late():\n    from mani_skill.render import shaders\n    import sapien._vulkan_tricks\n"
        "from sapien.wrapper.urdf_loader import URDFLoader\nfrom mani_skill.utils.common import _to_tensor\n"
        "import mani_skill_extra, sapien.render\n"
    )
    assert set(names.undocumented_imports(path)) == {
        "mani_skill.render.shaders",
        "sapien._vulkan_tricks",
        "sapien.wrapper.urdf_loader.URDFLoader",
        "mani_skill.utils.common._to_tensor",
    }


def test_the_page_names_all_that_is_imported() -> None:
    told = {
        name: module
        for cells in rows("Names that are imported")
        for name in coded(cells[0])
        for module in coded(cells[1])
    }
    assert told == undocumented.MODULES


def test_the_page_names_all_attributes_and_the_rooms_that_use_them() -> None:
    told = {name: set(coded(cells[2])) for cells in rows("Attributes with an underscore") for name in coded(cells[0])}
    used = names.rooms_by_attribute()
    assert set(told) == set(used)
    for cells in rows("Attributes with an underscore"):
        assert set(coded(cells[2])) == set().union(*(used[name] for name in coded(cells[0]))), cells[0]


def test_attributes_are_found(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Those of ManiSkill's objects everywhere, those of `self` where a class inherits them; hooks are documented."""
    monkeypatch.setattr(names, "module_of", lambda path: f"{path.parent.name}.{path.stem}")
    text = (
        "class A:\n    def _load_scene(self): self._bodies, self._last_obs, b._objs, b._nothing\n"
        "    def _step_action(self): ..."
    )
    found = {}
    for room in ("env", "skills"):
        (tmp_path / room).mkdir()
        (tmp_path / room / "a.py").write_text(text)
        found[room] = set(names.attributes(tmp_path / room / "a.py"))
    assert found == {"env": {"_last_obs", "_objs", "_step_action"}, "skills": {"_objs"}}


def test_all_names_exist_and_one_that_is_gone_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    assert names.gone(set(names.rooms_by_attribute())) == []
    monkeypatch.setitem(undocumented.MODULES, "EnvSpec", "mani_skill.render")
    monkeypatch.setitem(undocumented.MODULES, "AgentSpec", "mani_skill.nothing")
    told = names.gone({"_objs", "_no_such_name"})
    assert [line.split(": ")[0] for line in told] == [
        "mani_skill.nothing.AgentSpec",
        "mani_skill.render.EnvSpec",
        "_no_such_name",
    ]
    with pytest.raises(ImportError, match="mani_skill.render must have EnvSpec, which hazard_ms needs"):
        _ = undocumented.EnvSpec
    with pytest.raises(AttributeError, match="has no 'Nothing': it has BaseController, "):
        _ = undocumented.Nothing
