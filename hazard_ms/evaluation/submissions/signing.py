"""Signatures of reports by OpenSSH (`ssh-keygen -Y`), with whatever key its user has: no keys are made or kept here.

A file of signers holds a line for each whose reports count, in OpenSSH's form of allowed signers: NAME ssh-ed25519 KEY.
"""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

from hazard_ms.machine.processes import environment
from hazard_ms.spec.foreign.files import printable, read_foreign

NAMESPACE = "hazard-ms-report"  # a signature for anything else does not count
ENDING = ".sig"  # that OpenSSH adds to the name of what it signs
PATIENCE = 60.0  # longest time for one signature: a key on a token may have to be touched [s] [ours]
LARGEST = 100_000  # of a signature or a file of signers [bytes] [ours]


def sign(path: Path, key: Path) -> Path:
    """Sign a file with a private key, or with a public one whose private one an agent of OpenSSH holds.

    Returns the signature's file, which lies beside it. Raises ValueError where OpenSSH cannot sign.
    """
    signature = path.with_name(path.name + ENDING)
    signature.unlink(missing_ok=True)  # else it asks whether to write over it
    done = _ssh_keygen("sign", "-f", str(key), "-n", NAMESPACE, str(path))
    if done.returncode:
        raise ValueError(f"key must be one that OpenSSH can sign with, got {key}: {_said(done)}")
    return signature


def signer(path: Path, signers: Path) -> str:
    """The name in the file of `signers` whose key signed a file. Raises ValueError where there is none."""
    signature = path.with_name(path.name + ENDING)
    content = read_foreign(path, LARGEST * 100, path.name)
    for other in (signature, signers):
        read_foreign(other, LARGEST, other.name)
    files = ("-s", str(signature), "-f", str(signers))
    found = _ssh_keygen("find-principals", *files)
    name = next(iter(found.stdout.decode(errors="replace").splitlines()), "")
    if found.returncode or not name:
        raise ValueError(f"{printable(path.name)} must be signed by one of {signers.name}, got another signature")
    done = _ssh_keygen("verify", *files, "-I", name, "-n", NAMESPACE, content=content)
    if done.returncode:
        raise ValueError(
            f"{printable(path.name)} must be unchanged since {printable(name)} signed it, got other content"
        )
    return printable(name)


def _ssh_keygen(action: str, *words: str, content: bytes = b"") -> subprocess.CompletedProcess[bytes]:
    program = shutil.which("ssh-keygen")
    if program is None:
        raise ValueError("ssh-keygen must be installed to sign reports and to check them: apt install openssh-client")
    command = [program, "-Y", action, *words]
    try:
        return subprocess.run(
            command, input=content, capture_output=True, check=False, timeout=PATIENCE, env=environment()
        )
    except subprocess.TimeoutExpired:
        raise ValueError(f"ssh-keygen must answer within {PATIENCE:.0f} s, got no answer") from None


def _said(done: subprocess.CompletedProcess[bytes]) -> str:
    return printable(done.stderr.decode(errors="replace").strip())[:300]
