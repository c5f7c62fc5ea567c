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
    PAGE.write_text("\n".join(parts), encoding="utf-8")


if __name__ == "__main__":
    main()
