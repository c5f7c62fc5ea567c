"""The commands that install what a machine lacks."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import pytest

from hazard_ms.machine.drivers import (
    PRIVATE_LIBRARY,
    PRIVATE_PACKAGE,
    PRIVATE_SHA256,
    install_commands,
    mirror,
    missing_packages,
    private_lavapipe,
    unpack_lavapipe,
)
from hazard_ms.machine.vulkan import Answer
from tests.worlds.files.machines import ALL_LIBRARIES, NO_DRIVER, lavapipe, machine_at


def test_what_to_install(tmp_path: Path) -> None:
    machine = machine_at(tmp_path / "debian", None, ("libX11.so.6",))
    packages = missing_packages(machine, Answer(fault=NO_DRIVER))
    assert packages == ["libxext6", "libvulkan1", "mesa-vulkan-drivers"]
    source, update, install = install_commands(
        machine, packages, " 500 http://mirror.example/debian bookworm/main amd64 Packages"
    )
    assert "deb http://mirror.example/debian bookworm-backports main" in source[-1]
    assert update[:2] == ["apt-get", "update"] and install[-5:] == ["-t", "bookworm-backports", *packages]
    known = install_commands(
        machine, packages, " 100 http://mirror.example/debian bookworm-backports/main amd64 Packages"
    )
    assert [command[0] for command in known] == ["apt-get", "apt-get"]
    ubuntu = machine_at(tmp_path / "ubuntu", None, ALL_LIBRARIES, "ubuntu 24.04")
    assert not any("-t" in command for command in install_commands(ubuntu, ["mesa-vulkan-drivers"]))
    assert missing_packages(ubuntu, lavapipe(25, 2, 8)) == []


def test_a_package_with_another_hash_is_not_unpacked(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """A mirror in a folder serves a real package with a library in it, but not the one that we know."""
    if shutil.which("dpkg-deb") is None:
        pytest.skip("no dpkg-deb")
    made, mirrored = tmp_path / "made", tmp_path / "mirror" / PRIVATE_PACKAGE
    (made / "DEBIAN").mkdir(parents=True)
    (made / "DEBIAN/control").write_text(
        "Package: mesa-vulkan-drivers\nVersion: 1\nArchitecture: amd64\nMaintainer: nobody <n@x>\nDescription: x\n"
    )
    (made / PRIVATE_LIBRARY).parent.mkdir(parents=True)
    (made / PRIVATE_LIBRARY).write_text("not the library")
    mirrored.parent.mkdir(parents=True)
    subprocess.run(["dpkg-deb", "--build", str(made), str(mirrored)], check=True, capture_output=True)
    monkeypatch.setenv("HAZARD_MS_DEBIAN", (tmp_path / "mirror").as_uri())
    with pytest.raises(ValueError, match=f"must have the SHA-256 {PRIVATE_SHA256}, got another file"):
        unpack_lavapipe(tmp_path / "home" / "lavapipe")
    assert private_lavapipe(tmp_path / "home") == {} and "could not be unpacked" in capsys.readouterr().err
    assert not list((tmp_path / "home").rglob("*.so"))


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
