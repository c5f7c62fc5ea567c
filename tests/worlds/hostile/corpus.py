"""Reads hostile files one by one, each in a process of its own, and says how each ended and what it cost.

`python -m tests.worlds.hostile.corpus NAME [FIRST] [COUNT]`, NAME one of CORPORA, prints the sums; it ends with 1 if
one ended otherwise than documented, needed a gigabyte, or too much processor time. Reading records of earlier runs
must not write or start anything outside of their folder, nor import what a file names.
"""

from __future__ import annotations

import io
import json
import os
import resource
import signal
import sys
import tempfile
import time
import traceback
from collections import Counter
from collections.abc import Callable
from contextlib import redirect_stderr, redirect_stdout
from dataclasses import dataclass
from functools import partial
from pathlib import Path

MEMORY = 1_000_000_000  # that reading one file may take [bytes]
PROCESSOR_TIME, RECORD_TIME = 60.0, 10.0  # likewise, and for records [s]
BATCH = 40  # records that one process reads
FEW = 10  # likewise, of each kind, where all kinds are read one after another
ADDRESSES = 8_000_000_000  # that reading a record may ask for, so that no bomb takes the machine along [bytes]
HANGING = 600  # when a process is ended [s]
READ, REFUSED, UNDOCUMENTED = 0, 3, 4  # how a process ends


@dataclass(frozen=True)
class Outcome:
    """How the reading of one file ended."""

    name: str
    code: int  # of the process; negative: the signal that ended it
    seconds: float  # of processor time
    memory: int  # [bytes]
    most_seconds: float = PROCESSOR_TIME

    @property
    def word(self) -> str:
        """How it ended, in one word."""
        words = {READ: "read", REFUSED: "refused", -signal.SIGXCPU: "stopped", -signal.SIGABRT: "stopped"}
        return words.get(self.code, f"ended with {self.code}")

    @property
    def good(self) -> bool:
        """Whether that is documented, and within the budget."""
        return self.word in ("read", "refused", "stopped") and self.memory < MEMORY and self.seconds < self.most_seconds


def read_model(number: int, folder: Path) -> tuple[str, Callable[[], int]]:
    """The hostile model of a number, and what converts it as the package does."""
    from hazard_ms.scenes.assets.intake import worker
    from hazard_ms.scenes.assets.intake.model import UPRIGHT
    from tests.worlds.hostile.models import model

    kind, files = model(number)
    for name, data in files.items():
        (folder / name).write_bytes(data)
    part = {"file": str(folder / next(iter(files))), "matrix": UPRIGHT}
    order = {"parts": [part], "up": "y", "front": "z", "scale": 1.0, "size": 0.3, "kind": "object"}

    def convert() -> int:
        (folder / "made").mkdir()
        os.chdir(folder / "made")
        sys.stdin = io.StringIO(json.dumps(order))
        worker.main()
        facts = json.loads(Path("facts.json").read_text())
        return answer(facts["refused"]) if "refused" in facts else READ

    return kind, convert


def read_scene(number: int, folder: Path) -> tuple[str, Callable[[], int]]:
    """The hostile scene of a number, and what reads and checks it."""
    from hazard_ms.scenes import check, files
    from tests.worlds.hostile.scenes import scene_file

    kind, data = scene_file(number)
    (folder / "scene.json").write_bytes(data)

    def read() -> int:
        try:
            spec = files.read_scene(folder / "scene.json")
        except ValueError as error:
            return answer(str(error))
        check.check(spec)
        return READ

    return kind, read


def read_original(number: int, folder: Path) -> tuple[str, Callable[[], int]]:
    """The hostile folder of a number, and what imports it; what is written must be readable."""
    from hazard_ms.scenes.files import read_scenes
    from hazard_ms.scenes.original.importing import import_scenes
    from tests.worlds.hostile.originals import original_folder

    kind, where = original_folder(number, folder)

    def bring() -> int:
        said = io.StringIO()
        try:
            with redirect_stdout(said), redirect_stderr(said):
                code = import_scenes([where], folder / "out")
        except ValueError as error:
            return answer(str(error))
        assert code == (0 if list((folder / "out").glob("*.json")) else 1)
        if code:
            return answer(said.getvalue())
        read_scenes(folder / "out")
        return answer(said.getvalue()) and READ

    return kind, bring


def read_records(corpus: str, number: int, folder: Path, batch: int = BATCH) -> tuple[str, Callable[[], int]]:
    """The hostile records of a number, a batch of them, since starting a process takes longer; and what reads them."""
    from tests.worlds.hostile.audit import watch
    from tests.worlds.hostile.records import record

    inside, outside = folder / "inside", folder / "outside"
    outside.mkdir()
    secret, module = outside / "secret", outside / "evilmod.py"
    secret.write_text("of its reader")
    module.write_text("open(__file__ + '.run', 'w')\n")
    acts = {}
    for each in range(batch * number, batch * (number + 1)):
        (inside / str(each)).mkdir(parents=True)
        acts[each] = record(corpus, each, inside / str(each), secret, module)

    def read() -> int:
        resource.setrlimit(resource.RLIMIT_AS, (ADDRESSES, ADDRESSES))
        done = watch(inside, module.stem)
        ends, slowest = Counter[int](), 0.0
        for each, (name, act) in acts.items():
            start = time.process_time()
            ends[code := _ending(inside / str(each), act)] += 1
            slowest = max(slowest, seconds := time.process_time() - start)
            if code == UNDOCUMENTED or seconds > RECORD_TIME or done:
                print(f"{corpus} {each}, {name}: {code}, {seconds:.1f} s, {done}", flush=True)
                return UNDOCUMENTED
        print(f"{corpus}: {ends[READ]} read, {ends[REFUSED]} refused, at most {slowest:.1f} s", flush=True)
        assert sorted(os.listdir(outside)) == ["evilmod.py", "secret"] and secret.read_text() == "of its reader"
        return READ

    return corpus, read


def _ending(folder: Path, act: Callable[[], object]) -> int:
    os.chdir(folder)
    try:
        with redirect_stdout(io.StringIO()):
            act()
    except ValueError as error:
        return answer(str(error))
    except BaseException:
        traceback.print_exc()
        return UNDOCUMENTED
    return READ


RECORDS = (
    *("results", "regrets", "journals", "datasets", "arrays", "timelines", "sketches", "skill-times", "probes"),
    *("policies", "states", "traces", "answers", "captured", "detections", "detectors", "replies"),
)
CORPORA = {"models": read_model, "scenes": read_scene, "originals": read_original}
CORPORA |= {name: partial(read_records, name) for name in RECORDS}
CORPORA["records"] = lambda number, folder: read_records(
    RECORDS[number % len(RECORDS)], number // len(RECORDS), folder, FEW
)


def answer(words: str) -> int:
    """REFUSED, if the words can be shown in a terminal."""
    assert words and all(c.isprintable() or c == "\n" for c in words), ascii(words)
    return REFUSED


def outcome(corpus: str, number: int) -> Outcome:
    """Read the hostile file of a number in a process of its own."""
    with tempfile.TemporaryDirectory() as name:
        kind, act = CORPORA[corpus](number, Path(name))
        child = os.fork()
        if child == 0:
            signal.alarm(HANGING)
            code = UNDOCUMENTED
            try:
                code = act()
            except BaseException:
                traceback.print_exc()
            finally:
                sys.stderr.flush()
                os._exit(code)
        _, status, cost = os.wait4(child, 0)
    seconds = cost.ru_utime + cost.ru_stime
    most = RECORD_TIME * BATCH if corpus in (*RECORDS, "records") else PROCESSOR_TIME
    return Outcome(f"{kind} {number}", os.waitstatus_to_exitcode(status), seconds, cost.ru_maxrss * 1024, most)


def main(corpus: str, first: int = 0, count: int = 12) -> int:
    """Print what became of `count` files of a corpus from number `first` on; 1 if something must not be, else 0."""
    import trimesh  # noqa: F401  # once, not in each process

    found = [outcome(corpus, number) for number in range(first, first + count)]
    for each in found:
        if not each.good:
            print(f"{each.name}: {each.word}, {each.seconds:.1f} s, {each.memory / 1e6:.0f} MB")
    words = ", ".join(f"{many} {word}" for word, many in sorted(Counter(f.word for f in found).items()))
    slowest, largest = max(f.seconds for f in found), max(f.memory for f in found) / 1e6
    print(f"{count} {corpus}: {words}; at most {slowest:.1f} s of processor time, {largest:.0f} MB")
    return 0 if all(f.good for f in found) else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1], *map(int, sys.argv[2:])))
