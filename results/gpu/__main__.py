"""`./run gpu-check`: checks an NVIDIA GPU and measures it. It is of the checkout, whose tests it runs."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

import tyro

from hazard_ms.evaluation.choices import flag
from results.gpu.needs import missing, without_physx
from results.gpu.report import PARTS, PHYSX, SIZES, report

TASKS = ("HazardFire-v1", "HazardFlood-v1", "HazardWind-v1")


def gpu_check(
    env_id: Annotated[tuple[str, ...], flag("-e")] = TASKS,
    parts: tuple[str, ...] = PARTS,
    most: int = 4096,
    budget: float = 300.0,
    seed: Annotated[int, flag("-s")] = 0,
    output: Annotated[Path, flag("-o")] = Path("docs/gpu.md"),
) -> int:
    """Check an NVIDIA GPU and measure it: tests, rates of batches, differences from the CPU, waits of the host.

    Writes a page in Markdown that grows with every part. Ends with 1 without a GPU, and if a part failed. Tests, laws
    and looks need no PhysX on the GPU.

    Args:
        env_id: Tasks to measure.
        parts: Some of tests, laws, looks, state, pictures, comparison, waits; all if not given.
        most: Largest number of environments in a batch; 1, 4, 16, 64, 256, 1,024, 4,096 are measured up to it.
        budget: Time that one measurement may take [s]; a table ends at the first number that takes longer.
        seed: Seed of episodes and actions.
        output: The page.
    """
    if lack := missing():
        what = "runs the tests marked gpu, and measures batches of environments on a GPU"
        print(f"./run gpu-check {what}; this machine lacks {lack}", file=sys.stderr)
        return 1
    sizes = [size for size in SIZES if size <= most]
    lack = without_physx() if any(part in PHYSX for part in parts) else ""
    return int(report(output, env_id, parts, sizes, budget, seed, lack=lack) > 0)


def main(words: Sequence[str]) -> int:
    """Run the command. Returns its exit code: 2 for input that is not valid, which a line on stderr describes."""
    try:
        return tyro.cli(gpu_check, prog="./run gpu-check", args=words)
    except ValueError as error:  # its text says everything: no traceback
        print("./run gpu-check:", error, file=sys.stderr)
        return 2


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
