"""Plays episodes with other instructions of the processor, each in a new process, and compares them with the record.

As a program it prints how many of the 27 episodes are equal with each: `./run python -m tests.env.forced_instructions`.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import math
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import torch

from hazard_ms.machine.cores import maker
from tests.env.episode_hashes import PRESETS, SEEDS, TASKS, recorded

ROOT = Path(__file__).parents[2]
AVX512 = "avx512vl" in Path("/proc/cpuinfo").read_text()
PARTS = {  # what each variable changes, as `chosen` calls it
    "ATEN_CPU_CAPABILITY": "torch",
    "NPY_DISABLE_CPU_FEATURES": "numpy",
    "OPENBLAS_CORETYPE": "OpenBLAS",
    "MKL_CBWR": "MKL",
    "GLIBC_TUNABLES": "C library",
}
NATIVE = "what this processor has"
BEFORE_AVX2 = {
    "numpy without AVX2": {"NPY_DISABLE_CPU_FEATURES": "X86_V3 X86_V4 AVX512_ICL AVX512_SPR"},
    "OpenBLAS for SSE4": {"OPENBLAS_CORETYPE": "Nehalem"},
    "MKL for SSE2": {"MKL_CBWR": "COMPATIBLE"},
    "C library without AVX2 and FMA": {"GLIBC_TUNABLES": "glibc.cpu.hwcaps=-AVX2,-FMA"},
}
TOGETHER = {name: value for variables in BEFORE_AVX2.values() for name, value in variables.items()}
WITH_AVX512 = {
    "OpenBLAS for AVX-512": {"OPENBLAS_CORETYPE": "SkylakeX"},
    "torch for AVX-512": {"ATEN_CPU_CAPABILITY": "avx512"},
    NATIVE: {"ATEN_CPU_CAPABILITY": "avx512", "NPY_DISABLE_CPU_FEATURES": "", "OPENBLAS_CORETYPE": ""},
}
FORCED = {  # by what is forced, as far as this processor has it: variables of the process
    **BEFORE_AVX2,
    "all of these": TOGETHER,
    "OpenBLAS for AVX": {"OPENBLAS_CORETYPE": "Sandybridge"},
    **(WITH_AVX512 if AVX512 else {}),
    # on processors of other makers MKL knows COMPATIBLE alone
    **({"MKL for AVX2": {"MKL_CBWR": "AVX2"}} if AVX512 and maker() == "GenuineIntel" else {}),
}
NOT_PROMISED = {"torch without AVX2": {"ATEN_CPU_CAPABILITY": "default"}}  # what no processor with AVX2 does by itself


def chosen() -> dict[str, str]:
    """What the packages have chosen in this process, by the bits that they compute."""
    torch.set_num_threads(1)
    numbers = np.random.default_rng(0).random((300, 300))
    single = torch.from_numpy(numbers).float()
    bits = {
        "numpy": (np.exp(single.numpy()), np.exp(numbers)),
        "OpenBLAS": (numbers @ numbers,),
        "MKL": ((single @ single).numpy(), single.exp().numpy()),
        "C library": (np.array([math.exp(number) for number in numbers.flat]),),
    }
    made = {name: hashlib.sha256(b"".join(one.tobytes() for one in own)).hexdigest() for name, own in bits.items()}
    return {"torch": torch.backends.cpu.get_cpu_capability(), **made}


def chosen_with(variables: dict[str, str]) -> dict[str, str]:
    """The same in a new process with `variables`."""
    return _told(["tests.env.forced_instructions", "--chosen"], variables)


def forced(variables: dict[str, str], env_id: str, physics: str, seeds: tuple[int, ...]) -> dict[str, str]:
    """By seed: the hash of an episode that a new process with `variables` plays."""
    return _told(["tests.env.episode_hashes", env_id, physics, "--seeds", *map(str, seeds)], variables)


def _told(words: list[str], variables: dict[str, str]) -> dict[str, str]:
    environ = os.environ | {"OMP_NUM_THREADS": "1"} | variables
    command = [sys.executable, "-m", *words]
    child = subprocess.run(command, stdout=subprocess.PIPE, text=True, check=True, cwd=ROOT, env=environ)
    found: dict[str, str] = json.loads(child.stdout.splitlines()[-1])
    return found


def equal(variables: dict[str, str], env_id: str, physics: str, seeds: tuple[int, ...]) -> int:
    """The number of episodes that are equal to the record."""
    expected = recorded(env_id, physics)
    return sum(expected[seed] == found for seed, found in forced(variables, env_id, physics, seeds).items())


def main() -> None:
    every = {**FORCED, **NOT_PROMISED}
    parser = argparse.ArgumentParser()
    parser.add_argument("--seeds", nargs="+", type=int, default=SEEDS)
    parser.add_argument("--forced", nargs="+", choices=list(every), default=list(every))
    parser.add_argument("--chosen", action="store_true", help="only print what is chosen in this process")
    asked = parser.parse_args()
    if asked.chosen:
        print(json.dumps(chosen()))
        return
    seeds = tuple(asked.seeds)
    print(f"| forced | {' | '.join(TASKS)} |\n|---|{'---|' * len(TASKS)}")
    for name in asked.forced:
        found = [sum(equal(every[name], task, physics, seeds) for physics in PRESETS) for task in TASKS]
        print(f"| {name} | {' | '.join(f'{n} of {len(PRESETS) * len(seeds)}' for n in found)} |", flush=True)


if __name__ == "__main__":
    main()
