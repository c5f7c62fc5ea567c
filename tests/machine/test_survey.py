"""Which driver descriptions the Vulkan loader reads, in a folder that stands for a machine."""

from __future__ import annotations

from pathlib import Path

from hazard_ms.machine.survey import manifest_paths


def test_a_variable_replaces_the_folders_of_the_system(tmp_path: Path) -> None:
    """As the loader's documentation says: VK_DRIVER_FILES, else the older VK_ICD_FILENAMES, else the folders."""
    system, own = tmp_path / "usr/share/vulkan/icd.d", tmp_path / "own"
    for folder, names in ((system, ("b.json", "a.json", "read.me")), (own, ("c.json", "d.json"))):
        folder.mkdir(parents=True)
        for name in names:
            (folder / name).write_text("{}")
    usual = [system / "a.json", system / "b.json"]
    assert manifest_paths(tmp_path, {}) == usual
    assert manifest_paths(tmp_path, {"VK_DRIVER_FILES": ""}) == usual  # empty counts as unset
    assert manifest_paths(tmp_path, {"VK_ICD_FILENAMES": str(own / "c.json")}) == [own / "c.json"]
    both = {"VK_ICD_FILENAMES": str(own / "c.json"), "VK_DRIVER_FILES": f"{own / 'd.json'}:{system}"}
    assert manifest_paths(tmp_path, both) == [own / "d.json", *usual]
