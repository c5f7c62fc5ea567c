"""What a process may draw with while the GPU is hidden from it."""

from __future__ import annotations

import json
from pathlib import Path

from results.gpu.needs import without_gpu


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
