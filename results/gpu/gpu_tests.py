"""Runs the tests that need a GPU, which no other machine runs."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

from hazard_ms.machine.processes import environment

CHECKOUT = Path(__file__).parents[2]
MENTIONED = re.compile(r"(?:FAILED|ERROR|SKIPPED|XFAIL|XPASS)\b.*")  # lines of pytest's summary


def gpu_tests(checkout: Path = CHECKOUT) -> tuple[str, bool]:
    """Run all tests marked `gpu` of a checkout: what pytest says of them, and whether all of them ran and passed."""
    files = sorted(
        str(path.relative_to(checkout))
        for path in (checkout / "tests").rglob("test_*.py")
        if "mark.gpu" in path.read_text(encoding="utf-8")  # collecting all others takes longer than these tests
    )
    command = [sys.executable, "-m", "pytest", "-m", "gpu", "--long", "-q", "-p", "no:cacheprovider", *files]
    done = subprocess.run(
        command,
        cwd=checkout,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        errors="replace",
        env=environment(),
    )
    print(done.stdout, flush=True)
    lines = [line.strip() for line in done.stdout.splitlines()]
    summary = next((line.strip("= ") for line in reversed(lines) if re.search(r"\d+ \w+.* in [\d.]+", line)), "")
    mentioned = [line for line in lines if MENTIONED.match(line)]
    whole = done.returncode == 0 and "passed" in summary and "skipped" not in summary
    said = summary or f"pytest ended with status {done.returncode}: {lines[-1] if lines else 'it said nothing'}"
    return "\n".join(["```text", *mentioned, said, "```"]), whole
