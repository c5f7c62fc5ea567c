"""What frames, resets and pictures cost: `./run python results/speed.py [PART...]`, on a machine that does no more.

Runs each of COMMANDS, or those of the parts that are named, in a process of its own and writes docs/speed.md with what
they print; all take about ten minutes.
"""

from __future__ import annotations

import os
import subprocess
import sys

from hazard_ms.spec.checks import one_of
from results.tables import COMMAND, HERE

PAGE = HERE.parent / "docs" / "speed.md"
HEAD = """# Speed

Made by `./run python results/speed.py`. Times belong to the machine named with them; compare ratios. Things
compared are measured in turn, in one process. Each part gives the machine's load in the minutes before: only near 0
do its tables show an idle machine.
"""
GPU = """## On a GPU

`./run gpu-check` checks and measures an NVIDIA GPU. It writes the page `gpu` beside this one, in seven parts:

- `tests`: the results of the tests marked `gpu`, which no other machine runs.
- `laws`: the hazards of 1, 4, 16, 64, 256, 1,024 and 4,096 environments of fire, flood and wind without a simulator:
  total frames per second, time per step, memory; 64 of them compared with the CPU and with a repeat; waits.
- `looks`: one environment simulated on the CPU and drawn on the GPU and on the CPU: time per look, and pixels that
  differ.
- `state`: a batch of 1 to 4,096 environments, simulated on the GPU, with state observations: total frames per second,
  time per step, time to start, GPU memory.
- `pictures`: the same for rgb, depth and segmentation of 128 pixels, up to 256 environments.
- `comparison`: one environment on the GPU compared with the CPU, and with a repeat on the GPU: the largest differences
  of bodies, joints and hazards after 0 to 300 frames.
- `waits`: the lines at which the host waits for the GPU, and how often per frame (`torch.cuda.set_sync_debug_mode`).

The last four need PhysX for GPUs. **They have not been run yet**: the only GPU so far, an H200, was on a machine
without network. There 4,096 fires of `paper` ran at 4.9 million frames per second in total, floods at 3.8 and winds
at 6.8 million (`realistic`: 267,000, 65,000 and 3.7 million), without the host ever waiting; 64 of each agreed with
the CPU to within rounding, and repeats agreed bit for bit (page `gpu`). On a machine with a GPU, a single
environment is simulated on the CPU and drawn on the GPU: its episodes are the same as on any other machine, bit for
bit. A look took 6 to 11 ms there and 34 to 116 ms on its CPU; labels differed in at most 0.002 % of the pixels, at
outlines, and depth by more than 2 mm in 0.006 %, outdoors in up to 1 %: distant ground at 256 pixels, by up to 0.2
% of its distance.

If SAPIEN sees a GPU, it draws on it even with `render_backend="cpu"`. To draw on the CPU there, hide the other drivers:
`VK_DRIVER_FILES=/usr/share/vulkan/icd.d/lvp_icd.x86_64.json`, or wherever lavapipe's file is.

Each measurement runs in its own process. A table ends, with the reason, when memory runs out or a measurement takes
longer than `--budget`, 300 seconds. Complaints of PhysX, such as contacts that do not fit its buffers, appear
beside the numbers, which then belong to another simulation. Without a GPU the command ends at once with status 1.
For less at a time, and a separate page:

```bash
./run gpu-check --parts tests comparison -o first.md
./run gpu-check --parts state -e HazardFire-v1 --most 256 -o second.md
```

At the first simulation on a GPU, SAPIEN downloads PhysX for GPUs from GitHub into `~/.sapien/physx`. On a machine
without network, copy that folder from one that has it.
"""
STOCK, SCALING, RESETS = "stock", "scaling", "resets"
TITLES = {
    STOCK: "Beside ManiSkill's own tasks",
    SCALING: "By the number of things and the size of pictures",
    RESETS: "Many resets",
}
COMMANDS = {
    STOCK: ("--against stock",),
    SCALING: ("--scaling",),
    RESETS: tuple(f"--resets -e {task}" for task in ("HazardFire-v1", "HazardFlood-v1", "HazardWind-v1")),
}


def measured(part: str) -> str:
    """The section of one of COMMANDS, measured now."""
    load = f"Load average in the minutes before: {os.getloadavg()[1]:.1f}.\n"
    lines = [f"## {TITLES[part]}\n", load]
    for words in COMMANDS[part]:
        command = [*COMMAND, "bench", *words.split()]
        done = subprocess.run(command, cwd=HERE.parent, stdout=subprocess.PIPE, text=True, check=True)
        lines.append(f"`hazard-ms bench {words}` prints:\n\n{done.stdout.rstrip()}\n")
        print(lines[-1], flush=True)
    return "\n".join(lines)


def kept(part: str) -> str:
    """The section of one of COMMANDS as it is on the page."""
    _, heading, rest = PAGE.read_text(encoding="utf-8").partition(f"## {TITLES[part]}\n")
    return heading + rest.split("\n## ")[0]


def main(wanted: list[str]) -> None:
    """Write the page, its parts called `wanted` measured anew, or all. Raises ValueError for unknown names."""
    chosen = [one_of(name, TITLES, "a part of the page") for name in wanted] or [*TITLES]
    parts = [measured(part) if part in chosen else kept(part) for part in TITLES]
    PAGE.write_text("\n".join([HEAD, *parts, GPU]), encoding="utf-8")


if __name__ == "__main__":
    main(sys.argv[1:])
