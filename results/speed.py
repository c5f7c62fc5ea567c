"""What frames, resets and pictures cost: `./run python results/speed.py`, on a machine that does nothing else.

Runs each of COMMANDS in a process of its own and writes docs/speed.md with what they print; takes about ten minutes.
"""

from __future__ import annotations

import os
import subprocess

from results.tables import COMMAND, HERE

PAGE = HERE.parent / "docs" / "speed.md"
HEAD = """# Speed

Made by `./run python results/speed.py`. Times belong to the machine that is named with them; compare ratios. What is
compared is taken in turn, in one process. In the minutes before, {load:.1f} processes on average wanted the machine's
cores: the tables hold what an idle machine does only if that is about 0.
"""
GPU = """## On a GPU

`./run gpu-check` checks and measures an NVIDIA GPU. **Nobody has run it on a GPU yet**: its parts are tested with one
environment on a CPU, and there are no numbers of a GPU. It writes the page `gpu` beside this one, in five parts:

- `tests`: what pytest says of the tests marked `gpu`, which no other machine runs.
- `state`: one batch of 1, 4, 16, 64, 256, 1,024 and 4,096 environments of fire, flood and wind with state observations:
  frames a second of all together, time of a step, time to start, memory of the GPU.
- `pictures`: the same for rgb, depth and segmentation of 128 pixels, up to 256 environments.
- `comparison`: one environment on the GPU beside the same on the CPU, and twice on the GPU: the largest differences of
  bodies, joints and hazards after 0 to 300 frames.
- `waits`: the lines at which the host waits for the GPU, and how often in a frame (`torch.cuda.set_sync_debug_mode`).

Each measurement is a process of its own. A table ends, with a line that says why, where the memory is exhausted or a
measurement takes longer than `--budget`, 300 seconds. What PhysX complains of, such as contacts for which its buffers
have no room, stands beside the numbers: these then belong to another simulation. Without a GPU the command ends at once
with status 1. For less at a time, and a page of its own:

```bash
./run gpu-check --parts tests comparison -o first.md
./run gpu-check --parts state -e HazardFire-v1 --most 256 -o second.md
```

The first simulation on a GPU lets SAPIEN download PhysX for GPUs from GitHub into `~/.sapien/physx`. A machine without
network needs that folder from one that has it.
"""
COMMANDS = {
    "Beside ManiSkill's own tasks": ("--against stock",),
    "By the number of things and the size of pictures": ("--scaling",),
    "Many resets": tuple(f"--resets -e {task}" for task in ("HazardFire-v1", "HazardFlood-v1", "HazardWind-v1")),
}


def main() -> None:
    """Write the page."""
    parts = [HEAD.format(load=os.getloadavg()[1])]
    for title, commands in COMMANDS.items():
        parts.append(f"## {title}\n")
        for words in commands:
            done = subprocess.run(
                [*COMMAND, "bench", *words.split()], cwd=HERE.parent, stdout=subprocess.PIPE, text=True, check=True
            )
            parts.append(f"`hazard-ms bench {words}` prints:\n\n{done.stdout.rstrip()}\n")
            print(parts[-1], flush=True)
    PAGE.write_text("\n".join([*parts, GPU]), encoding="utf-8")


if __name__ == "__main__":
    main()
