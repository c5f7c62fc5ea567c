"""Which driver descriptions the Vulkan loader reads, in a folder that stands for a machine."""

from __future__ import annotations

import json
from pathlib import Path

from hazard_ms.machine.survey import manifest_paths, without_gpu


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


def test_a_process_sees_no_driver_but_lavapipe(tmp_path: Path) -> None:
    folder = tmp_path / "usr/share/vulkan/icd.d"
    folder.mkdir(parents=True)
    libraries = {"lvp_icd.x86_64": "/usr/lib/libvulkan_lvp.so", "nvidia_icd": "libGLX_nvidia.so.0", "amd": "libvk.so"}
    for name, library in libraries.items():
        (folder / f"{name}.json").write_text(json.dumps({"ICD": {"library_path": library}}))
    own = str(folder / "lvp_icd.x86_64.json")
    assert without_gpu(tmp_path, {}) == {"VK_DRIVER_FILES": own, "VK_ICD_FILENAMES": own}
    assert without_gpu(tmp_path, {"VK_DRIVER_FILES": str(folder / "nvidia_icd.json")})["VK_DRIVER_FILES"] == own
    (folder / "lvp_icd.x86_64.json").unlink()
    assert without_gpu(tmp_path, {}) == {}
