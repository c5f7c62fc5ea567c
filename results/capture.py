"""How quickly labelled pictures are taken, and in how much memory: `./run python results/capture.py`.

Takes 1,000 pictures by raster and 100 by ray tracing of 512 x 512 with a process for each core, and writes capture.md
beside this file. Memory is that of all processes together, sampled each second.
"""

from __future__ import annotations

import shutil
import subprocess
import time
from pathlib import Path

from hazard_ms.machine.cores import cores
from results.tables import COMMAND, HERE, machine

RAW = HERE.parent / "build" / "capture"
RUNS = {  # name: pictures of a scene, scenes, options
    "raster": (100, 10, []),
    "ray-traced (rt-fast, 4 samples)": (10, 10, ["--shader", "rt-fast"]),
}
SCENES = [f"{room}/{number:02d}" for number in range(4) for room in ("kitchen_a", "living_room_a", "craft_room_a")]
HEAD = """# Taking labelled pictures

Made by `./run python results/capture.py` at {machine}: fire, pictures of
512 x 512, {workers} processes. Memory is of all processes together, at most in the first and in the last third of the
run.

| pictures | number | minutes | a second | 15,000 would take [h] | memory early, late [GiB] |
|---|---|---|---|---|---|
"""


def family(pid: int) -> list[int]:
    """A process and all that it began."""
    found = [pid]
    for number in found:
        for path in Path(f"/proc/{number}/task").glob("*/children"):
            try:
                found += [int(word) for word in path.read_text().split()]
            except OSError:  # it has ended meanwhile
                continue
    return found


def memory(pid: int) -> float:
    """Memory of a process and all that it began [GiB]: what they share is counted in parts."""
    total = 0
    for number in family(pid):
        try:
            lines = Path(f"/proc/{number}/smaps_rollup").read_text().splitlines()
        except OSError:
            continue
        total += next((int(line.split()[1]) for line in lines if line.startswith("Pss:")), 0)
    return total / 2**20


def taken(name: str) -> str:
    """Take the pictures of a run, and tell its row of the table. Raises RuntimeError where it fails."""
    per_scene, scenes, options = RUNS[name]
    words = ["--per-scene", str(per_scene), "--scenes", *SCENES[:scenes], "--workers", "0", *options]
    output = RAW / name.split()[0]
    begin, samples = time.monotonic(), []
    with subprocess.Popen([*COMMAND, "perception", "capture", *words, "-o", str(output)], cwd=HERE.parent) as command:
        while command.poll() is None:
            samples.append(memory(command.pid))
            time.sleep(1.0)
    seconds = time.monotonic() - begin
    if command.returncode:
        raise RuntimeError(f"the capture must end with 0, got {command.returncode}")
    early, late = (max(samples[k * len(samples) // 3 : (k + 1) * len(samples) // 3], default=0.0) for k in (0, 2))
    count = per_scene * scenes
    rate = count / seconds
    hours = 15_000 / rate / 3600
    return f"| {name} | {count:,} | {seconds / 60:.1f} | {rate:.2f} | {hours:.1f} | {early:.2f}, {late:.2f} |\n"


def main() -> None:
    """Take all pictures anew, for nothing but their time, and write the table."""
    shutil.rmtree(RAW, ignore_errors=True)
    text = HEAD.format(machine=machine(), workers=cores()) + "".join(map(taken, RUNS))
    (HERE / "capture.md").write_text(text, encoding="utf-8")
    print(text)


if __name__ == "__main__":
    main()
