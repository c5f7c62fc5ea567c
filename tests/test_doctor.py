"""The diagnosis, on folders that stand for machines and on child processes whose Vulkan really is broken."""

from __future__ import annotations

import dataclasses
import json
import os
import subprocess
import sys
from collections.abc import Mapping
from pathlib import Path

import pytest

from hazard_ms import rendering
from hazard_ms.drivers import install_commands, mirror, missing_packages
from hazard_ms.findings import OPENCVS, PACKAGES, Facts, Finding, examine
from hazard_ms.machine import Machine, read_machine
from hazard_ms.vulkan import Answer, Device, ask_vulkan

ALL_LIBRARIES = ("libX11.so.6", "libXext.so.6", "libvulkan.so.1", "libvulkan_lvp.so")
LAVAPIPE = '{"file_format_version": "1.0.0", "ICD": {"library_path": "libvulkan_lvp.so", "api_version": "1.4.305"}}'
CPU_DEVICE = 4  # VK_PHYSICAL_DEVICE_TYPE_CPU
NO_DRIVER = "no Vulkan driver works"


def ldconfig(*libraries: str) -> str:
    """What `ldconfig -p` prints where exactly `libraries` are installed."""
    lines = [f"\t{name} (libc6,x86-64) => /lib/x86_64-linux-gnu/{name}" for name in libraries]
    return "\n".join([f"{len(lines)} libs found in cache `/etc/ld.so.cache'", *lines, "\tlibonly32.so (libc6) => /lib/libonly32.so"])


def machine_at(root: Path, icd: str | None = LAVAPIPE, libraries: tuple[str, ...] = ALL_LIBRARIES, release: str = "debian 12") -> Machine:
    """A machine whose files lie below `root`, with one Vulkan driver file of text `icd`."""
    system, version = release.split()
    (root / "etc").mkdir(parents=True)
    (root / "etc/os-release").write_text(f'PRETTY_NAME="A Linux"\nID={system}\nVERSION_ID="{version}"\n')
    folder = root / "usr/share/vulkan/icd.d"
    folder.mkdir(parents=True)
    if icd is not None:
        (folder / "lvp_icd.json").write_text(icd)
    return read_machine(root, {}, ldconfig(*libraries), gpus="")


def lavapipe(*version: int) -> Answer:
    return Answer((Device("llvmpipe (LLVM 15.0.6, 256 bits)", CPU_DEVICE, 0x10005, version),), "libvulkan.so.1")


def facts_of(machine: Machine, vulkan: Answer, **changes: object) -> Facts:
    """A machine in an environment where everything else is as it should be."""
    packages = {name: "1.0" for name in PACKAGES}
    draws = "" if vulkan.usable else "RuntimeError: vk::createInstanceUnique: ErrorIncompatibleDriver"
    facts = Facts(machine, vulkan, (3, 11), packages, None, draws, "", None, 50.0)
    return dataclasses.replace(facts, **changes)  # type: ignore[arg-type]


def first_fault(facts: Facts) -> Finding | None:
    return next((finding for finding in examine(facts) if finding.state == "fault"), None)


def test_a_machine_in_order_has_no_fault(tmp_path: Path) -> None:
    assert first_fault(facts_of(machine_at(tmp_path), lavapipe(25, 0, 7))) is None


def test_libraries_of_other_architectures_do_not_count(tmp_path: Path) -> None:
    assert machine_at(tmp_path).libraries == frozenset(ALL_LIBRARIES)


@pytest.mark.parametrize(
    ("icd", "said"),
    [
        ("{", "is not JSON"),
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


@pytest.mark.parametrize(("version", "good"), [((23, 2, 1), False), ((24, 2, 8), False), ((24, 3, 0), True), ((25, 0, 7), True)])
def test_mesa_is_new_enough_from_24_3(tmp_path: Path, version: tuple[int, ...], good: bool) -> None:
    fault = first_fault(facts_of(machine_at(tmp_path), lavapipe(*version)))
    assert (fault is None) is good
    if fault is not None:
        assert ".".join(map(str, version)) in fault.detail and "24.3" in fault.detail


@pytest.mark.parametrize(
    ("library", "package"), [("libXext.so.6", "libxext6"), ("libX11.so.6", "libx11-6"), ("libvulkan.so.1", "libvulkan1")]
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


def test_what_to_install(tmp_path: Path) -> None:
    machine = machine_at(tmp_path / "debian", None, ("libX11.so.6",))
    packages = missing_packages(machine, Answer(fault=NO_DRIVER))
    assert packages == ["libxext6", "libvulkan1", "mesa-vulkan-drivers"]
    source, update, install = install_commands(machine, packages, " 500 http://mirror.example/debian bookworm/main amd64 Packages")
    assert "deb http://mirror.example/debian bookworm-backports main" in source[-1]
    assert update[:2] == ["apt-get", "update"] and install[-5:] == ["-t", "bookworm-backports", *packages]
    known = install_commands(machine, packages, " 100 http://mirror.example/debian bookworm-backports/main amd64 Packages")
    assert [command[0] for command in known] == ["apt-get", "apt-get"]
    ubuntu = machine_at(tmp_path / "ubuntu", None, ALL_LIBRARIES, "ubuntu 24.04")
    assert not any("-t" in command for command in install_commands(ubuntu, ["mesa-vulkan-drivers"]))
    assert missing_packages(ubuntu, lavapipe(25, 2, 8)) == []


def test_where_debian_is(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    templates = tmp_path / "Debian.info"
    templates.write_text("Suite: bookworm\nBaseURI: https://mirror.example/debian/\nMirrorsFile: x\n")
    monkeypatch.delenv("HAZARD_MS_DEBIAN", raising=False)
    assert mirror(templates) == "https://mirror.example/debian"
    monkeypatch.setenv("HAZARD_MS_DEBIAN", "http://mine.example/debian/")
    assert mirror(templates) == "http://mine.example/debian"
    monkeypatch.delenv("HAZARD_MS_DEBIAN")
    templates.write_text("nothing of use")
    with pytest.raises(ValueError, match="HAZARD_MS_DEBIAN"):
        mirror(templates)


def environment(**changes: str) -> dict[str, str]:
    """This process's variables, changed, with the package importable."""
    root = str(Path(__file__).parents[1])
    return {**os.environ, "PYTHONPATH": root, **changes}


@pytest.fixture
def broken(tmp_path: Path) -> Mapping[str, str]:
    """Variables under which Vulkan has one driver, whose library does not exist."""
    icd = tmp_path / "broken_icd.json"
    icd.write_text('{"file_format_version": "1.0.0", "ICD": {"library_path": "./gone.so", "api_version": "1.3.0"}}')
    return environment(VK_DRIVER_FILES=str(icd), VK_ICD_FILENAMES=str(icd), HAZARD_MS_HOME=str(tmp_path / "home"))


def test_broken_vulkan_is_noticed_in_the_child(broken: Mapping[str, str]) -> None:
    assert not ask_vulkan(broken).usable and ask_vulkan(broken).fault
    assert rendering.trial_fault("cpu", environ=broken)


def test_doctor_names_the_broken_driver_and_ends_with_1(broken: Mapping[str, str]) -> None:
    command = [sys.executable, "-m", "hazard_ms.cli", "doctor", "--json", "--no-draw"]
    child = subprocess.run(command, capture_output=True, text=True, check=False, env=dict(broken))
    answer = json.loads(child.stdout)
    assert child.returncode == 1
    assert answer["backend"] == "none"
    drivers = next(finding for finding in answer["findings"] if finding["name"] == "vulkan drivers")
    assert "broken_icd.json" in drivers["detail"] and drivers["command"] == "unset VK_DRIVER_FILES"
    assert answer["cause"] == next(finding for finding in answer["findings"] if finding["state"] == "fault")


def test_a_crash_in_the_child_is_a_finding(tmp_path: Path) -> None:
    """`sitecustomize` runs at the start of every Python: here it dies as a crashing driver would."""
    (tmp_path / "sitecustomize.py").write_text("import os, signal\nos.kill(os.getpid(), signal.SIGSEGV)\n")
    environ = environment(PYTHONPATH=str(tmp_path))
    assert "signal 11" in ask_vulkan(environ).fault
    assert "signal 11" in rendering.trial_fault("cpu", environ=environ)


def test_backend_is_one_of_three_and_can_be_chosen(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("HAZARD_MS_RENDER", "none")
    assert rendering.backend() == "none"
    monkeypatch.setenv("HAZARD_MS_RENDER", "opengl")
    with pytest.raises(ValueError, match="opengl.*gpu, cpu, none"):
        rendering.backend()


def test_the_answer_is_kept_and_a_damaged_one_is_found_anew(tmp_path: Path, broken: Mapping[str, str]) -> None:
    code = "from hazard_ms.rendering import *; import os; print(machine_key(os.environ), backend())"

    def ask() -> tuple[str, str]:
        out = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, env=dict(broken)).stdout
        return out.split()[0], out.split()[1]

    key, answer = ask()
    assert answer == "none"
    kept = tmp_path / "home" / f"rendering-{key}.json"
    assert not kept.exists(), "what is missing may be installed at any time, so `none` is not kept"
    kept.parent.mkdir(exist_ok=True)
    kept.write_text('{"backend": "cpu"}')
    assert ask() == (key, "cpu"), "a kept answer needs no trial"
    kept.write_text('{"backe')
    assert ask() == (key, "none")


@pytest.mark.render
def test_a_working_backend_is_kept_on_disk(tmp_path: Path) -> None:
    code = "from hazard_ms.rendering import backend; print(backend())"
    environ = environment(HAZARD_MS_HOME=str(tmp_path), HAZARD_MS_RENDER="")
    answer = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, env=environ).stdout.strip()
    assert answer in ("gpu", "cpu")
    assert [json.loads(path.read_text()) for path in tmp_path.glob("rendering-*.json")] == [{"backend": answer}]


@pytest.mark.render
def test_vulkan_says_which_mesa_draws() -> None:
    answer = ask_vulkan()
    assert answer.usable
    for device in answer.devices:
        assert device.name and (not device.lavapipe or device.version >= (24, 3))


def test_a_robot_without_looks_keeps_bodies_joints_and_collisions(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("HAZARD_MS_HOME", str(tmp_path / "home"))
    (tmp_path / "arm.srdf").write_text("<robot name='arm'/>")
    (tmp_path / "arm.urdf").write_text(
        "<robot name='arm'><link name='a'><inertial><mass value='2'/></inertial>"
        "<visual><geometry><mesh filename='look.dae'/></geometry><material name='red'><color rgba='1 0 0 1'/></material></visual>"
        "<collision><geometry><mesh filename='package://meshes/a.stl'/></geometry></collision></link>"
        "<link name='b'/><joint name='j' type='fixed'><parent link='a'/><child link='b'/></joint></robot>"
    )
    bare = rendering.bare_robot(tmp_path / "arm.urdf")
    text = bare.read_text()
    assert "visual" not in text and "look.dae" not in text
    assert 'mass value="2"' in text and 'joint name="j"' in text and str(tmp_path / "meshes/a.stl") in text
    assert bare.with_suffix(".srdf").read_text() == "<robot name='arm'/>"


def test_state_observations_need_no_vulkan(broken: Mapping[str, str]) -> None:
    code = (
        "import gymnasium as gym, hazard_ms\n"
        "env = gym.make('HazardFire-v1', obs_mode='state'); env.reset(seed=0); env.step(env.action_space.sample())\n"
        "print(env.unwrapped.scene.can_render())"
    )
    child = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False, env=dict(broken))
    assert child.stdout.split()[-1:] == ["False"], child.stderr[-2000:]
