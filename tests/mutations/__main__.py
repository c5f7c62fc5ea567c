"""Makes every mistake of the list in a copy of the checkout and sees whether a test notices it.

    ./run test --mutate            all of them
    ./run test --mutate NAME...    some: by name, or by the beginning of their file or name

Prints a line for each, then the survivors; ends with 1 if there are any. What a test says of a mistake counts only if
the same test passes without it.
"""

from __future__ import annotations

import os
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

from hazard_ms.spec.checks import one_of
from tests.mutations.choosing import stages
from tests.mutations.reading import Mutation, listed
from tests.project.imports import ROOT

PATIENCE = 1800  # [s] for one group of tests; a mistake that makes them hang is noticed, too
MOST_WORKERS = 8  # each takes 2 GB, as in `./run test`
PASSED, FAILED, BROKEN, EMPTY = 0, 1, 2, 5  # exit codes of pytest; BROKEN: a file of tests could not be imported
LINKED = ("assets", "docs", ".git")  # large, and changed by no test
# a line of `pytest -v` on a test that failed, or of its summary on a file that could not be imported
FAILURE = re.compile(r"^(tests/.+::.+) (?:FAILED|ERROR) +\[ *\d+%\]$|^ERROR (tests/[^\s:]+)", re.MULTILINE)
MADE = shutil.ignore_patterns("__pycache__", ".*_cache", ".hypothesis", ".venv", "build", "demo*_output")


@dataclass(frozen=True)
class Verdict:
    """What the tests said of one mutation."""

    mutation: Mutation
    noticed_by: str  # the test that failed, or a reason; empty if none did
    seconds: float

    def __str__(self) -> str:
        """One line of the report."""
        said = f"noticed by {self.noticed_by}" if self.noticed_by else "SURVIVED"
        return f"{self.mutation.name:45} {self.seconds:5.0f} s  {said}"


def chosen(words: list[str]) -> list[Mutation]:
    """The mutations of which the name or the file begins with one of `words`; all without words.

    Raises ValueError for a word with which none begins.
    """
    every = listed()
    for word in words:
        if not any(m.name.startswith(word) or m.file.startswith(word) for m in every.values()):
            one_of(word, every, "a mutation", "tests/mutations/list.txt has all")
    return [
        m for m in every.values() if not words or m.name.startswith(tuple(words)) or m.file.startswith(tuple(words))
    ]


def copy(source: Path, place: Path) -> Path:
    """A copy of a checkout at `place`, in which large folders are links. Returns `place`."""

    def left_out(folder: str, names: list[str]) -> set[str]:
        return {*MADE(folder, names), *(LINKED if Path(folder) == source else ())}

    shutil.copytree(source, place, symlinks=True, ignore=left_out)
    for name in LINKED:
        if (source / name).exists():
            (place / name).symlink_to((source / name).resolve())
    (place / "tmp").mkdir(exist_ok=True)
    return place


def tried(checkout: Path, tests: list[str]) -> tuple[int, str]:
    """The exit code of pytest with these tests, stopped at the first failure, and the name of the one that failed."""
    environment = {**os.environ, "PYTHONPATH": str(checkout), "TMPDIR": str(checkout / "tmp"), "OMP_NUM_THREADS": "1"}
    environment["PYTHONDONTWRITEBYTECODE"] = "1"  # nobody runs the code of this folder again
    command = [sys.executable, "-m", "pytest", "-x", "-v", "--no-header", "--tb=no", "-p", "no:cacheprovider"]
    command += ["--long"] if all("::" in test for test in tests) else []  # tests that are named, not whole files
    command += tests
    with subprocess.Popen(
        command, cwd=checkout, env=environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, start_new_session=True
    ) as run:
        try:
            said = run.communicate(timeout=PATIENCE)[0].decode(errors="replace")
        except subprocess.TimeoutExpired:
            return FAILED, f"{tests[0]}, which hung"
        finally:
            end(run)
    if run.returncode not in (PASSED, FAILED, BROKEN, EMPTY):
        raise RuntimeError(f"pytest must run {tests} in {checkout}, got exit code {run.returncode}:\n{said}")
    failed = FAILURE.search(said)
    return run.returncode, failed[1] or failed[2] if failed else ""


def end(run: subprocess.Popen[bytes]) -> None:
    """End a run of tests and all that it started."""
    try:
        os.killpg(run.pid, signal.SIGKILL)
    except ProcessLookupError:
        pass


def judge(mutation: Mutation, clean: Path) -> Verdict:
    """Make the mistake in a copy of the checkout `clean` and try the tests that can notice it."""
    start = time.monotonic()
    with tempfile.TemporaryDirectory(prefix="hazard_ms-mutation-") as folder:
        spoilt = copy(clean, Path(folder) / "checkout")
        file = spoilt / mutation.file
        file.write_text(mutation.apply(file.read_text(encoding="utf-8")), encoding="utf-8")
        for tests in stages(mutation):
            code, failed = tried(spoilt, tests)
            if code in (FAILED, BROKEN):
                return Verdict(mutation, failed or tests[0], time.monotonic() - start)
    return Verdict(mutation, "", time.monotonic() - start)


def unfounded(verdicts: list[Verdict], clean: Path) -> Iterator[str]:
    """Tests that noticed a mutation but fail without it, too."""
    said = sorted({v.noticed_by.split(",")[0] if v.noticed_by.endswith("hung") else v.noticed_by for v in verdicts})
    left = [test for test in said if test]
    while left:
        code, failed = tried(clean, left)
        if code == PASSED:
            return
        yield failed
        left = left[left.index(failed) + 1 :] if failed in left else []


def main(words: list[str]) -> int:
    """Judge the mutations that `words` choose; the exit code."""
    mutations = chosen(words)
    workers = min(os.cpu_count() or 1, MOST_WORKERS)
    start = time.monotonic()
    with tempfile.TemporaryDirectory(prefix="hazard_ms-mutations-") as folder:
        clean = copy(ROOT, Path(folder) / "checkout")
        verdicts = []
        with ThreadPoolExecutor(workers) as pool:
            for verdict in pool.map(lambda mutation: judge(mutation, clean), mutations):
                print(verdict, flush=True)
                verdicts.append(verdict)
        wrong = list(unfounded(verdicts, clean))
    survivors = [v.mutation for v in verdicts if not v.noticed_by or v.noticed_by in wrong]
    for test in wrong:
        print(f"{test} fails without any mutation: what it noticed does not count")
    for mutation in survivors:
        print(f"survivor {mutation.name} in {mutation.file}: {mutation.breaks}")
    print(f"{len(mutations)} mutations, {len(survivors)} survivors, {time.monotonic() - start:.0f} s")
    return int(bool(survivors))


if __name__ == "__main__":
    try:
        sys.exit(main(sys.argv[1:]))
    except ValueError as refusal:
        sys.exit(f"mutate: {refusal}")
