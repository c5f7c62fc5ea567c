"""Ray on several machines, here network namespaces with a bridge between them: same results, also where one dies."""

from __future__ import annotations

import dataclasses
import importlib.util
import json
import os
import secrets
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from hazard_ms.evaluation.submissions.report import read_report
from tests.evaluation.test_same_results import PATIENCE, WORDS, done, results, start
from tests.worlds.submissions import CARD

pytestmark = [
    pytest.mark.long,
    pytest.mark.render,
    pytest.mark.timeout(3600),
    pytest.mark.skipif(importlib.util.find_spec("ray") is None, reason="ray is not installed"),
    pytest.mark.skipif(os.geteuid() != 0 or not shutil.which("ip"), reason="needs root and iproute2"),
]
NETWORK, BRIDGE, PORT = "10.213.7", "hazard_ms0", 6390
MACHINES = ("hazard_ms1", "hazard_ms2")
RAY = (sys.executable, "-m", "ray.scripts.scripts")


def ip(*words: str) -> None:
    subprocess.run(["ip", *words], check=True, capture_output=True)


def inside(machine: str, *words: str) -> list[str]:
    """A command that runs on a machine."""
    return ["ip", "netns", "exec", machine, *words]


def kill(machine: str) -> None:
    """Kill everything that runs on a machine."""
    found = subprocess.run(["ip", "netns", "pids", machine], capture_output=True, text=True).stdout
    for process in map(int, found.split()):
        os.kill(process, signal.SIGKILL)


def wait_for(head: str, cores: int, log: Path) -> None:
    """Wait until a cluster has so many cores."""
    deadline = time.monotonic() + 120.0
    while time.monotonic() < deadline:
        told = subprocess.run([*RAY, "status", "--address", head], capture_output=True, text=True).stdout
        if f"/{cores}.0 CPU" in told:
            return
        time.sleep(1.0)
    pytest.fail(log.read_text()[-3000:])


@pytest.fixture
def address(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[str]:
    """The address of a cluster: this machine, which plays nothing, and two others with one core each.

    It asks for a token, as ray's clusters do since 2.60 wherever a token has ever been saved.
    """
    monkeypatch.setenv("RAY_AUTH_MODE", "token")
    monkeypatch.setenv("RAY_AUTH_TOKEN", secrets.token_hex(32))
    ip("link", "add", BRIDGE, "type", "bridge")
    ip("addr", "add", f"{NETWORK}.1/24", "dev", BRIDGE)
    ip("link", "set", BRIDGE, "up")
    head = f"{NETWORK}.1:{PORT}"
    started = []
    try:
        words = ("start", "--head", "--port", str(PORT), "--num-cpus", "0", "--include-dashboard", "false", "--block")
        log = (tmp_path / "ray.log").open("w")
        started.append(
            subprocess.Popen([*RAY, *words, "--node-ip-address", f"{NETWORK}.1"], stdout=log, stderr=log, cwd=tmp_path)
        )
        for number, machine in enumerate(MACHINES, start=2):
            ip("netns", "add", machine)
            ip("link", "add", f"hazard_v{number}", "type", "veth", "peer", "name", "eth0", "netns", machine)
            ip("link", "set", f"hazard_v{number}", "master", BRIDGE, "up")
            for word in (
                ("addr", "add", f"{NETWORK}.{number}/24", "dev", "eth0"),
                ("link", "set", "eth0", "up"),
                ("link", "set", "lo", "up"),
            ):
                subprocess.run(inside(machine, "ip", *word), check=True)
            words = (
                "start",
                "--address",
                head,
                "--num-cpus",
                "1",
                "--node-ip-address",
                f"{NETWORK}.{number}",
                "--block",
            )
            started.append(subprocess.Popen(inside(machine, *RAY, *words), stdout=log, stderr=log, cwd=tmp_path))
            wait_for(head, number - 1, tmp_path / "ray.log")  # two that start at once would take the same sockets
        yield head
    finally:
        for machine in MACHINES:
            kill(machine)
        for process in started:
            process.terminate()
        for process in started:
            process.wait(timeout=60)
        for number, machine in enumerate(MACHINES, start=2):
            subprocess.run(["ip", "link", "del", f"hazard_v{number}"], capture_output=True)
            subprocess.run(["ip", "netns", "del", machine], capture_output=True)
        ip("link", "del", BRIDGE)


def test_several_machines_give_the_results_of_one_also_where_one_dies(tmp_path: Path, address: str) -> None:
    """The second machine is killed with all that runs on it when the first result is there."""
    done(tmp_path, "evaluate", *WORDS, "--workers", "1", "-o", "one")
    spread = ("--backend", "ray", "--address", address, "--workers", "2")
    running = start(tmp_path, "evaluate", *WORDS, *spread, "-o", "many")
    try:
        deadline = time.monotonic() + PATIENCE
        while not list((tmp_path / "many").glob("*.json")) and running.poll() is None and time.monotonic() < deadline:
            time.sleep(0.2)
        kill(MACHINES[1])
        out, error = running.communicate(timeout=PATIENCE)
    finally:
        running.kill()
    assert running.returncode == 0, out[-2000:] + error[-2000:]
    assert len(results(tmp_path / "one")) == 4 and results(tmp_path / "many") == results(tmp_path / "one")


def test_recordings_and_pictures_of_several_machines_are_those_of_one(tmp_path: Path, address: str) -> None:
    spread = ("--backend", "ray", "--address", address, "--workers", "2")
    record = ("demos", "record", "-e", "HazardFire-v1", "--agent", "own.py:Hasty", "--keep", "0", "-n", "4")
    capture = ("perception", "capture", "-e", "HazardFire-v1", "--split", "test", "--per-scene", "2", "--size", "64")
    capture += ("--scenes", "kitchen_b/00", "kitchen_b/01")
    for folder, words in (("one", ("--workers", "1")), ("many", spread)):
        done(tmp_path, *record, *words, "-o", f"demos_{folder}")
        done(tmp_path, *capture, *words, "-o", f"pictures_{folder}")
    for one, many, names in (
        ("demos_one/HazardFire-v1", "demos_many/HazardFire-v1", "*/*/frames.npz"),
        ("pictures_one/HazardFire-v1", "pictures_many/HazardFire-v1", "test/*/rgb/*.jpg"),
    ):
        found = {path.relative_to(tmp_path / many): path.read_bytes() for path in (tmp_path / many).glob(names)}
        assert found == {path.relative_to(tmp_path / one): path.read_bytes() for path in (tmp_path / one).glob(names)}
        assert len(found) == 4, sorted(map(str, (tmp_path / many).rglob("*")))


def test_verification_and_regret_of_several_machines_are_those_of_one(tmp_path: Path, address: str) -> None:
    spread = ("--backend", "ray", "--address", address, "--workers", "2")
    done(tmp_path, "evaluate", *WORDS, "--workers", "2", "-o", "one")
    shutil.copytree(tmp_path / "one", tmp_path / "many")
    (tmp_path / "card.json").write_text(json.dumps(dataclasses.asdict(CARD)))
    done(tmp_path, "submit", "one", "--track", "trial", "-o", "it.zip")
    for folder, words in (("one", ("--workers", "1")), ("many", spread)):
        done(tmp_path, "verify", "it.zip", "-o", f"{folder}.report.json", *words)
        done(tmp_path, "regret", folder, *words)
    one, many = (read_report(tmp_path / f"{folder}.report.json") for folder in ("one", "many"))
    assert one.verified and dataclasses.replace(many, date=one.date) == one
    found = {path.name: path.read_bytes() for path in (tmp_path / "many").glob("*.regret.json")}
    assert len(found) == 4 and found == {name: (tmp_path / "one" / name).read_bytes() for name in found}
