"""The Dockerfile: what it copies and asks for, and, without a daemon, what its commands make of a bare Debian 12."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.worlds.files.checkout import ROOT

SCRATCH = {"__pycache__", "_assets"}  # what git ignores inside of folders
CERTIFICATES = "/etc/ssl/certs/ca-certificates.crt"
MIRROR = "http://deb.debian.org/debian"


def instructions() -> list[tuple[str, str]]:
    """The instructions of the Dockerfile with what they are given, lines joined as Docker joins them."""
    text = "\n".join(line for line in (ROOT / "Dockerfile").read_text().splitlines() if not line.startswith("#"))
    lines = re.sub(r"\\\n", "", text).splitlines()
    return [(name, rest) for name, _, rest in (line.partition(" ") for line in lines if line.strip())]


def stage(name: str) -> list[tuple[str, str]]:
    """The instructions of the stage with this name."""
    made: list[tuple[str, str]] = []
    inside = False
    for word, rest in instructions():
        if word == "FROM":
            inside = rest.endswith(f" AS {name}")
        elif inside:
            made.append((word, rest))
    return made


def test_both_kinds_of_image_are_made_from_one_that_runs_the_projects_own_script() -> None:
    froms = [rest for word, rest in instructions() if word == "FROM"]
    assert froms == ["debian:bookworm-slim AS cpu", "cpu AS gpu", "cpu"], "without a target it is the one without a GPU"
    asked = dict(stage("cpu"))
    assert asked["ENTRYPOINT"] == '["/opt/hazard_ms/run"]' and asked["CMD"] == '["demo"]'
    assert {word for word, _ in instructions()} <= {"FROM", "COPY", "ENV", "RUN", "WORKDIR", "ENTRYPOINT", "CMD"}
    assert "NVIDIA_DRIVER_CAPABILITIES=all" in dict(stage("gpu"))["ENV"], "drawing is one of them"


def test_images_hold_nothing_that_git_ignores_and_not_its_history() -> None:
    told = {line.strip("/").removeprefix("**/") for line in (ROOT / ".dockerignore").read_text().split()}
    ignored = {line.strip("/") for line in (ROOT / ".gitignore").read_text().split() if not line.startswith("*")}
    assert told >= ({name for name in ignored if "/" not in name} - SCRATCH) | {".git", "__pycache__", "*.secret.json"}


@pytest.fixture
def machine(tmp_path: Path) -> Iterator[Path]:
    """A bare Debian 12 in a folder, with the kernel's own folders."""
    if os.geteuid() or not shutil.which("debootstrap"):
        pytest.skip("needs root and debootstrap")
    root = tmp_path / "debian"
    subprocess.run(["debootstrap", "--variant=minbase", "bookworm", str(root), MIRROR], check=True)
    mounted = []
    try:
        for name in ("proc", "sys", "dev", "dev/shm"):
            subprocess.run(["mount", "--rbind", f"/{name}", str(root / name)], check=True)
            mounted.append(root / name)
        shutil.copyfile("/etc/resolv.conf", root / "etc/resolv.conf")
        yield root
    finally:
        for place in reversed(mounted):
            subprocess.run(["umount", "-l", str(place)], check=False)


def trusted(machine: Path) -> dict[str, str]:
    """Variables by which pip and uv go through this machine's proxy and trust whom it trusts, where it has a say."""
    found = {name: os.environ[name] for name in ("http_proxy", "https_proxy") if name in os.environ}
    if not Path(CERTIFICATES).is_file():
        return found
    shutil.copyfile(CERTIFICATES, machine / "trusted.crt")
    return {**found, "PIP_CERT": "/trusted.crt", "SSL_CERT_FILE": "/trusted.crt"}


@pytest.mark.long
@pytest.mark.timeout(3600)
def test_its_commands_make_a_machine_on_which_an_episode_is_played(machine: Path) -> None:
    """What git knows is copied, and another user, who may write in /data alone, plays. Takes minutes and 15 GB."""
    names = subprocess.run(["git", "-C", str(ROOT), "ls-files", "-z"], check=True, capture_output=True, text=True)
    environment = {"PATH": "/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin", **trusted(machine)}
    for word, rest in stage("cpu"):
        if word == "COPY":
            assert rest == ". /opt/hazard_ms"
            for name in filter(None, names.stdout.split("\0")):
                (machine / "opt/hazard_ms" / name).parent.mkdir(parents=True, exist_ok=True)
                shutil.copy2(ROOT / name, machine / "opt/hazard_ms" / name, follow_symlinks=False)
        elif word == "ENV":
            environment |= dict(part.split("=", 1) for part in rest.split())
        elif word == "RUN":
            subprocess.run(["chroot", str(machine), "/bin/sh", "-c", rest], env=environment, check=True)
    data = machine / "data"
    data.mkdir()
    os.chown(data, 1000, 1000)
    play = "/opt/hazard_ms/run hazard-ms play -e HazardFire-v1 --agent greedy -s 0 --video a.mp4"
    played = subprocess.run(
        ["chroot", "--userspec=1000:1000", str(machine), "/bin/sh", "-c", f"cd /data && {play}"],
        env=environment,
        capture_output=True,
        text=True,
    )
    assert played.returncode == 0, played.stderr
    assert "rescued" in played.stdout and (data / "a.mp4").stat().st_size > 100_000
