"""The diagnosis of machines, whose files lie in folders: each fault is traced to its cause and a command."""

from __future__ import annotations

import importlib.metadata
from pathlib import Path

import pytest

from hazard_ms.machine.diagnosis import OPENCVS, PACKAGES, Facts, Finding, examine, installed_version
from hazard_ms.machine.survey import read_machine
from hazard_ms.machine.vulkan import Answer
from tests.worlds.files.machines import ALL_LIBRARIES, NO_DRIVER, facts_of, lavapipe, ldconfig, machine_at


def first_fault(facts: Facts) -> Finding | None:
    return next((finding for finding in examine(facts) if finding.state == "fault"), None)


def test_a_machine_in_order_has_no_fault(tmp_path: Path) -> None:
    assert first_fault(facts_of(machine_at(tmp_path), lavapipe(25, 0, 7))) is None


def test_libraries_of_other_architectures_do_not_count(tmp_path: Path) -> None:
    assert machine_at(tmp_path).libraries == frozenset(ALL_LIBRARIES)


@pytest.mark.parametrize(
    ("icd", "said"),
    [
        ("{", "is not valid JSON"),
        ("{}", "names no library"),
        ('["ICD"]', "names no library"),
        ('{"ICD": {"library_path": "libvulkan_gone.so"}}', "libvulkan_gone.so is not there"),
        ('{"ICD": {"library_path": "./gone.so"}}', "./gone.so is not there"),
    ],
)
def test_a_broken_driver_file_is_named(tmp_path: Path, icd: str, said: str) -> None:
    fault = first_fault(facts_of(machine_at(tmp_path, icd), Answer(fault=NO_DRIVER)))
    assert fault is not None and fault.name == "vulkan drivers"
    assert said in fault.detail and "lvp_icd.json" in fault.detail
    assert "lvp_icd.json" in fault.command


def test_a_broken_driver_file_beside_a_working_one_only_warns(tmp_path: Path) -> None:
    found = {finding.name: finding for finding in examine(facts_of(machine_at(tmp_path, "{"), lavapipe(25, 0, 7)))}
    assert found["vulkan drivers"].state == "warning" and found["rendering"].state == "ok"


def test_no_driver_at_all(tmp_path: Path) -> None:
    fault = first_fault(facts_of(machine_at(tmp_path, None), Answer(fault=NO_DRIVER)))
    assert fault is not None and fault.detail == "none is installed"
    assert "mesa-vulkan-drivers" in fault.command and "bookworm-backports" in fault.command


@pytest.mark.parametrize(
    ("version", "good"), [((23, 2, 1), False), ((24, 2, 8), False), ((24, 3, 0), True), ((25, 0, 7), True)]
)
def test_mesa_is_new_enough_from_24_3(tmp_path: Path, version: tuple[int, ...], good: bool) -> None:
    fault = first_fault(facts_of(machine_at(tmp_path), lavapipe(*version)))
    assert (fault is None) is good
    if fault is not None:
        assert ".".join(map(str, version)) in fault.detail and "24.3" in fault.detail


@pytest.mark.parametrize(
    ("library", "package"),
    [("libXext.so.6", "libxext6"), ("libX11.so.6", "libx11-6"), ("libvulkan.so.1", "libvulkan1")],
)
def test_a_missing_library_is_traced_to_its_package(tmp_path: Path, library: str, package: str) -> None:
    machine = machine_at(tmp_path, libraries=tuple(name for name in ALL_LIBRARIES if name != library))
    fault = first_fault(facts_of(machine, lavapipe(25, 0, 7), cpu_fault="ImportError"))
    assert fault is not None and fault.name == "libraries"
    assert library in fault.detail and package in fault.command.split()


@pytest.mark.parametrize(
    ("changes", "name", "said"),
    [
        ({"python": (3, 13)}, "python", "3.13"),
        ({"python": (3, 9)}, "python", "3.9"),
        ({"packages": {}}, "packages", "sapien"),
        ({"opencv_fault": "AttributeError: no attribute 'gapi_wip_gst_GStreamerPipeline'"}, "opencv", "gapi_wip"),
        ({"free": 0.2}, "disk", "0.2 GB"),
        ({"cpu_fault": "SAPIEN crashed (signal 11)"}, "rendering", "signal 11"),
    ],
)
def test_other_causes(tmp_path: Path, changes: dict[str, object], name: str, said: str) -> None:
    fault = first_fault(facts_of(machine_at(tmp_path), lavapipe(25, 0, 7), **changes))
    assert fault is not None and fault.name == name
    assert said in fault.detail and fault.command


def test_two_opencvs_are_warned_of_and_both_removed(tmp_path: Path) -> None:
    packages = {name: "1.0" for name in (*PACKAGES, "opencv-python")}
    found = {f.name: f for f in examine(facts_of(machine_at(tmp_path), lavapipe(25, 0, 7), packages=packages))}
    assert found["opencv"].state == "warning"
    assert "uninstall -y opencv-python opencv-python-headless" in found["opencv"].command
    assert set(OPENCVS) > {"opencv-python"}


def test_mig_slices_and_containers_without_graphics_leave_drawing_to_the_cpu(tmp_path: Path) -> None:
    for name, listing, said in (
        ("mig", "GPU 0: A100\n  MIG 1g.5gb Device 0: (UUID: MIG-1)\n", "MIG"),
        ("plain", "GPU 0: T4\n", "graphics"),
    ):
        root = tmp_path / name
        machine_at(root)
        (root / "dev").mkdir()
        (root / "dev/nvidiactl").touch()
        machine = read_machine(root, {}, ldconfig(*ALL_LIBRARIES), gpus=listing)
        assert machine.nvidia_devices and not machine.nvidia_driver and machine.mig == (name == "mig")
        facts = facts_of(machine, lavapipe(25, 0, 7), gpu_fault="RuntimeError: no device", cuda_fault="")
        found = {finding.name: finding for finding in examine(facts)}
        assert found["gpu"].state == "warning" and said in found["gpu"].detail
        assert found["rendering"].detail.endswith("CPU") and first_fault(facts) is None


def test_a_nightly_build_counts_as_its_package(monkeypatch: pytest.MonkeyPatch) -> None:
    there = {"mani-skill-nightly": "2026.8.2", "sapien": "3.0.3"}

    def version(name: str) -> str:
        if name not in there:
            raise importlib.metadata.PackageNotFoundError(name)
        return there[name]

    monkeypatch.setattr(importlib.metadata, "version", version)
    assert [installed_version(name) for name in ("mani-skill", "sapien", "torch")] == ["2026.8.2", "3.0.3", None]
    there["mani-skill"] = "3.0.1"
    assert installed_version("mani-skill") == "3.0.1"
