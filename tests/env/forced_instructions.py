"""Plays episodes with other instructions of the processor, each in a new process, and compares them with the record.

As a program it prints how many of the 27 episodes are equal with each: `./run python -m tests.env.forced_instructions`.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
from pathlib import Path

from tests.env.episode_hashes import PRESETS, SEEDS, TASKS, recorded

ROOT = Path(__file__).parents[2]
NUMPY_TO_AVX = "X86_V3 X86_V4 AVX512_ICL AVX512_SPR"
FORCED = {  # by what is forced: variables of the process
    "numpy without AVX2": {"NPY_DISABLE_CPU_FEATURES": NUMPY_TO_AVX},
    "OpenBLAS for SSE4": {"OPENBLAS_CORETYPE": "Nehalem"},
    "MKL for SSE2": {"MKL_CBWR": "COMPATIBLE"},
    "MKL for AVX2": {"MKL_CBWR": "AVX2"},
    "what this processor has": {
        "ATEN_CPU_CAPABILITY": "avx512" if "avx512vl" in Path("/proc/cpuinfo").read_text() else "avx2",
        "NPY_DISABLE_CPU_FEATURES": "",
        "OPENBLAS_CORETYPE": "",
    },
}
NOT_PROMISED = {  # what no processor with AVX2 does by itself
    "torch without AVX2": {"ATEN_CPU_CAPABILITY": "default"},
    "C library without AVX2 and FMA": {"GLIBC_TUNABLES": "glibc.cpu.hwcaps=-AVX2,-FMA"},
}


def forced(variables: dict[str, str], env_id: str, physics: str, seeds: tuple[int, ...]) -> dict[str, str]:
    """By seed: the hash of an episode that a new process with `variables` plays."""
    command = [sys.executable, "-m", "tests.env.episode_hashes", env_id, physics, "--seeds", *map(str, seeds)]
    environ = os.environ | {"OMP_NUM_THREADS": "1"} | variables
    child = subprocess.run(command, stdout=subprocess.PIPE, text=True, check=True, cwd=ROOT, env=environ)
    found: dict[str, str] = json.loads(child.stdout.splitlines()[-1])
    return found


def equal(variables: dict[str, str], env_id: str, physics: str, seeds: tuple[int, ...]) -> int:
    """The number of episodes that are equal to the record."""
    expected = recorded(env_id, physics)
    return sum(expected[seed] == found for seed, found in forced(variables, env_id, physics, seeds).items())


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("--seeds", nargs="+", type=int, default=SEEDS)
    seeds = tuple(parser.parse_args().seeds)
    print(f"| forced | {' | '.join(TASKS)} |\n|---|{'---|' * len(TASKS)}")
    for name, variables in {**FORCED, **NOT_PROMISED}.items():
        found = [sum(equal(variables, task, physics, seeds) for physics in PRESETS) for task in TASKS]
        print(f"| {name} | {' | '.join(f'{n} of {len(PRESETS) * len(seeds)}' for n in found)} |", flush=True)


if __name__ == "__main__":
    main()
